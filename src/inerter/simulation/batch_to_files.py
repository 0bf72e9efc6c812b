"""Simulation of many runs with their outputs over time, each written to a separate file by its worker process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from inerter.atomic_io import is_disk_failure, write_netcdf
from inerter.errors import SimulationError, WorkError
from inerter.kernels.prepare import prepare_on
from inerter.simulation import event_driven
from inerter.simulation.batch import as_list, groups_of
from inerter.simulation.inputs import BatchInputs, check_keywords, initial_of
from inerter.simulation.simulate import simulate
from inerter.systems.outputs import find
from inerter.systems.piecewise import piecewise
from inerter.validation import checked
from inerter.vehicle.vehicle import Vehicle
from inerter.work.running import map_items, running_on


@checked(SimulationError)
def simulate_to_files(
    vehicles: Sequence[Vehicle],
    folder: str | Path,
    *,
    outputs: str | Sequence[str],
    duration: float,
    step: float = 2e-4,
    every: int = 1,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
    **driven: Unpack[BatchInputs],
) -> list[list[Path]]:
    """Simulate every vehicle on every signal, and write the history of `outputs` of each run to a file in `folder`.

    Returns the files, `design-<i>-signal-<j>.nc`, as designs x signals: netCDF over `time` with units, and the run's
    `status` as an attribute. `folder` is new, or empty. With an `executor` (of `concurrent.futures`, of a dask client,
    of mpi4py) processes write what they have simulated, so that no history passes through a scheduler; on several
    machines the folder must be on a disk that all of them see. See `simulate` and `simulate_many` for the rest.

    Raises `SimulationError` as `simulate_many` does, and if the folder holds something or cannot be written;
    `WorkError` if what was written elsewhere is not seen here, or the disk is full.

    >>> import inerter as it
    >>> from tempfile import TemporaryDirectory
    >>> devices, motion = [it.Rig(it.Damper(100.0))], it.sine(0.01, 1.0)
    >>> with TemporaryDirectory() as folder:
    ...     written = it.simulate_to_files(
    ...         devices, folder, outputs=["device_force"], duration=0.1, displacement=[motion]
    ...     )
    >>> written[0][0].name
    'design-00000-signal-000.nc'
    """
    cars = as_list("vehicles", vehicles)
    names = [outputs] if isinstance(outputs, str) else as_list("outputs", outputs)
    check_keywords("simulate_to_files", driven)
    groups, count = groups_of(driven)
    for car in cars:
        known = piecewise(car).outputs
        for name in names:
            find(known, name, SimulationError)
    place = _empty(folder)
    files = [[place / f"design-{i:05d}-signal-{j:03d}.nc" for j in range(count)] for i in range(len(cars))]
    shared = {"speed": driven.get("speed"), "initial": initial_of(driven)}
    same = {"duration": duration, "step": step, "every": every, **shared}
    items = [
        (car, {name: group[j] for name, group in groups.items()}, str(files[i][j]))
        for i, car in enumerate(cars)
        for j in range(count)
    ]
    with running_on(executor) as pool:
        prepare_on(pool, event_driven.KERNELS)
        map_items(partial(_write, names, same), items, progress=progress)
    missing = next((file for row in files for file in row if not file.is_file()), None)
    if missing is not None:
        raise WorkError(
            f"{str(missing)!r} was written to a folder that this process cannot read. Name a shared folder."
        )
    return files


def _write(names: Sequence[str], same: dict[str, Any], item: tuple[Vehicle, dict[str, Any], str]) -> None:
    car, driven, file = item
    run = simulate(car, **same, **driven)
    try:
        write_netcdf(Path(file), run.to_xarray(names))
    except OSError as error:
        raise _unwritten(file, error) from error


def _empty(folder: str | Path) -> Path:
    """Absolute path of an empty folder, created if missing; raises `SimulationError` if the folder holds a file."""
    place = Path(folder).resolve()
    try:
        place.mkdir(parents=True, exist_ok=True)
        holds = next(place.iterdir(), None)
    except OSError as error:
        raise _unwritten(folder, error) from error
    if holds is not None:
        raise SimulationError(
            f"The folder {str(folder)!r} already contains {holds.name!r}. Name a new or an empty one."
        )
    return place


def _unwritten(place: str | Path, error: OSError) -> SimulationError | WorkError:
    kind = WorkError if is_disk_failure(error) else SimulationError
    return kind(f"Cannot write {str(place)!r}: {error.strerror or error}.")
