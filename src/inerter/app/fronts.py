"""Long work on trade-offs: designs of which none is better than another in all of some indices."""

from __future__ import annotations

from dataclasses import replace
from math import isnan
from pathlib import Path
from typing import Any

import xarray as xr

from inerter.app.answers import Body, texts_of
from inerter.app.designs import describe_index, problem_digest
from inerter.app.documents import study_from
from inerter.app.kinds import RESULTS, Tell
from inerter.atomic_io import write_text
from inerter.errors import Status, StudyError
from inerter.files.study.parts import run_part
from inerter.files.study.running import csv_of
from inerter.files.study.study import Study
from inerter.files.study.tasks import TaskResults
from inerter.formatting import format_share, printed_text, shown_decimals
from inerter.methods.registry import methods_that, searches
from inerter.methods.ties import percent_below
from inerter.table import csv_rows, csv_text
from inerter.tasks.fronts import FrontAnswer, FrontPart, Fronts

_POINTS = 15
_EQUAL = 5e-3  # difference of values that are called equal [%]


def front(body: Body, folder: Path, tell: Tell) -> Any:
    """The fronts of layouts over two or three indices: each point has its values, and the design that has them."""
    study = study_from(body["study"])
    layouts, indices = body.get("layouts") or list(study.layouts), body.get("indices") or list(study.indices[:2])
    if not 2 <= len(indices) <= 3:
        raise StudyError(f"A trade-off requires two or three indices, got {len(indices)}.")
    method = body.get("method") or study.optimise or methods_that(searches)[0]
    asked = replace(study, trade_off=tuple(indices), optimise=method, points=body.get("points") or _POINTS)
    found: list[FrontAnswer] = []
    for number, layout in enumerate(layouts):
        tell(number, len(layouts), layout)
        found.append(run_part(asked, {}, FrontPart(layout)))
    (folder / RESULTS).mkdir(exist_ok=True)
    table = Fronts().table(TaskResults(asked, xr.Dataset(), found))
    write_text(folder / RESULTS / csv_of(Fronts.key), csv_text(csv_rows(table)))
    tell(len(layouts), len(layouts), "")
    baseline = study.baseline or next(iter(study.layouts))
    base = next((one for one in found if one.layout == baseline), None)
    return {
        "indices": [describe_index(study, index) for index in indices],
        "baseline": baseline,
        "fronts": [_describe_front(asked, one, base) for one in found],
    }


def _describe_front(study: Study, found: FrontAnswer, base: FrontAnswer | None) -> dict[str, Any]:
    points = []
    for i, (values, parameters, said) in enumerate(zip(found.values, found.parameters, found.statuses, strict=True)):
        status, message = Status.parts(said)
        decimals = [shown_decimals(one.value, one.error, one.bound) for one in found.quantities(study, i)]
        points.append(
            {
                "values": dict(zip(study.trade_off, values, strict=True)),
                "decimals": dict(zip(study.trade_off, decimals, strict=True)),
                "parameters": parameters,
                "texts": texts_of(study, parameters),
                "status": status,
                "message": message,
                "reference": _reference(study, found, i, base),
            }
        )
    return {
        "layout": found.layout,
        "problem_digests": [problem_digest(study, found.layout, index) for index in study.trade_off],
        "points": points,
        "jumps": found.jumps,
        "knee": found.knee,
        "status": found.status,
        "message": found.message,
    }


def _reference(study: Study, found: FrontAnswer, i: int, base: FrontAnswer | None) -> dict[str, Any] | None:
    """Knee with which a point is compared, and how it differs, in a sentence: of its own front, or of the baseline.

    The knee of a front is compared with that of the baseline. None where there is no other knee.
    """
    of = base if i == found.knee else found
    if of is None or of.knee is None or (of is found and i == of.knee):
        return None
    pairs = zip(study.trade_off, found.values[i], of.values[of.knee], strict=True)
    changes = ", ".join(_change(index, value, other) for index, value, other in pairs)
    name = f"{of.layout} at its knee"
    sentence = f"Relative to {name}: {changes}."
    return {"layout": of.layout, "point": of.knee, "name": name, "sentence": printed_text(sentence)}


def _change(index: str, value: float, other: float) -> str:
    """How an index differs from another value of it, in words."""
    percent = percent_below(value, other)
    if isnan(percent):
        return f"{index} is not comparable"
    if abs(percent) < _EQUAL:
        return f"equal {index}"
    return f"{format_share(abs(percent) / 100.0, 2)} {'lower' if percent > 0.0 else 'higher'} {index}"
