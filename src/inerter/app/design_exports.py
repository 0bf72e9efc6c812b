"""Designs in the formats of other programs, as `inerter export` writes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from inerter.app.designs import one_design
from inerter.app.documents import study_from
from inerter.exports.export import export_contents
from inerter.exports.registry import EXPORTS
from inerter.exports.request import ExportSpec


def export_design(body: Mapping[str, Any]) -> bytes:
    """Contents of the file of a design, in tables with the curves of one index.

    Raises what `export` raises, and `StudyError` for a study without such a design or index.
    """
    kind = EXPORTS[body["kind"]]
    study = study_from(body["study"])
    design = one_design(study, body)
    indices = [body["index"]] if body["index"] else study.indices[:1]
    request = ExportSpec(
        design.vehicle,
        kind.key,
        linear=body["linear"],
        indices={index: study.index(index) for index in indices} if "indices" in kind.takes else None,
        conventions=study.conventions,
        title=f"{' '.join(study.title.split())}, {design.name}",
    )
    return export_contents(kind, request, f"design{body['suffix'] or next(iter(kind.suffixes), '')}")
