"""Options that are quantities with a unit."""

from __future__ import annotations

from inerter.errors import StudyError, UnitError
from inerter.units import parse_quantity


def positive_option(name: str, text: str, unit: str) -> float:
    """The number of an option in SI units; raises `StudyError` unless it is a positive quantity of that unit."""
    option = f"--{name.replace('_', '-')}"
    try:
        value = parse_quantity(text, unit)
    except UnitError as error:
        raise StudyError(f"{option}: {error}") from None
    if value <= 0.0:
        raise StudyError(f'{option}: Got "{text}": not positive; expected more than 0 {unit}.')
    return value
