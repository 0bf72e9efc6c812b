"""Numbers with their standard uncertainty, as stated by a calibration certificate.

The uncertainty is a standard one (k = 1) in the sense of JCGM 100:2008 (the GUM), 2.3.1, unless the text names another
coverage factor: "1 +- 2 % (k = 2)" is "1 +- 1 %". A limit of error +-a without a distribution has a standard
uncertainty of a / sqrt(3) (4.3.7).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from inerter.errors import UnitError
from inerter.formatting import format_alike, format_number, format_share
from inerter.units import parse_quantity, quote_value
from inerter.validation import is_number

_SIGNS = re.compile(r"\+/-|\+-|±")
_FACTOR = re.compile(r"\(\s*k\s*=\s*([0-9.]+)\s*\)\s*$")


@dataclass(frozen=True)
class Uncertain:
    """A positive number and its standard uncertainty, both in `unit` (empty for a ratio)."""

    value: float
    uncertainty: float = 0.0
    unit: str = ""

    def __post_init__(self) -> None:
        if not all(map(is_number, (self.value, self.uncertainty))) or self.value <= 0.0 or self.uncertainty < 0.0:
            raise UnitError(
                f"Got {self.value!r} +- {self.uncertainty!r}; expected a positive value and a standard uncertainty of "
                f"at least 0."
            )
        if self.uncertainty >= 0.5 * self.value:
            raise UnitError(
                f"Got {self.value!r} +- {self.uncertainty!r}; expected an uncertainty below half of the value."
            )

    @property
    def relative(self) -> float:
        """Standard uncertainty over the value."""
        return self.uncertainty / self.value

    def __str__(self) -> str:
        if self.unit:
            return " +- ".join(format_alike([self.value, self.uncertainty], self.unit))
        return f"{format_number(self.value)} +- {format_share(self.relative)}"


def parse_uncertain(text: object, unit: str = "") -> Uncertain:
    """The number and the standard uncertainty that a text such as "1 +- 1 %" or "0.3 kg +- 10 g" states.

    Raises `UnitError` for other texts, a value that is not positive, or an uncertainty of half of it or more.

    >>> parse_uncertain("1 +- 2 % (k = 2)"), parse_uncertain("0.3 kg +- 10 g", "kg").uncertainty
    (Uncertain(value=1.0, uncertainty=0.01, unit=''), 0.01)
    """
    example = f'"0.3 {unit}" or "0.3 {unit} +- 3 %"' if unit else '"1" or "1 +- 1 %"'
    if isinstance(text, Uncertain):
        return text
    if is_number(text) and not unit:
        return Uncertain(float(text))
    if not isinstance(text, str) or not text.strip():
        raise UnitError(_refusal_message(text, example))
    factor = _FACTOR.search(text)
    coverage = 1.0 if factor is None else _parse_number(factor[1], text, example)
    parts = _SIGNS.split(text if factor is None else text[: factor.start()])
    if len(parts) > 2 or not coverage > 0.0 or (factor is not None and len(parts) == 1):
        raise UnitError(_refusal_message(text, example))
    value = _parse_size(parts[0], unit, text, example)
    if len(parts) == 1:
        return Uncertain(value, 0.0, unit)
    spread = parts[1].strip()
    share = spread.endswith("%")
    wide = (
        0.01 * value * _parse_number(spread[:-1], text, example) if share else _parse_size(spread, unit, text, example)
    )
    return Uncertain(value, wide / coverage, unit)


def _parse_size(part: str, unit: str, text: object, example: str) -> float:
    return parse_quantity(part.strip(), unit) if unit else _parse_number(part, text, example)


def _parse_number(part: str, text: object, example: str) -> float:
    try:
        number = float(part)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise UnitError(_refusal_message(text, example))
    return number


def _refusal_message(text: object, example: str) -> str:
    return f"Got {quote_value(text)}; expected a value, alone or with its standard uncertainty, such as {example}."
