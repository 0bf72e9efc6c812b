"""Matrices for python-control, SciPy, MATLAB and Octave give the responses of the vehicle, with names and units."""

from __future__ import annotations

import io
import shutil
import subprocess
from pathlib import Path

import control
import numpy as np
import pytest
import scipy
from campaigns import sampled
from designs import ALWAYS, COUNT, design, deviation, frequencies
from nodal import Nodal
from wang_su import paper_quarter_car

import inerter as it
from inerter.exports.kinds.matlab import matlab_file, matlab_script

OCTAVE = shutil.which("octave")
K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
CAR = paper_quarter_car(K | C - B)


def expected(number: int) -> np.ndarray:
    return it.frequency_response(it.state_space(design(number)), frequencies())


@pytest.mark.parametrize("number", sampled(range(COUNT), ALWAYS, kept=12))
def test_python_control_and_scipy_respond_as_the_vehicle(number: int) -> None:
    omega, here = frequencies(), expected(number)
    system = it.export(design(number), "control")
    assert deviation(np.moveaxis(system(1j * omega, squeeze=False), 2, 0), here) < 1e-10
    other = it.export(design(number), "scipy")
    identity = np.eye(len(other.A))
    found = [other.C @ np.linalg.solve(1j * w * identity - other.A, other.B) + other.D for w in omega]
    assert deviation(np.array(found), here) < 1e-10


@pytest.mark.parametrize("number", sampled(range(COUNT), ALWAYS, kept=12))
def test_the_descriptor_responds_as_the_state_space(number: int) -> None:
    assert (
        deviation(it.named_system(design(number), form="descriptor").response(frequencies()), expected(number)) < 1e-10
    )


@pytest.mark.parametrize("tens", sampled(range(0, COUNT, 10), (0,), kept=2))
def test_octave_responds_as_the_vehicle(tens: int, tmp_path: Path) -> None:
    """By the script through `freqresp` of its package control, and by the matrices of the file."""
    if OCTAVE is None:
        pytest.skip("Octave is not installed (Debian: octave, octave-control).")
    omega, numbers = frequencies(), range(tens, tens + 10)
    scipy.io.savemat(tmp_path / "omega.mat", {"omega": omega})
    for n in numbers:
        it.export(design(n), "matlab", tmp_path / f"script_{n}.m")
        it.export(design(n), "matlab", tmp_path / f"data_{n}.mat")
    lines = ["pkg load control; load omega.mat; r = struct();"]
    for n in numbers:
        lines += [
            f"clear E; script_{n}; r.by_script_{n} = freqresp(sys, omega); r.names_{n} = sys.inname;",
            f"d = load('data_{n}.mat'); if ~isfield(d, 'E'), d.E = eye(rows(d.A)); end",
            "for i = 1:numel(omega), h(1:rows(d.C), 1:columns(d.B), i) = ",
            "d.C * ((1i * omega(i) * d.E - d.A) \\ d.B) + d.D; end",
            f"r.by_data_{n} = h; clear h; r.units_{n} = d.input_units;",
        ]
    (tmp_path / "ask.m").write_text("\n".join([*lines, "save -v7 found.mat -struct r"]).replace(" = \n", " = ...\n"))
    done = subprocess.run(
        [OCTAVE, "--no-gui", "-qf", "ask.m"], check=False, cwd=tmp_path, capture_output=True, text=True, timeout=280
    )
    if "package" in done.stderr and "control" in done.stderr and not (tmp_path / "found.mat").exists():
        pytest.skip("The package control of Octave is not installed (Debian: octave-control).")
    assert done.returncode == 0, done.stderr
    found = scipy.io.loadmat(tmp_path / "found.mat")
    for n in numbers:
        assert deviation(in_order(found[f"by_data_{n}"]), expected(n)) < 1e-10
        assert deviation(in_order(found[f"by_script_{n}"]), expected(n), of_output=True) < 1e-10  # it mixes all states
        system = it.named_system(design(n))
        assert [str(cell[0]) for cell in found[f"names_{n}"].ravel()] == [one.name for one in system.inputs]
        assert [str(cell[0]) for cell in found[f"units_{n}"].ravel()] == [one.unit for one in system.inputs]


def in_order(responses: np.ndarray) -> np.ndarray:
    return np.moveaxis(np.atleast_3d(responses), 2, 0)


@pytest.mark.parametrize("number", ALWAYS)
def test_files_hold_every_bit(number: int) -> None:
    for form in ("state-space", "descriptor"):
        system = it.named_system(design(number), form=form)
        data = scipy.io.loadmat(io.BytesIO(matlab_file(system)))
        text = matlab_script(system)
        for name in "ABCDE" if form == "descriptor" else "ABCD":
            matrix = getattr(system, name)
            assert np.array_equal(data[name], matrix)
            rows = text.partition(f"\n{name} = [\n")[2].partition("\n];")[0].splitlines()
            assert np.array_equal([[float(x) for x in row.split()] for row in rows], matrix)
        assert ("E" in data) == (form == "descriptor")


@pytest.mark.parametrize("number", sampled(range(COUNT), ALWAYS, kept=12))
def test_the_model_is_the_nodal_equations(number: int) -> None:
    """Against M s^2 + C s + K in extended precision, which has no code of the package."""
    system, omega = it.named_system(design(number)), frequencies()
    nodal = Nodal(design(number).mechanism(), omega)
    sources = [name.removesuffix("_velocity") if name not in nodal.inputs else name for name in input_names(system)]
    known = [[nodal.response(out.name, source) for source in sources] for out in system.outputs]
    assert deviation(system.response(omega), np.moveaxis(np.array(known, complex), 2, 0)) < 1e-10


def input_names(system: it.NamedSystem) -> list[str]:
    return [one.name for one in system.inputs]


def test_every_name_says_what_it_is() -> None:
    system = it.named_system(CAR)
    assert [one.label for one in system.inputs] == ["road_velocity [m/s]", "sprung_force [N]"]
    assert [one.label for one in system.outputs][:2] == ["sprung_velocity [m/s]", "sprung_acceleration [m/s^2]"]
    assert [one.label for one in system.states][-1] == "tyre.k_elongation [m]"
    labels = it.export(CAR, "control").state_labels
    assert labels[-1] == "tyre_k_elongation [m]"  # python-control allows no points
    half = it.named_system(design(1))
    units = {one.name: one.unit for one in (*half.states, *half.inputs, *half.outputs)}
    assert units["pitch_velocity"] == "rad/s"
    assert units["pitch_acceleration"] == "rad/s^2"
    assert units["pitch_moment"] == "N m"
    assert {units["road_front_velocity"], units["road_rear_velocity"]} == {"m/s"}


@pytest.mark.parametrize("number", ALWAYS)
def test_a_state_is_what_its_name_and_unit_say(number: int) -> None:
    """The velocity of a coordinate, and the elongation of a spring, as outputs by those names."""
    vehicle = design(number)
    states = it.named_system(vehicle).states
    mechanism = vehicle.mechanism()
    names = [f"{c.name}_velocity" for c in mechanism.coordinates if f"{c.name}_velocity" in {s.name for s in states}]
    assert names
    system = it.named_system(vehicle, outputs=names)
    for row, out in zip(system.C, system.outputs, strict=True):
        place = [state.name for state in states].index(out.name)
        assert states[place].unit == out.unit
        assert np.array_equal(np.flatnonzero(row), [place])
        assert row[place] == 1.0


def test_delays_between_axles_are_told() -> None:
    (note,) = it.named_system(design(1)).notes
    assert note.startswith("The inputs of the roads are independent: delays and coherence are not in the model")
    assert "road_rear_velocity" in note
    assert it.named_system(CAR).notes == ()


def test_a_linear_system_has_its_names() -> None:
    system = it.state_space(CAR, "road", "strut_travel")
    made = it.export(system, "control")
    assert made.input_labels == ["road"]
    with pytest.raises(it.InerterError, match="share a source or are delayed"):
        it.export(system.with_delays("road", [0.1]), "control")
    with pytest.raises(it.InerterError, match="has no descriptor"):
        it.named_system(system, form="descriptor")


def test_without_python_control_a_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "control", None)
    with pytest.raises(it.InerterError, match=r"pip install .inerter\[control\]"):
        it.export(CAR, "control")


def test_a_descriptor_is_refused_where_there_is_none() -> None:
    for kind in ("control", "scipy"):
        with pytest.raises(it.InerterError, match="has no descriptor systems"):
            it.export(CAR, kind, form="descriptor")
    assert isinstance(it.export(CAR, "control", form="state-space"), control.StateSpace)
