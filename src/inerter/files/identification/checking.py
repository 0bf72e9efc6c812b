"""Check of an identification configuration without a record."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.files.common.suggest import some
from inerter.files.identification.loading import identification_of
from inerter.networks.elements import Free


def check_lines(tables: Mapping[str, Any], path: Path) -> Iterator[str]:
    """Sentences about a sound configuration: the model, and what is free; raises `StudyError` for another."""
    request = identification_of(tables, path)
    if request.layout is None and request.name is None:
        yield f"{path}: ok. Configuration for inerter identify, which also needs --model."
        return
    models = request.models()
    what = f"the layout {request.layout}" if request.layout is not None else f"the model {request.name}"
    if len(models) > 1:
        what = f"the best of {some(models)}"
    elements = [element for model in models.values() for element in model.elements()]
    free = dict.fromkeys(e.label for e in elements if isinstance(e.value, Free))
    yield f"{path}: ok. Configuration for inerter identify: {what}; to be identified: {some(free)}."
