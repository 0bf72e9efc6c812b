"""Free networks in study files: what they are, what cannot be, and that only a search takes them."""

from __future__ import annotations

from pathlib import Path

import pytest
from study_text import assert_refused, assert_survives, load_text, study_text

import inerter as it
from inerter.errors import StudyError
from inerter.files.study import KIND
from inerter.files.study.checking import check_study
from inerter.files.study.drafts import Draft
from inerter.files.study.places import places
from inerter.files.study.study import Study, searched_layouts
from inerter.networks.free_network import FreeNetwork, free_networks

SPRINGS = 'springs = { from = "1 kN/m", to = "10 MN/m" }'
DAMPERS = 'dampers = { from = "10 N s/m", to = "1 MN s/m" }'
FIXED = 'k = "20 kN/m"\nc = { from = "100 N s/m", to = "100 kN s/m" }'
LAYOUTS = 'S1 = "k | c"\nS = "k | any"'
ASK = 'indices = ["J1"]\noptimise = "norm"'


def study_of(folder: Path, entry: str, layouts: str = LAYOUTS, settings: str = ASK) -> Study:
    return load_text(folder, study_text(settings, elements=f"{FIXED}\nany = {entry}", layouts=layouts))


@pytest.mark.parametrize(
    ("entry", "network"),
    [
        (f"{{ network = 3, {SPRINGS} }}", FreeNetwork(3, springs=(1e3, 1e7), name="any")),
        (
            f"{{ network = 5, at_least = 2, {SPRINGS}, {DAMPERS}, dampers_at_most = 2, bridges = true }}",
            FreeNetwork(5, (1e3, 1e7), (10.0, 1e6), min_elements=2, dampers_at_most=2, bridges=True, name="any"),
        ),
        (
            '{ network = 1, inerters = { from = "10 g", to = "100 t" }, inerters_at_most = 1 }',
            FreeNetwork(1, inerters=(0.01, 1e5), inerters_at_most=1, name="any"),
        ),
    ],
)
def test_a_free_network_is_read_and_written(tmp_path: Path, entry: str, network: FreeNetwork) -> None:
    study = study_of(tmp_path, entry)
    assert study.free_networks == {"any": network}
    assert free_networks(study.design("S").strut) == [network]
    assert searched_layouts(study) == {"S": ["any"]}
    again = assert_survives(study, tmp_path)
    assert again.free_networks == study.free_networks


def test_layouts_without_it_are_as_ever(tmp_path: Path) -> None:
    study = study_of(tmp_path, f"{{ network = 2, {SPRINGS} }}")
    assert study.design("S1").strut == it.network("k | c", k=it.Spring(20e3), c=it.Damper(it.free(100.0, 100e3, "c")))
    assert not any(label.startswith("any") for label in places(study))


@pytest.mark.parametrize(
    ("entry", "place", "words"),
    [
        (f"{{ network = 9, {SPRINGS} }}", "elements.any.network", ["got 9", "from 1 to 7"]),
        ("{ network = 2 }", "elements.any", ["without elements", "springs ="]),
        ('{ network = 2, springs = "3 N/m" }', "elements.any.springs", ['"3 N/m"', "from ="]),
        ('{ network = 2, springs = { from = "3 N/m", to = "1 N/m" } }', "elements.any.springs", ["reversed"]),
        ('{ network = 2, springs = { from = "3 kg", to = "1 N/m" } }', "elements.any.springs.from", ['"3 kg"', "N/m"]),
        (f"{{ network = 2, at_least = 3, {SPRINGS} }}", "elements.any", ["at_least = 3, network = 2"]),
        (f"{{ network = 2, {SPRINGS}, damper = {{}} }}", "elements.any.damper", ["unknown key", '"dampers"']),
        (f"{{ network = 2, {SPRINGS}, springs_at_most = -1 }}", "elements.any.springs_at_most", ["got -1"]),
    ],
)
def test_what_a_free_network_cannot_be(tmp_path: Path, entry: str, place: str, words: list[str]) -> None:
    assert_refused(lambda: study_of(tmp_path, entry), place, words)


def test_it_has_no_value_to_sweep(tmp_path: Path) -> None:
    sweep = f'{ASK}\nsweep = {{ any = ["1 kN/m", "2 kN/m"] }}'
    load = lambda: study_of(tmp_path, f"{{ network = 2, {SPRINGS} }}", settings=sweep)  # noqa: E731
    assert_refused(load, "study.sweep.any", ["a free network has no value"])


def test_it_needs_a_method_that_optimises(tmp_path: Path) -> None:
    load = lambda: study_of(  # noqa: E731
        tmp_path, f"{{ network = 2, {SPRINGS} }}", 'S = "k | any"', 'indices = ["J1"]'
    )
    assert_refused(load, "study.optimise", ["missing", "any"])


def test_a_run_refuses_it_and_names_the_search(tmp_path: Path) -> None:
    study = study_of(tmp_path, f"{{ network = 2, {SPRINGS} }}")
    with pytest.raises(StudyError, match=r"layouts\.S: any is a free network.*inerter search study\.toml"):
        check_study(study)


def test_schema_and_drafts_know_it() -> None:
    entries = KIND.schema()["properties"]["elements"]["additionalProperties"]["anyOf"]
    assert any("network" in entry.get("properties", {}) for entry in entries)
    draft = Draft({"elements": {"any": {"network": 2, "springs": {"from": "1 N/m", "to": "2 N/m"}}}, "layouts": {}})
    assert draft.elements == {}
