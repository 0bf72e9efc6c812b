"""Notes of designs are one where they differ in numbers alone, whatever their words."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path

from folders import EXAMPLES
from hypothesis import given
from hypothesis import strategies as st
from study_text import ELEMENTS, study_text

from inerter.files.study.cases import Case, Outcome, cases, run_case
from inerter.files.study.loading import load_study
from inerter.files.study.results import dataset
from inerter.methods.notes import Note, parts_of, text_of

STUDY = load_study(EXAMPLES / "quarter-car.toml")
WORDS = st.text("abc 0123456789.{}", min_size=1, max_size=12)
NUMBERS = st.floats(1e-3, 1e6)


@given(WORDS, WORDS, st.data())
def test_the_range_of_the_numbers_stands_in_one_note(before: str, after: str, data: st.DataObject) -> None:
    """Digits in the words are words."""
    layouts = list(STUDY.layouts)[:2]
    values = {case: data.draw(NUMBERS) for case in cases(STUDY) if case.layout in layouts}
    found = {case: _outcome(case, Note(f"x{before}", value, after)) for case, value in values.items()}
    low, high = (text_of((end(values.values()),)) for end in (min, max))
    many = low if low == high else f"{low} to {high}"
    assert dataset(STUDY, found).attrs["notes"] == f"{', '.join(layouts)}: x{before}{many}{after}"


def test_a_note_is_a_text_that_keeps_its_numbers() -> None:
    note = Note("a damper of ", 1234.5678, " N s/m")
    assert note == "a damper of 1235 N s/m"
    assert pickle.loads(pickle.dumps(note)).parts == note.parts
    assert parts_of("plain") == ("plain",)


def test_a_note_of_a_method_and_of_its_design_is_one(tmp_path: Path) -> None:
    """Linear analysis says what it leaves out, and so does the study for it, among several methods too."""
    settings = 'indices = ["J1"]\nevaluate = ["norm", "statistical-linearisation"]'
    file = tmp_path / "study.toml"
    file.write_text(study_text(settings, elements=f'{ELEMENTS}\nf = "10 N"', layouts='S = "k | c | f"'))
    study = load_study(file)
    (case,) = cases(study)
    data = dataset(study, {case: run_case(study, case)})
    lines = data.attrs["notes"].splitlines()
    assert "S: exact norms: friction 'f' in 'strut' left out" in lines
    assert len(lines) == len(set(lines)) == 2


def _outcome(case: Case, note: Note) -> Outcome:
    outcome = Outcome(case.layout, case.index, case.point, {}, {}, {}, 0, 0, 0, {}, {}, {"norm": "ok"})
    again = json.loads(json.dumps(replace(outcome, notes=[list(note.parts)]).to_json()))
    return Outcome(**again)
