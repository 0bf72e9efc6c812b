"""Numbers with standard uncertainties, from text."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inerter.errors import UnitError
from inerter.records.uncertain import Uncertain, parse_uncertain

READ = {
    ("1 +- 1 %", ""): (1.0, 0.01),
    ("1 ± 0.5 %", ""): (1.0, 0.005),
    ("1.02 +/- 0.01", ""): (1.02, 0.01),
    ("1 +- 2 % (k = 2)", ""): (1.0, 0.01),
    ("1.5", ""): (1.5, 0.0),
    ("0.3 kg +- 10 g", "kg"): (0.3, 0.01),
    ("300 g +- 0.02 kg (k=2)", "kg"): (0.3, 0.01),
    ("2 kg +- 5 %", "kg"): (2.0, 0.1),
    ("2 kg", "kg"): (2.0, 0.0),
}


@pytest.mark.parametrize(("text", "unit"), READ)
def test_texts_are_read(text: str, unit: str) -> None:
    value, uncertainty = READ[text, unit]
    found = parse_uncertain(text, unit)
    assert found.value == pytest.approx(value)
    assert found.uncertainty == pytest.approx(uncertainty)


@given(st.floats(0.01, 100.0), st.floats(0.0, 0.4), st.sampled_from([1.0, 2.0, 3.0]))
def test_an_expanded_uncertainty_is_divided_by_its_coverage_factor(value: float, share: float, k: float) -> None:
    found = parse_uncertain(f"{value!r} +- {k * share * value!r} (k = {k})")
    assert math.isclose(found.value, value)
    assert math.isclose(found.relative, share, abs_tol=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "one",
        "1 +- ",
        "1 +- 1 % +- 2 %",
        "1 +- one %",
        "1 (k = 2)",
        "1 +- 1 % (k = 0)",
        "nan +- 1 %",
        None,
        [1.0],
        True,
    ],
)
def test_others_are_refused_with_an_example(text: object) -> None:
    with pytest.raises(UnitError, match=r'expected .* "1 \+- 1 %"'):
        parse_uncertain(text)


@pytest.mark.parametrize("text", ["-1 +- 1 %", "0 +- 0.1", "1 +- -1 %", "1 +- 60 %"])
def test_sizes_that_no_scale_has_are_refused(text: str) -> None:
    with pytest.raises(UnitError, match="expected"):
        parse_uncertain(text)


def test_a_text_of_one_is_read_back() -> None:
    for one in (Uncertain(1.0, 0.01), Uncertain(0.3, 0.01, "kg")):
        again = parse_uncertain(str(one), one.unit)
        assert (again.value, again.uncertainty) == pytest.approx((one.value, one.uncertainty))


@pytest.mark.parametrize(("unit", "examples"), [("kg", ("0.3 kg", "0.3 kg +- 3 %")), ("", ("1", "1 +- 1 %"))])
def test_examples_in_a_refusal_are_read(unit, examples):
    with pytest.raises(UnitError) as refused:
        parse_uncertain(["2 kg"], unit)
    for example in examples:
        assert f'"{example}"' in str(refused.value)
        parse_uncertain(example, unit)
