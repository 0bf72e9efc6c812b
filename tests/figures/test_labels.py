"""Words and numbers for people: they mean what the results say."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from synthetic import designs, sweep

from inerter.field_metadata import fields_of
from inerter.figures.labels import (
    axis_label,
    compared_layouts,
    flat_range,
    layouts,
    percent,
    scale,
    swept_element,
    together,
    typeset,
    with_unit,
)
from inerter.indices.registry import INDICES, index_settings
from inerter.networks.elements.registry import ELEMENTS
from inerter.units import decimal_places, format_quantity, parse_quantity
from inerter.vehicle.registry import VEHICLES

SIZES = st.floats(1e-6, 1e9)
UNITS = sorted(
    {index.unit for index in INDICES.values()}
    | {setting.unit for setting in index_settings().values()}
    | {one.unit for vehicle in VEHICLES.values() for one in fields_of(vehicle)}
    | {element.unit for element in ELEMENTS.values()}
    | {"m/s", "m^3/cycle", "Hz"}
)


@given(st.lists(SIZES, min_size=1, max_size=5), st.sampled_from(["N/m", "N s/m", "kg", "N", "m", "m/s^2"]))
def test_a_scaled_number_with_its_unit_is_the_value(values, unit):
    handy = scale(values, unit)
    for value in values:
        assert parse_quantity(f"{value * handy.factor!r} {handy.unit}", unit) == pytest.approx(value, rel=1e-12)


@given(SIZES, st.floats(1e-12, 0.09))
def test_the_last_digit_is_no_smaller_than_the_error_bound(value, bound):
    text = with_unit(value, "")
    coarse = with_unit(value, "", bound=bound)
    digits = re.sub(r"e.*|\.", "", coarse).lstrip("0")
    assert len(digits.rstrip("0")) <= len(re.sub(r"e.*|\.", "", text).strip("0"))  # never more digits than without
    places = decimal_places(value, bound * value)
    assert float(coarse) == pytest.approx(value, abs=0.501 * 10.0**-places)
    assert 10.0**-places >= 0.999 * bound * value or places == decimal_places(value, value)  # two digits are left
    assert 10.0**-places < 10.0 * bound * value or text == coarse  # and no fewer than the bound leaves


@pytest.mark.parametrize(
    ("value", "error", "bound", "text"),
    [
        (2.5094, math.nan, math.nan, "2.509 N"),
        (2.5094, math.nan, 1e-9, "2.509 N"),
        (2.5094, math.nan, 1e-3, "2.51 N"),
        (2.5094, math.nan, 0.03, "2.5 N"),
        (502.9, math.nan, 0.03, "500 N"),
        (7912.0, math.nan, 0.3, "7.9 kN"),
        (2.50911, 0.00047, 1e-6, "2.50911 +- 0.00047 N"),
        (2.50911, 0.00047, 1e-4, "2.5091 +- 0.0005 N"),
        (2.50911, 0.00047, 1e-3, "2.51 N"),
        (41.0, 3.0, 0.02, "41 +- 3 N"),
    ],
)
def test_digits_that_an_error_bound_and_a_standard_error_bear(value, error, bound, text):
    assert with_unit(value, "N", error, bound) == text


def test_an_improvement_has_tenths_only_if_its_bound_leaves_them():
    assert percent(13.74, bound=0.1) == "+13.7 %"
    assert percent(13.74, bound=0.2) == "+14 %"
    assert percent(13.74, 0.05, 0.01) == "+13.74 +- 0.05 %"
    assert percent(13.74, 0.05, 0.2) == "+14 %"
    assert percent(0.3, bound=6.0) == "0 %"


@pytest.mark.parametrize("values", [[], [math.nan], [math.inf, math.nan], [0.0]])
def test_values_that_have_no_size_keep_their_unit(values):
    assert scale(values, "N/m").factor == 1.0


@pytest.mark.parametrize(
    ("plain", "printed"),
    [
        ("2.428 m/s^2", "2.428 m/s²"),
        ("5e-07 m^3/cycle", "5 × 10⁻⁷ m³/cycle"),
        ("1e-05", "10⁻⁵"),
        ("1.2e+10 N", "1.2 × 10¹⁰ N"),
        ("-18.7 %", "−18.7 %"),
        ("(m/s^2)/(m/s)", "(m/s²)/(m/s)"),
        ("20.76 um/N", "20.76 µm/N"),
        ("inf", "inf"),
    ],
)
def test_printed_numbers(plain, printed):
    assert typeset(plain) == printed


def test_numbers_that_are_none():
    assert with_unit(math.inf, "N") == "inf"
    assert with_unit(math.nan, "N") == percent(math.nan) == "n/a"
    assert percent(-math.inf) == "-inf %"
    assert percent(-0.01) == percent(0.01) == "0.0 %"


def test_the_baseline_comes_first_and_is_not_compared_with_itself():
    data = designs(["S2", "S1", "S3"])
    assert layouts(data) == ["S1", "S2", "S3"]
    assert compared_layouts(data) == ["S2", "S3"]
    assert compared_layouts(designs(["S1"], baseline="")) == []


def test_the_swept_element_is_the_dimension_that_only_a_sweep_has():
    assert swept_element(designs()) is None
    assert swept_element(sweep()) == "k"


def test_long_labels_take_two_lines_and_keep_units_whole():
    label = axis_label("Damping coefficient of the front axle", "kN s/m")
    assert label.count("\n") == 1
    assert "kN s/m".replace(" ", "\N{NO-BREAK SPACE}") in label.splitlines()[1]


def test_flat_optima_show_their_range() -> None:
    data = designs()
    entry = data.sel(layout="S2", index="J1", parameter="c")
    assert flat_range(entry) == ""
    wide = entry.assign(parameter_low=3000.0, parameter_high=40e3)
    assert flat_range(wide) == "3 kN s/m to 40 kN s/m"


@given(SIZES, st.sampled_from(UNITS))
def test_a_number_and_its_unit_stay_on_one_line_and_words_part(value, unit):
    quantity = format_quantity(value, unit)
    text = (
        f"no design of 3 layouts has at most {quantity} with 2 {quantity}, 12 % of {quantity}; the nearest {quantity}."
    )
    lines = together(text).split(" ")
    assert "".join(lines).replace("\xa0", "") == text.replace(" ", "")
    assert [line.replace("\xa0", " ") for line in lines] == [
        *("no", "design", "of", "3", "layouts", "has", "at", "most", quantity, "with", "2"),
        *(f"{quantity},", "12 %", "of", f"{quantity};", "the", "nearest", f"{quantity}."),
    ]
