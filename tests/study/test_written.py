"""Numbers are told as the study file wrote them, and read back to the last bit."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from study_text import assert_survives, load_text, study_text

from inerter.files.study.quantity_texts import as_written, write_resolved
from inerter.report.problem_statement import element_rows, vehicle_rows

UNITS = ["N/m", "kN/m", "N/mm", "MN/m", "lbf/in"]
SPACE = "\N{NO-BREAK SPACE}"


@settings(max_examples=25)
@given(st.floats(0.01, 1e6), st.sampled_from(UNITS), st.sampled_from(["", " "]))
def test_a_quantity_is_told_as_it_was_written(tmp_path_factory, number, unit, space):
    written = f"{number!r}{space}{unit}"
    folder = tmp_path_factory.mktemp("written")
    elements = f'k = "{written}"\nc = {{ from = "0.1 kN s/m", to = "9 kN s/m" }}\nb = "30 kg"'
    text = study_text('indices = ["J1"]\noptimise = "norm"', elements=elements, title='title = "12 kg"')
    study = load_text(folder, text.replace('speed = "25 m/s"', 'speed = "90 km/h"'))
    rows = {name: value.replace(SPACE, " ") for name, _, value in element_rows(study)}
    assert rows == {"k": written, "c": "free, 0.1 kN s/m to 9 kN s/m", "b": "30 kg"}
    assert ("Speed", f"90{SPACE}km/h") in vehicle_rows(study)
    resolved = write_resolved(study)
    assert f'k = "{written}"' in resolved
    assert 'speed = "90 km/h"' in resolved
    assert_survives(study, folder)


def test_another_number_in_its_place_is_not_told_by_the_old_text(tmp_path):
    study = load_text(tmp_path, study_text('indices = ["J1"]'))
    assert as_written(study, 20e3, "N/m") == "20 kN/m"
    assert as_written(study, 20e3, "N") is None
    stiff = replace(study, elements={**study.elements, "k": study.elements["k"].with_value(21e3)})
    assert ("k", "spring", f"21{SPACE}kN/m") in element_rows(stiff)
    assert 'k = "21000.0 N/m"' in write_resolved(stiff)


@pytest.mark.parametrize("spelling", ["  20   kN/m ", "2e4 N/m"])
def test_spaces_do_not_matter(spelling, tmp_path):
    elements = f'k = "{spelling}"\nc = "1 kN s/m"\nb = "30 kg"'
    study = load_text(tmp_path, study_text('indices = ["J1"]', elements=elements))
    assert as_written(study, 20e3, "N/m") == " ".join(spelling.split())
