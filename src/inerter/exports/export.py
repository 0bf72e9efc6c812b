"""`export`: a design in the format of another program."""

from __future__ import annotations

import os
from dataclasses import fields
from pathlib import Path
from typing import Any

from inerter.atomic_io import export as atomic_export
from inerter.errors import ExportError
from inerter.exports.kind import ExportKind
from inerter.exports.registry import EXPORTS
from inerter.exports.request import Exportable, ExportSpec
from inerter.formatting import format_list
from inerter.validation import checked


@checked(ExportError)
def export(
    of: Exportable, to: str, path: str | os.PathLike[str] | None = None, *, overwrite: bool = False, **options: Any
) -> Any:
    """A design in the format of another program; `inerter.EXPORTS` lists the kinds.

    `of` is a vehicle without free values, or what the kind takes besides: a network (drawings, `spice`, FMUs), a
    `LinearSystem` (linear models), a `Trajectory` (tables), a `Record` (tables, `matlab`). `options` are those of an
    `ExportSpec`, by name. Returns the object of Python for `control` and `scipy`; the path for a file that was written
    to `path`, or without `path` what it would hold, text or bytes.

    A file is written whole or not at all, and an existing one replaced with `overwrite` only.

    Raises `ExportError` for what the format cannot say, such as friction and gaps unless `linear` leaves them out, or
    for a file that cannot be written; `UnknownEntryError` for an unknown kind, `DesignError` if a value is free,
    `TypeError` for an unknown option.

    >>> from inerter import Damper, QuarterCar, Spring
    >>> car = QuarterCar(250.0, 35.0, 150e3, Spring(20e3) | Damper(2e3))
    >>> export(car, "scipy").input_labels
    ('road_velocity [m/s]', 'sprung_force [N]')
    """
    kind = EXPORTS[to]
    known = [field.name for field in fields(ExportSpec) if field.name not in ("of", "to")]
    if unknown := [name for name in options if name not in known]:
        raise TypeError(f"export() has no option {unknown[0]!r}. Its options: {format_list(known)}.")
    request = ExportSpec(of, to, **options)
    if path is None:
        return kind.contents(request, kind.suffixes[0] if kind.is_file else "")
    contents = export_contents(kind, request, path)
    with atomic_export(path, ExportError, overwrite=overwrite) as draft:
        draft.write_bytes(contents)
    return Path(path)


def export_contents(kind: ExportKind, request: ExportSpec, path: str | os.PathLike[str]) -> bytes:
    """The contents of a file of that name; raises `ExportError` for a suffix that the kind does not have."""
    check_suffix(kind, path)
    made: str | bytes = kind.contents(request, Path(path).suffix.lower())
    return made.encode() if isinstance(made, str) else made


def check_suffix(kind: ExportKind, path: str | os.PathLike[str]) -> None:
    """Raise `ExportError` unless a file of that name may hold such an export."""
    if not kind.is_file:
        raise ExportError(
            f'An export to {kind.key} is an object of Python, not a file: export(design, to="{kind.key}") returns it.'
        )
    if Path(path).suffix.lower() not in kind.suffixes:
        raise ExportError(
            f"{os.fsdecode(path)}: an export to {kind.key} is a file with the suffix {' or '.join(kind.suffixes)}."
        )
