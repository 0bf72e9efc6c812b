"""`export` as its user meets it: kinds, refusals, files."""

from __future__ import annotations

import errno
import sys
from pathlib import Path
from runpy import run_path
from typing import ClassVar

import numpy as np
import pytest
from campaigns import sampled
from wang_su import paper_quarter_car

import inerter as it
from inerter.exports import kinds, registry
from inerter.exports.registry import EXPORTS

K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
CAR = paper_quarter_car(K | C - B)
REAL = paper_quarter_car(K | C - (B | it.Friction(20.0)) | it.Spring(1e4, "stop") - it.Gap(0.01))
TIME = np.linspace(0.0, 1.0, 101)
TRAJECTORY = it.simulate(it.Rig(it.Damper(100.0)), displacement=it.sine(0.01, 1.0), duration=1.0)
RECORD = it.Record(TIME, 1e-3 * np.sin(TIME), np.cos(TIME))
FILES = [kind.key for kind in EXPORTS.values() if kind.is_file]
LINEAR = [key for key in EXPORTS if key not in ("svg", "pdf", "latex", "fmu", "fmu3", "simulation")]


@pytest.mark.parametrize("key", LINEAR)
def test_friction_and_gaps_are_refused_unless_they_are_left_out(key: str) -> None:
    with pytest.raises(it.InerterError) as caught:
        it.export(REAL, key)
    sentence = str(caught.value)
    assert sentence.startswith("A linear model has neither friction nor gaps (friction 'f' in 'strut' left out, gap ")
    assert sentence.endswith("). To export the design without them: linear=True, on the command line --linear.")
    assert it.export(REAL, key, linear=True) is not None


def test_what_was_left_out_is_in_the_file() -> None:
    for key, mark in (("modelica", "// "), ("spice", "* "), ("csv", "# ")):
        idle = it.export(paper_quarter_car(K | C | it.Spring(5e4, "k3") - it.Friction(80.0)), key, linear=True)
        assert f"{mark}'k3' in 'strut' without force then" in idle
        text = it.export(REAL, key, linear=True)
        assert f"{mark}friction 'f' in 'strut' left out" in text
        assert f"{mark}gap 'gap' in 'strut' taken as closed" in text
    assert "friction 'f' in 'strut' left out." in it.named_system(REAL, linear=True).notes


@pytest.mark.parametrize("key", sampled(FILES, [key for key in FILES if key not in ("fmu", "fmu3")], ["fmu"]))
@pytest.mark.usefixtures("unoptimised")
def test_a_file_is_whole_and_replaced_only_on_request(key: str, tmp_path: Path) -> None:
    path = tmp_path / f"design{EXPORTS[key].suffixes[0]}"
    assert it.export(CAR, key, path) == path
    made = it.export(CAR, key)
    if key != "netcdf":  # which holds times of its own
        assert path.read_bytes() == (made.encode() if isinstance(made, str) else made)
    before = path.read_bytes()
    with pytest.raises(it.InerterError, match="exists"):
        it.export(REAL, key, path, linear="linear" in EXPORTS[key].takes)
    assert path.read_bytes() == before
    it.export(REAL, key, path, linear="linear" in EXPORTS[key].takes, overwrite=True)
    assert path.read_bytes() != before
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


def test_a_file_that_fails_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = it.export(CAR, "modelica", tmp_path / "car.mo")
    before = path.read_bytes()

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(it.InerterError, match="No space left"):
        it.export(CAR, "modelica", path, overwrite=True)
    monkeypatch.undo()
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("key", FILES)
def test_a_suffix_of_another_kind_is_refused(key: str, tmp_path: Path) -> None:
    with pytest.raises(it.InerterError, match="is a file with the suffix"):
        it.export(CAR, key, tmp_path / "design.docx")
    assert not list(tmp_path.iterdir())


def test_objects_are_no_files(tmp_path: Path) -> None:
    for key in ("control", "scipy"):
        with pytest.raises(it.InerterError, match="is an object of Python, not a file"):
            it.export(CAR, key, tmp_path / "design.mat")


def test_an_unknown_option_is_told_with_all_that_there_are() -> None:
    with pytest.raises(TypeError, match=r"export\(\) has no option 'output'\. Its options: inputs, outputs, linear, "):
        it.export(CAR, "scipy", output="tyre_load")


OPTIONS = {
    "inputs": "road",
    "outputs": ["tyre_load"],
    "linear": True,
    "form": "descriptor",
    "frequencies": np.array([1.0, 2.0]),
    "indices": {"J1": it.LoadCarrying()},
    "part": "strut",
    "speed": 10.0,
    "platforms": ["windows"],
}


class WatchedSpec(it.ExportSpec):
    """A request that keeps the names of the fields that were read."""

    read: ClassVar[set[str]] = set()

    def __getattribute__(self, name: str) -> object:
        WatchedSpec.read.add(name)
        return super().__getattribute__(name)


@pytest.mark.parametrize("key", [key for key in EXPORTS if key not in ("fmu", "fmu3")])
def test_a_kind_reads_the_options_that_it_takes(key: str) -> None:
    kind = EXPORTS[key]
    WatchedSpec.read.clear()
    kind.make(WatchedSpec(CAR, key), kind.suffixes[0] if kind.is_file else "")
    assert set(kind.takes) <= WatchedSpec.read


@pytest.mark.parametrize("key", EXPORTS)
def test_an_option_that_a_kind_does_not_take_is_refused(key: str) -> None:
    for option in OPTIONS.keys() - EXPORTS[key].takes:
        with pytest.raises(it.InerterError, match=f"An export to {key} does not accept {option}: "):
            it.export(CAR, key, **{option: OPTIONS[option]})


@pytest.mark.parametrize(
    ("of", "key", "option"),
    [
        *((TRAJECTORY, "csv", one) for one in ("inputs", "linear", "frequencies", "indices")),
        (TRAJECTORY, "netcdf", "frequencies"),
        *((RECORD, "csv", one) for one in ("inputs", "outputs", "frequencies")),
        (RECORD, "matlab", "form"),
        (K, "spice", "part"),
        (K | C, "fmu", "outputs"),
        (K | C, "fmu", "linear"),
        (REAL, "fmu", "inputs"),
    ],
)
def test_an_option_without_meaning_for_the_object_is_refused(of: object, key: str, option: str) -> None:
    with pytest.raises(it.InerterError, match=f" does not accept {option}: "):
        it.export(of, key, **{option: OPTIONS[option]})  # type: ignore[arg-type]


def test_a_strut_alone_has_neither_outputs_nor_a_speed() -> None:
    for option in ("outputs", "speed", "linear"):
        with pytest.raises(it.InerterError, match=f"An FMU of a strut alone does not accept {option}: "):
            it.export(CAR, "fmu", part="strut", **{option: OPTIONS[option]})


def test_unknown_kinds_and_forms() -> None:
    with pytest.raises(it.InerterError, match=r"Unknown kind of export 'Simulink'.*Did you mean 'fmu'"):
        it.export(CAR, "Simulink")
    with pytest.raises(it.InerterError, match=r"Unknown kind of export 'matlba'.*Did you mean 'matlab'"):
        it.export(CAR, "matlba")
    with pytest.raises(it.InerterError, match="Unknown form 'dss'; available: state-space, descriptor"):
        it.export(CAR, "matlab", form="dss")
    with pytest.raises(it.InerterError, match="Unknown output 'sprung_speed'"):
        it.export(CAR, "matlab", outputs=["sprung_speed"])


@pytest.mark.parametrize(
    ("key", "of", "wanted"),
    [
        ("modelica", K | C, "a vehicle"),
        ("matlab", K | C, "a vehicle or a LinearSystem"),
        ("spice", it.state_space(CAR), "a network or a vehicle"),
        ("svg", 3.0, "a network or a vehicle"),
        ("csv", it.QuarterCar, "a vehicle or a LinearSystem"),
    ],
)
def test_what_cannot_be_exported(key: str, of: object, wanted: str) -> None:
    with pytest.raises(it.InerterError, match=f"An export to {key} requires {wanted}, got "):
        it.export(of, key)  # type: ignore[arg-type]


def test_a_kind_of_another_distribution_is_used_like_ours(tmp_path: Path) -> None:
    kind = it.ExportKind("order", "number of states", (".txt",), lambda request, suffix: f"{len(request.system().A)}\n")
    it.EXPORTS.add(kind)
    try:
        assert it.export(CAR, "order", tmp_path / "order.txt").read_text() == "5\n"
    finally:
        it.EXPORTS.remove(kind)


def test_a_strut_without_linear_force_is_refused() -> None:
    for strut, what in ((it.Friction(10.0), "carries no force"), (it.Gap(0.1), "is rigid")):
        with pytest.raises(it.InerterError, match=what):
            it.export(strut, "spice", linear=True)


def test_matrices_are_those_of_the_state_space() -> None:
    made, system = it.export(CAR, "scipy"), it.state_space(CAR)
    for name in "ABCD":
        assert np.array_equal(getattr(made, name), getattr(system, name))


def test_a_module_among_the_kinds_is_a_kind_of_export(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kind = 'ExportKind("one-line", "one line of text", (".txt",), lambda request, suffix: request.title)'
    (tmp_path / "one_line.py").write_text(f"from inerter.exports.kind import ExportKind\nONE_LINE = {kind}\n")
    monkeypatch.setattr(kinds, "__path__", [*kinds.__path__, str(tmp_path)])
    found = run_path(registry.__file__)["EXPORTS"]
    monkeypatch.delitem(sys.modules, "inerter.exports.kinds.one_line")
    assert [*found] == [*EXPORTS, "one-line"]
    assert found["one-line"].contents(it.ExportSpec(REAL, "one-line", title="A line"), ".txt") == "A line"
