"""Roads and vehicles that no road or vehicle is: warned of by `inerter check` and first in the answer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from folders import EXAMPLES

from inerter.cli.main import call

QUARTER = (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8")


def checked(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str) -> str:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    assert call(["check", str(path)]) == 0
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("roughness", "letter"),
    [
        ('roughness = "256e-6 m^3"', "C"),
        ('roughness = "16e-6 m^3/rad"', "C"),
        ('roughness = "1.28e-6 m^3/cycle"', "C"),
        ('class = "C"', "C"),
        ('roughness = "5e-7 m^3/cycle"', "B"),
    ],
)
def test_check_says_which_class_a_road_is(tmp_path, capsys, roughness, letter):
    text = checked(tmp_path, capsys, QUARTER.replace('roughness = "5e-7 m^3/cycle"', roughness))
    assert f"Road: class {letter} of ISO 8608" in text
    assert "Warning" not in text


@pytest.mark.parametrize(
    ("old", "new", "warning"),
    [
        ("5e-7 m^3/cycle", "256e-6 m^3/cycle", "no public road is as rough as class G"),
        ("5e-7 m^3/cycle", "5e-7 m^3", "no road is as smooth as Gd(n0) = 0.5e-6 m^3"),
        ('"25 m/s"', '"250 m/s"', "no vehicle drives at 250 m/s"),
        ("181.75 kg", "200 mg", "no quarter car is like this one: sprung mass 0.0002 kg, less than 1 kg"),
        ('tyre_stiffness = "120 kN/m"', 'tyre_stiffness = "120 N/m"', "tyre stiffness 0.12 kN/m, less than 2 kN/m"),
    ],
)
def test_check_doubts_what_no_road_or_vehicle_is(tmp_path, capsys, old, new, warning):
    assert old in QUARTER
    assert warning in checked(tmp_path, capsys, QUARTER.replace(old, new))


def test_a_profile_in_other_units_than_it_says_is_told_to_check_them(tmp_path, capsys):
    """Not to give another roughness: the study has none of its own."""
    heights = np.cumsum(np.random.default_rng(0).normal(size=4000))
    rows = "\n".join(f"{0.05 * i:.2f},{h!r}" for i, h in enumerate(heights.tolist()))
    (tmp_path / "road.csv").write_text(f"distance [m],height [m]\n{rows}\n", encoding="utf-8")
    text = checked(tmp_path, capsys, QUARTER.replace('roughness = "5e-7 m^3/cycle"', 'profile = "road.csv"'))
    assert "no public road is as rough as class H" in text
    assert "Check the units of the profile, and its columns." in text
    assert "Give Gd(n0)" not in text


def test_an_absorber_is_no_vehicle_on_a_road(tmp_path, capsys):
    assert "Warning" not in checked(tmp_path, capsys, (EXAMPLES / "building_quake.toml").read_text(encoding="utf-8"))


def test_roads_of_sweeps_and_conditions_are_each_looked_at(tmp_path, capsys):
    swept = QUARTER + '\n[study.sweep]\n"road.roughness" = ["16e-6 m^3", "64e-6 m^3", "1 m^3"]\n'
    text = checked(tmp_path, capsys, swept)
    assert "Roads: from class A of ISO 8608 (Gd(n0) = 16e-6 m^3, n0 = 0.1 cycle/m) to class H" in text
    assert "no public road is as rough as class H" in text
    text = checked(tmp_path, capsys, QUARTER + '\n[[conditions]]\n"road.speed" = "600 km/h"\n[[conditions]]\n')
    assert "no vehicle drives at 166.7 m/s, faster than 150 m/s" in text
    assert "n0 = 0.1 cycle/m)." in text  # several speeds: none is told


def test_elements_that_no_vehicle_has(tmp_path, capsys):
    text = checked(tmp_path, capsys, QUARTER.replace('\nk = "120 kN/m"', '\nk = "12 N/m"'))
    assert "no vehicle has such a spring: k 12 N/m, less than 100 N/m" in text


@pytest.mark.usefixtures("undrawn")
def test_an_answer_begins_with_what_no_vehicle_stands(tmp_path, capsys):
    path = tmp_path / "study.toml"
    text = QUARTER.replace("5e-7 m^3/cycle", "256e-6 m^3/cycle")
    path.write_text(text.replace('indices  = ["J1", "J3", "J5"]', 'indices = ["J1", "J3"]'), encoding="utf-8")
    assert call(["run", str(path), "-o", str(tmp_path / "results")]) == 0
    lines = capsys.readouterr().out
    answer = " ".join(lines[lines.rindex("Warning: J1") :].split())
    assert "more than the acceleration of gravity" in answer
    assert "more than the static load of 2.028 kN" in answer  # (181.75 kg + 25 kg) g
    assert answer.index("Warning") < answer.index("better than S1 in ride comfort (J1)")
    assert "Road: class G of ISO 8608 (Gd(n0) = 51200e-6 m^3" in " ".join(lines.split())
    assert "no public road is as rough" in (tmp_path / "results" / "report.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("roughness", "lifts"), [("5e-7", False), ("4e-6", True)])
def test_an_answer_says_where_a_tyre_leaves_the_road(tmp_path, capsys, roughness, lifts):
    """J3 of this car is 549 N at 5e-7 and rises with the square root: three times 549 N is less than 2028 N."""
    path = tmp_path / "study.toml"
    text = QUARTER.replace("5e-7 m^3/cycle", f"{roughness} m^3/cycle")
    path.write_text(text.replace('indices  = ["J1", "J3", "J5"]', 'indices = ["J3"]'), encoding="utf-8")
    assert call(["run", str(path), "-o", str(tmp_path / "results")]) == 0
    answer = " ".join(capsys.readouterr().out.split())
    said = "with a static load of 2.028 kN in all: a tyre leaves the road at times, which the linear model ignores"
    assert (said in answer) == lifts
    assert "more than the static load" not in answer


@pytest.mark.usefixtures("undrawn")
def test_an_answer_doubts_a_body_without_support_and_not_the_road_of_an_undamped_one(tmp_path, capsys):
    text = (
        QUARTER[: QUARTER.index("[layouts]")]
        + """
[layouts]
S1 = "k | c"
undamped = "k | b"
hanging = "k - c"
[study]
indices = ["J1", "J3"]
optimise = "norm"
"""
    )
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    assert call(["run", str(tmp_path / "study.toml"), "-o", str(tmp_path / "results"), "-j", "1"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Warning: no static equilibrium: no spring supports the body with hanging. Put a spring in parallel." in out
    assert "Ride comfort (J1) of undamped is infinite" in out
    assert "inf r.m.s." not in out
    assert out.index("Warning: no static") < out.index("in ride comfort (J1)")
