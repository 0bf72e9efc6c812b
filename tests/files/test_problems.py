"""A problem of a file keeps what it is made of, and becomes a sentence that says all of it."""

from __future__ import annotations

import shlex
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from folders import EXAMPLES
from hypothesis import given
from hypothesis import strategies as st

from inerter.errors import StudyError
from inerter.files.common.entries import one_of, positive_number, some_names
from inerter.files.common.kinds import kind_of, kind_with, kinds
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.toml import check_measurements
from inerter.files.identification.loading import load_identification
from inerter.files.rig.loading import load_rig
from inerter.files.simulation.loading import load_simulation
from inerter.files.study.loading import load_study

WORDS = st.text("abcdefgh", min_size=3, max_size=8)
MAYBE = st.one_of(st.just(""), WORDS)


@given(st.lists(WORDS, min_size=1, max_size=3), MAYBE, WORDS, MAYBE, MAYBE)
def test_the_sentence_says_the_place_and_every_part(
    place: list[str], got: str, fault: str, expected: str, hint: str
) -> None:
    problem = at(place, got=got, fault=fault, expected=expected, hint=hint and f"{hint}.")
    text = str(problem)
    assert text.startswith(f"{'.'.join(place)}: ")
    assert text.endswith(".")
    assert [part for part in (got, fault, expected, hint) if part not in text] == []
    assert problem == Problem(tuple(place), "", got, fault, expected, hint and f"{hint}.")


@given(WORDS, WORDS)
def test_an_entry_that_is_refused_keeps_its_parts(got: str, expected: str) -> None:
    error = EntryError(got=got, expected=expected)
    assert (error.problem.got, error.problem.expected) == (got, expected)
    assert str(error) == f"Got {got}; expected {expected}."


def test_every_check_of_an_entry_says_what_arrived_and_what_was_expected() -> None:
    for check, value in (
        (positive_number, -1),
        (one_of("a word", ("one", "two")), "thre"),
        (some_names("k").parse, []),
    ):
        with pytest.raises(EntryError) as refused:
            check(value)
        problem = refused.value.problem
        assert problem.got
        assert problem.expected or problem.fault


def test_the_words_of_a_problem_decide_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Other words in the place of all sentences: the same problems at the same places, in the same order."""
    file = tmp_path / "wrong.toml"
    file.write_text('[vehicle]\nmodel = "quarter-car"\nsprung = "1 kg"\n[rood]\n[study]\nindices = []\n')
    with pytest.raises(StudyError) as said:
        load_study(file)
    monkeypatch.setattr(Problem, "__str__", lambda problem: f"{'.'.join(problem.place)}: token")
    with pytest.raises(StudyError) as token:
        load_study(file)
    places = [[line.split(": ")[1] for line in str(error.value).splitlines()] for error in (said, token)]
    assert places[0] == places[1]
    assert len(places[0]) > 4


def test_a_refusal_has_a_line_for_each() -> None:
    problems = [at(("elements", "k 1"), fault="odd"), at((), "a sentence.")]
    assert str(refusal(Path("a.toml"), problems)).splitlines() == [
        'a.toml: elements."k 1": odd.',
        "a.toml: a sentence.",
    ]


LOADS = {"run": load_study, "simulate": load_simulation, "rig": load_rig, "identify": load_identification}


@pytest.mark.parametrize("section", [section for kind in kinds() for section in kind.sections])
def test_a_section_of_another_kind_of_file_says_which_and_is_one_of_its_own(section: str, tmp_path: Path) -> None:
    owner = kind_with(section)
    assert owner is not None
    assert {kind.command for kind in kinds()} == set(LOADS)
    path = tmp_path / "file.toml"
    hint = f"It is a section of {owner.plural}, for: inerter {owner.command}."
    for kind in kinds():
        sections = dict.fromkeys([*kind.sections, section])
        path.write_text("\n".join(f"[{one}]" for one in sections), encoding="utf-8")
        try:
            LOADS[kind.command](path)
        except StudyError as error:
            text = str(error)
        else:
            text = ""
        if kind == owner:
            assert f"{section}: unknown key" not in text
        elif (kind.command, section) != ("rig", "signal"):  # what a table and a road may both be
            assert f"{section}: unknown key" in text
            assert hint in text


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_file_of_another_kind_is_one_sentence_with_the_command_that_takes_it(example: Path) -> None:
    kind = kind_of(tomllib.loads(example.read_text(encoding="utf-8")))
    for other in kinds():
        if other != kind:
            with pytest.raises(StudyError) as refused:
                LOADS[other.command](example)
            text = f"this is a {kind.singular}; expected a {other.singular} for inerter {other.command}"
            assert str(refused.value) == f"{example.name}: {text}. Try: {kind.call(example)}"
    with pytest.raises(StudyError, match=f"this is a {kind.singular}; expected measurements"):
        check_measurements(example)


@pytest.mark.parametrize("size", [10, 200_000])
@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
def test_measurements_in_the_place_of_a_file_are_one_sentence(
    load: Callable[[Path], object], size: int, tmp_path: Path
) -> None:
    path = tmp_path / "bench.csv"
    path.write_text("time [s],force [N],displacement [m]\n" + "0.1,1,2\n" * size, encoding="utf-8")
    with pytest.raises(StudyError) as refused:
        load(path)
    assert "this is a file of measurements" in str(refused.value)
    assert f"Try: inerter identify {path}" in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_a_command_that_is_proposed_can_be_pasted_into_a_shell(tmp_path: Path) -> None:
    folder = tmp_path / "my cars; $HOME"
    folder.mkdir()
    study, record = folder / "a car.toml", folder / "run 1.csv"
    study.write_text((EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8"), encoding="utf-8")
    record.write_text("time [s],force [N]\n0.1,1\n", encoding="utf-8")
    for path, command in ((study, "run"), (record, "identify")):
        with pytest.raises(StudyError) as refused:
            load_simulation(path)
        _, _, proposed = str(refused.value).partition("Try: ")
        assert shlex.split(proposed)[:3] == ["inerter", command, str(path)]
