"""The text of a study file: a quarter car and what a test asks of it, as lines of its sections; and how it is read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from inerter.errors import StudyError
from inerter.files.study.loading import load_study
from inerter.files.study.quantity_texts import write_resolved
from inerter.files.study.study import Study

VEHICLE = 'sprung_mass = "250 kg"\nunsprung_mass = "35 kg"\ntyre_stiffness = "150 kN/m"'
PAPER_CAR = 'sprung_mass = "181.75 kg"\nunsprung_mass = "25 kg"\ntyre_stiffness = "120 kN/m"'  # of Wang and Su (2008)
HALF_CAR = """model = "half-car"
sprung_mass = "363.5 kg"
pitch_inertia = "200 kg m^2"
unsprung_mass_front = "25 kg"
unsprung_mass_rear = "20 kg"
tyre_stiffness_front = "120 kN/m"
tyre_stiffness_rear = "100 kN/m"
distance_front = "0.775 m"
distance_rear = "1.265 m\""""  # of the same paper
ON_A_ROUGH_ROAD = """[vehicle]
model = "quarter-car"
sprung_mass = "320 kg"
unsprung_mass = "38 kg"
tyre_stiffness = "190 kN/m"
[road]
speed = "80 km/h"
roughness = "2e-6 m^3/cycle"
"""  # the begin of a file
ELEMENTS = 'k = "20 kN/m"\nc = "1 kN s/m"\nb = "30 kg"'
LAYOUTS = 'S1 = "k | c"\nS2 = "k | c | b"'


def study_text(
    settings: str, *, vehicle: str = VEHICLE, elements: str = ELEMENTS, layouts: str = LAYOUTS, title: str = ""
) -> str:
    """A whole file; `title` is the line before the first section."""
    return f"""{title}
[vehicle]
model = "quarter-car"
{vehicle}
[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
{elements}
[layouts]
{layouts}
[study]
{settings}
"""


RIG_FIT = """
[record]
force_bandwidth = "300 Hz"
[model]
layout = "(ks | cs) - (b | f)"
[elements]
ks = "1000 kN/m"
cs = "3200 N s/m"
b = { from = "1 kg", to = "500 kg" }
f = { from = "0 N", to = "100 N" }
[fit]
starts = 8
"""  # an identification file


def with_changes(text: str, *changes: tuple[str, str]) -> str:
    """The text with parts of it replaced, each once; each must be there."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def load_text(folder: Path, text: str, name: str = "study.toml") -> Study:
    """The study of a file with this text in `folder`."""
    (folder / name).write_text(text, encoding="utf-8")
    return load_study(folder / name)


def assert_survives(study: Study, folder: Path) -> Study:
    """The study as it is read from a file that it was written to: the same."""
    again = load_text(folder, write_resolved(study), "copy.toml")
    assert again == study
    assert again.to_tables() == study.to_tables()
    assert (list(again.layouts), list(again.elements)) == (list(study.layouts), list(study.elements))
    return again


def assert_refused(load: Callable[[], object], place: str, words: Sequence[str], *, alone: bool = True) -> str:
    """The line about a place of study.toml, which has these words, and is the only one if it is `alone`."""
    with pytest.raises(StudyError) as caught:
        load()
    lines = str(caught.value).splitlines()
    (line,) = lines if alone else [line for line in lines if line.startswith(f"study.toml: {place}: ")]
    assert line.startswith(f"study.toml: {place}: "), line
    assert [word for word in words if word not in line] == [], line
    return line
