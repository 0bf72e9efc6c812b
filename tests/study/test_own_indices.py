"""Indices by words, and those that a study file describes itself."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import pytest
from study_text import assert_refused, assert_survives, load_text, study_text
from synthetic import terminal_text

from inerter.files.study.running import run_study
from inerter.files.study.study import Study
from inerter.indices.names import index_names
from inerter.indices.registry import INDICES
from inerter.report.page import report
from inerter.report.study_contents import StudyContents

OWN = """[indices.grip]
kind = "tyre-load"
high_pass = "1 Hz"
[indices.pushed]
kind = "J5"
force = "1 kN"
"""


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., Study]:
    def load_file(settings: str, own: str = "", **parts: str) -> Study:
        return load_text(tmp_path, study_text(settings, **parts).replace("[study]", f"{own}[study]"))

    return load_file


def test_every_index_has_a_symbol_and_words() -> None:
    names = index_names()
    assert {names[symbol] for symbol in INDICES} == {*INDICES} == {*names.values()}
    assert {name: names[name] for name in ("ride-comfort", "tyre-load", "load-carrying")} == {
        "ride-comfort": "J1",
        "tyre-load": "J3",
        "load-carrying": "J5",
    }


def test_words_and_symbols_ask_the_same(load: Callable[..., Study], tmp_path: Path) -> None:
    by_symbol = run_study(load('indices = ["J1", "J3", "J5"]'), tmp_path / "symbols").data
    by_words = run_study(load('indices = ["ride-comfort", "tyre-load", "load-carrying"]'), tmp_path / "words").data
    np.testing.assert_array_equal(by_words["value"].values, by_symbol["value"].values)
    assert by_words["index"].values.tolist() == ["ride-comfort", "tyre-load", "load-carrying"]
    assert by_words["index_title"].values.tolist() == by_symbol["index_title"].values.tolist()


def test_an_own_index_is_its_kind_with_its_settings(load: Callable[..., Study], tmp_path: Path) -> None:
    study = load('indices = ["J3", "grip", "J1"]', OWN.partition("[indices.pushed]")[0])
    filtered = load('indices = ["J3"]\nhigh_pass = "1 Hz"')
    assert study.index("grip") == filtered.index("J3") != study.index("J3")
    data = run_study(study, tmp_path / "own").data
    alone = run_study(filtered, tmp_path / "alone").data
    np.testing.assert_array_equal(data["value"].sel(index="grip"), alone["value"].sel(index="J3"))
    page = report(StudyContents(data, study), tmp_path)
    assert "High-pass filter of grip" in page
    assert "Dynamic tyre load (grip)" in terminal_text(data)


def test_settings_of_the_study_are_those_of_its_indices_that_have_none(load: Callable[..., Study]) -> None:
    own = OWN + '[indices.plain]\nkind = "tyre-load"\n'
    study = load('indices = ["grip", "plain", "J5", "pushed"]\nhigh_pass = "2 Hz"\nevaluate = ["expected-value"]', own)
    assert study.index("grip").high_pass == pytest.approx(2 * pi)
    assert study.index("plain").high_pass == pytest.approx(4 * pi)
    assert (study.index("J5").amplitude, study.index("pushed").amplitude) == (None, 1000.0)
    assert_survives(study, study.path.parent)


def test_a_setting_of_an_own_index_is_swept(load: Callable[..., Study]) -> None:
    sweep = 'sweep = { "indices.grip.high_pass" = ["1 Hz", "0.1 Hz"] }'
    study = load(f'indices = ["grip"]\n{sweep}', OWN.partition("[indices.pushed]")[0])
    (swept,) = study.sweeps
    assert swept.words == "high-pass filter of grip"
    assert [study.at([value]).index("grip").high_pass for value in swept.values] == [2 * pi, 0.2 * pi]


BAD = {
    "no kind": ("[indices.grip]\n", '"grip"', "indices.grip.kind", ["missing", 'kind = "ride-comfort"']),
    "unknown kind": (
        '[indices.grip]\nkind = "tire-load"\n',
        '"grip"',
        "indices.grip.kind",
        ["not a kind of index", 'Did you mean "tyre-load"?'],
    ),
    "kind of number": ("[indices.grip]\nkind = 3\n", '"grip"', "indices.grip.kind", ["got 3"]),
    "unknown setting": (
        '[indices.grip]\nkind = "tyre-load"\nhigh_pas = "1 Hz"\n',
        '"grip"',
        "indices.grip.high_pas",
        ["unknown key", 'Did you mean "high_pass"?'],
    ),
    "setting of another kind": (
        '[indices.grip]\nkind = "tyre-load"\nforce = "1 kN"\n',
        '"grip"',
        "indices.grip.force",
        ["unknown key"],
    ),
    "setting in another unit": (
        '[indices.grip]\nkind = "tyre-load"\nhigh_pass = "1 m"\n',
        '"grip"',
        "indices.grip.high_pass",
        ["incompatible unit"],
    ),
    "name of an index": ('[indices.J1]\nkind = "tyre-load"\n', '"J1"', "indices.J1", ["has already", "comfort"]),
    "name in words": (
        '[indices.ride-comfort]\nkind = "tyre-load"\n',
        '"J1"',
        "indices.ride-comfort",
        ["has already"],
    ),
    "no name": ('[indices."a b"]\nkind = "tyre-load"\n', '"J1"', 'indices."a b"', ["not a layout name"]),
    "not asked": ('[indices.grip]\nkind = "tyre-load"\n', '"J1"', "indices.grip", ["not used", "no section"]),
    "no section": ("", '"grip"', "study.indices", ['"grip"', "not an index"]),
    "twice": ("", '"J1", "ride-comfort"', "study.indices", ["the same index", "at most once"]),
    "not tables": ('[indices]\ngrip = "tyre-load"\n', '"grip"', "indices.grip", ["not a table"]),
}


@pytest.mark.parametrize(("own", "asked", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_index_is_refused_with_its_place(
    load: Callable[..., Study], own: str, asked: str, place: str, words: list[str]
) -> None:
    assert_refused(lambda: load(f"indices = [{asked}]", own), place, words)
