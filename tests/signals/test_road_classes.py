"""Classes of ISO 8608: their means and limits in exact arithmetic, and in files."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

import inerter as it
from inerter.errors import InerterError, PerformanceIndexError
from inerter.files.simulation.loading import load_simulation

# Table C.1 of ISO 8608: Gd(n0) in 1e-6 m^3, lower limit, geometric mean, upper limit.
TABLE = {
    "A": (0, 16, 32),
    "B": (32, 64, 128),
    "C": (128, 256, 512),
    "D": (512, 1024, 2048),
    "E": (2048, 4096, 8192),
    "F": (8192, 16384, 32768),
    "G": (32768, 65536, 131072),
    "H": (131072, 262144, math.inf),
}


def kappa(density):
    """The roughness of Gd(n0) in 1e-6 m^3, exactly."""
    return Fraction(density, 10**6) * Fraction(1, 100) / 2


@pytest.mark.parametrize("letter", TABLE)
def test_the_table_of_the_standard(letter):
    low, mean, high = TABLE[letter]
    found = it.ROAD_CLASSES[letter]
    assert [1e6 * v for v in (found.lowest, found.mean, found.highest)] == pytest.approx([low, mean, high], rel=1e-15)
    assert it.Road.iso8608(letter, speed=25).roughness == pytest.approx(float(kappa(mean)), rel=2e-16)


@pytest.mark.parametrize("letter", TABLE)
def test_a_road_has_the_class_in_whose_limits_it_lies(letter):
    low, mean, high = TABLE[letter]
    inside = [mean, low * 1.0001 or 1e-3, min(high, 1e9) * 0.9999]
    assert {it.Road(float(kappa(1)) * d, speed=10.0).iso8608_class.letter for d in inside} == {letter}
    if letter != "H":
        outside = it.Road(float(kappa(1)) * high * 1.0001, speed=10.0)
        assert outside.iso8608_class.letter == chr(ord(letter) + 1)


@pytest.mark.parametrize("letter", ["I", "c", "", "AB", 3, None])
def test_what_is_no_class(letter):
    with pytest.raises(PerformanceIndexError, match=r"a letter from A \(smooth\) to H \(rough\)"):
        it.Road.iso8608(letter, speed=25.0)


STUDY = """
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
[road]
speed = "20 m/s"
class = "C"
[elements]
k = "20 kN/m"
c = "1500 N s/m"
[layouts]
S1 = "k | c"
[study]
indices = ["J1"]
"""
SIMULATION = STUDY.split("[study]", maxsplit=1)[0] + '[signal]\nkind = "multisine"\n[simulation]\nduration = "1 s"\n'


def test_a_file_may_name_the_class(tmp_path):
    for load, text in ((it.load_study, STUDY), (load_simulation, SIMULATION)):
        (tmp_path / "by.toml").write_text(text)
        (tmp_path / "as.toml").write_text(text.replace('class = "C"', 'roughness = "1.28e-6 m^3/cycle"'))
        assert load(tmp_path / "by.toml").to_tables()["road"] == load(tmp_path / "as.toml").to_tables()["road"]


BAD = {
    "no class": ('class = "C"', 'class = "K"', 'road.class: got "K": not a class of ISO 8608'),
    "small": ('class = "C"', 'class = "c"', 'road.class: got "c": not a class of ISO 8608'),
    "a number": ('class = "C"', "class = 3", "road.class: got 3: not a class"),
    "both": ('class = "C"', 'class = "C"\nroughness = "1e-6 m^3/cycle"', "road: got both roughness and class"),
    "neither": ('class = "C"', "", "road.roughness: missing"),
    "a list": ('class = "C"', 'class = ["C"]', "road.class: got"),
}


@pytest.mark.parametrize(("old", "new", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_classes_in_files(tmp_path, old, new, sentence):
    (tmp_path / "bad.toml").write_text(STUDY.replace(old, new))
    with pytest.raises(InerterError) as caught:
        it.load_study(tmp_path / "bad.toml")
    assert sentence in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1
