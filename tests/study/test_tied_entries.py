"""Values that follow from others in study files: what they are, and what cannot be."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study_text import assert_refused, assert_survives, load_text, study_text

import inerter as it
from inerter.errors import StudyError
from inerter.files.study.checking import check_study
from inerter.files.study.place import place_of
from inerter.files.study.places import with_numbers
from inerter.files.study.running import run_study
from inerter.files.study.study import Study, elements_used

OWN = """k = "60 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
k1 = { from = "70 kN/m", to = "1 MN/m" }
"""
MADE_UP = OWN + 'k2 = { tied = "1 / (1 / k - 1 / k1)" }'
ASK = 'indices = ["J1"]\noptimise = "norm"'


def study_of(folder: Path, elements: str, layouts: str, settings: str = ASK) -> Study:
    return load_text(folder, study_text(settings, elements=elements, layouts=layouts))


def test_a_spring_that_makes_up_a_stiffness(tmp_path: Path) -> None:
    """Two springs in series that are as stiff as one give what the one gives, whatever the first is."""
    study = study_of(tmp_path, MADE_UP, 'S1 = "k | c"\nS2 = "k1 - k2 | c"')
    check_study(study)
    strut = it.Spring(1.0 / (1.0 / 60e3 - 1.0 / it.tied("k1")), "k2")
    assert study.elements["k2"].unit == strut.unit
    for k1 in (80e3, 300e3):
        fixed = study.design("S2").with_values({"c": 2e3, "k1": k1})
        assert it.evaluate(fixed, it.static_stiffness("strut"), it.Norm()).value == pytest.approx(60e3, rel=1e-12)
    found = run_study(study, tmp_path / "out").data["value"].squeeze()
    assert float(found.sel(layout="S2")) == pytest.approx(float(found.sel(layout="S1")), rel=1e-9)
    assert elements_used(study)["k"] == ["S1", "S2"]


def test_a_tie_follows_a_sweep_and_survives_being_written(tmp_path: Path) -> None:
    sweep = ASK + '\nsweep = { k = ["40 kN/m", "50 kN/m"] }'
    study = study_of(tmp_path, MADE_UP, 'S2 = "k1 - k2 | c"', sweep)
    for k in (40e3, 50e3):
        fixed = study.design("S2", k).with_values({"c": 2e3, "k1": 80e3})
        assert it.evaluate(fixed, it.static_stiffness("strut"), it.Norm()).value == pytest.approx(k, rel=1e-12)
    assert_survives(study, tmp_path)


@pytest.mark.parametrize(
    ("tie", "layouts"),
    [
        ("0.4 * k", 'S1 = "k | c"\nS2 = "k | c - x"'),
        ("1 / (1 / k - 1 / k1)", 'S1 = "k1 | c"\nS2 = "k1 - x | c"'),
        ("c * c / b", 'S1 = "k | c - b"\nS2 = "k | x | c - b"'),
        ("c * c / k", 'S1 = "k | c"\nS2 = "k | c - x"'),
    ],
)
def test_a_tie_follows_a_condition(tmp_path: Path, tie: str, layouts: str) -> None:
    """The mean over conditions is that of a study that has these numbers from the beginning."""
    rng = np.random.default_rng(len(tie))
    elements = 'k = "60 kN/m"\nk1 = "300 kN/m"\nc = "2 kN s/m"\nb = "100 kg"\n' + f'x = {{ tied = "{tie}" }}'
    for _ in range(4):
        k, c = rng.uniform(20e3, 90e3, 2).tolist(), rng.uniform(1e3, 4e3, 2).tolist()
        sections = [f'[[conditions]]\nk = "{k[i]!r} N/m"\nc = "{c[i]!r} N s/m"\nshare = {i + 1}\n' for i in range(2)]
        study = study_of(tmp_path, elements, layouts, 'indices = ["J1"]\n' + "".join(sections))
        for layout in study.layouts:
            found = it.evaluate(study.design(layout), study.resolve_index("J1", layout), it.Norm()).value
            values = []
            for i in range(2):
                numbers = [(place_of("k"), k[i]), (place_of("c"), c[i])]
                there = with_numbers(replace(study, conditions=()), numbers)
                values.append(it.evaluate(there.design(layout), there.resolve_index("J1", layout), it.Norm()).value)
            assert found == pytest.approx((values[0] + 2.0 * values[1]) / 3.0, rel=1e-9)


def test_a_condition_of_what_a_free_value_follows_from_too_is_refused(tmp_path: Path) -> None:
    condition = ASK + '\n[[conditions]]\nk = "50 kN/m"'
    with pytest.raises(StudyError, match="k2 depends on it and on a design variable"):
        study_of(tmp_path, MADE_UP, 'S1 = "k | c"\nS2 = "k1 - k2 | c"', condition)


def test_what_is_in_no_layout_itself_does_not_scatter(tmp_path: Path) -> None:
    elements = 'k = "60 kN/m"\nc = "2 kN s/m"\nx = { tied = "2 * k" }'
    study = study_of(tmp_path, elements, 'S1 = "k | c"\nS2 = "x | c"', 'indices = ["J1"]\ntolerance = { k = 0.1 }')
    assert [study.spread(layout) for layout in ("S1", "S2")] == [{"k": 0.1}, {}]


@pytest.mark.parametrize(
    ("expression", "unit", "value"),
    [
        ("0.8 * c", "N s/m", 0.8 * 3.0),
        ("c / 4 + 2 * c", "N s/m", 0.75 + 6.0),
        ("c - 0.1 * c", "N s/m", 2.7),
        ("k1 * k / (k1 + k)", "N/m", 80e3 * 60e3 / 140e3),
        ("c * c / k", "kg", 9.0 / 60e3),
    ],
)
def test_the_units_of_an_expression_tell_its_element(tmp_path: Path, expression: str, unit: str, value: float) -> None:
    study = study_of(tmp_path, OWN + f'x = {{ tied = "{expression}" }}', 'S1 = "k1 | c | x"')
    assert study.elements["x"].unit == unit
    design = study.design("S1").with_values({"c": 3.0, "k1": 80e3})
    (found,) = [e.value for e in design.strut.elements() if e.name == "x"]
    assert found == pytest.approx(value, rel=1e-14)


BAD: dict[str, tuple[str, list[str]]] = {
    "nothing": ("", ["quotients"]),
    "no name": ("2 * 3", ["names no element"]),
    "unknown": ("0.8 * cc", ['"cc"', 'Did you mean "c"?']),
    "a tied one": ("0.8 * x", ['"x"', "elements with a value"]),
    "half of it": ("0.8 *", ["cannot be read"]),
    "a power": ("c ** 2", ["cannot be read"]),
    "a call": ("abs(c)", ["cannot be read"]),
    "a sign": ("-c", ["cannot be read"]),
    "unlike units": ("c + k", ["cannot be added"]),
    "no element's unit": ("c * k", ["it is in", "N/m"]),
    "too long": (" + ".join(["c"] * 100), ["quotients"]),
}


@pytest.mark.parametrize(("expression", "words"), BAD.values(), ids=BAD)
def test_a_bad_tie_is_refused_with_its_place(tmp_path: Path, expression: str, words: list[str]) -> None:
    own = OWN + f'x = {{ tied = "{expression}" }}'
    assert_refused(lambda: study_of(tmp_path, own, 'S1 = "k1 | c"'), "elements.x", words)


@pytest.mark.parametrize(
    ("entry", "settings", "place", "words"),
    [
        ("{ tied = 3 }", ASK, "elements.x", ["got 3"]),
        ('{ tied = "c", from = "1 N s/m" }', ASK, "elements.x", ['"from"', "alone"]),
        ('{ tied = "c" }', ASK + '\nsweep = { x = ["1 N s/m", "2 N s/m"] }', "study.sweep.x", ["tied to others"]),
    ],
)
def test_what_else_cannot_be(tmp_path: Path, entry: str, settings: str, place: str, words: list[str]) -> None:
    own = OWN + f"x = {entry}"
    assert_refused(lambda: study_of(tmp_path, own, 'S1 = "k1 | c | x"', settings), place, words, alone=False)
