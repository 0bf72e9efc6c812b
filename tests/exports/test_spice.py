"""Netlists have the admittance of the strut in ngspice."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from random_mechanisms import drawn, logarithmic
from strategies import random_network

import inerter as it
from inerter.networks.elements import Network
from inerter.networks.transform import map_elements

NGSPICE = shutil.which("ngspice")
COUNT = 50
BRIDGE = it.Bridge(it.Damper(3e3), it.Spring(4e4), it.Inerter(20.0), it.Damper(1e3), it.Spring(1e5))


OF_VEHICLES = {it.Spring: (5e3, 5e5), it.Damper: (2e2, 2e4), it.Inerter: (5.0, 5e2)}


def network(number: int) -> Network:
    rng = np.random.default_rng([690, number])
    made = drawn(rng, random_network(rng, 4, int(rng.integers(1, 9))), 1.0)
    return made if number % 5 else made | BRIDGE


def strut_of_a_vehicle(number: int) -> Network:
    rng = np.random.default_rng([691, number])
    parts = random_network(rng, 4, int(rng.integers(1, 9)))
    made = map_elements(parts, lambda part: part.with_value(logarithmic(rng, *OF_VEHICLES[type(part)])))
    return made if number % 5 else made | BRIDGE


def admittance(netlist: str, folder: Path, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies from `low` to `high` Hz and admittances of `strut` by ngspice: 1 N gives the velocity 1/Y."""
    driven = f"xs upper 0 strut\niforce 0 upper dc 0 ac 1\n.options noopac\n.ac dec 13 {low} {high}\n.end\n"
    (folder / "strut.cir").write_text(f"{netlist}\n{driven}", encoding="utf-8")
    (folder / ".spiceinit").write_text("set filetype=ascii\n", encoding="utf-8")
    command = [str(NGSPICE), "-b", "-r", "strut.raw", "strut.cir"]
    done = subprocess.run(command, check=False, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    head, _, values = (folder / "strut.raw").read_text().partition("Values:")
    count = int(re.search(r"No. Variables: (\d+)", head)[1])  # type: ignore[index]
    names = re.findall(r"^\t\d+\t(\S+)", head, re.MULTILINE)
    cells = re.findall(r"(\S+),(\S+)\s*$", values, re.MULTILINE)
    rows = np.array([complex(float(a), float(b)) for a, b in cells]).reshape(-1, count)
    return 2.0 * np.pi * rows[:, 0].real, 1.0 / rows[:, names.index("v(upper)")]


@pytest.mark.parametrize("number", sampled(range(COUNT), (0, 1, 2), kept=12))
def test_ngspice_finds_the_admittance_of_the_strut_of_a_vehicle(number: int, tmp_path: Path) -> None:
    """From 0.5 to 80 Hz, the range in which ISO 2631 weights vibration."""
    strut = strut_of_a_vehicle(number)
    assert deviation(strut, tmp_path, 0.5, 80.0)[1].max() < 1e-12


@pytest.mark.parametrize("number", sampled(range(COUNT), (3, 5, 10), kept=12))
def test_ngspice_loses_no_more_than_elimination_does(number: int, tmp_path: Path) -> None:
    """Six decades of frequency, and parts five decades apart."""
    omega, found = deviation(network(number), tmp_path, 0.01, 1e4)
    assert np.all(found < np.maximum(1e-12, 1e-15 * condition(network(number), omega)))


def deviation(network: Network, folder: Path, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies, and by how much ngspice and we differ there, over the admittance."""
    if NGSPICE is None:
        pytest.skip("ngspice is not installed (Debian: ngspice).")
    omega, found = admittance(it.export(network, "spice"), folder, low, high)
    assert omega.size > 25
    return omega, np.abs(found / network.admittance(1j * omega) - 1.0)


def condition(network: Network, omega: np.ndarray) -> np.ndarray:
    """How many times the admittance of a part exceeds that of the whole, or its impedance that of the whole.

    So much does the elimination of ngspice lose, in whatever order it takes nodes and inductors.
    """
    whole = np.abs(network.admittance(1j * omega))
    parts = np.array([np.abs(element.admittance(1j * omega)) for element in network.elements()])
    return np.maximum(np.max(parts / whole, axis=0), np.max(whole / parts, axis=0))


def test_every_strut_of_a_vehicle_is_a_subcircuit() -> None:
    front, rear = it.Spring(2e4) | it.Damper(2e3, "d"), it.Spring(3e4) | it.Damper(1e3, "d") - it.Inerter(50.0)
    car = it.HalfCar(400.0, 200.0, 25.0, 20.0, 1.2e5, 1e5, 0.8, 1.2, front, rear)
    text = it.export(car, "spice")
    assert re.findall(r"^\.subckt (\w+) upper lower$", text, re.MULTILINE) == ["front", "rear"]
    assert re.findall(r"^(\w+) \w+ \w+ (\S+)$", text, re.MULTILINE) == [
        ("Lk", "5e-05"),
        ("Rd", "0.0005"),
        ("Lk", repr(1.0 / 3e4)),
        ("Rd", "0.001"),
        ("Cb", "50.0"),
    ]


def test_struts_that_differ_by_capitals_are_told_apart() -> None:
    """A netlist has no capital letters, and the first of two subcircuits would stand for both."""
    struts = [it.Strut(name, it.Spring(k), {"mass": 1.0}, {}) for name, k in (("a", 1e3), ("A", 2e3), ("b", 3e3))]
    text = it.export(it.Mechanism((it.Coordinate("mass", 1.0),), tuple(struts)), "spice")
    assert re.findall(r"^\.subckt (\w+) ", text, re.MULTILINE) == ["a_1", "A_2", "b"]
    assert re.findall(r"^\.ends (\w+)$", text, re.MULTILINE) == ["a_1", "A_2", "b"]
    assert "* subcircuits: a_1, A_2, b" in text


def test_parts_of_one_name_are_told_apart() -> None:
    parts = re.findall(
        r"^([LRC]\w+) ", it.export(it.Spring(1e3) | it.Spring(2e3) - it.Spring(3e3), "spice"), re.MULTILINE
    )
    assert len(set(parts)) == 3
