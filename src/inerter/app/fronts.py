"""Long work on trade-offs: designs of which none is better than another in all of some indices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from inerter.app.answers import Body, texts_of
from inerter.app.documents import study_from
from inerter.app.kinds import Tell
from inerter.errors import StudyError
from inerter.files.study.limits import limits_in
from inerter.methods.registry import methods_that, searches
from inerter.optimisation.threads import one_blas_thread
from inerter.trade_off.pareto import pareto

_POINTS = 15


def front(body: Body, folder: Path, tell: Tell) -> Any:
    """The fronts of layouts over two or three indices: each point has its values, and the design that has them."""
    study = study_from(body["study"])
    layouts, indices = body.get("layouts") or list(study.layouts), body.get("indices") or list(study.indices[:2])
    if not 2 <= len(indices) <= 3:
        raise StudyError(f"A trade-off is one between two or three indices, got {len(indices)}.")
    method = study.method(body.get("method") or study.optimise or methods_that(searches)[0])
    points = body.get("points") or _POINTS
    limits = [limit for several in limits_in(study) for limit in several]
    fronts: list[dict[str, Any]] = []
    for number, layout in enumerate(layouts):
        tell(number, len(layouts), layout)
        asked = [study.asked(index, layout) for index in indices]
        with one_blas_thread():
            found = pareto(
                study.design(layout),
                asked,
                method,
                points=points,
                subject_to=limits,
                seed=study.seed,
            )
        several = zip(found.values.tolist(), found.parameters, found.statuses, strict=True)
        fronts.append(
            {
                "layout": layout,
                "points": [
                    {
                        "values": dict(zip(indices, values, strict=True)),
                        "parameters": parameters,
                        "texts": texts_of(study, parameters),
                        "status": status.kind.value,
                        "message": status.message,
                    }
                    for values, parameters, status in several
                ],
                "jumps": [list(pair) for pair in found.jumps],
                "knee": found.knee if len(found.values) else None,
                "status": found.status.kind.value,
                "message": found.status.message,
            }
        )
    tell(len(layouts), len(layouts), "")
    told = [{"index": index, "title": study.index(index).title, "unit": study.unit(index)} for index in indices]
    return {"indices": told, "fronts": fronts}
