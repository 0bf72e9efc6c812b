"""Numbers as text: their digits are those that their errors justify, and they are read back."""

import ast
import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import inerter
from inerter.field_metadata import fields_of
from inerter.formatting import (
    choose_scale,
    decimal_places,
    format_alike,
    format_count,
    format_entry,
    format_number,
    format_percent,
    format_quantity,
    format_range,
    format_share,
    format_uncertain,
    format_with_error,
    format_with_interval,
    printed_text,
    shown_decimals,
    significant_digits,
    typeset,
    typeset_quantity,
)
from inerter.indices.registry import INDICES, index_settings
from inerter.networks.elements.registry import ELEMENTS, kinds_by_unit
from inerter.table import Quantity
from inerter.units import parse_quantity
from inerter.vehicle.registry import VEHICLES

SIZES = st.floats(1e-6, 1e9)
UNITS = sorted(
    {index.unit for index in INDICES.values()}
    | {setting.unit for setting in index_settings().values()}
    | {one.unit for vehicle in VEHICLES.values() for one in fields_of(vehicle)}
    | {element.unit for element in ELEMENTS.values()}
    | {"m/s", "m^3/cycle", "Hz"}
)


@given(
    st.floats(-1e15, 1e15).filter(lambda value: value == 0.0 or abs(value) > 1e-15),
    st.sampled_from((*kinds_by_unit(), "kg m^2", "m/s", "m^3/cycle", "rad/s", "s", "m/N")),
    st.integers(2, 9),
)
def test_formatted_text_reads_back_to_its_digits(value, unit, digits):
    read = parse_quantity(format_quantity(value, unit, digits), unit)
    assert read == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits), abs=0.0)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (120e3, "N/m", "120 kN/m"),
        (7544.2, "N s/m", "7.544 kN s/m"),
        (366.54, "kg", "366.5 kg"),
        (12345.6, "kg", "12350 kg"),
        (999.96, "N", "1 kN"),
        (0.5, "N", "0.5 N"),
        (0.0, "N", "0 N"),
        (1e-4, "m", "0.1 mm"),
        (1.265, "m", "1.265 m"),
        (2.5e6, "N/m", "2.5 MN/m"),
        (5e-7, "m^3/cycle", "5e-07 m^3/cycle"),
        (-3200.0, "N s/m", "-3.2 kN s/m"),
        (2e-3, "s", "2 ms"),
        (3e-6, "s", "3 us"),
        (5e12, "N/m", "5e+12 N/m"),
        (1e-12, "m", "1e-12 m"),
    ],
)
def test_format_chooses_prefix_and_digits(value, unit, text):
    assert format_quantity(value, unit) == text


@given(
    st.floats(1e-8, 1e8),
    st.floats(1e-4, 0.9),
    st.floats(0.0, 1.0),
    st.sampled_from(["kg", "N", "N/m", "N s/m", "m"]),
)
def test_a_value_with_an_interval_has_the_digits_that_the_interval_bears(middle, half, place, unit):
    low, high = middle * (1.0 - half), middle * (1.0 + half)
    value = low + place * (high - low)
    text, interval = format_with_interval(value, low, high, unit)
    first, _, second = interval.partition(" to ")
    name = second.partition(" ")[2]
    printed = [parse_quantity(part, unit) for part in (f"{first} {name}", second, text)]
    assert text.partition(" ")[2] == name
    for shown_value, exact in zip(printed, (low, high, value), strict=True):
        assert abs(shown_value - exact) <= 0.06 * middle * half  # half of the second digit of the half width, at most


@pytest.mark.parametrize(
    ("value", "low", "high", "unit"),
    [(950.0, 900.0, 1020.0, "N"), (1010.0, 960.0, 1060.0, "kN"), (0.0, 950.0, 1050.0, "kN")],
)
def test_an_interval_is_in_the_unit_of_its_value_or_of_its_upper_end_if_that_is_zero(value, low, high, unit):
    text, interval = format_with_interval(value, low, high, "N")
    assert text.partition(" ")[2] == unit
    assert interval.endswith(f" {unit}")


def test_an_interval_through_decades_has_a_unit_at_each_end():
    assert format_with_interval(50.0, 0.002, 5e5, "N") == ("50 N", "0.002 N to 500 kN")
    assert format_with_interval(50.0, 0.0, 60.0, "N") == ("50 N", "0 to 60 N")


@given(st.lists(SIZES, min_size=1, max_size=5), st.sampled_from(["N/m", "N s/m", "kg", "N", "m", "m/s^2"]))
def test_a_scaled_number_with_its_unit_is_the_value(values, unit):
    handy = choose_scale(values, unit)
    for value in values:
        assert parse_quantity(f"{value * handy.factor!r} {handy.unit}", unit) == pytest.approx(value, rel=1e-12)


@given(SIZES, st.floats(1e-12, 0.09))
def test_rounding_moves_a_value_by_no_more_than_its_error_bound(value, bound):
    text = format_quantity(value, "")
    coarse = format_quantity(value, "", bound=bound)
    digits = re.sub(r"e.*|\.", "", coarse).lstrip("0")
    assert len(digits.rstrip("0")) <= len(re.sub(r"e.*|\.", "", text).strip("0"))  # never more digits than without
    places = decimal_places(value, bound * value)
    assert float(coarse) == pytest.approx(value, abs=0.501 * 10.0**-places)
    least = places == decimal_places(value, value)  # two digits
    assert least or text == coarse or abs(float(coarse) - value) <= 1.001 * bound * value
    assert 0.5 * 10.0**-places >= 0.0999 * bound * value or least  # and the next digit would say nothing


@pytest.mark.parametrize(
    ("value", "error", "bound", "text"),
    [
        (2.5094, math.nan, math.nan, "2.509 N"),
        (2.5094, math.nan, 1e-9, "2.509 N"),
        (2.5094, math.nan, 1e-3, "2.509 N"),
        (2.5094, math.nan, 0.03, "2.5 N"),
        (502.9, math.nan, 0.03, "500 N"),
        (7912.0, math.nan, 0.3, "7.9 kN"),
        (2.50911, 0.00047, 1e-6, "2.50911 +- 0.00047 N"),
        (2.50911, 0.00047, 1e-4, "2.5091 +- 0.0005 N"),
        (2.50911, 0.00047, 1e-3, "2.509 N"),
        (185.457, math.nan, 0.0067, "185 N"),
        (185.457, math.nan, 0.03, "190 N"),
        (41.0, 3.0, 0.02, "41 +- 3 N"),
    ],
)
def test_digits_that_an_error_bound_and_a_standard_error_bear(value, error, bound, text):
    assert format_quantity(value, "N", error=error, bound=bound) == text


def test_an_improvement_has_tenths_only_if_its_bound_leaves_them():
    assert format_percent(13.74, bound=0.1) == "+13.7 %"
    assert format_percent(13.74, bound=0.5) == "+13.7 %"
    assert format_percent(13.74, bound=0.6) == "+14 %"
    assert format_percent(13.74, 0.05, 0.01) == "+13.74 +- 0.05 %"
    assert format_percent(13.74, 0.05, 0.6) == "+14 %"
    assert format_percent(0.3, bound=6.0) == "0 %"


@pytest.mark.parametrize("values", [[], [math.nan], [math.inf, math.nan], [0.0]])
def test_values_that_have_no_size_keep_their_unit(values):
    assert choose_scale(values, "N/m").factor == 1.0


@pytest.mark.parametrize(
    ("plain", "printed"),
    [
        ("2.428 m/s^2", "2.428 m/s²"),
        ("5e-07 m^3/cycle", "5 × 10⁻⁷ m³/cycle"),
        ("1e-05", "10⁻⁵"),
        ("1.2e+10 N", "1.2 × 10¹⁰ N"),
        ("-18.7 %", "−18.7 %"),
        ("offset -2.9 N (-0.2 to 1 %), bounds [-1, -inf]", "offset −2.9 N (−0.2 to 1 %), bounds [−1, −inf]"),
        ('state "-3 ms"; k - 2 on 2008-11-30, S1-2', 'state "-3 ms"; k - 2 on 2008-11-30, S1-2'),
        ("(m/s^2)/(m/s)", "(m/s²)/(m/s)"),
        ("20.76 um/N", "20.76 µm/N"),
        ("inf", "inf"),
    ],
)
def test_printed_numbers(plain, printed):
    assert typeset(plain) == printed


def test_numbers_that_are_none():
    assert format_quantity(math.inf, "N") == "inf"
    assert format_quantity(math.nan, "N") == format_percent(math.nan) == "n/a"
    assert format_percent(-math.inf) == "-inf %"
    assert format_percent(-0.01) == format_percent(0.01) == "0.0 %"


@given(SIZES, st.sampled_from(UNITS))
def test_a_number_and_its_unit_stay_on_one_line_and_words_part(value, unit):
    quantity = typeset(f"= {format_quantity(value, unit)}")[2:]
    text = (
        f"no design of 3 layouts has at most {quantity} with 2 {quantity}, 12 % of {quantity}; the nearest {quantity}."
    )
    lines = printed_text(text).split(" ")
    assert "".join(lines).replace("\xa0", "") == text.replace(" ", "")
    assert [line.replace("\xa0", " ") for line in lines] == [
        *("no", "design", "of", "3", "layouts", "has", "at", "most", quantity, "with", "2"),
        *(f"{quantity},", "12 %", "of", f"{quantity};", "the", "nearest", f"{quantity}."),
    ]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (-12.345, "-12.3"),
        (999.6, "1000"),
        (math.nan, "n/a"),
        (math.inf, "inf"),
        (-math.inf, "-inf"),
        (5e-324, "4.94e-324"),
        (1.7e308, "1.7e+308"),
        (123456.0, "123000"),
    ],
)
def test_numbers_of_any_size(value, text):
    assert format_number(value, 3) == text
    assert format_share(value / 100.0) == (text if math.isnan(value) else f"{text} %") or abs(value) < 1e-300
    quantity = text if not math.isfinite(value) else f"{text} kg"
    assert format_quantity(value, "kg", 3) == quantity
    assert typeset_quantity(value, "kg") == typeset(format_quantity(value, "kg")).replace(" ", "\N{NO-BREAK SPACE}")


def test_a_sign_is_shown_where_it_is_asked_for():
    assert format_number(0.25, 2, "+") == "+0.25"
    assert format_number(-0.25, 2, "+") == "-0.25"
    assert format_share(0.02, 2, "+") == "+2 %"


@pytest.mark.parametrize("value", [0.0, -3.0, 1e-300, 1e300, math.nan, math.inf])
def test_functions_of_several_numbers_accept_any(value):
    assert len(format_alike([value, 2.0 * value], "N")) == 2
    assert " to " in format_range(value, 2.0 * value, "N")
    assert format_range(5.0, math.inf, "N") == "5 N to inf"
    assert all(format_with_interval(value, value, 2.0 * value, "N"))
    assert " +- " in format_uncertain(value, 1.0)
    assert all(format_with_error(value, 1.0, "N"))
    assert format_entry(value)
    assert significant_digits(value) >= 1
    assert (shown_decimals(value, 1.0, 0.0, 4) is None) == (not math.isfinite(value))


@given(st.lists(SIZES, min_size=2, max_size=4), st.sampled_from(["N", "m", "s", "kg"]), st.integers(1, 6))
def test_compared_values_are_in_one_unit_and_differ_if_they_do(values, unit, digits):
    texts = format_alike(values, unit, digits)
    assert len({text.partition(" ")[2] for text in texts}) == 1
    for text, value in zip(texts, values, strict=True):
        assert parse_quantity(text, unit) == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits))
    rounded = {float(f"{value:.11e}") for value in values}
    assert len(set(texts)) == len(rounded)


@given(SIZES, st.floats(1.0, 1e6), st.sampled_from(["N", "m", "s", "kg"]))
def test_a_range_is_read_back(low, ratio, unit):
    first, _, second = format_range(low, low * ratio, unit).partition(" to ")
    first = first if " " in first else f"{first} {second.partition(' ')[2]}"
    assert parse_quantity(first, unit) == pytest.approx(low, rel=6e-4)
    assert parse_quantity(second, unit) == pytest.approx(low * ratio, rel=6e-4)


@given(SIZES, st.floats(1e-5, 1.0), st.sampled_from(["N", "m", "s", "kg"]))
def test_a_value_and_its_error_are_in_one_unit_with_as_many_decimals(value, relative, unit):
    first, second = format_with_error(value, relative * value, unit)
    assert first.partition(" ")[2] == second.partition(" ")[2]
    assert parse_quantity(first, unit) == pytest.approx(value, abs=0.06 * relative * value)
    assert parse_quantity(second, unit) == pytest.approx(relative * value, rel=0.06)


SOURCE = Path(inerter.__file__).parent
EXCEPTIONS = {
    "formatting.py": "the functions themselves",
    "app/examples": "programs of the user's, which print their own numbers; only an installed package has them",
    "papers": "claims state their numbers with the decimals of the print that they are compared with",
}


def float_formats(tree):
    """Format specifications of floating-point numbers, with their lines."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FormattedValue) and isinstance(node.format_spec, ast.JoinedStr):
            last = node.format_spec.values[-1] if node.format_spec.values else None
            if isinstance(last, ast.Constant) and str(last.value)[-1:] in tuple("eEfFgG%"):
                yield node.lineno, ast.unparse(node)


def test_numbers_are_formatted_in_one_place():
    files = {p.relative_to(SOURCE).as_posix(): p.read_text(encoding="utf-8") for p in sorted(SOURCE.rglob("*.py"))}
    found = [
        f"{name}:{line}: {text}"
        for name, source in files.items()
        if not name.startswith(tuple(EXCEPTIONS)) and re.search(r":[^:\n]*[eEfFgG%]\}", source)
        for line, text in float_formats(ast.parse(source))
    ]
    assert not found, "\n".join(found)


def test_one_thing_is_named_in_the_singular() -> None:
    assert [format_count(number, "break-even values") for number in (0, 1, 2)] == [
        "0 break-even values",
        "1 break-even value",
        "2 break-even values",
    ]


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (549.03, "N", "549.0 N"),
        (999.96, "N", "1.000 kN"),
        (0.20002, "m/s^2", "0.2000 m/s^2"),
        (549.0, "N", "549 N"),
        (22.2222222222222222 * 3.6, "km/h", "80 km/h"),
        (12345.6, "kg", "12350 kg"),
        (1.23e-9, "N", "1.23e-09 N"),
        (0.0, "N", "0 N"),
    ],
)
def test_a_table_keeps_the_zeros_of_a_rounded_number(value: float, unit: str, text: str) -> None:
    assert str(Quantity(value, unit)) == text
