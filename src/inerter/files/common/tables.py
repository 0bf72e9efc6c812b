"""What every table of a file is."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import BaseModel, ConfigDict


class Shape(BaseModel):
    """A table of a study file; keys that it does not know are errors."""

    model_config = ConfigDict(extra="forbid")


Shapes = Mapping[tuple[str, ...], type[Shape]]
