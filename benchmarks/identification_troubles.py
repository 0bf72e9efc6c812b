"""Does `identify` know a wrong model or sensor? Random rigs with one trouble each, sound ones, and sound ones on which
the friction never slips, by a simulator of their own (tests/troubled_rig.py), which shares no code with the package.

    python benchmarks/identification_troubles.py troubled [RECORDS] [PROCESSES]
    python benchmarks/identification_troubles.py sound [RECORDS] [PROCESSES]
    python benchmarks/identification_troubles.py sticking [RECORDS] [PROCESSES]

Results go line by line to identification-troubles-<kind>.jsonl in the current folder; a record that is in there is not
fitted again, so that an interrupted campaign can be resumed. Then it counts: of the intervals given without a warning
how many miss the truth, how many of the troubles are among the first two explanations, how many sound rigs are warned.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from troubled_records import Case, clean, fits_fault, model_of, record_of, sticking, troubled

import inerter as it


def case_of(kind: str, number: int) -> Case:
    return {"sound": lambda n: clean(n)[0], "sticking": sticking, "troubled": troubled}[kind](number)


def fit_member(task: tuple[str, int]) -> dict[str, object]:
    """One record fitted with the model of its device without the trouble, as data."""
    kind, number = task
    case = case_of(kind, number)
    begun = time.perf_counter()
    fit = it.identify(record_of(case, number), model_of(case), seed=0)
    seconds = time.perf_counter() - begun
    parameters = {
        name: {
            "identified": bool(fit.identifiable[name]),
            "verdict": fit.identifiable[name].verdict,
            "best": p.best,
            "interval": p.interval,
            "error": p.standard_error,
        }
        for name, p in fit.parameters.items()
    }
    return {
        "number": number,
        "fault": case.fault,
        "layout": case.layout,
        "seconds": seconds,
        "simulations": fit.simulations,
        "status": str(fit.status),
        "misfit": [fit.misfit.fitted, fit.misfit.checked],
        "predicted": fit.predicted,
        "explained": fit.variance_explained,
        "parameters": parameters,
        "explanations": [[e.name, e.explained, e.misfit.worst, e.sentence] for e in fit.explanations[:5]],
        "notes": list(fit.notes),
    }


def run(kind: str, count: int, processes: int) -> list[dict[str, object]]:
    path = Path(f"identification-troubles-{kind}.jsonl")
    done = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    todo = sorted(set(range(count)) - {row["number"] for row in done})
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(processes) as pool, path.open("a") as file:
        for row in pool.map(fit_member, [(kind, number) for number in todo]):
            file.write(json.dumps(row) + "\n")
            file.flush()
            done.append(row)
    return [row for row in sorted(done, key=lambda row: row["number"]) if row["number"] < count]


def misses(kind: str, row: dict[str, object]) -> tuple[int, list[str]]:
    """How many intervals of parameters are given, and which of them do not hold the truth."""
    truth = case_of(kind, row["number"]).truth
    given = {
        name: p
        for name, p in row["parameters"].items()
        if (p["identified"] or p["verdict"] == "conditional") and name in truth
    }
    missed = [n for n, p in given.items() if not p["interval"][0] <= truth[n] <= p["interval"][1]]
    return len(given), missed


def report(kind: str, rows: list[dict[str, object]]) -> None:
    warned = [row for row in rows if row["status"] != "ok"]
    seconds = np.median([row["seconds"] for row in rows])
    print(f"{len(rows)} {kind} rigs, {len(warned)} with a warning; median {seconds:.1f} s a fit")
    for which, group in (("without a warning", [r for r in rows if r not in warned]), ("with a warning", warned)):
        found = [(row, *misses(kind, row)) for row in group]
        given, missed = sum(n for _, n, _ in found), sum(len(m) for *_, m in found)
        print(f"  {which}: {given} intervals, {missed} miss ({100 * missed / max(given, 1):.1f} %)")
        for row, _, names in found:
            if names:
                print(
                    f"    {row['number']} {row['layout']}, {row['fault']}: {', '.join(names)}; misfit {row['misfit']}"
                )
    if kind != "troubled":
        for row in warned:
            print(f"  warned: {row['number']} {row['layout']}: {row['status']}")
        return
    named, of = Counter(), Counter()
    for row in rows:
        of[row["fault"]] += 1
        named[row["fault"]] += fits_fault(row["fault"], [(e[0], e[3]) for e in row["explanations"][:2]], row["notes"])
    for fault in of:
        print(f"  {fault}: {named[fault]} of {of[fault]} among the first two")
    counted = [fault for fault in of if fault not in ("fixture",)]
    share = sum(named[f] for f in counted) / sum(of[f] for f in counted)
    print(f"  all but known fixtures: {100 * share:.1f} %")


if __name__ == "__main__":
    what = sys.argv[1] if len(sys.argv) > 1 else "troubled"
    numbers = [int(text) for text in sys.argv[2:]]
    report(what, run(what, numbers[0] if numbers else 200, numbers[1] if len(numbers) > 1 else 2))
