"""Quantities in text: "120 kN/m" to a number in SI units. Only this module uses pint, loaded on first use."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

from inerter.errors import UnitError
from inerter.frequent_units import FREQUENT

if TYPE_CHECKING:
    from pint import UnitRegistry

STANDARD_GRAVITY = 9.80665  # [m/s^2]
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*")
_NOT_FINITE = re.compile(r"\s*[+-]?(?:nan|inf|infinity)\b", re.IGNORECASE)
# Pint evaluates what it is given, so only names, small exponents and separators reach it.
_POWER = r"(?:(?:\^|\*\*)-?\d|[²³])"
_NAME = rf"[^\W\d_]++{_POWER}?+"
_UNIT = re.compile(rf"(?:{_NAME}|\((?:{_NAME}|[\s*/·.])++\){_POWER}|[()\s*/·.])+")  # a bracket with a power holds none
_DENSITY = "/Hz"  # suffix of a spectral density, which may be given per rad/s too
_PER_FREQUENCY = re.compile(r"\b[kM]?(?:Hz|hertz)\b|\brad(?:ian)?s?\b")
_ACCELERATIONS = {
    "g": "gravity",
    "G": "gravity",
    "gal": "Gal",
    **dict.fromkeys(("gn", "g_n", "g0", "g_0"), "gravity"),
}  # as meant in an acceleration, not grams and gallons
_FORCES = {"lb": "lbf", "lbs": "lbf", "lbm": "lbf", "kg": "kgf"}  # weight of a mass, as meant in a force
_MASS = re.compile(rf"\b({'|'.join(_FORCES)})\b")
_SPELLINGS = (  # that are often seen, and their replacements
    (re.compile(r"(?<=N)(?=s|m)|(?<=kg)(?=m)"), " "),
    (re.compile(r"(?<=[a-z])(?=[234]\b)"), "^"),
    (re.compile(r"\b(?:kmh|kmph)\b"), "km/h"),
)
_LETTERS = re.compile(r"[A-Za-z]+")
_CASES = {name.lower(): name for name in ("kg", "kN", "N", "km", "mm", "m", "s", "h", "Hz", "kmh")}  # of usual units
_THOUSANDS = re.compile(r"(?<=\d)[\s'’_](?=\d{3}(?!\d))")
PURE = "1"  # unit of a dimensionless number
_ROUGHNESS = "m^3/cycle"
_KAPPA_OVER = {0: 0.5 * 0.1**2, -1: 1.0 / (4.0 * math.pi)}  # Gd(n0) [m^3] and Gd(Omega0) [m^3/rad], by powers of rad
_FORMS = "a unit of Gd(n0) (m^3) or Gd(Omega0) (m^3/rad) of ISO 8608 or of kappa (m^3/cycle)", "256e-6 m^3"
_RATIO = "a ratio without a unit: 20 dB is 10 times an amplitude, and 100 times a power"
_NEVER_MEANT = re.compile(r"\b(?:[kM]?Nm|ct)\b")  # kilometres a kilogram, as of yarn, and a carat to pint
_LONGEST = 100
_IMPORTS, _PAUSE = 5, 0.2  # of pint: attempts, and seconds between them


def parse_quantity(text: str, unit: str) -> float:
    """Value of the quantity `text`, in `unit`.

    A roughness [m^3/cycle] may be given as ISO 8608 states it too: "256e-6 m^3" is the displacement spectral density at
    n0 = 0.1 cycle/m, Gd(n0) = 2 kappa / n0^2, and "16e-6 m^3/rad" that at Omega0 = 1 rad/m, Gd(Omega0) = 4 pi kappa.

    Cycles are counted, not turned into 2 pi rad: "m^3/cycle" is its own kind; "Hz" becomes 2 pi rad/s.

    Raises `UnitError` unless `text` is a finite number followed by a unit of the same kind as `unit`. Decibels and
    degrees Celsius, of which twice the number is not twice the quantity, are refused.

    >>> parse_quantity("120 kN/m", "N/m")
    120000.0
    """
    expected, example = _FORMS if unit == _ROUGHNESS else (f"a unit of {unit}", "")
    number, given = _split(text, expected, (unit,), example)
    if unit == _ROUGHNESS and (form := _density_form(given)) is not None:
        return _convert(text, number, given, "m^3") * _KAPPA_OVER[form]
    if not _have_same_dimension(given, unit):
        problem = f"incompatible unit {_describe_unit(given)}"
        meant = _as_force(given, (unit,)) or _as_acceleration(given, unit)
        like = f"{_number_of(text)} {meant or _with_prefix(given, unit)}"
        _fail(text, problem, expected, example or like)
    _check_density(text, given, unit)
    return _convert(text, number, given, unit)


def parse_one_of(text: str, units: Mapping[str, str], example: str, what: str = "element") -> tuple[str, float]:
    """The one of `units` with the dimension of the quantity `text`, and its value in that unit.

    `units` goes from a unit to the kind of `what` it is the unit of; `example` is one of them, for messages.

    Raises `UnitError` unless `text` is a finite number followed by a unit of one of these kinds.

    >>> parse_one_of("3.2 kN s/m", {"N/m": "spring", "N s/m": "damper"}, "N/m")
    ('N s/m', 3200.0)
    """
    number, given = _split(text, f"one of {', '.join(units)}", (example, *units))
    for unit in units:
        if _have_same_dimension(given, unit):
            _check_density(text, given, unit)
            return unit, _convert(text, number, given, unit)
    known = ", ".join(f"{unit} ({what})" for unit, what in units.items())
    force = _as_force(given, units)
    hint = f' Did you mean "{_number_of(text)} {force}"?' if force else ""
    raise UnitError(
        f"Got {quote_value(text)}: {_describe_unit(given)} is not the unit of any {what}; "
        f"expected one of {known}.{hint}"
    )


def unit_in(text: str) -> str:
    """Unit in a quantity of any kind, as written.

    Raises `UnitError` unless `text` is a finite number followed by a unit.
    """
    return _split(text, "its unit")[1]


def is_unit(unit: str) -> bool:
    """Whether `unit` is a known unit."""
    if unit in FREQUENT:
        return True
    if len(unit) > _LONGEST or not _UNIT.fullmatch(unit) or _NEVER_MEANT.search(unit):
        return False
    registry = _registry()  # whose failure says nothing of the unit
    try:
        registry.parse_units(unit)
    except Exception:  # pint's errors share no base: AttributeError, TypeError, AssertionError, tokenize's own
        return False
    return True


def is_unit_for(given: str, unit: str) -> bool:
    """Whether `parse_quantity` accepts quantities in `given` for `unit`.

    >>> is_unit_for("km/h", "m/s"), is_unit_for("m^3", "m^3/cycle"), is_unit_for("m^3", "kg")
    (True, True, False)
    """
    return are_compatible(given, unit) or (unit == _ROUGHNESS and _density_form(given) is not None)


def _density_form(given: str) -> int | None:
    """Power of rad in a unit of displacement spectral density of ISO 8608; None for other units."""
    if given in FREQUENT:
        return 0 if FREQUENT[given][0] == "m^3" else None
    if _dimension(given) != _dimension("m^3"):
        return None
    base = _registry().get_base_units(_registry().parse_units(given))[1]
    power = next((n for n in _KAPPA_OVER if base == _registry().parse_units("m^3") * _registry().radian ** n), None)
    return None if power and "rad" not in given else power  # of a degree or a turn the meaning is ambiguous


def are_compatible(unit: str, other: str) -> bool:
    """Whether both units have the same dimension.

    >>> are_compatible("km/h", "m/s"), are_compatible("kg", "N/m")
    (True, False)
    """
    return _have_same_dimension("" if unit == PURE else unit, "" if other == PURE else other)


def combine_units(one: str, sign: str, other: str) -> str:
    """Unit of the product ("*") or quotient ("/") of quantities in two units, in SI units.

    >>> combine_units("N/m", "/", "N/m"), combine_units("1", "/", "N/m")
    ('1', 'm/N')
    """
    parts = [_registry().parse_units("" if unit == PURE else unit) for unit in (one, other)]
    found = parts[0] * parts[1] if sign == "*" else parts[0] / parts[1]
    return f"{found:~D}".replace(" ** ", "^").replace(" * ", " ").replace(" / ", "/") or PURE


def quote_value(value: object) -> str:
    """Value as written in a study file, on one line and shortened, for messages."""
    match value:
        case dict():
            return "a table"
        case list() | tuple():
            return "a list"
        case str() | bool():
            text = json.dumps(value, ensure_ascii=False)
        case _:
            text = str(value)
    text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    return text if len(text) <= 62 else f"{text[:58]}..." + text[-1] * text.startswith('"')


def _split(text: object, expected: str, units: Sequence[str] = (), example: str = "") -> tuple[str, str]:
    """Number and known unit in `text`; the first of the right `units`, or an `example`, is for the error message."""
    example = example or (f"{_number_of(text)} {units[0]}" if units else "")
    if not isinstance(text, str):
        is_number = isinstance(text, int | float) and not isinstance(text, bool)
        _fail(text, "unit missing" if is_number else "not a quantity in quotes", expected, example)
    if _NOT_FINITE.match(text):
        _fail(text, "not a finite number", expected, example)
    number = _NUMBER.match(text)
    if number is None:
        _fail(text, "does not begin with a number", expected, example)
    given = text[number.end() :].strip()
    if given.startswith(","):
        _fail(text, "a comma in a number, where the decimal mark is a point", expected, example)
    if (joined := _THOUSANDS.sub("", text)) != text:
        left = _NUMBER.sub("", joined, count=1).strip()
        right = joined.strip() if left and is_unit(left) else example
        _fail(text, "separators in a number, which is written without", expected, right)
    if not given:
        _fail(text, "unit missing", expected, example)
    if not is_unit(given):
        why = "(units are case-sensitive; write a product with a space or *)"
        meant = _respell(given) or _ACCELERATIONS.get(given, "")
        if any(meant and _have_same_dimension(meant, unit) for unit in units):
            example = f"{number.group(1)} {meant}"
        _fail(text, f"unknown unit {quote_value(given)} {why}", expected, example)
    return number.group(1), given


def _check_density(text: object, given: str, unit: str) -> None:
    """Raise `UnitError` unless a spectral density is explicitly per Hz or per rad/s: seconds alone are ambiguous."""
    if unit.endswith(_DENSITY) and not _PER_FREQUENCY.search(given):
        why = "ambiguous density, per Hz or per rad/s"
        _fail(text, why, f"a unit of {unit}", f"{_number_of(text)} {unit}")


def _number_of(text: object) -> str:
    """Number in `text`, or a plausible one, for use in an example."""
    if isinstance(text, int | float) and not isinstance(text, bool) and abs(text) < 1e12:
        return quote_value(text)
    number = _NUMBER.match(text) if isinstance(text, str) and "," not in text else None
    return number.group(1) if number and len(number.group(1)) < 12 else "120"


def _as_force(given: str, units: Iterable[str]) -> str:
    """`given` with forces for its masses ("lbf/in" for "lb/in"), if compatible with one of `units`; else empty."""
    force = _MASS.sub(lambda mass: _FORCES[mass[0]], given)
    return force if force != given and any(_have_same_dimension(force, unit) for unit in units) else ""


def _as_acceleration(given: str, unit: str) -> str:
    """Unit of acceleration meant by `given` ("gravity" for "g") where `unit` is one of acceleration; else empty."""
    meant = _ACCELERATIONS.get(given, "")
    return meant if meant and _have_same_dimension(meant, unit) else ""


def _respell(given: str) -> str:
    """Unit that is meant by a usual spelling that is none ("kNs/m", "kg m2", "kmh", "KG"); else empty."""
    unit = _LETTERS.sub(lambda name: _CASES.get(name[0].lower(), name[0]), given)
    for pattern, replacement in _SPELLINGS:
        unit = pattern.sub(replacement, unit)
    return unit if unit != given and is_unit(unit) else ""


def _with_prefix(given: str, unit: str) -> str:
    """`unit`, with the k or M of `given` where that was probably meant ("120 kN" for N/m)."""
    return given[0] + unit if unit and given[:1] in ("k", "M") and given[1:2] == unit[0] else unit


def _convert(text: str, number: str, given: str, unit: str) -> float:
    # Dividing by a whole number is exact to the last digit where multiplying by its inverse is not: 0.3 mm = 0.0003 m.
    try:
        up, down = _factors(given, unit)
        if math.isnan(up):
            problem = f"{_describe_unit(given)} is a logarithmic unit, or one with another zero"
            if _have_same_dimension(unit, ""):
                _refuse(text, problem, _RATIO, "")
            _fail(text, problem, f"a unit of {unit}", f"120 {unit}")
        value = float(number) * up if up >= 1.0 else float(number) / down
    except (OverflowError, ZeroDivisionError):
        value = math.inf
    if not math.isfinite(value):
        _fail(text, "too large a number", f"a unit of {unit}", f"120 {unit}")
    return value


@cache
def _factors(given: str, unit: str) -> tuple[float, float]:
    """Size of one unit in the other, both ways; nan where quantities are not proportional, as those in decibels."""
    if given in FREQUENT and FREQUENT[given][0] == unit:
        return FREQUENT[given][1:]
    registry = _registry()
    one, other = registry.parse_units(given), registry.parse_units(unit)
    up, three = (float(registry.convert(number, one, other)) for number in (1.0, 3.0))
    if not math.isclose(three, 3.0 * up):
        return math.nan, math.nan
    return up, float(registry.convert(1.0, other, one))


def _have_same_dimension(given: str, unit: str) -> bool:
    """Whether quantities in `given` are quantities in `unit`: an angle is a dimension that may only be left out."""
    if given in FREQUENT and unit in FREQUENT:
        return FREQUENT[given][0] == FREQUENT[unit][0]
    return bool(_dimension(given) == _dimension(unit)) and _power_of_angle(given) in (0, _power_of_angle(unit))


@cache
def _dimension(unit: str) -> object:
    return _registry().parse_units(unit).dimensionality


@cache
def _power_of_angle(unit: str) -> float:
    """Power of an angle in a unit; each of its names by itself, as the factor of all together may overflow."""
    registry, power = _registry(), 0.0
    for name, exponent in registry.parse_units_as_container(unit).items():
        with_metre = registry.parse_units(name) * registry.meter  # of hertz alone pint remembers its own base units
        in_base: Mapping[str, Any] = dict((1.0 * registry.get_base_units(with_metre)[1]).unit_items())
        power += float(str(exponent)) * float(in_base.get("radian", 0.0))
    return power


def _describe_unit(given: str) -> str:
    """Unit as written, and in full, as for "kn", a knot."""
    full = str(_registry().parse_units(given))
    return f'"{given}"' if full == given else f'"{given}" ({full})'


def _fail(text: object, problem: str, expected: str, example: str) -> NoReturn:
    _refuse(text, problem, f"a number with {expected}", example)


def _refuse(text: object, problem: str, expected: str, example: str) -> NoReturn:
    like = f', such as "{example}"' if example else ""
    raise UnitError(f"Got {quote_value(text)}: {problem}; expected {expected}{like}.")


@cache
def _registry() -> UnitRegistry[Any]:
    pint = _import_pint()
    registry: UnitRegistry[Any] = pint.UnitRegistry(on_redefinition="ignore")
    # Pint has cycle = 2 pi rad and Hz = 1/s, each of which would silently put 2 pi into a road or a frequency.
    registry.define("cycle = [cycle]")
    registry.define("@alias pound = lbm")
    registry.define("hertz = 2 * pi * radian / second = Hz")
    return registry


def _import_pint() -> Any:
    """The module, imported again where another thread was importing what it shares, such as dask, at the same time.

    Python then hands out a module that is half imported, and the import of pint fails once.
    """
    for _ in range(_IMPORTS - 1):
        try:
            return import_module("pint")
        except ImportError:
            time.sleep(_PAUSE)
    return import_module("pint")
