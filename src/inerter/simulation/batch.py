"""Many designs on many signals at once, keeping mean squares instead of histories."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from functools import partial
from itertools import count as count_from
from threading import Lock
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import renamed_keywords
from inerter.errors import SimulationError, Status
from inerter.formatting import format_alike
from inerter.kernels.prepare import prepare_on
from inerter.signals.signal import Signal
from inerter.simulation import event_driven
from inerter.simulation.initial_state import ending_of, initial_state
from inerter.simulation.inputs import (
    BatchInputs,
    InputTable,
    assign,
    check_holds,
    check_keywords,
    initial_of,
    tabulate,
    whole_steps,
)
from inerter.simulation.threads import threads
from inerter.simulation.trajectory import Trajectory
from inerter.systems.outputs import find
from inerter.systems.piecewise import PiecewiseSystem, piecewise
from inerter.validation import checked, is_number
from inerter.vehicle.vehicle import Vehicle
from inerter.work.running import map_items, running_on, threads_here

if TYPE_CHECKING:
    import xarray

Matrix = NDArray[np.float64]
_TOGETHER = 16  # designs on the same signal in one item of work, which is laid out once for them


@dataclass(frozen=True, eq=False)
class Batch:
    """Mean squares over time of every design on every signal; nan where a run could not go to its end.

    Without a history there is no check for wheel lift-off, so `status` is the `integration_status` of `simulate`.

    >>> import inerter as it
    >>> devices = [it.Rig(it.Damper(c)) for c in (100.0, 300.0)]
    >>> both = it.simulate_many(devices, outputs=["device_force"], duration=1.0, displacement=[it.sine(0.01, 1.0)])
    >>> both.mean_square.shape  # designs x signals x outputs; [N^2] here
    (2, 1, 1)
    >>> round(float(both.rms[1, 0, 0] / both.rms[0, 0, 0]), 9)
    3.0
    """

    outputs: tuple[str, ...]
    units: tuple[str, ...]
    mean_square: Matrix  # (designs, signals, outputs)
    events: NDArray[np.int64]  # (designs, signals)
    status: tuple[tuple[Status, ...], ...]  # designs x signals

    @property
    def rms(self) -> Matrix:
        """Roots of the mean squares, (designs, signals, outputs)."""
        return np.sqrt(self.mean_square)

    def to_xarray(self) -> xarray.Dataset:
        """R.m.s. values and numbers of events over `design` and `signal`."""
        import xarray  # noqa: PLC0415 - heavy

        dims = ("design", "signal")
        data = {
            name: (dims, self.rms[..., i], {"units": unit, "long_name": f"r.m.s. {name.replace('_', ' ')}"})
            for i, (name, unit) in enumerate(zip(self.outputs, self.units, strict=True))
        }
        status = np.array([[str(s) for s in row] for row in self.status])
        return xarray.Dataset({**data, "events": (dims, self.events), "status": (dims, status)})


@renamed_keywords(settled="discard")
@checked(SimulationError)
def simulate_many(
    vehicles: Sequence[Vehicle],
    *,
    outputs: str | Sequence[str],
    duration: float,
    step: float = 2e-4,
    discard: float = 0.0,
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
    **driven: Unpack[BatchInputs],
) -> Batch:
    """Simulate every vehicle on every signal, and keep the mean squares of `outputs` after the first `discard` [s].

    What drives them are the keywords of `simulate`, here sequences of signals, which are gone through together: the
    j-th run of a vehicle takes the j-th of each. `jobs` threads (all cores by default) share the work, or an
    `executor` (of `concurrent.futures`, of a dask client, of mpi4py); results do not depend on it. `progress` is called
    with the part that is done, never twice at the same time. See `simulate` for the rest.

    Raises `SimulationError` as `simulate` does, and for an output that some vehicle does not have.

    >>> import inerter as it
    >>> devices = [it.Rig(it.Damper(c)) for c in (100.0, 300.0)]
    >>> signals = [it.sine(0.01, 1.0), it.sine(0.02, 1.0), it.sine(0.03, 1.0)]  # m, Hz
    >>> it.simulate_many(devices, outputs=["device_force"], duration=1.0, displacement=signals).rms.shape
    (2, 3, 1)
    """
    cars = as_list("vehicles", vehicles)
    names = [outputs] if isinstance(outputs, str) else as_list("outputs", outputs)
    if jobs is not None and (not isinstance(jobs, int) or jobs < 1):
        raise SimulationError(f"The number of threads must be a positive integer, got jobs = {jobs!r}.")
    if not is_number(discard):
        raise SimulationError(f"discard: the discarded time must be a number of seconds; got {discard!r}.")
    check_keywords("simulate_many", driven)
    speed, initial = driven.get("speed"), initial_of(driven)
    groups, count = groups_of(driven)
    joined = isinstance(initial, Trajectory)
    begin = initial.end if isinstance(initial, Trajectory) else 0.0
    steps, skipped = whole_steps(duration, step), round(discard / step)
    if not 0 <= skipped < steps:
        part, whole = format_alike([discard, duration], "s")
        raise SimulationError(f"discard: {part} must be shorter than the duration, {whole}.")
    if executor is not None:
        same = {"outputs": names, "duration": duration, "step": step, "discard": discard, "initial": initial}
        with running_on(executor) as there:
            prepare_on(there, event_driven.KERNELS)
            return _run_on_executor(cars, groups, count, {**same, "speed": speed}, progress)
    squares = np.full((len(cars), count, len(names)), np.nan)
    events, status = np.zeros((len(cars), count), np.int64), np.empty((len(cars), count), dtype=object)
    systems: list[PiecewiseSystem | None] = [None] * len(cars)
    tables = [_Tables(len(cars)) for _ in range(count)]
    preparing = Lock()  # much of it holds the interpreter: threads that pass that to and fro lose a quarter of the time

    def run(i: int, j: int) -> None:
        own = {name: group[j] for name, group in groups.items()}
        with preparing:
            system = systems[i] = systems[i] or _system(cars[i], names)
            signals, delays = assign(system.mechanism, **own, speed=speed)
            check_holds(system, signals)
        table = tables[j].take(signals, delays, duration, step, begin, joined)
        with preparing:
            state, after = initial_state(system, table.value[0], initial, table.slope[0]), ending_of(initial)
            integration = event_driven.start_finely(
                system, table, state, names, keep=False, discard=skipped, after=after
            )
        integration.advance(integration.table.time.size - 1)
        events[i, j], status[i, j] = integration.events, integration.status
        if integration.status.ok:
            squares[i, j] = integration.record.squares / (steps - skipped)

    runs = [(i, j) for j in range(count) for i in range(len(cars))]
    waiting, done = iter(runs), count_from(1)

    def work() -> None:
        for i, j in waiting:
            run(i, j)
            if progress is not None:
                with preparing:
                    progress(next(done) / len(runs))

    workers = min(jobs or threads_here(), len(runs))
    with threads(workers) as pool:
        for worker in as_completed([pool.submit(work) for _ in range(workers)]):
            worker.result()
    system = systems[0]
    assert system is not None
    units = tuple(system.outputs[name].unit for name in names)
    return Batch(tuple(names), units, squares, events, tuple(tuple(row) for row in status))


def _run_on_executor(
    cars: Sequence[Vehicle],
    groups: Mapping[str, Any],
    count: int,
    same: Mapping[str, Any],
    progress: Callable[[float], None] | None,
) -> Batch:
    """Results of all runs on the executor, in tasks of several designs on one signal."""
    firsts = range(0, len(cars), _TOGETHER)
    items = [
        (cars[i : i + _TOGETHER], {name: [group[j]] for name, group in groups.items()})
        for i in firsts
        for j in range(count)
    ]
    found = map_items(partial(_run_designs, same), items, progress=progress)
    rows = [found[k * count : (k + 1) * count] for k in range(len(firsts))]
    return Batch(
        found[0].outputs,
        found[0].units,
        np.concatenate([np.concatenate([batch.mean_square for batch in row], axis=1) for row in rows]),
        np.concatenate([np.concatenate([batch.events for batch in row], axis=1) for row in rows]),
        tuple(tuple(batch.status[i][0] for batch in row) for row in rows for i in range(len(row[0].status))),
    )


def _run_designs(same: Mapping[str, Any], item: tuple[Sequence[Vehicle], Mapping[str, Any]]) -> Batch:
    cars, driven = item
    return simulate_many(cars, **same, **driven)


class _Tables:
    """The inputs of the j-th runs: laid out when first needed, shared where they agree, dropped after the last run."""

    def __init__(self, runs: int) -> None:
        self.runs, self.known, self.lock = runs, dict[tuple[object, ...], InputTable](), Lock()

    def take(
        self,
        signals: Sequence[Signal | None],
        delays: Sequence[float],
        duration: float,
        step: float,
        begin: float,
        joined: bool,
    ) -> InputTable:
        key = (tuple(map(id, signals)), tuple(delays))
        with self.lock:
            table = self.known[key] = self.known.get(key) or tabulate(signals, delays, duration, step, 1, begin, joined)
            self.runs -= 1
            if self.runs == 0:
                self.known.clear()
        return table


def _system(car: Vehicle, outputs: Sequence[str]) -> PiecewiseSystem:
    system = piecewise(car)
    for name in outputs:
        find(system.outputs, name, SimulationError)
    return system


def as_list(what: str, given: object) -> list[Any]:
    """A list of one or more; raises `SimulationError` for anything else."""
    if not isinstance(given, Sequence) or isinstance(given, str) or not given:
        raise SimulationError(f"There must be one or more {what} in a list, got {given!r}.")
    return list(given)


def groups_of(driven: BatchInputs) -> tuple[dict[str, Any], int]:
    """The sequences that drive the runs of each vehicle, by keyword, and how many runs that are."""
    groups: dict[str, Any] = {
        name: group for name, group in driven.items() if name not in ("speed", "initial") and group is not None
    }
    given: Collection[Any] = groups.values()
    lengths = {len(g) if isinstance(g, Sequence) else 0 for g in given}
    if len(lengths) != 1 or 0 in lengths:
        raise SimulationError(
            "Runs are driven by sequences of signals, all of one length: road=[multisine(...), ...] or forces=[{...}]."
        )
    return groups, lengths.pop()
