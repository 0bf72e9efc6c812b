"""Measured road profiles from CSV files, and what is said of files that are none."""

from __future__ import annotations

import numpy as np
import pytest

from inerter.errors import SignalError
from inerter.roads.reading import profile


@pytest.fixture
def road_file(tmp_path):
    def write(text, encoding="utf-8"):
        path = tmp_path / "road.csv"
        path.write_text(text, encoding=encoding)
        return path

    return write


def test_a_profile_is_driven_from_its_first_point(road_file):
    road = profile(road_file("distance [m], height [mm]\n100, 0\n110, 5\n\n120, -2\n150, 1.5e0\n"), speed=20.0)
    np.testing.assert_allclose(road([-1.0, 0.0, 0.5, 1.0, 2.5]), [0.0, 0.0, 5e-3, -2e-3, 1.5e-3], atol=1e-15)
    assert (road.speed, road.duration, road.hold, road.interval) == (20.0, 2.5, "cubic", 0.5)
    assert road.label == "profile road.csv"


def test_columns_in_either_order_and_any_unit_of_length(road_file):
    one = profile(road_file("Height [cm],Distance [km]\n1,0\n2,0.01\n0,0.02\n"), 10.0)
    two = profile(str(road_file("distance [m],height [m]\r\n0,0.01\r\n10,0.02\r\n20,0\r\n", "utf-8-sig")), 10.0)
    times = np.linspace(0.0, 2.0, 9)
    np.testing.assert_allclose(one(times), two(times), atol=1e-15)


HEADER = "distance [m], height [mm]\n"
BAD = {
    "no units": (
        "distance, height\n0,0\n1,1\n",
        r"'distance' and 'height' have no unit. Write it after the name, such as \"distance \[m\], height \[mm\]\"",
    ),
    "no header": ("0,0\n1,1\n", "has no header, and several columns increase throughout"),
    "no header, no unit": ("0,0\n1,1\n2,0\n", "'column 0' and 'column 1' have no unit"),
    "one unit": (
        "distance [m], height\n0,0\n1,1\n",
        r"'height' has no unit. Write it after the name, such as \"height \[mm\]\"",
    ),
    "twice the same": (
        "height [m], height [mm]\n0,0\n1,1\n",
        r"ambiguous height column: height \[m\] and height \[mm\]",
    ),
    "unknown unit": (
        "distance [m], height [furl]\n0,0\n1,1\n",
        "the unit \"furl\" of 'height' is not a unit of length",
    ),
    "unit of another kind": ("distance [s], height [mm]\n0,0\n1,1\n", 'the unit "s" .* is not a unit of length'),
    "times": (
        "time [s], height [mm]\n0,0\n1,1\n",
        r"of which no other is a length. Add a column \"distance \[m\]\" to the file, or give interval=0.1",
    ),
    "a word": (HEADER + "0, 0\n1, 1\n2, 1\n3, one\n", 'line 5: expected a number with a decimal point, got "one"'),
    "not a number": (HEADER + "0, 0\n1, nan\n", r"height .* missing or not finite at point 1\. Fill"),
    "an empty cell": (HEADER + "0, 1\n1,\n", "height .* missing or not finite"),
    "a third cell": (HEADER + "0, 0, 5\n1, 0, 5\n", "line 1: the header has 2 columns, the rows below have 3"),
    "decimal commas among commas": (HEADER + "0,5, 1,2\n1,5, 1,2\n", "requires a delimiter other than a comma"),
    "backwards": (HEADER + "0, 0\n\n2, 0\n1, 0\n", "must increase, but point 2 is at 1 m after 2 m"),
    "one point": (HEADER + "0, 0\n", "a vector of two or more real numbers"),
    "nothing": ("\n\n", "empty file; expected a header"),
    "an open quote": (HEADER + '"0, 0\n', "rows of numbers not found"),
}


@pytest.mark.parametrize(("text", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_files(road_file, text, sentence):
    with pytest.raises(SignalError, match=sentence):
        profile(road_file(text), 20.0)


def test_no_file(tmp_path):
    with pytest.raises(SignalError, match=r"absent\.csv: file not found in"):
        profile(tmp_path / "absent.csv", 20.0)
    with pytest.raises(SignalError, match="is not a file"):
        profile(tmp_path, 20.0)
    with pytest.raises(SignalError, match="is not a file"):
        profile("a\0b", 20.0)


def test_not_text(tmp_path):
    (tmp_path / "road.csv").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(SignalError, match="rows of numbers not found"):
        profile(tmp_path / "road.csv", 20.0)


def test_bad_arguments(road_file):
    with pytest.raises(SignalError, match=r"speed over a profile must be a positive number of m/s, got 0\.0"):
        profile(road_file(HEADER + "0,0\n1,1\n"), 0.0)
    with pytest.raises(SignalError, match="`path` must be a string or a path, got 5"):
        profile(5, 20.0)
