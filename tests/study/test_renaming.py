"""Renaming of elements: whatever names an element, the study computes the same numbers afterwards."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from campaigns import sampled

from inerter.app.about import examples
from inerter.errors import InerterError
from inerter.files.common.problem import EntryError
from inerter.files.study.drafts import rename_elements
from inerter.files.study.loading import study_of
from inerter.files.study.study import Study
from inerter.methods.method import evaluate

NEW = "other_name"
DOCUMENTS: dict[str, dict[str, Any]] = {name: tomllib.loads(path.read_text()) for name, path in examples().items()}
MEMBERS = [(name, element) for name, document in DOCUMENTS.items() for element in document["elements"]]
OFTEN = ("building_quake", "k")


def _numbers(study: Study) -> dict[tuple[str, str], float]:
    """Indices by the first method that needs no search, of designs in the middle of their bounds."""
    found = {}
    for layout in [] if study.free_networks else study.layouts:
        vehicle = study.design(layout)
        free = vehicle.free_values()
        vehicle = vehicle.with_values({name: math.sqrt(v.lower * v.upper) for name, v in free.items()})
        for index in study.indices:
            asked = study.resolve_index(index, layout)
            found[layout, index] = evaluate(vehicle, asked, study.method("norm")).value
    return found


def _study(tables: dict[str, Any]) -> Study:
    return study_of(tables, Path("study.toml"))


def _names(tables: Any) -> set[str]:
    """All names in texts and keys of tables."""
    return set(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", json.dumps(tables)))


@pytest.mark.parametrize(("name", "element"), sampled(MEMBERS, [OFTEN, ("limits", "b"), ("tolerances", "c")], kept=8))
def test_a_study_has_the_same_numbers_after_a_renaming(name: str, element: str) -> None:
    tables = DOCUMENTS[name]
    renamed = rename_elements(tables, {element: NEW})
    assert rename_elements(renamed, {NEW: element}) == tables
    assert list(renamed["elements"]) == [NEW if each == element else each for each in tables["elements"]]
    before, after = _study(tables), _study(renamed)
    assert _numbers(after) == _numbers(before)
    assert {NEW if each == element else each for each in before.tolerance} == set(after.tolerance)
    assert len(after.sweeps) == len(before.sweeps)
    assert [limit.value for limit in after.limits] == [limit.value for limit in before.limits]


EVERYWHERE: dict[str, Any] = {
    "vehicle": {
        "model": "mechanism",
        "coordinates": {"body": "250 kg", "wheel": "35 kg"},
        "struts": {"strut": {"upper": {"body": 1}, "lower": {"wheel": 1}}},
        "tyres": {"tyre": {"port": {"wheel": 1}, "road": "road", "network": "kt"}},
        "roads": {"road": {}},
        "forces": {"load": {"body": 1}},
        "measures": {
            "comfort": {"body_acceleration": 1},
            "tyre_load": {"kt_force": 1},
            "load_input": "load",
            "load_output": "body_displacement",
        },
    },
    "road": {"speed": "25 m/s", "roughness": "5e-7 m^3/cycle"},
    "elements": {
        "kt": "150 kN/m",
        "k": "20 kN/m",
        "c": {"from": "100 N s/m", "to": "10 kN s/m"},
        "b": {"tied": "0.01 * ratio"},
        "ratio": "900 kg",
        "f": "20 N",
        "unused": "1 N/m",
    },
    "layouts": {"S1": "k | c", "S3": {"strut": "k | c - (b | f)"}},
    "indices": {
        "stroke": {"kind": "element-stroke", "element": "k"},
        "push": {"kind": "element-force", "element": "c"},
        "sway": {
            "kind": "random-response",
            "outputs": {"c_force": 1.0, "k_force": 0.5},
            "excitation": {"force": "load", "intensity": "1 N^2/Hz"},
        },
        "gain": {"kind": "peak-response", "input": "load", "output": "k_force"},
    },
    "conditions": [{"k": "30 kN/m", "share": 0.3}, {"elements": {"k": "20 kN/m", "ratio": "950 kg"}, "share": 0.7}],
    "study": {
        "indices": ["J1", "J3", "stroke", "push"],
        "optimise": "norm",
        "baseline": "S1",
        "sweep": {"elements.ratio": ["800 kg", "900 kg"]},
        "tolerance": {"k": "10 %", "elements": {"c": 0.1}},
        "break_even": ["f"],
        "subject_to": {"stroke": {"at_most": "90 mm"}},
    },
}


def _valid() -> dict[str, Any]:
    """The tables without what excludes each other."""
    study = {key: value for key, value in EVERYWHERE["study"].items() if key not in ("sweep", "break_even")}
    return {**EVERYWHERE, "study": {**study, "indices": ["J1", "J3", *EVERYWHERE["indices"]]}}


@pytest.mark.parametrize("element", EVERYWHERE["elements"])
def test_no_place_keeps_an_old_name(element: str) -> None:
    renamed = rename_elements(EVERYWHERE, {element: NEW})
    old = {element, *(f"{element}_{what}" for what in ("force", "velocity", "stroke"))}
    assert not _names(renamed) & old
    assert rename_elements(renamed, {NEW: element}) == EVERYWHERE


NAMES = [NEW, "share", "road", "study", "constructor", "toString", "name"]
RENAMED = [(element, new) for element in EVERYWHERE["elements"] for new in NAMES]


@pytest.mark.parametrize(("element", "new"), sampled(RENAMED, [each for each in RENAMED if each[0] == "c"], kept=4))
def test_every_name_gives_the_same_numbers(element: str, new: str) -> None:
    """Also names that are keys of a condition, sections of a file, or attributes of objects in other languages."""
    before, after = _study(_valid()), _study(rename_elements(_valid(), {element: new}))
    assert _numbers(after) == _numbers(before)
    assert _conditions(after) == _conditions(before)
    assert after.tolerance == {new if name == element else name: part for name, part in before.tolerance.items()}


def _conditions(study: Study) -> list[tuple[float, list[float]]]:
    return [(condition.share, sorted(condition.numbers.values())) for condition in study.conditions]


def test_names_may_be_exchanged() -> None:
    exchanged = rename_elements(EVERYWHERE, {"k": "c", "c": "k"})
    assert rename_elements(exchanged, {"k": "c", "c": "k"}) == EVERYWHERE
    assert exchanged["indices"]["sway"]["outputs"] == {"k_force": 1.0, "c_force": 0.5}


@pytest.mark.parametrize(("element", "new"), [("k", "strut"), ("c", "strut"), ("c", "c2"), ("k", "c"), ("k", "2k")])
def test_a_name_that_would_change_the_meaning_is_refused(element: str, new: str) -> None:
    """An output of the strut is not one of a spring that is called so; a name that is free is taken."""
    if new == "c2":
        assert new in rename_elements(_valid(), {element: new})["elements"]
        return
    with pytest.raises(EntryError) as refused:
        rename_elements(_valid(), {element: new})
    assert refused.value.args


@pytest.mark.parametrize("spoilt", [{"layouts": {"S1": "k | ("}}, {"indices": {"x": 3}}, {"study": None}])
def test_tables_that_are_no_study_yet_are_renamed(spoilt: dict[str, Any]) -> None:
    tables = {**EVERYWHERE, **spoilt}
    with pytest.raises(InerterError):
        _study(tables)
    assert "spring" in rename_elements(tables, {"k": "spring"})["elements"]
