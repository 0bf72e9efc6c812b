"""Histories of many runs, each in a file that the process which made it writes."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import xarray
from wang_su import ROAD

import inerter as it
from inerter.errors import SimulationError

OUTPUTS = ["sprung_acceleration", "tyre_load"]


def car(damping: float) -> it.QuarterCar:
    strut = it.Spring(120e3) | it.Damper(damping) | it.Friction(20.0)
    return it.QuarterCar(sprung_mass=180.0, unsprung_mass=25.0, tyre_stiffness=120e3, strut=strut)


CARS, SIGNALS = [car(1e3), car(3e3)], [it.multisine(ROAD, seed=seed) for seed in range(3)]


@pytest.mark.marathon
def test_each_file_holds_what_a_simulation_says(tmp_path: Path) -> None:
    told: list[float] = []
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        files = it.simulate_to_files(
            CARS, tmp_path / "new", outputs=OUTPUTS, duration=0.2, road=SIGNALS, executor=executor, progress=told.append
        )
    assert [[file.name for file in row] for row in files][1] == [f"design-00001-signal-00{j}.nc" for j in range(3)]
    assert sorted(tmp_path.glob("new/*")) == sorted(file for row in files for file in row)
    here = it.simulate_to_files(CARS[:1], tmp_path / "here", outputs=OUTPUTS, duration=0.2, road=SIGNALS[:1])
    assert here[0][0].read_bytes() == files[0][0].read_bytes()
    assert told == sorted(told)
    assert told[-1] == 1.0
    for one, row in zip(CARS, files, strict=True):
        for signal, file in zip(SIGNALS, row, strict=True):
            run = it.simulate(one, duration=0.2, road=signal)
            with xarray.open_dataset(file, engine="h5netcdf") as found:
                assert list(found) == OUTPUTS
                assert found.attrs["status"] == "ok"
                assert found["tyre_load"].attrs["units"] == "N"
                assert all(np.array_equal(found[name].values, run[name]) for name in OUTPUTS)


def test_a_folder_that_holds_something_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("dear to me", encoding="utf-8")
    with pytest.raises(SimulationError, match=r"already contains 'mine.txt'"):
        it.simulate_to_files(CARS, tmp_path, outputs=OUTPUTS, duration=0.1, road=SIGNALS)
    assert [one.name for one in tmp_path.iterdir()] == ["mine.txt"]


def test_what_is_wrong_is_said_before_a_folder_is_made(tmp_path: Path) -> None:
    place = tmp_path / "new"
    with pytest.raises(SimulationError, match="Unknown output 'comfort'"):
        it.simulate_to_files(CARS, place, outputs=["comfort"], duration=0.1, road=SIGNALS)
    with pytest.raises(SimulationError, match="one or more vehicles in a list"):
        it.simulate_to_files([], place, outputs=OUTPUTS, duration=0.1, road=SIGNALS)
    with pytest.raises(SimulationError, match="all of one length"):
        it.simulate_to_files(CARS, place, outputs=OUTPUTS, duration=0.1, road=SIGNALS[0])  # type: ignore[arg-type]
    assert not place.exists()
