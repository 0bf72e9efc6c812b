"""JSON Schema of study files, for completion and checks in editors."""

from __future__ import annotations

from typing import Any

from inerter.files.common.schema import json_schema
from inerter.files.study.sections import study_codec
from inerter.registry import cache_until_registration


@cache_until_registration
def study_schema() -> dict[str, Any]:
    """The schema, with what other distributions add."""
    about = "Vehicle, road, elements, layouts and indices. Every quantity is text with its unit."
    return json_schema(study_codec().schema(), "A study file of inerter", about)
