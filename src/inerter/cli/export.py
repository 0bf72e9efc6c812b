"""Implementation of `inerter export`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from inerter.cli.interrupts import interruptible
from inerter.cli.quantity_options import positive_option
from inerter.cli.streams import say
from inerter.errors import ExportError
from inerter.exports.export import check_suffix, export_contents
from inerter.exports.kind import ExportKind
from inerter.exports.registry import EXPORTS
from inerter.exports.request import ExportSpec
from inerter.files.common.folder import check_single, single
from inerter.files.common.suggest import missing_kind, nearest
from inerter.files.study.chosen_design import CHOOSE_ONE, WITHOUT_CONDITIONS, chosen_design
from inerter.units import quote_value

_BY = "export"


def export(
    source: Path,
    to: str | None,
    layout: str | None,
    index: str | None,
    point: int | None,
    condition: str | None,
    output: Path | None,
    options: Mapping[str, Any],
    *,
    speed: str | None,
    force: bool,
) -> None:
    """Export a design of a study file or of a folder of results to a file, with `options` of `ExportSpec`."""
    kind, part = _kind(to), options["part"]
    kind.check_options(name for name, value in {**options, "speed": speed}.items() if value)
    delayed = None if speed is None else positive_option("speed", speed, "m/s")
    if output is not None:
        check_suffix(kind, output)
        check_single(output, by=_BY, inputs=(), force=force)
    else:
        check_suffix(kind, f"design{kind.suffixes[0]}" if kind.is_file else "design")
    with interruptible():
        design = chosen_design(source, layout, index, point, condition)
        stem = source.stem if source.is_file() else source.resolve().name
        name = "-".join([stem, design.name, *([part] if part else [])])
        path = output or Path(f"{name}{kind.suffixes[0]}")
        check_single(path, by=_BY, inputs=design.inputs, force=force)
        titles = " ".join(design.study.title.split()), design.case.name, part, design.conditions_text
        indices = {design.case.index: design.index}
        request = ExportSpec(
            design.vehicle(),
            kind.key,
            **options,
            speed=delayed,
            indices=indices if "indices" in kind.takes else None,
            conventions=design.study.conventions,
            title=", ".join(filter(None, titles)),
        )
        contents = export_contents(kind, request, path)
        with single(path, by=_BY, inputs=design.inputs, force=force) as draft:
            draft.write_bytes(contents)
    say(f"{kind.description}: {path}")
    if design.study.conditions and condition is None:
        say(f"{WITHOUT_CONDITIONS}; {CHOOSE_ONE}")


def _kind(name: str | None) -> ExportKind:
    """The kind of export; raises `ExportError` for none or an unknown one, with those that are written to files."""
    files = {key: kind for key, kind in EXPORTS.items() if kind.is_file}
    if name is None:
        raise ExportError(missing_kind("--to", "exports", {key: kind.description for key, kind in files.items()}))
    if name in EXPORTS:
        return EXPORTS[name]
    opened = EXPORTS.synonym(name)
    hint = nearest(name, files) if opened is None else f" Try: --to {opened}"
    raise ExportError(f"Unknown kind of export {quote_value(name)}; available: {', '.join(files)}.{hint}")
