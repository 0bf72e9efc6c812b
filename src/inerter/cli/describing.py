"""What `inerter schema` does, in calls of the library: only what it needs is loaded."""

from __future__ import annotations

import json

from inerter.files.study.schema import study_schema


def schema() -> int:
    """Print the JSON Schema of study files; returns the exit code."""
    print(json.dumps(study_schema(), indent=2, ensure_ascii=False))
    return 0
