"""Model selection: candidate devices compared by their prediction of validation data."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError, InerterError, Status, StatusKind
from inerter.identification.arguments import check_progress, checked_records, model_of, warn_of_units
from inerter.identification.conclusions import fit_of
from inerter.identification.fit import Fit
from inerter.identification.identify import solution_of
from inerter.identification.intervals import soft_squares
from inerter.identification.models import MODELS, VISCOUS
from inerter.identification.noise import Whitening, noise_whitening
from inerter.identification.options import DEFAULTS, FitOptions, OptionChanges, options_of
from inerter.identification.solving import SolvedFit
from inerter.identification.statements.findings import FitFinding
from inerter.identification.wrong_units import WrongUnitError
from inerter.kernels.prepare import prepare_on
from inerter.networks.elements import Element, Free, Network
from inerter.networks.transform import map_elements, with_values
from inerter.records.finding import Finding
from inerter.records.record import Record
from inerter.simulation.event_driven import KERNELS
from inerter.statements import Severity
from inerter.vehicle.rig import Rig
from inerter.work.progress import part, within
from inerter.work.running import running_on

Matrix = NDArray[np.float64]
LEAST, MOST = 0.02, 0.1  # of the loss: least and largest allowed difference
_BLOCKS = 20
_RANGE = 4.0  # factor about known values, within which a fit is repeated
_AGAIN = " again"  # not a name of a candidate
_PAIRS = (("ideal", "friction"), ("elastic", "elastic-friction"), ("backlash", "ball-screw"))


@dataclass(frozen=True)
class Candidate:
    """Prediction of the validation data by one candidate.

    A loss is a mean square of whitened residuals, about 1 for a right model.
    """

    name: str
    unknowns: int
    loss: float
    behind: float  # loss above that of the best candidate
    error: float  # standard error of that difference
    as_good: bool  # as the best one, by the rule of `select_model`
    status: Status  # of its fit


@dataclass(frozen=True, eq=False)
class ModelSelection:
    """The result of `select_model`.

    >>> import inerter as it
    >>> rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), sampling=500.0)
    >>> chosen = it.select_model(rig.run(it.cosine(1e-3, 3.0), 2.0), ["ideal", "friction"], starts=8)
    >>> chosen.name, sorted(chosen.fits)
    ('friction', ['friction', 'ideal'])
    """

    name: str
    fits: dict[str, Fit]
    candidates: tuple[Candidate, ...]  # the best first
    device: Network  # the chosen candidate with its best values
    status: Status
    findings: tuple[Finding, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """The findings in sentences."""
        return tuple(finding.sentence for finding in self.findings)

    @property
    def fit(self) -> Fit:
        """Fit of the selected candidate."""
        return self.fits[self.name]


def select_model(
    records: Record | Sequence[Record],
    models: Mapping[str, Network] | Iterable[str] | None = None,
    options: FitOptions = DEFAULTS,
    *,
    progress: Callable[[float], None] | None = None,
    executor: Executor | None = None,
    **changes: Unpack[OptionChanges],
) -> ModelSelection:
    """Fit every candidate, and select the one with the fewest unknowns of those that predict as well as the best.

    `models`: devices by name, or names of `MODELS`; by default those of `MODELS` without a viscous damper, then the
    selected one with a damper, with and without friction. Options and keywords are those of `identify`.

    **The criterion.** Each candidate is fitted with weights from its own residuals, so likelihoods of candidates cannot
    be compared. All are therefore compared on the same validation data, the last part `check` of each record, whitened
    by the sensor noise of the candidate with the smallest residual. The loss is the mean square of the whitened
    residuals (those beyond 3 count less), so about 1 for a correct model. A candidate is as good as the best if its
    loss is larger by no more than the standard error of the difference, from 20 blocks of time; at least 2 % of the
    best loss is allowed, because a smaller improvement does not justify an element, and at most 10 %, because an
    element may matter in few blocks only (the rule of one standard error, Breiman et al. 1984). Of those as good, the
    one with the fewest unknowns is selected.

    Raises `IdentificationError` if no candidate can be fitted or there are no validation data; a candidate that fails
    among others is reported in `findings`.

    >>> import inerter as it
    >>> rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), sampling=500.0)
    >>> record = rig.run(it.cosine(1e-3, 3.0), 2.0)  # m, Hz, s
    >>> it.select_model(record, ["ideal", "friction"], starts=8).name
    'friction'
    """
    asked = options_of(options, changes)
    check_progress(progress)
    given = _models_by_name(models)
    records = checked_records(records)
    warn_of_units(records)
    if not asked.check > 0.0:
        raise IdentificationError(f"check: candidates are compared on validation data; got {asked.check!r}.")
    selection = _Selection(records, asked, len(given) + (2 if models is None else 0), progress)
    with running_on(executor) as pool:
        prepare_on(pool, KERNELS)
        selection.enter(given)
        if models is None:
            first = _fewest_unknowns(ranking(selection.fits))
            pair = next(pair for pair in _PAIRS if first in pair)
            selection.enter({VISCOUS[name]: MODELS[VISCOUS[name]] for name in pair})
        return selection.choice()


@dataclass(eq=False)
class _Selection:
    """Candidates that are fitted to the same records, with their solutions and failures."""

    records: Sequence[Record]
    asked: FitOptions
    expected: int  # candidates
    progress: Callable[[float], None] | None
    models: dict[str, Network] = field(default_factory=dict)
    solutions: dict[str, SolvedFit] = field(default_factory=dict)
    fits: dict[str, Fit] = field(default_factory=dict)
    failed: list[Finding] = field(default_factory=list)

    def enter(self, candidates: Mapping[str, Network]) -> None:
        """Fit further candidates; raises `IdentificationError` if none can be fitted."""
        self.models |= candidates
        for name, model in candidates.items():
            done = len(self.fits) + len(self.failed)
            try:
                with within(f"model {name}, {done + 1} of {self.expected}"):
                    self._add_solution(name, solution_of(self.records, model, self.asked, self._part_progress(done)))
            except WrongUnitError:
                raise
            except InerterError as error:
                self.failed.append(Finding(FitFinding.FAILED, Severity.WARNING, name, {"error": error.args}))
        if not self.fits:
            why = " ".join(finding.sentence for finding in self.failed)
            raise IdentificationError(f"No candidate can be fitted. {why}")
        self._retry()

    def choice(self) -> ModelSelection:
        """The selected candidate of all that entered."""
        ranked = ranking(self.fits)
        name = _fewest_unknowns(ranked)
        with within(f"model {name}, selected"):
            fit = self.fits[name] = fit_of(self.solutions[name])
        values = {n: p.best for n, p in fit.parameters.items()}
        stuck = (
            Finding(FitFinding.NOT_REACHED, Severity.WARNING, c, {"other": o})
            for c, o in _not_converged(ranked, self.fits)
        )
        return ModelSelection(
            name=name,
            fits=self.fits,
            candidates=tuple(replace(c, status=self.fits[c.name].status) for c in ranked),
            device=with_values(Rig(self.models[name]).device, values),
            status=_status(fit),
            findings=(_selection_finding(ranked, name), *stuck, *self.failed),
        )

    def _add_solution(self, name: str, solution: SolvedFit) -> None:
        fit = fit_of(solution, explain=False)
        self.solutions[name], self.fits[name] = solution, fit

    def _retry(self) -> None:
        """Refit candidates that have not converged near the fit of the related candidate that shows it."""
        for name, relative in _not_converged(ranking(self.fits), self.fits):
            with suppress(InerterError), within(f"model {name} again"):
                near = solution_of(
                    self.records, _bounded_near(self.models[name], self.fits[relative]), self.asked, None
                )
                other = fit_of(near, explain=False)
                fits = {relative: self.fits[relative], name: self.fits[name], _AGAIN: other}
                losses = {c.name: c.loss for c in ranking(fits)}
                if losses[_AGAIN] < losses[name]:
                    self.solutions[name], self.fits[name] = near, other

    def _part_progress(self, done: int) -> Callable[[float], None] | None:
        """Progress callback of the next candidate."""
        return part(self.progress, done / self.expected, (done + 1) / self.expected)


def ranking(fits: Mapping[str, Fit]) -> tuple[Candidate, ...]:
    """The candidates, the best first, by the criterion of `select_model`.

    Raises `IdentificationError` if they have no validation data in common.
    """
    masks = [
        np.logical_and.reduce(parts)
        for parts in zip(*([c.checked for c in f.comparisons] for f in fits.values()), strict=True)
    ]
    if sum(int(mask.sum()) for mask in masks) < 2 * _BLOCKS:
        raise IdentificationError("check: too few validation samples to compare candidates. Increase `check`.")
    left = {name: _relative_residual(fit, masks) for name, fit in fits.items()}
    whitenings = _whitenings(fits[min(left, key=lambda name: left[name])], masks)
    losses = {name: _losses(fit, whitenings) for name, fit in fits.items()}
    mean = {name: float(loss.mean()) for name, loss in losses.items()}
    best = min(mean, key=lambda name: mean[name])
    result = []
    for name, loss in losses.items():
        blocks = np.array([part.mean() for part in np.array_split(loss - losses[best], _BLOCKS)])
        error = float(blocks.std(ddof=1)) / math.sqrt(_BLOCKS)
        behind = mean[name] - mean[best]
        allowed = float(np.clip(error, LEAST * mean[best], MOST * mean[best]))
        fit, as_good = fits[name], behind <= allowed
        result.append(Candidate(name, len(fit.parameters), mean[name], behind, error, as_good, fit.status))
    return tuple(sorted(result, key=lambda c: c.loss))


def _fewest_unknowns(ranked: Sequence[Candidate]) -> str:
    return min((c for c in ranked if c.as_good), key=lambda c: (c.unknowns, c.loss)).name


def _models_by_name(models: Mapping[str, Network] | Iterable[str] | None) -> dict[str, Network]:
    if models is None:
        return {name: MODELS[name] for name in VISCOUS}
    if isinstance(models, Mapping):
        chosen = dict(models)
    else:
        names = [models] if isinstance(models, str) else list(models)
        chosen = {name: model_of(name) for name in names}
    if not chosen:
        raise IdentificationError("models: at least one candidate is required.")
    return chosen


def _relative_residual(fit: Fit, masks: Sequence[NDArray[np.bool_]]) -> float:
    """R.m.s. residual on the validation data, relative to the force of each record."""
    shares = [
        np.mean(c.residual[mask] ** 2) / np.var(c.record.force)
        for c, mask in zip(fit.comparisons, masks, strict=True)
        if mask.any()
    ]
    return float(np.sqrt(np.mean(shares)))


def _whitenings(fit: Fit, masks: Sequence[NDArray[np.bool_]]) -> list[Whitening]:
    return [
        noise_whitening(c.draws, c.experiment.noise, mask)
        for c, mask in zip(fit.comparisons, masks, strict=True)
        if mask.any()
    ]


def _losses(fit: Fit, whitenings: Sequence[Whitening]) -> Matrix:
    parts = []
    for c, whitening in zip((c for c in fit.comparisons if c.checked.any()), whitenings, strict=True):
        white = whitening(c.residual)[whitening.weight > 0.0]
        parts.append(soft_squares(white))
    return np.concatenate(parts)


def _status(fit: Fit) -> Status:
    if not fit.status.ok:
        return Status(StatusKind.INACCURATE, f"even the selected candidate fails: {fit.status.message}")
    return fit.status


def _selection_finding(ranked: Sequence[Candidate], name: str) -> Finding:
    """Finding with the reason for the selection."""
    chosen, best = next(c for c in ranked if c.name == name), ranked[0]
    others = [c for c in ranked if not c.as_good]
    numbers = {
        "unknowns": chosen.unknowns,
        "best": best.name,
        "best_unknowns": best.unknowns,
        "behind": chosen.behind / best.loss,
        "next": others[0].name if others else None,
        "ratio": others[0].loss / best.loss if others else None,
    }
    return Finding(FitFinding.BEST if chosen is best else FitFinding.FEWEST_UNKNOWNS, Severity.INFO, name, numbers)


def _not_converged(ranked: Sequence[Candidate], fits: Mapping[str, Fit]) -> Iterator[tuple[str, str]]:
    """Candidates that have not converged, each with the related candidate that shows it.

    One that is worse than a candidate with a subset of its elements could at least equal it. And one with a subset of
    the elements of the best could equal that, if none of the further elements of the best is identifiable.
    """
    best = ranked[0]
    for c in ranked:
        mine = set(fits[c.name].parameters)
        part = next((p.name for p in ranked if set(fits[p.name].parameters) < mine), None)
        if part is not None and _is_worse(ranked, c.name, part):
            yield c.name, part
        whole = fits[best.name]
        idle = not any(whole.identifiable[name] for name in set(whole.parameters) - mine)
        if mine < set(whole.parameters) and idle and _is_worse(ranked, c.name, best.name):
            yield c.name, best.name


def _is_worse(ranked: Sequence[Candidate], one: str, other: str) -> bool:
    losses = {c.name: c.loss for c in ranked}
    return losses[one] > (1.0 + MOST) * losses[other]


def _bounded_near(model: Network, fit: Fit) -> Network:
    """The model with its common values with a fit bounded to a range about them."""

    def bound(element: Element) -> Network:
        value = element.value
        if not isinstance(value, Free) or value.name not in fit.parameters:
            return element
        best = fit.parameters[value.name].best
        low, high = max(value.lower, best / _RANGE), min(value.upper, best * _RANGE)
        return element.with_value(replace(value, lower=low, upper=high)) if low < high else element

    return map_elements(Rig(model).device, bound)
