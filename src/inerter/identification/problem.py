"""The least-squares problem: whitened residuals of all records over the coordinates, and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError
from inerter.identification.experiment import Experiment, SimulationCount, free_motions, load_cell_output
from inerter.identification.hypotheses import Hypothesis, read_by_load_cell
from inerter.identification.models import on_rig
from inerter.identification.noise import Whitening
from inerter.identification.parameter_space import Space
from inerter.networks.elements import Element, Free, Network
from inerter.networks.transform import map_elements, with_values
from inerter.records.record import Record
from inerter.simulation.trajectory import Trajectory
from inerter.systems.piecewise import PiecewiseSystem, piecewise, with_element_values
from inerter.vehicle.rig import Rig
from inerter.work.chunks import Item, Result
from inerter.work.running import map_items, over_threads

Matrix = NDArray[np.float64]
NoiseSpectrum = Callable[[Network], Matrix]
_FEWEST = 100  # samples that are compared
FAILED = 1e3  # whitened residual of a simulation that fails


class SimulatedRecord(NamedTuple):
    """A record as a device gives it, from rest."""

    force: Matrix  # (samples,) [N] of the load cell
    run: Trajectory
    free: Matrix  # (samples, motions) free motions, for an initial state that the record does not show


@dataclass(eq=False)
class FitProblem:
    """A rig with unknowns and the records to which they are fitted."""

    rig: Rig
    space: Space
    experiments: Sequence[Experiment]
    whitenings: Sequence[Whitening]
    offset: bool = True  # whether the load cell has a free offset in each record
    assumed: tuple[Hypothesis, ...] = ()
    horizon: float = 1.0  # share of the information of each record that is compared
    spectra: tuple[NoiseSpectrum, ...] = ()  # of the noise of each record, where whitenings depend on the values
    systems: dict[tuple[object, ...], PiecewiseSystem] = field(default_factory=dict)  # by load cell and zeros

    def __getstate__(self) -> dict[str, object]:
        """State for another process, without systems, which are faster to build than to send."""
        return {**vars(self), "systems": {}}

    def system(self, coordinates: Matrix, record: Record) -> PiecewiseSystem | None:
        """The rig with these values and the load cell of a record; None where such a device cannot be simulated.

        It is built once, and its values replaced, so that feasibility does not depend on the first values.
        """
        kinds = dict(zip(self.space.names, self.space.kinds, strict=True))
        values = {n: v for n, v in self.space.values_by_name(coordinates).items() if kinds[n] is not None}
        layout = (record.force_bandwidth, *(value == 0.0 for value in values.values()))
        try:
            known = self.systems.get(layout)
            if known is None:
                largest = dict(zip(self.space.names, self.space.upper.tolist(), strict=True))
                known = self._build_system(record, {n: v and largest[n] for n, v in values.items()})
                self.systems[layout] = known
            if set(values) <= {b.label for b in known.graph.branches} and not known.kinematics.weighs:
                return with_element_values(known, {n: v for n, v in values.items() if v != 0.0})
            return self._build_system(record, values)
        except InerterError:
            return None

    def _build_system(self, record: Record, values: Mapping[str, float]) -> PiecewiseSystem:
        return piecewise(on_rig(_label_elements(self.rig), record.force_bandwidth).with_values(values))

    def forces(self, coordinates: Matrix) -> list[Matrix | None]:
        """Load cell forces of each record up to the horizon, with the free motion that fits best; None on failure."""
        simulated = (self.simulate(e, coordinates) for e in self.experiments)
        return [None if one is None else self.read_force(n, one) for n, one in enumerate(simulated)]

    def read_force(self, number: int, simulated: SimulatedRecord) -> Matrix:
        """Load cell force [N] of a record of this number, with the free motion that fits it best."""
        force, _, free = simulated
        if not free.shape[1]:
            return force
        e, w = self.experiments[number], self.whitenings[number]
        white, columns = w(e.record.force[: force.size] - force), self._nuisances(w, free)
        return np.asarray(force + free @ _least_squares(columns, white)[: free.shape[1]])

    def simulate(self, experiment: Experiment, coordinates: Matrix) -> SimulatedRecord | None:
        """One record as the device gives it from rest; None where the simulation fails."""
        e, values = experiment, self.space.values_by_name(coordinates)
        for hypothesis in reversed(self.assumed):  # a delay, which is assumed first, of the motion that others mend
            e = hypothesis.change_motion(e, values)
        system = self.system(coordinates, e.record)
        run = None if system is None else e.run(system, None if self.horizon == 1.0 else self.samples(experiment))
        if run is None or system is None:
            return None
        force = run[load_cell_output(e.record)]
        if e.record.fixture_mass is not None:
            force = force + e.record.fixture_mass * read_by_load_cell(e.motion.acceleration[: force.size], e)
        for hypothesis in self.assumed:
            force = hypothesis.read(force, e, values)
        return SimulatedRecord(force, run, free_motions(experiment, system, force.size))

    def _nuisances(self, whitening: Whitening, free: Matrix) -> Matrix:
        """Whitened free motions, and the offset, where it is free."""
        columns = whitening(free) if free.shape[1] else free
        return np.column_stack([columns, whitening.of_offset(free.shape[0])]) if self.offset else columns

    def samples(self, experiment: Experiment) -> int:
        """Number of samples of a record up to the horizon."""
        if self.horizon == 1.0:
            return experiment.size
        return min(max(_FEWEST, int(np.searchsorted(experiment.information, self.horizon))), experiment.size)

    def residual(self, coordinates: Matrix) -> Matrix:
        """Whitened residuals of all records, one after the other."""
        parts = []
        for e, w in zip(self.experiments, self._whitenings_at(coordinates), strict=True):
            simulated = self.simulate(e, coordinates)
            if simulated is None:
                parts.append(np.where(w.weight[: self.samples(e)] > 0.0, FAILED, 0.0))
                continue
            force, _, free = simulated
            white, columns = w(force - e.record.force[: force.size]), self._nuisances(w, free)
            parts.append(white - columns @ _least_squares(columns, white))
        return np.concatenate(parts)

    def spectra_at(self, coordinates: Matrix) -> list[Matrix]:
        """The spectra of the noise in each record with these values, where whitenings depend on them."""
        device = with_values(self.rig.device, self.space.values_by_name(coordinates))
        return [spectrum(device) for spectrum in self.spectra]

    def _whitenings_at(self, coordinates: Matrix) -> Sequence[Whitening]:
        if not self.spectra:
            return self.whitenings
        pairs = zip(self.whitenings, self.spectra_at(coordinates), strict=True)
        return [replace(w, lines=lines, offsets={}) for w, lines in pairs]

    def residuals(self, points: Sequence[Matrix]) -> list[Matrix]:
        """The residuals at several points, over the cores."""
        return list(over_threads(self.residual, points))

    def jacobian(self, coordinates: Matrix, steps: Matrix, among: Sequence[int] | None = None) -> Matrix:
        """Central differences of the residuals over these steps, one-sided at a bound: by all coordinates, or `among`.

        Steps are as wide as the coordinates are uncertain: with friction and backlash the residuals are not smooth, so
        tiny steps would fail.
        """
        lower, upper = self.space.bounds
        points, widths = [], []
        for i in range(coordinates.size) if among is None else among:
            ends = np.clip(coordinates[i] + np.array([-steps[i], steps[i]]), lower[i], upper[i])
            widths.append(float(ends[1] - ends[0]))
            for end in ends:
                point = coordinates.copy()
                point[i] = end
                points.append(point)
        found = self.residuals(points)
        return np.stack([(found[2 * i + 1] - found[2 * i]) / w for i, w in enumerate(widths)], axis=1)

    def offsets(self, coordinates: Matrix) -> list[float]:
        """The offset of the load cell [N] in each record."""
        result = []
        for e, w, force in zip(self.experiments, self.whitenings, self.forces(coordinates), strict=True):
            if force is None or not self.offset:
                result.append(0.0)
                continue
            size = self.samples(e)
            column, white = w.of_offset(size), w(e.record.force[:size] - force)
            result.append(float(column @ white / max(float(column @ column), 1e-300)))
        return result


def _least_squares(columns: Matrix, values: Matrix) -> Matrix:
    """The factors of columns whose sum is nearest to values."""
    if columns.shape[1] == 1:
        return np.array([columns[:, 0] @ values / max(float(columns[:, 0] @ columns[:, 0]), 1e-300)])
    return np.asarray(np.linalg.lstsq(columns, values, rcond=1e-10)[0])


def map_problems(
    work: Callable[[FitProblem, Item], Result],
    calls: Sequence[tuple[FitProblem, Item]],
    otherwise: Callable[..., Iterable[tuple[Result, list[int]]]] = map,
    progress: Callable[[float], None] | None = None,
) -> list[Result]:
    """Results of `work` on each problem and item, on the current executor, else by `otherwise`.

    The simulations of any process count for the records of the problem.
    """
    found = []
    answers = map_items(partial(_run_on_problem, work), calls, otherwise, progress)
    for (problem, _), (result, counts) in zip(calls, answers, strict=True):
        for experiment, count in zip(problem.experiments, counts, strict=True):
            experiment.tally.add(count)
        found.append(result)
    return found


def _run_on_problem(
    work: Callable[[FitProblem, Item], Result], call: tuple[FitProblem, Item]
) -> tuple[Result, list[int]]:
    problem, item = call
    own = replace(problem, experiments=[replace(e, tally=SimulationCount()) for e in problem.experiments])
    result = work(own, item)
    return result, [e.tally.total for e in own.experiments]


def _label_elements(rig: Rig) -> Network:
    """The device of a rig with every free element labelled by the name of its value."""

    def label(element: Element) -> Network:
        value = element.value
        return type(element)(value, value.name) if isinstance(value, Free) else element  # type: ignore[call-arg]

    return map_elements(rig.device, label)
