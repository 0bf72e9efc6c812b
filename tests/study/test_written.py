"""Numbers are told as the study file wrote them, and read back to the last bit."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_text import study_text

from inerter.files.study.loading import load_study
from inerter.files.study.quantity_texts import as_written, write_resolved
from inerter.report.problem_statement import element_rows, vehicle_rows

UNITS = ["N/m", "kN/m", "N/mm", "MN/m", "lbf/in"]
SPACE = "\N{NO-BREAK SPACE}"


@settings(max_examples=25)
@given(st.floats(0.01, 1e6), st.sampled_from(UNITS), st.sampled_from(["", " "]))
def test_a_quantity_is_told_as_it_was_written(tmp_path_factory, number, unit, space):
    written = f"{number!r}{space}{unit}"
    path = tmp_path_factory.mktemp("written") / "study.toml"
    elements = f'k = "{written}"\nc = {{ from = "0.1 kN s/m", to = "9 kN s/m" }}\nb = "30 kg"'
    text = study_text('indices = ["J1"]\noptimise = "norm"', elements=elements, title='title = "12 kg"')
    path.write_text(text.replace('speed = "25 m/s"', 'speed = "90 km/h"'), encoding="utf-8")
    study = load_study(path)
    rows = {name: value.replace(SPACE, " ") for name, _, value in element_rows(study)}
    assert rows == {"k": written, "c": "free, 0.1 kN s/m to 9 kN s/m", "b": "30 kg"}
    assert ("Speed", f"90{SPACE}km/h") in vehicle_rows(study)
    resolved = write_resolved(study)
    assert f'k = "{written}"' in resolved
    assert 'speed = "90 km/h"' in resolved
    path.write_text(resolved, encoding="utf-8")
    assert load_study(path) == study


def test_another_number_in_its_place_is_not_told_by_the_old_text(tmp_path):
    (tmp_path / "study.toml").write_text(study_text('indices = ["J1"]'), encoding="utf-8")
    study = load_study(tmp_path / "study.toml")
    assert as_written(study, 20e3, "N/m") == "20 kN/m"
    assert as_written(study, 20e3, "N") is None
    stiff = replace(study, elements={**study.elements, "k": study.elements["k"].with_value(21e3)})
    assert ("k", "spring", f"21{SPACE}kN/m") in element_rows(stiff)
    assert 'k = "21000.0 N/m"' in write_resolved(stiff)


@pytest.mark.parametrize("spelling", ["  20   kN/m ", "2e4 N/m"])
def test_spaces_do_not_matter(spelling, tmp_path):
    elements = f'k = "{spelling}"\nc = "1 kN s/m"\nb = "30 kg"'
    (tmp_path / "study.toml").write_text(study_text('indices = ["J1"]', elements=elements), encoding="utf-8")
    study = load_study(tmp_path / "study.toml")
    assert as_written(study, 20e3, "N/m") == " ".join(spelling.split())
