"""What is to be known of a study before any work, as `inerter check` tells it."""

from __future__ import annotations

from typing import Any

from inerter.app.documents import problems_of, study_from
from inerter.errors import InerterError
from inerter.files.study.checking import check_study, study_notes
from inerter.files.study.study import Study, elements_used


def checked(document: object) -> dict[str, Any]:
    """What `inerter check` says of a document, and of what its layouts are made."""
    try:
        study = study_from(document)
        check_study(study)
    except InerterError as error:
        return {"problems": problems_of(error), "notes": [], "layouts": {}}
    return {"problems": [], "notes": study_notes(study), "layouts": _layouts(study)}


def _layouts(study: Study) -> dict[str, Any]:
    used = elements_used(study)
    return {
        name: {
            "mounts": layout.struts,
            "elements": [element for element, layouts in used.items() if name in layouts],
            "free": {
                element: {"lower": value.lower, "upper": value.upper, "unit": study.elements[element].unit}
                for element, value in study.design(name).free_values().items()
            },
        }
        for name, layout in study.layouts.items()
    }
