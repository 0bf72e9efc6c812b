"""Numbers as text: with a suitable unit, and with as many digits as their errors justify."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from inerter.units import PURE

_PREFIXES: dict[str, tuple[tuple[float, float, str], ...]] = {  # smallest size, factor, unit
    "N/m": ((1e6, 1e-6, "MN/m"), (1e3, 1e-3, "kN/m"), (0.0, 1.0, "N/m")),
    "N s/m": ((1e6, 1e-6, "MN s/m"), (1e3, 1e-3, "kN s/m"), (0.0, 1.0, "N s/m")),
    "N": ((1e6, 1e-6, "MN"), (1e3, 1e-3, "kN"), (0.0, 1.0, "N")),
    "m": ((1.0, 1.0, "m"), (1e-5, 1e3, "mm"), (0.0, 1e6, "um")),  # 0.1 mm is a gap, 5 um the clearance of a bearing
    "s": ((0.1, 1.0, "s"), (1e-5, 1e3, "ms"), (0.0, 1e6, "us")),
    "m/N": ((1.0, 1.0, "m/N"), (1e-3, 1e3, "mm/N"), (0.0, 1e6, "um/N")),
}
_DIGITS = 4  # of a quantity, unless more or fewer are asked for
_ALIKE = 1e-9  # of a number: closer ones are the same, but for the rounding of units
_MOST_DIGITS = 6  # of a value with an interval
_EXACT = 12  # digits to which values are shown that differ in fewer
_SMALL, _LARGE = 1e-4, 1e6  # numbers in a prefixed unit; others are written with a power of ten and without a prefix
_FAR = 100.0  # ratio of two numbers above which each has its own unit
_LEAST_ERROR = 1e-6  # of the value; a smaller standard error is rounding
_LEAST_PERCENT = 1e-4
_TENTH = 0.5 * (1.0 + 1e-9)
_SMALLEST, _LARGEST = 1e-6, 1e6  # errors that are written without a power of ten
_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
_NUMBER = re.compile(r"(?<![\w.])(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)(?![\w.]*[A-Za-z_\d])")  # not in a name, such as k1
_POWER = re.compile(r"\^(-?\d)")
_MINUS = re.compile(r"(?<![^ (\[])-(?=[\d.]|inf\b)")  # before a number, not within a word or a date
_MICRO = re.compile(r"(?:(?<=\d )|(?<=in )|(?<=[\[(]))u(?=[ms]\b)")
_UNIT = r"\(?[munµkMG]?(?:N|m|g|s|t|Hz|rad|cycle)(?![A-Za-z])[^\s,;:]*"
_LEAST = 1e-12  # of a number that is written without a power of ten, and its inverse
_EXPONENT = re.compile(
    rf"(?<![\w.])(\d+(?:\.\d+)?)e([+-])(?=\d\d|\d[ \xa0]{_UNIT})0*(\d+)\b"
)  # not in a name, such as 1e-3
_QUANTITY = re.compile(rf"(?<=[\d.⁰¹²³⁴⁵⁶⁷⁸⁹]) (?:%|{_UNIT}(?: {_UNIT})*)")
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """A unit that suits the size of some values; a value in SI units times `factor` is in it."""

    factor: float
    unit: str


def choose_scale(values: Iterable[float], unit: str) -> Scale:
    """The unit in which the middle one of `values` [`unit`] is a number of suitable size.

    >>> choose_scale([10e3, 300e3], "N/m"), choose_scale([0.0], "m")
    (Scale(factor=0.001, unit='kN/m'), Scale(factor=1.0, unit='m'))
    """
    sizes = sorted(abs(value) for value in values if value != 0.0 and math.isfinite(value))
    count = len(sizes)
    return _scale(0.5 * (sizes[(count - 1) // 2] + sizes[count // 2]) if sizes else 0.0, unit)


def is_prefixed(given: str, unit: str) -> bool:
    """Whether `format_quantity` may write quantities in `unit` in this unit.

    >>> is_prefixed("kN/m", "N/m"), is_prefixed("km/h", "m/s")
    (True, False)
    """
    return given in (unit, *(name for _, _, name in _PREFIXES.get(unit, ())))


def unit_choices() -> dict[str, list[tuple[float, float, Scale]]]:
    """Units that suit values of an SI unit, the largest first, each with the range of sizes that it suits.

    `choose_scale` takes the first one that suits the middle value, and the SI unit if none does.

    >>> unit_choices()["m/N"][-1]
    (1e-10, 1.0, Scale(factor=1000000.0, unit='um/N'))
    """
    return {
        unit: [(max(least, _SMALL / factor), _LARGE / factor, Scale(factor, name)) for least, factor, name in choices]
        for unit, choices in _PREFIXES.items()
    }


def format_number(value: float, digits: int = 6, sign: str = "") -> str:
    """Number as text with so many significant digits, without a power of ten unless far from 1; "n/a" for nan.

    With `sign` "+", a positive number has its sign too.

    >>> format_number(5000.0, 3), format_number(1.234e-7, 2), format_number(0.251, 2, "+")
    ('5000', '1.2e-07', '+0.25')
    """
    if math.isnan(value):
        return "n/a"
    text = f"{value:{sign}.{digits}g}" if value else "0"
    whole = "e" in text and 1.0 <= abs(value) < 10.0 ** max(digits, 9)
    return f"{float(text):{sign}.0f}" if whole else text


def format_complex(value: complex) -> str:
    """Complex number as text, as its real part where the imaginary one is rounding.

    >>> format_complex(-0.5 - 12.3456j), format_complex(-3.0 + 1e-15j)
    ('-0.5 - 12.35j', '-3')
    """
    if abs(value.imag) <= 1e-12 * abs(value):
        return format_number(value.real, _DIGITS)
    sign = "+" if value.imag > 0.0 else "-"
    return f"{format_number(value.real, _DIGITS)} {sign} {format_number(abs(value.imag), _DIGITS)}j"


def format_decimals(value: float, decimals: int, sign: str = "") -> str:
    """Number with so many decimals; without a sign if it rounds to zero, "n/a" for nan.

    >>> format_decimals(1.005, 1), format_decimals(-0.001, 2), format_decimals(0.5, 2, "+")
    ('1.0', '0.00', '+0.50')
    """
    if math.isnan(value):
        return "n/a"
    text = f"{value:{sign}.{decimals}f}"
    return text.lstrip("+-") if float(text) == 0.0 else text


def format_quantity(
    value: float,
    unit: str,
    digits: int = _DIGITS,
    *,
    error: float = math.nan,
    bound: float = math.nan,
) -> str:
    """Value [`unit`] as text: at most `digits` significant digits and a suitable prefix; "n/a" for nan, "inf".

    With a standard error, which then has two digits, the value has as many decimals; fewer where its largest other
    error, the relative `bound`, allows no more. Without one, `parse_quantity` reads the text back to its digits.

    >>> format_quantity(7544.2, "N s/m"), format_quantity(7544.2, "N s/m", error=23.0), format_quantity(2e-3, "s")
    ('7.544 kN s/m', '7.544 +- 0.023 kN s/m', '2 ms')
    >>> format_quantity(7544.2, "N s/m", bound=1e-3), format_quantity(float("nan"), "N")
    ('7.54 kN s/m', 'n/a')
    """
    if not math.isfinite(value):
        return format_number(value)
    if shows_error(value, error, bound):
        own = _scale(value, unit)
        return _with_unit(format_uncertain(value * own.factor, error * own.factor, bound), own.unit)
    return _in_scale(value, _scale(value, unit, digits), significant_digits(value, bound, digits))


def format_quantity_in_table(value: float, unit: str, *, error: float = math.nan, bound: float = math.nan) -> str:
    """Quantity as `format_quantity` gives it, but with zeros at the end where the value has more digits.

    >>> format_quantity(549.03, "N"), format_quantity_in_table(549.03, "N"), format_quantity_in_table(549.0, "N")
    ('549 N', '549.0 N', '549 N')
    """
    if math.isfinite(value) and not shows_error(value, error, bound):
        own, shown = _scale(value, unit), significant_digits(value, bound)
        text = f"{value * own.factor:.{shown}g}"
        if "e" not in text and abs(float(text) - value * own.factor) > _ALIKE * abs(value * own.factor):
            return _with_unit(_with_zeros(value * own.factor, shown), own.unit)
    return format_quantity(value, unit, error=error, bound=bound)


def format_alike(values: Iterable[float], unit: str, digits: int = _DIGITS) -> list[str]:
    """Texts of several values [`unit`] that are compared: in one unit, and different where the values are.

    >>> format_alike([950.0, 1050.0], "N"), format_alike([1.000002, 1.0], "m", 3)
    (['0.95 kN', '1.05 kN'], ['1.000002 m', '1 m'])
    """
    values = list(values)
    own = _scale(max((abs(value) for value in values if math.isfinite(value)), default=0.0), unit, digits)
    texts = [_in_scale(value, own, digits) for value in values]
    return texts if digits >= _EXACT or len(set(texts)) == len(set(values)) else format_alike(values, unit, digits + 1)


def format_range(low: float, high: float, unit: str, digits: int = _DIGITS) -> str:
    """Range of values [`unit`], in one unit; if it extends over decades, each end has its own.

    >>> format_range(0.0, 1500.0, "N"), format_range(900.0, 1100.0, "N"), format_range(5e-6, 1.0, "m")
    ('0 to 1.5 kN', '0.9 to 1.1 kN', '5 um to 1 m')
    """
    small, large = sorted((abs(low), abs(high)))
    own = _scale(large, unit, digits)
    far = 0.0 < small < large / _FAR and _scale(small, unit, digits) != own
    if far or not math.isfinite(large):
        return f"{format_quantity(low, unit, digits)} to {format_quantity(high, unit, digits)}"
    return f"{format_number(low * own.factor, digits)} to {_in_scale(high, own, digits)}"


def format_with_interval(value: float, low: float, high: float, unit: str) -> tuple[str, str]:
    """Texts of `value` and its interval [`unit`]: in one unit, with as many decimals as the interval justifies.

    The ends of an interval over decades have three digits.

    >>> format_with_interval(113.0123, 112.9917, 113.0331, "kg")
    ('113.012 kg', '112.992 to 113.033 kg')
    >>> format_with_interval(9.9997, 9.9973, 10.002, "N")
    ('9.9997 N', '9.9973 to 10.0020 N')
    >>> format_with_interval(-0.5e-3, -0.512e-3, -0.488e-3, "s")
    ('-0.500 ms', '-0.512 to -0.488 ms')
    """
    small, large = sorted((abs(low), abs(high)))
    own = _scale(value or high, unit) if math.isfinite(value or high) else Scale(1.0, unit)
    is_plain = low * high > 0.0 and large <= _FAR * small and _LEAST <= large * own.factor < 1.0 / _LEAST
    if not is_plain or not math.isfinite(value):
        return format_quantity(value, unit, 3), format_range(low, high, unit, 3)
    value, low, high = value * own.factor, low * own.factor, high * own.factor
    decimals = _decimals(low, high)
    ends = f"{low:.{decimals}f} to {high:.{decimals}f}"
    return _with_unit(f"{value:.{decimals}f}", own.unit), _with_unit(ends, own.unit)


def format_with_error(value: float, error: float, unit: str) -> tuple[str, str]:
    """Texts of `value` and its standard error [`unit`]: in one unit, with two digits of the error.

    >>> format_with_error(0.0012345, 3.21e-5, "s"), format_with_error(5.0, 0.0, "N")
    (('1.234 ms', '0.032 ms'), ('5 N', '0 N'))
    """
    if not shows_error(value, error):
        return format_quantity(value, unit), format_quantity(error, unit, 2)
    own = _scale(value, unit)
    first, _, second = format_uncertain(value * own.factor, error * own.factor).partition(" +- ")
    return _with_unit(first, own.unit), _with_unit(second, own.unit)


def format_uncertain(value: float, error: float, bound: float = math.nan, sign: str = "") -> str:
    """A number of a relative error `bound`, and its standard error; `sign` is "+" to show it always.

    >>> format_uncertain(2.50911, 0.00047), format_uncertain(2.50911, 0.00047, 1e-4)
    ('2.50911 +- 0.00047', '2.5091 +- 0.0005')
    """
    decimals = decimal_places(value, bound * abs(value), error)
    if not _SMALLEST < error < _LARGEST:
        return f"{value:{sign}.{max(decimals + 1 + _exponent(value), 1)}g} +- {error:.2g}"
    shown = max(decimals, 0)
    return f"{round(value, decimals):{sign}.{shown}f} +- {round(error, decimals):.{shown}f}"


def format_share(share: float, digits: int = 3, sign: str = "") -> str:
    """Share of a whole, or a relative change, in per cent.

    >>> format_share(0.12345), format_share(-0.02, sign="+")
    ('12.3 %', '-2 %')
    """
    return "n/a" if math.isnan(share) else f"{format_number(100.0 * share, digits, sign)} %"


def format_percent(value: float, error: float = math.nan, bound: float = math.nan) -> str:
    """Improvement [%] with its sign and, if known, its standard error, as text; "-inf %", or "n/a" for nan.

    `bound` is its largest other error [%]: beyond half a per cent there are no tenths, unless nothing else would
    be left of a value that is larger than it.

    >>> format_percent(13.74), format_percent(13.74, bound=0.6), format_percent(13.74, 0.05)
    ('+13.7 %', '+14 %', '+13.740 +- 0.050 %')
    >>> format_percent(-0.38, bound=0.11), format_percent(0.38, bound=0.6)
    ('-0.4 %', '0 %')
    """
    if math.isnan(value):
        return "n/a"
    if error >= _LEAST_PERCENT and math.isfinite(error) and abs(value) < _LARGEST and not error <= bound:
        return f"{format_uncertain(value, error, bound / max(abs(value), 1e-300), '+')} %"
    if abs(value) >= _LARGEST:
        return f"{value:+.3g} %"
    text = f"{value:+.{0 if bound > _TENTH and not bound < abs(value) < 1.0 else 1}f} %"
    return text[1:] if text in ("+0.0 %", "-0.0 %", "+0 %", "-0 %") else text


def format_percent_size(value: float, error: float = math.nan, bound: float = math.nan) -> str:
    """Percentage as `format_percent` gives it, without the sign of a positive one."""
    return format_percent(value, error, bound).removeprefix("+")


def format_entry(value: float, bound: float = math.nan) -> str:
    """A number of a table without its unit: four digits, or as many as its relative error `bound` justifies.

    >>> format_entry(2.5), format_entry(2.5, bound=0.03)
    ('2.500', '2.5')
    """
    digits = significant_digits(value, bound)
    text = _with_zeros(value, digits)
    return text if digits == _DIGITS or "e" not in text else format_number(value, digits)


def shows_error(value: float, error: float, bound: float = math.nan) -> bool:
    """Whether a standard error exists and is large enough to be shown next to a relative error `bound`."""
    least = _LEAST_ERROR if math.isnan(bound) else max(_LEAST_ERROR, bound)
    return bool(math.isfinite(value) and math.isfinite(error) and error > least * abs(value))


def decimal_places(value: float, bound: float = math.nan, error: float = math.nan, digits: int = _DIGITS) -> int:
    """Decimal places that a largest error `bound` and a standard `error` justify, both in the unit of the value.

    As many as two digits of the standard error have, without one as make `digits` significant digits; of places that
    round by no more than the bound the first is the last, but there are two significant digits at least, and one of a
    standard error. Below zero the number is rounded to tens, hundreds, ...

    >>> decimal_places(2.5094), decimal_places(2.5094, bound=0.02), decimal_places(2.5094, bound=1e-4, error=0.00046)
    (3, 2, 4)
    """
    size = _exponent(value)
    if math.isfinite(error) and error > 0.0:
        rounded = float(f"{error:.1e}")
        fine, least = 1 - _exponent(rounded), -_exponent(rounded)
    else:
        fine, least = digits - 1 - size, 1 - size
    if not bound > 0.0:
        return fine
    if math.isinf(bound):
        return least
    coarse = -math.floor(math.log10(2.0 * bound) + 1e-12)
    return max(min(fine, coarse), least)


def shown_decimals(value: float, error: float, bound: float, digits: int = _DIGITS) -> int | None:
    """Decimal places of a value with a standard error and a relative error `bound`; None unless it is finite.

    Where the standard error is not shown, there are at most `digits` significant digits.
    """
    if not math.isfinite(value):
        return None
    return decimal_places(value, bound * abs(value), error if shows_error(value, error, bound) else math.nan, digits)


def significant_digits(value: float, bound: float = math.nan, digits: int = _DIGITS) -> int:
    """Significant digits, `digits` at most, that a relative error `bound` justifies.

    >>> significant_digits(2.5094), significant_digits(2.5094, bound=5e-3)
    (4, 3)
    """
    return max(decimal_places(value, bound * abs(value), digits=digits) + 1 + _exponent(value), 1)


def label_with_unit(what: str, unit: str) -> str:
    """Label of a column or axis, with its unit in brackets if it has one.

    >>> label_with_unit("value", "N"), label_with_unit("ratio", "")
    ('value [N]', 'ratio')
    """
    return f"{what} [{unit}]" if unit else what


def typeset(text: str) -> str:
    """Printed form of plain units and numbers: superscripts, powers of ten, and proper minus signs; names are kept.

    What stands in quotes is to be typed, and remains as it is.

    >>> typeset("5e-07 m^3/cycle"), typeset("um = 3 um in 1e-3"), typeset_unit("um/N")
    ('5 × 10⁻⁷ m³/cycle', 'um = 3 µm in 1e-3', 'µm/N')
    >>> typeset('-3 dB and between -2 and 1 kN: state "-5 ms"')
    '−3 dB and between −2 and 1 kN: state "-5 ms"'
    """
    return outside_quotes(_typeset, text)


def outside_quotes(change: Callable[[str], str], text: str) -> str:
    """Text whose parts outside quotes are changed."""
    parts = text.split('"')
    return '"'.join(change(part) if i % 2 == 0 else part for i, part in enumerate(parts))


def _typeset(text: str) -> str:
    text = text.replace(" +- ", " ± ")
    text = _EXPONENT.sub(_power_of_ten, text)
    text = _POWER.sub(lambda power: power[1].translate(_SUPERSCRIPT), text)
    text = re.sub(r"^1 × (?=10)", "", text).replace(") 1 × 10", ") × 10")
    return _MICRO.sub("µ", _MINUS.sub("−", text))


def _power_of_ten(number: re.Match[str]) -> str:
    mantissa, sign, exponent = number.groups()
    return f"{mantissa} × 10{(sign.strip('+') + exponent).translate(_SUPERSCRIPT)}"


def typeset_unit(unit: str) -> str:
    """Printed form of a unit alone, as on an axis."""
    return re.sub(r"^u(?=[ms]\b)", "µ", typeset(unit))


def typeset_quantity(value: float, unit: str) -> str:
    """Value with its unit as `format_quantity` gives it, in printed form and without line breaks."""
    return typeset(format_quantity(value, unit)).replace(" ", _NO_BREAK_SPACE)


def printed_text(text: str) -> str:
    r"""`typeset` text without line breaks between a number, its error and its unit.

    >>> printed_text("at most 400 +- 3 N of 1 of 2").split(" ")
    ['at', 'most', '400\xa0±\xa03\xa0N', 'of', '1', 'of', '2']
    """
    return outside_quotes(_join_units, text)


def _join_units(text: str) -> str:
    parts = re.sub(r" ([±×]) ", rf"{_NO_BREAK_SPACE}\1{_NO_BREAK_SPACE}", _typeset(text))
    return _QUANTITY.sub(lambda found: found[0].replace(" ", _NO_BREAK_SPACE), parts)


def format_duration(seconds: float) -> str:
    """Duration for readers, in the largest unit of which it has at least two.

    >>> format_duration(119.0), format_duration(120.0)
    ('119 s', '2 min')
    """
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{round(seconds / size)} {unit}"
    return f"{round(seconds)} s"


def format_list(words: Sequence[str]) -> str:
    """Words one after another, as a sentence has them."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def format_some(words: Iterable[str], most: int) -> str:
    """The first words one after another, and the number of further ones.

    >>> format_some(["k", "c", "b", "f"], most=2)
    'k, c and 2 more'
    """
    known = list(words)
    more = f" and {len(known) - most} more" if len(known) > most else ""
    return f"{', '.join(known[:most])}{more}"


def merge_alike(texts: Sequence[str]) -> list[tuple[str, list[int]]]:
    """Texts that differ in their numbers alone as one text with their ranges, and the places of those texts.

    >>> merge_alike(["at most 5.4 % of k1", "none", "at most 3.9 % of k1"])
    [('at most 3.9 to 5.4 % of k1', [0, 2]), ('none', [1])]
    """
    alike: dict[tuple[str, ...], list[int]] = {}
    parts = [_NUMBER.split(text) for text in texts]  # words and numbers in turn
    for place, each in enumerate(parts):
        alike.setdefault(tuple(each[::2]), []).append(place)
    merged = []
    for places in alike.values():
        whole = list(parts[places[0]])
        for i in range(1, len(whole), 2):
            ends = sorted({parts[place][i] for place in places}, key=float)
            whole[i] = ends[0] if len(ends) == 1 else f"{ends[0]} to {ends[-1]}"
        merged.append(("".join(whole), places))
    return merged


def format_count(number: int, several: str) -> str:
    """A number of things that are named in the plural, as in 1 design, 2 designs."""
    return f"{number} {several.removesuffix('s') if number == 1 else several}"


def in_words(name: str) -> str:
    """Name of an output, an input or an element with spaces in place of underscores."""
    return name.replace("_", " ")


def capital(text: str) -> str:
    """The text as the beginning of a sentence."""
    return text[:1].upper() + text[1:]


def _scale(size: float, unit: str, digits: int = _DIGITS) -> Scale:
    """Unit for a value of this size, rounded to its digits; without a size, `unit` itself."""
    rounded = abs(float(f"{size:.{digits}g}"))
    rounded = rounded if rounded > 0.0 else 1.0
    choices = _PREFIXES.get(unit, ((0.0, 1.0, unit),))
    found = next(Scale(factor, name) for least, factor, name in choices if rounded >= least)
    return found if _SMALL <= rounded * found.factor < _LARGE else Scale(1.0, unit)


def _in_scale(value: float, own: Scale, digits: int) -> str:
    return (
        _with_unit(format_number(value * own.factor, digits), own.unit)
        if math.isfinite(value)
        else format_number(value)
    )


def _with_zeros(value: float, digits: int) -> str:
    """Number with all its significant digits, zeros at the end among them."""
    return re.sub(r"\.(?=e|$)", "", f"{value:#.{digits}g}")


def _with_unit(text: str, unit: str) -> str:
    return text if unit in ("", PURE) else f"{text} {unit}"


def _decimals(low: float, high: float) -> int:
    """Number of decimals for which half of the interval has two digits, within limits."""
    half, size = 0.5 * (high - low), max(abs(low), abs(high))
    if not half > 0.0 or not size > 0.0:
        return 3
    most = max(_MOST_DIGITS - 1 - math.floor(math.log10(size)), 0)
    return min(max(1 - math.floor(math.log10(half)), 0), most)


def _exponent(value: float) -> int:
    """Power of ten of the first digit."""
    return int(f"{value:.15e}".partition("e")[2]) if math.isfinite(value) else 0
