"""Index of r.m.s. values over random roads: length of the roads, out-of-band contributions, and the mean."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, ErrorSource, Status, StatusKind, worst_of
from inerter.formatting import format_quantity, format_share
from inerter.indices.definition import IndexDefinition
from inerter.indices.excitation import error_sources_of
from inerter.methods.averages import interval_of, mean_and_error
from inerter.methods.equivalent_linear import (
    EquivalentLinearModel,
    equivalent_linear_model,
    few_lines,
    format_elements_with_play,
    has_play,
    lower_peaks,
    modal_shares,
    relative_change,
    squares_above,
    travels_with_play,
    with_velocities,
)
from inerter.methods.error_bounds import with_error_sources
from inerter.methods.linear import Conventions
from inerter.methods.measured_road_errors import road_errors
from inerter.methods.method import Estimate
from inerter.methods.realisations import (
    STEP,
    RandomExcitation,
    check_held_roads,
    factor_of,
    random_excitation,
    realisation_seeds,
    run,
)
from inerter.methods.steady_squares import Squares, mean_bound, steady_state_error
from inerter.norms.h2 import h2
from inerter.norms.response import modal_response
from inerter.systems.linear import LinearSystem
from inerter.systems.piecewise import PiecewiseSystem
from inerter.work.running import map_items

Array = NDArray[np.float64]
PROMISE = 0.01  # relative error of a mean that is ok, sampling and what stands in for its excitation apart
LONGEST = 640  # [s] of a road
MOST_ROADS = 1000
_LONGER = 4  # times the length that does not do
_FIRST = 2  # roads that decide how long the others must be
_MOST_BEYOND = 0.1  # of a mean square that may be added for the road outside the band
_UNSEEN = 5e-4  # of a mean square that lines may miss without a longer road
_LOST = 1e-2  # the same, beyond which nothing is known
_MOST_PEAKED = 0.01  # of a mean square, without a longer road ...
_MOST_PEAKED_BY_PLAY = 0.015  # ... with gaps and such, where the roads needed for this are slow
_IMAGES = 6  # of each line, on either side, that samples cannot tell from it
_SMOOTH = 500  # lines whose images are computed
_IMAGES_WITHIN = 1e-8  # of the largest response to images, which are a per cent of any line, or less
_ROUNDING = 1e-12  # of the mean square of an index, within which an output is at rest
_COARSE = 1e-2  # how well what knots of the road take from a mean square is known
_UNLIKE = "no equivalent linear model: nothing is added for the road outside 0.1 to 1000 Hz"
_STEPPED = 2e-6  # relative error of a value by the time step
_PEAKS = 4.0  # the largest of a random motion over its r.m.s. value
_FEW = 3  # periods after which a motion with play must repeat, or the period is too short to stand for a long road


@dataclass(frozen=True, eq=False)
class OnRoads:
    """A design and the definition of an index, on random roads of one length.

    `frictions` names the velocities across its frictions, `play` the travels of mounts with an element that no damper
    represents, such as a gap.
    """

    system: PiecewiseSystem
    frictions: tuple[str, ...]
    play: tuple[str, ...]
    definition: IndexDefinition
    excitation: RandomExcitation
    linear: EquivalentLinearModel | None
    seed: int
    longest: int  # road that may be taken [s]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs of the index."""
        return tuple(output.output for output in self.definition.outputs)

    @property
    def weights(self) -> Array:
        """Factor of each output's r.m.s. value in the index."""
        return np.array([abs(output.weight) for output in self.definition.outputs])

    def runs(
        self, first: int, stop: int, pool: Executor, *, spectra: Sequence[str] = (), after: Sequence[Squares] = ()
    ) -> list[Squares]:
        """Results of the realisations `first`, ..., `stop` - 1, with numbers of spectral lines of `spectra`.

        The motions begin from rest, or where those `after` which they come have ended.
        """
        begins: list[Array | None] = [one.ending for one in after] or [None] * (stop - first)
        on_roads = list(zip(realisation_seeds(self.seed, first, stop), begins, strict=True))
        outputs, filters = (*self.outputs, *self.frictions, *self.play), self.definition.filters
        on_road = partial(run, self.system, self.excitation, outputs, filters, spectra=spectra)
        return map_items(on_road, on_roads, pool.map)

    def on_higher_roads(self) -> OnRoads:
        """The design on the same roads, twice as high."""
        road = self.excitation.road
        return replace(self, excitation=replace(self.excitation, road=replace(road, roughness=4.0 * road.roughness)))


@dataclass(frozen=True, eq=False)
class OutOfBandContribution:
    """Contribution missing from the lines of a road: mean squares to add to the outputs', and their uncertainty."""

    power: Array
    unseen: float = 0.0  # share of the mean squares that may be missing, or too much
    beyond: float = 0.0  # the same of the road outside the band
    peaked: float = 0.0  # the same by frictions, whose velocities have lower peaks on lines than on a road
    within_reach: bool = True  # whether longer roads would tell, if the motion stays as it is
    status: Status = OK
    notes: tuple[str, ...] = ()
    measured: tuple[ErrorSource, ...] = ()  # of a road that was measured


def on_roads(
    system: PiecewiseSystem, definition: IndexDefinition, conventions: Conventions, seed: int, period: int | None = None
) -> OnRoads:
    """An index of a system on roads of this `period` [s]; by default of the usual length, or longer where needed."""
    excitation = random_excitation(system, definition, conventions, period)
    check_held_roads(system, excitation)
    if excitation.hold is not None:
        return OnRoads(system, (), (), definition, excitation, None, seed, LONGEST)
    linear = equivalent_linear_model(system.mechanism, definition, conventions)
    longest = LONGEST if period is None else excitation.period
    play = travels_with_play(system)
    return OnRoads(*with_velocities(system), play, definition, excitation, linear, seed, longest)


def long_enough(design: OnRoads, pool: Executor) -> tuple[OnRoads, list[Squares], OutOfBandContribution]:
    """The design on roads long enough to resolve its response, the first runs there, and the out-of-band rest.

    On those of the usual length if none of the lengths will do. On a longer road friction that stuck may slip, so one
    is tried even if the motion is out of reach as it is. Where friction is much of the damping, they are longer still,
    so that a resonance has more lines.
    """
    usual = longer, found, missing = _first_runs(design, pool)
    while not _is_resolved(longer, found, missing):
        if _LONGER * longer.excitation.period > design.longest or (longer is not design and not missing.within_reach):
            return usual
        longer, found, missing = _first_runs(_on_longer_roads(longer), pool)
    most = _MOST_PEAKED_BY_PLAY if design.play else _MOST_PEAKED
    while missing.peaked > most and _LONGER * longer.excitation.period <= design.longest:
        tried = _first_runs(_on_longer_roads(longer), pool)
        if not (np.all(np.isfinite(tried[2].power)) and _is_resolved(*tried)):
            break
        longer, found, missing = tried
    return longer, found, missing


def _first_runs(design: OnRoads, pool: Executor) -> tuple[OnRoads, list[Squares], OutOfBandContribution]:
    found = design.runs(0, _FIRST, pool, spectra=design.play)
    missing = out_of_band_contribution(design, found)
    if design.play and all(ran.status.ok for ran in found):
        higher = design.on_higher_roads().runs(0, _FIRST, pool)
        peaked = np.maximum(missing.peaked, _peaked_by_play(design, found, higher))
        if not all(ran.status.ok for ran in higher):
            peaked = np.maximum(peaked, _kept_by_play(design, found, design.runs(0, _FIRST, pool, after=higher)))
        missing = replace(missing, peaked=float(peaked))
    return design, found, missing


def _peaked_by_play(design: OnRoads, found: Sequence[Squares], higher: Sequence[Squares]) -> float:
    """Share of a mean square by which it may be off, as lines have lower peaks than a random road, with gaps and such.

    No linear model tells which resonance a gap changes, nor how wide that is: the change of the response is that of
    the motion on roads twice as high, and the lines are those over which the travel spreads on the roads themselves.
    """
    count, first = len(design.outputs), len(design.outputs) + len(design.frictions)
    power, there = (np.mean([ran.power[:count] for ran in runs], axis=0) for runs in (found, higher))
    over_lines = np.mean([1.0 / ran.lines[first:] for ran in found], axis=0)
    moving = power > 0.0
    change = np.abs(there[moving] / (4.0 * power[moving]) - 1.0).max(initial=0.0)
    return lower_peaks(float(change), float(over_lines.max()))


def _kept_by_play(design: OnRoads, found: Sequence[Squares], after: Sequence[Squares]) -> float:
    """Share of a mean square by which it is another one `after` a higher peak.

    A gap that the road does not close stays open; once a peak has closed it, an inerter without damping coasts from
    contact to contact. On a long road there is such a peak, sooner or later. The share is twice what two roads show.
    """
    count = len(design.outputs)
    power, later = (np.mean([ran.power[:count] for ran in runs], axis=0) for runs in (found, after))
    return 2.0 * relative_change(power, later)


def _on_longer_roads(design: OnRoads) -> OnRoads:
    return replace(design, excitation=replace(design.excitation, period=_LONGER * design.excitation.period))


def _is_resolved(design: OnRoads, found: Sequence[Squares], missing: OutOfBandContribution) -> bool:
    """Whether the period is long enough for the motion, or no period would be."""
    if design.excitation.hold is not None or worst_of([ran.status for ran in found]).kind is StatusKind.FAILED:
        return True
    settled = all(ran.status.ok for ran in found)
    if has_play(design.system) or design.linear is None:
        return settled and max(ran.steady.periods for ran in found) <= _FEW
    return bool(np.any(np.isinf(missing.power))) or (settled and missing.unseen <= _UNSEEN)


def out_of_band_contribution(design: OnRoads, found: Sequence[Squares]) -> OutOfBandContribution:
    """Contribution missing from the lines of these roads, by the equivalent linear model of the motion `found`.

    Its squared norms less its mean squares on the lines.
    """
    count, excitation, linear = len(design.outputs), design.excitation, design.linear
    if linear is None:
        if excitation.hold is not None:
            return OutOfBandContribution(np.zeros(count))
        return OutOfBandContribution(np.zeros(count), _left_over(found), beyond=np.nan, notes=(_UNLIKE,))
    power = np.mean([ran.power for ran in found], axis=0)
    if not np.all(np.isfinite(power)):
        return OutOfBandContribution(np.full(count, np.nan))
    speeds = np.sqrt(power[count : count + len(design.frictions)])
    system = linear.system(speeds)
    pade_order = linear.problem.pade_order
    whole = h2(system, pade_order)
    if not whole.status.ok:
        return OutOfBandContribution(np.where(np.isinf(whole.outputs), np.inf, np.nan), status=whole.status)
    norms, _ = linear.problem.correct_norms(system, whole.outputs)
    lines = _lines_of(excitation)
    gains, sampled = _squared_gains(design, speeds, system)
    inside, seen = lines.power @ gains, lines.power @ sampled
    whole_band = (design.definition.drive.amplitude_density * norms) ** 2
    added = whole_band - seen
    modes = modal_shares(system, norms)
    (left, pole), (at_last, _) = modes.remaining(excitation.period), modes.remaining(design.longest)
    change = linear.unlike(speeds, norms)
    peaked = modes.lower_peaks(excitation.period, change)
    with np.errstate(over="ignore"):  # infinite where the model would take away more than there is
        share = max(float(np.max(np.abs(added) / np.maximum(power[:count] + added, 1e-300))) - 2.0 * left, 0.0)
    misfit = relative_change(inside, power[:count])
    unlike = min(misfit + change, 1.0)  # once the lines tell more
    parts = design.weights**2 * power[:count]
    moving = parts > _ROUNDING * parts.max()  # others are at rest but for rounding, as on one side of a symmetry
    larger = float(np.max(whole_band[moving] / power[:count][moving], initial=1.0))  # the model's motion
    unseen, within_reach = 2.0 * left * larger, True
    if unseen > _UNSEEN:
        far = 1.0 if design.play else unlike  # a motion over gaps may have other resonances and equal mean squares
        unseen, within_reach = unseen * far, 2.0 * at_last * larger * far <= _UNSEEN
    if design.play:  # the model closes gaps, which may damp what is not damped while they are open
        unseen = max(unseen, _left_over(found))
    if design.play and unseen > _UNSEEN:
        above = design.definition.drive.amplitude_density**2 * squares_above(system, float(lines.omega[-1]))
        # Nothing is added below the band, where the model, which closes gaps, may move much more than the design.
        below = np.abs(added[moving]) / power[:count][moving] - 2.0 * left * larger
        share = float(np.max([below, above[moving] / power[:count][moving]], initial=0.0))
        return OutOfBandContribution(above, unseen, beyond=share, peaked=peaked, notes=(_loose_note(design.system),))
    if unseen > _LOST:
        return OutOfBandContribution(
            np.full(count, np.nan), unseen, share, peaked, within_reach, _almost_undamped(pole, design.longest)
        )
    taken = (lines.power * (1.0 - lines.kept**2)) @ gains
    unseen += _COARSE * float(np.max(taken / np.maximum(inside, 1e-300)))
    status = OK if share <= _MOST_BEYOND else _mostly_beyond(share)
    measured = road_errors(design.definition, system, pade_order, norms)
    return OutOfBandContribution(added, unseen, share * unlike, peaked, within_reach, status, measured=measured)


def _loose_note(system: PiecewiseSystem) -> str:
    """Note on the elements that no damper represents, which the equivalent linear model takes as the linear one."""
    return (
        f"no damper represents {format_elements_with_play(system)}: added above 1000 Hz is the response of the linear "
        "model, with closed gaps; below 0.1 Hz nothing is added"
    )


def _left_over(found: Sequence[Squares]) -> float:
    """Share of a mean square that lines may miss, from what a period leaves of the simulated motion."""
    return 2.0 * max(ran.steady.remaining_share for ran in found)


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines of a road, which all designs share, and their images between the knots of a simulation."""

    omega: Array  # [rad/s]
    power: Array  # mean square of the velocity on each line
    kept: Array  # share of each amplitude that remains
    some: Array  # lines whose images are computed [rad/s]
    images: Array  # (images, some): their angular frequencies [rad/s] ...
    gained: Array  # ... and amplitudes, of displacements, over omega^4
    arriving: dict[tuple[str, str], NDArray[np.complex128]]  # what an input gets of a source on each line


@lru_cache(maxsize=8)
def _lines_of(excitation: RandomExcitation) -> _Lines:
    """Lines of the realisations of an excitation."""
    signal = excitation.signal(0)
    omega = 2.0 * np.pi * signal.frequencies
    some = omega[np.linspace(0, omega.size - 1, min(omega.size, _SMOOTH)).astype(int)]
    orders = np.array([*range(-_IMAGES, 0), *range(1, _IMAGES + 1)], dtype=float)
    images = some + 2.0 * np.pi / STEP * orders[:, None]
    arriving: dict[tuple[str, str], NDArray[np.complex128]] = {}
    for path in (path for one in excitation.reached for path in one):
        arriving[path.input, path.source] = arriving.get((path.input, path.source), 0.0) + factor_of(path, omega)
    return _Lines(
        omega=omega,
        power=0.5 * (omega * signal.amplitudes) ** 2,
        kept=_cubic(omega * STEP, omega * STEP),
        some=some,
        images=images,
        gained=_cubic(some * STEP, images * STEP)
        / some**4,  # with the cube of the angle they grow, or the fourth power
        arriving=arriving,
    )


def _squared_gains(design: OnRoads, speeds: Array, system: LinearSystem) -> tuple[Array, Array]:
    """Squared gains (lines, outputs) of `system`, the equivalent linear one, over all sources, and those of samples.

    Samples are those of a simulation, whose inputs are cubic between knots.

    A line of angle a between knots becomes lines of angles a + 2 pi m, a series that falls with the fourth power: the
    transform of the cubics through values and slopes. Samples see all of them as one. Knots are at the same instants
    for all inputs, so that each of the lines arrives with the phase of the first. What is cubic is the displacement of
    a road, whose velocity is the input of the linear system, or a force itself.
    """
    linear = design.linear
    assert linear is not None
    lines = _lines_of(design.excitation)
    omega, sources = lines.omega, list(dict.fromkeys(linear.problem.sources))
    here = modal_response(system, omega, linear.problem.pade_order)
    here = linear.problem.with_true_densities(here, omega)
    at_once = linear.at_inputs(speeds)
    responses = modal_response(at_once, lines.images.ravel(), within=_IMAGES_WITHIN)
    responses = responses.reshape(*lines.images.shape, len(at_once.outputs), len(at_once.inputs))
    sampled = here * lines.kept[:, None, None]
    for j, name in enumerate(at_once.inputs):
        is_road = linear.is_road(name)
        share = lines.gained * lines.images if is_road else lines.gained
        images = np.einsum("ms,mso->so", share, responses[:, :, :, j])
        smooth = np.column_stack([np.interp(omega, lines.some, column) for column in images.T])
        smooth *= (omega ** (3 if is_road else 4))[:, None]
        for i, source in enumerate(sources):
            if (name, source) in lines.arriving:
                sampled[:, :, i] += lines.arriving[name, source][:, None] * smooth
    return np.sum(np.abs(here) ** 2, axis=2), np.sum(np.abs(sampled) ** 2, axis=2)


def _cubic(angle: Array, there: Array) -> Array:
    """Spectral amplitude at the angle `there` of a line of `angle` interpolated by cubics: itself or an image."""
    values = -6.0 * np.sin(there) / there**3 - 12.0 * (np.cos(there) - 1.0) / there**4
    slopes = (2.0 * np.cos(there) + 4.0) / there**3 - 6.0 * np.sin(there) / there**4
    near = np.abs(there) < 0.1  # where these two would cancel
    return np.where(near, 1.0 - there**4 / 720.0 + there**6 / 25200.0, 2.0 * values + 2.0 * angle * slopes)


def _almost_undamped(pole: complex, longest: float) -> Status:
    return Status(
        StatusKind.MARGINAL,
        f"almost undamped mode at {format_quantity(abs(pole.imag), 'rad/s', 3)}, with friction included (decay rate "
        f"{format_quantity(-pole.real, '1/s', 2)}): no steady state on roads of up to "
        f"{format_quantity(longest, 's', 6)}",
    )


def _mostly_beyond(share: float) -> Status:
    message = f"out-of-band contribution to a mean square: {format_share(share, 2)}, outside 0.1 to 1000 Hz"
    return Status(StatusKind.INACCURATE, message)


def mean_on_roads(design: OnRoads, wanted: int, relative_error: float | None, pool: Executor) -> Estimate:
    """Estimate over `wanted` roads, or over as many as the relative standard error requires."""
    design, found, missing = long_enough(design, pool)
    is_known = bool(np.all(np.isfinite(missing.power)))
    if is_known and len(found) < wanted:
        found += design.runs(len(found), wanted, pool)
    while True:
        estimate = _average_index(design, found, missing)
        if relative_error is not None and len(found) >= wanted and np.isfinite(estimate.value):
            wanted = _enough(np.array(estimate.samples), relative_error)
        if len(found) >= wanted or not is_known:
            return _with_error_reached(estimate, relative_error)
        found += design.runs(len(found), wanted, pool)


def _average_index(design: OnRoads, found: Sequence[Squares], missing: OutOfBandContribution) -> Estimate:
    """The index from the mean squares of all roads; under conventions that hold them, the mean of its values."""
    power = np.array([ran.power[: len(design.outputs)] for ran in found]) + missing.power
    status, unit = worst_of([missing.status, *(ran.status for ran in found)]), design.definition.unit
    definition, weights = design.definition, design.weights
    samples = definition.combine(np.sqrt(np.maximum(power, 0.0)), weights)
    sizes = np.sqrt(np.maximum(power.mean(axis=0), 0.0))
    if not np.all(np.isfinite(samples)):
        found_none = Estimate(float(definition.combine(sizes, weights)), unit, status, notes=missing.notes)
        return with_error_sources(found_none, (), PROMISE)
    mean, scatter, _ = mean_and_error(samples)
    value = mean if design.excitation.hold is not None else float(definition.combine(sizes, weights))
    estimate = Estimate(
        value, unit, status, scatter, interval_of(value, scatter, samples.size), samples.size, notes=missing.notes,
        samples=tuple(samples.tolist()), period=design.excitation.period,
        error_sources=(*error_sources_of(definition.drive, design.system.mechanism), *missing.measured),
    )  # fmt: skip
    return with_error_sources(estimate, _errors(missing, found, len(design.outputs)), PROMISE)


def _errors(missing: OutOfBandContribution, found: Sequence[Squares], outputs: int) -> list[ErrorSource]:
    """Error sources of a value on random roads other than sampling; errors are half those of mean squares."""
    kept = [ran for ran in found if np.any(np.isfinite(ran.lines))] or found  # whose contacts are known, if any is
    jumps = mean_bound([ran.jumps[:outputs] for ran in kept]) * float(np.sqrt(len(kept) / len(found)))
    return [
        ErrorSource("time step", _STEPPED + jumps),
        steady_state_error([ran.steady for ran in found], _PEAKS),
        ErrorSource("lines of the road", 0.5 * missing.unseen),
        few_lines(missing.peaked),
        ErrorSource("road outside 0.1 to 1000 Hz", 0.5 * missing.beyond),
    ]


def _with_error_reached(estimate: Estimate, relative_error: float | None) -> Estimate:
    """Estimate with status inaccurate if its standard error exceeds the one requested."""
    error = estimate.standard_error or 0.0
    if not estimate.status.ok or relative_error is None or error <= relative_error * estimate.value:
        return estimate
    share = format_share(error / estimate.value, 2)
    message = f"after {estimate.realisations} roads the standard error is {share} of the value"
    return replace(estimate, status=Status(StatusKind.INACCURATE, message))


def _enough(values: Array, relative_error: float) -> int:
    """Number of realisations expected to suffice, from the scatter of the present values."""
    scatter, mean = float(np.std(values, ddof=1)), float(np.mean(values))
    if scatter / np.sqrt(values.size) <= relative_error * mean or values.size >= MOST_ROADS:
        return values.size
    guess = 1.05 * (scatter / (relative_error * mean)) ** 2
    return int(min(max(np.ceil(guess), values.size + 2), 4 * values.size, MOST_ROADS))
