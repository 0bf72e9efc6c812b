"""A folder of a user with commands at work in it: what they cost is left out, what they write is not."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import count
from math import sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from study_text import study_text

from inerter.atomic_io import write_text
from inerter.files.common.listing import MARK, digest, listing
from inerter.files.identification.running import RESIDUALS, IdentificationResult
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.loading import load_study
from inerter.files.study.running import run_study
from inerter.report.identification import write_fit

STUDY = study_text('indices = ["J1", "J3"]')
RIG = """
[elements]
k = "10 kN/m"
f = "10 N"
b = "5 kg"
c = "50 N s/m"
[layouts]
device = "k | c - (b | f)"
[signal]
kind = "cosine"
amplitude = "1 mm"
frequency = "5 Hz"
"""
SIMULATION_FILE = f'[vehicle]\nmodel = "rig"\n{RIG}[simulation]\nduration = "20 ms"\nstep = "1 ms"\n'
RIG_FILE = f'{RIG}[rig]\nduration = "0.1 s"\nsampling = "100 Hz"\n'
TABLE = "time [s],displacement [mm],force [N]\n" + "".join(
    f"{i / 200},{sin(0.1 * i):.3f},{-20.0 * sin(0.1 * i) + 0.05 * (i * i % 11 - 5):.3f}\n" for i in range(300)
)
_numbers = count()
PARTS = ("study.toml", "simulation.toml", "rig.toml", "bench.csv")


def files_of(folder: Path) -> dict[str, bytes | str | None]:
    """All that is below a folder: bytes of files, targets of links, None for folders. Links are not followed."""
    found: dict[str, bytes | str | None] = {}
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = Path(place) / name
            content = str(path.readlink()) if path.is_symlink() else path.read_bytes() if path.is_file() else None
            found[path.relative_to(folder).as_posix()] = content
    return found


def inputs(folder: Path) -> None:
    """Write the files that commands read."""
    for name, text in zip(PARTS, (STUDY, SIMULATION_FILE, RIG_FILE, TABLE), strict=True):
        (folder / name).write_text(text, encoding="utf-8")


def drawn(*names: str) -> Callable[..., list[Path]]:
    """A stand-in for what draws figures into a folder."""

    def draw(first: Any, folder: Path, *others: Any, **more: Any) -> list[Path]:
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            write_text(folder / name, f"{name} of {type(first).__name__}\n" * 50)
        return [folder / name for name in names]

    return draw


def outcome(case: Case, study: Any, designs: object, threads: int) -> Outcome:
    """A stand-in for the search of a design."""
    value = {"norm": {index: float(len(case.layout + index) + study.seed) for index in study.indices}}
    error = {"norm": dict.fromkeys(study.indices)}
    return Outcome(case.layout, case.index, case.point, {}, {}, {}, 0, 0, 0, value, error, {"norm": "ok"})


def page(found: Any, folder: Path, *others: Any) -> None:
    """A stand-in for what writes the figures and the page of an identification or a reproduction."""
    drawn("fit.svg", "record.svg")(found, folder / "figures")
    write_text(folder / "report.html", "page\n" * 100)


def fit(found: Any, folder: Path) -> None:
    """What writes a fit, with something that differs from one to the next."""
    write_fit(found, folder)
    with (folder / RESIDUALS).open("a") as stream:
        stream.write(f"# {next(_numbers)}\n")


@contextmanager
def cheap(identified: IdentificationResult | None = None) -> Iterator[None]:
    """Inside, commands write as ever, but search, fit and draw nothing.

    The reproduction has its two linear studies, with the same folders and journals, and no simulated tasks.
    """
    paper = "inerter.papers.wang_su_2008.reproduce"
    with ExitStack() as stack:

        def change(place: str, by: object) -> None:
            stack.enter_context(patch(place, by))

        change("inerter.files.study.cases.Case.compute", outcome)
        change("inerter.report.writing.draw_study", drawn("improvement.svg", "improvement.png"))
        change("inerter.report.writing.draw_layouts", drawn("networks.svg", "networks.png"))
        change(
            "inerter.report.writing.write_report",
            lambda contents, figures, path: write_text(path, "page\n"),
        )
        change("inerter.cli.simulation.draw_simulation", drawn("simulation.svg", "simulation.png"))
        change("inerter.cli.identify.write_identification", page)
        change("inerter.cli.identify.write_fit", fit)
        if identified is not None:
            change("inerter.cli.identify.run_identification", lambda *arguments: identified)
        change("inerter.papers.wang_su_2008.report.page.write_reproduction", page)
        change(f"{paper}.linear.recompute", lambda studies: None)
        change(f"{paper}._figure11", lambda studies: None)
        change(f"{paper}.run_study", small_study)
        yield


def small_study(study: Any, folder: Any, **options: Any) -> Any:
    """The study of this module in the place of one of a paper."""
    with TemporaryDirectory() as place:
        inputs(Path(place))
        small = replace(load_study(Path(place) / PARTS[0]), title=study.title)
    return run_study(small, folder, **options)


def is_whole(folder: Path) -> bool:
    """Whether every file that the list of a folder names is there, and is what was written."""
    known = listing(folder)
    assert known is not None
    return all(digest(folder / name) in entry.digests for name, entry in known.files.items() if entry.digests)


def results_of(folder: Path) -> dict[str, bytes | str | None]:
    """What a user sees of a folder: all but our mark."""
    return {name: content for name, content in files_of(folder).items() if not name.startswith(MARK)}
