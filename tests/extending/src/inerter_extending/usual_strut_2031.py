"""A paper of one table: ride comfort of the usual strut in closed form, for four dampings."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import inerter as it

_HERE = __name__
PRINTED = {500.0: "1.0937", 1000.0: "1.0209", 2000.0: "1.1872", 4000.0: "1.5752"}  # [N s/m], [m/s^2]
ROAD = it.Road(roughness=5e-7, speed=25.0)


@dataclass(frozen=True)
class Found:
    """The table recomputed: damping and value."""

    table: dict[float, float]
    studies: dict[str, Any] = field(default_factory=dict)


def work(damping: float) -> tuple[float, float]:
    """One row, in whichever process."""
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | it.Damper(damping))
    return damping, it.evaluate(car, it.RideComfort(ROAD), it.METHODS["quadrature"]()).value


def recompute(
    folder: Path,
    *,
    only: tuple[str, ...],
    finish: Callable[..., object],
    jobs: int = 1,
    executor: Any = None,
    resume: bool = False,
    force: bool = False,
    progress: Callable[[str, int, int], None] = lambda what, done, total: None,
) -> Found:
    intent = it.WriteMode(folder, "reproduce", ("table.csv", "report.html"), resume=resume, force=force)
    with it.open_results(intent) as results, it.worker_pool(jobs, executor) as pool:
        table: dict[float, float] = {}
        for damping, value in pool.spread(work, list(PRINTED)):
            table[damping] = value
            progress("rows", len(table), len(PRINTED))
        found = Found({damping: table[damping] for damping in PRINTED})
        finish(found, results.draft, pool)
    return found


def write(found: Found, folder: Path, pool: object) -> None:
    with (folder / "table.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, ["damping", "value", "printed"])
        writer.writeheader()
        writer.writerows(data(found)["table"])
    (folder / "report.html").write_text(f"<!DOCTYPE html><title>{PAPER.title}</title><pre>{text(found)}</pre>\n")


def data(found: Found) -> dict[str, Any]:
    return {"table": [{"damping": c, "value": value, "printed": float(PRINTED[c])} for c, value in found.table.items()]}


def text(found: Found) -> str:
    return "\n".join(f"{c:6g} N s/m  {value:.4f} m/s^2  printed {PRINTED[c]}" for c, value in found.table.items())


PAPER = it.PAPERS.add(
    it.Paper(
        name="usual-strut-2031",
        title="The usual strut (2031), Ride comfort in closed form",
        parts=("table",),
        claims={1: "Ride comfort is best for a damping near 1000 N s/m."},
        figures={},
        examples=("--only table",),
        recompute=f"{_HERE}:recompute",
        write=f"{_HERE}:write",
        data=f"{_HERE}:data",
        text=f"{_HERE}:text",
    )
)
