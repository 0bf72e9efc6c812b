"""Profiles written as test rigs, spreadsheets and surveyors write them: what is read is what was measured."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import inerter as it
from inerter.errors import InerterError, RecordError

UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
NAMES = {
    "distance": ("distance", "Distance", "x", "Chainage", "station", "s"),
    "height": ("height", "Elevation", "z", "left", "height_left", "Profile left"),
    "right": ("right", "height_right", "z right"),
}
DELIMITERS = (",", ";", "\t", "  ", " ; ")


def written(rng, folder):
    """A random profile in a random file, and what `read_profile` has to be told besides."""
    count = int(rng.integers(2, 40))
    distance = rng.uniform(-50, 50) + np.cumsum(rng.uniform(0.01, 1.0, count))
    tracks = {"height": rng.normal(0, 0.02, count), "right": rng.normal(0, 0.02, count)}
    delimiter = str(rng.choice(DELIMITERS))
    decimal = "." if delimiter == "," or rng.random() < 0.5 else ","
    header = bool(rng.random() < 0.7)
    order = ["distance", "height", "right"][: int(rng.integers(2, 4))]
    if header:
        rng.shuffle(order)
    else:
        tracks["height"][:2] = 0.01, 0.0  # what increases is the distance
        tracks["right"][:2] = 0.01, 0.0
    columns = {"distance": distance, **tracks}
    units = {role: str(rng.choice(list(UNITS))) for role in ("distance", "height")}
    worth = {role: UNITS[units["distance" if role == "distance" else "height"]] for role in order}
    newline = str(rng.choice(["\n", "\r\n"]))
    names = {role: str(rng.choice(NAMES[role])) for role in order}
    if not delimiter.strip():  # white space within a name divides it
        names = {role: name.replace(" ", "_") for role, name in names.items()}
    if len(order) == 2 and "left" in names["height"]:
        names["height"] = "height"
    lines = [f"# profiler {rng.integers(100)}"] if rng.random() < 0.3 else []
    if header:
        by = {role: units["distance" if role == "distance" else "height"] for role in order}
        brackets = "()" if rng.random() < 0.3 else "[]"
        lines.append(delimiter.join(f"{names[r]} {brackets[0]}{by[r]}{brackets[1]}" for r in order))
    for row in zip(*(columns[role] / worth[role] for role in order), strict=True):
        lines.append(delimiter.join(f"{value:.17g}".replace(".", decimal) for value in row))
    path = folder / f"road.{rng.choice(['csv', 'txt', 'tsv'])}"
    encoding = str(rng.choice(["utf-8", "utf-8-sig"]))
    path.write_bytes((newline.join(lines) + newline).encode(encoding))
    return path, {} if header else {"units": units}, {role: columns[role] for role in order}


def check_one(seed, folder):
    path, told, columns = written(np.random.default_rng(seed), folder)
    found = it.read_profile(path, **told)
    read = {"distance": found.distance, "height": found.height, "right": found.right}
    for role, expected in columns.items():
        np.testing.assert_allclose(read[role], expected, rtol=1e-13, atol=1e-15, err_msg=f"{seed}: {path.read_text()}")
    assert ("right" in columns) == (found.right is not None)


@pytest.mark.parametrize("seed", range(40))
def test_what_is_read_is_what_was_written(seed, tmp_path):
    check_one(seed, tmp_path)


@pytest.mark.marathon
def test_many_of_them(tmp_path):
    for seed in range(40, 2000):
        check_one(seed, tmp_path)


def test_a_spacing_in_place_of_distances(tmp_path):
    (tmp_path / "road.csv").write_text("left [mm];right [mm]\n1,5;2\n2,5;3\n3,5;1\n")
    found = it.read_profile(tmp_path / "road.csv", interval=0.25)
    np.testing.assert_allclose(found.distance, [0.0, 0.25, 0.5])
    np.testing.assert_allclose([found.height, found.right], [[1.5e-3, 2.5e-3, 3.5e-3], [2e-3, 3e-3, 1e-3]])


TABLE = "distance [m], left [mm], right [mm], note [m]\n0,1,2,9\n1,2,1,9\n2,0,0,9\n"
BAD = {
    "a number": ((3,), {}, "`path` must be a string or a path, got 3"),
    "a folder": ((".",), {}, "is not a file"),
    "absent": (("absent.csv",), {}, "file not found"),
    "another kind": (("road.xlsx",), {}, "unsupported file suffix '.xlsx'"),
    "a unit of force": (("road.csv",), {"units": {"height": "N"}}, 'the unit "N" .* is not a unit of length'),
    "an empty unit": (("road.csv",), {"units": {"height": " "}}, "has no unit"),
    "a unit of nothing": (("road.csv",), {"units": {"depth": "m"}}, "units must be a table such as"),
    "units as text": (("road.csv",), {"units": "mm"}, "units must be a table such as"),
    "no such column": (("road.csv",), {"height": "up"}, "unknown or repeated column 'up' for the height"),
    "a number too large": (("road.csv",), {"height": 9}, "unknown or repeated column 9"),
    "a truth": (("road.csv",), {"height": True}, "unknown or repeated column True"),
    "two of one": (("road.csv",), {"height": "note", "right": "note"}, "one column is named for two"),
    "no such role": (("road.csv",), {"depth": 1}, "has no argument 'depth'"),
    "interval and distance": (("road.csv",), {"interval": 0.1, "distance": 0}, "not both"),
    "no interval": (("road.csv",), {"interval": 0.0}, "interval between points must be a positive"),
    "lateral of a table": (("road.csv",), {"lateral": (0.5,)}, "`lateral` applies to OpenCRG files"),
}


@pytest.mark.parametrize(("args", "options", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_requests(tmp_path, monkeypatch, args, options, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "road.csv").write_text(TABLE)
    (tmp_path / "road.xlsx").write_text(TABLE)
    with pytest.raises(RecordError, match=sentence) as caught:
        it.read_profile(*args, **options)
    assert "\n" not in str(caught.value)


BAD_VALUES = {
    "not a vector": (lambda: it.Profile([[0.0, 1.0]], [0.0, 1.0]), "distance of a profile must be a vector"),
    "words": (lambda: it.Profile([0.0, 1.0], ["a", "b"]), "height of a profile must be a vector"),
    "one longer": (lambda: it.Profile([0.0, 1.0], [0.0, 1.0, 2.0]), "as long as its distance, got 3 and 2"),
    "standing": (lambda: it.Profile([0.0, 0.0], [0.0, 1.0]), "must increase, but point 1 is at 0 m"),
    "an interval beyond": (lambda: it.Profile([0.0, 1.0], [0.0, 1.0]).even(5.0), "at most its length, got 5.0 m"),
    "no track": (lambda: it.Profile([0.0, 1.0], [0.0, 1.0]).to_signal(9.0, "left"), "it has a single track"),
    "no speed": (lambda: it.Profile([0.0, 1.0], [0.0, 1.0]).to_signal(-1.0), "speed over a profile must be a positive"),
}


@pytest.mark.parametrize(("make", "sentence"), BAD_VALUES.values(), ids=BAD_VALUES.keys())
def test_bad_profiles(make, sentence):
    with pytest.raises(InerterError, match=sentence):
        make()


def surface(folder):
    crg = pytest.importorskip("pyopencrg")
    road = crg.generate.from_function(lambda u, v: 0.01 * np.sin(u) + 0.004 * v, length=20.0, width=4.0, u_inc=0.1)
    road.save(folder / "road.crg", fmt="LDFI")
    return folder / "road.crg"


def test_opencrg(tmp_path):
    path = surface(tmp_path)
    found = it.read_profile(path, lateral=(0.75, -0.75))
    u = found.distance
    assert u[-1] == pytest.approx(20.0)
    np.testing.assert_allclose(found.height, 0.01 * np.sin(u) + 0.003, atol=1e-9)
    np.testing.assert_allclose(found.right, 0.01 * np.sin(u) - 0.003, atol=1e-9)
    np.testing.assert_allclose(it.read_profile(path).height, 0.01 * np.sin(u), atol=1e-9)


def test_bad_opencrg(tmp_path, monkeypatch):
    path = surface(tmp_path)
    with pytest.raises(RecordError, match=r"position 3 m outside the road, which extends from -2 to 2 m"):
        it.read_profile(path, lateral=(3.0,))
    with pytest.raises(RecordError, match=r"one position .* or two"):
        it.read_profile(path, lateral="left")
    with pytest.raises(RecordError, match="requires no units"):
        it.read_profile(path, interval=0.1)
    path.write_bytes(path.read_bytes()[:1500])
    with pytest.raises(RecordError, match=r"road\.crg cannot be read as OpenCRG: the file is damaged or truncated"):
        it.read_profile(path)
    monkeypatch.setitem(sys.modules, "pyopencrg", None)
    with pytest.raises(RecordError, match=r'pip install "inerter\[roads\]"'):
        it.read_profile(path)


def test_the_old_name_of_to_signal_works_with_a_warning() -> None:
    road = it.Profile([0.0, 1.0], [0.0, 1.0])
    with pytest.warns(DeprecationWarning, match="`driven` is now `to_signal`"):
        assert road.driven(2.0)(0.25) == road.to_signal(2.0)(0.25)


COLUMNS = {  # files of 40 heights alone: heading and how a height of so many cm is written
    "points": ("", lambda h: f"{h:.4f}"),
    "points below a name": ("height [cm]\n", lambda h: f"{h:.4f}"),
    "commas": ("", lambda h: f"{h:.4f}".replace(".", ",")),
    "commas below a name": ("Höhe [cm]\n", lambda h: f"{h:.4f}".replace(".", ",")),
}


@pytest.mark.parametrize("name", COLUMNS)
def test_heights_alone_are_one_column(name, tmp_path):
    """Also with decimal commas, which are not two columns of integers."""
    heading, written_as = COLUMNS[name]
    heights = np.round(np.random.default_rng(0).normal(size=40), 4)  # cm
    path = tmp_path / "road.csv"
    path.write_text(heading + "\n".join(map(written_as, heights)), encoding="utf-8")
    profile = it.read_profile(path, interval=0.25, units={"height": "cm"})
    assert profile.right is None
    np.testing.assert_allclose(profile.height, heights / 100.0, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(profile.distance, 0.25 * np.arange(40))
    with pytest.raises(RecordError, match=r"interval=0\.1"):
        it.read_profile(path, units={"height": "cm"})


def test_two_columns_of_integers_stay_two(tmp_path):
    path = tmp_path / "road.csv"
    path.write_text("".join(f"{x},{7 * x % 10}\n" for x in range(40)), encoding="utf-8")
    profile = it.read_profile(path, units={"distance": "m", "height": "mm"})
    np.testing.assert_array_equal(profile.distance, np.arange(40.0))
