"""Result of an identification: parameters with intervals, identifiability, and goodness of fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import OK, Status
from inerter.identification.experiment import Experiment
from inerter.identification.statements.causes import Details, Suspect
from inerter.identification.statements.identifiability import Identifiability
from inerter.identification.statements.patterns import MisfitPattern
from inerter.networks.elements import Network
from inerter.notebook import shown_by
from inerter.records.finding import Finding
from inerter.records.record import Record
from inerter.records.remedy import in_python
from inerter.statements import Statement

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """One identified value with its 95 % interval.

    `value` is nan where the records do not identify it: the interval then is still valid, such as an upper bound. An
    unreliable fit has no value and no standard error, and the interval is nan or, where hypotheses explain the misfit,
    the range of values under them. `best` is the value of the best fit in any case, for further computation.
    """

    name: str
    unit: str
    value: float
    interval: tuple[float, float]
    best: float
    standard_error: float  # from the curvature at the best fit and the scales of the sensors; nan if none is known
    profile: tuple[tuple[float, float], ...] = ()  # (value, rise of the cost over its threshold)


@dataclass(frozen=True)
class NormalisedResidual:
    """Normalised residual: r.m.s. whitened residual of a fit over that of sensor noise."""

    fitted: float
    checked: float  # of the validation data; nan if there are none
    limits: tuple[float, float]  # largest values of both that sensor noise alone may cause

    @property
    def worst(self) -> float:
        """The larger of both."""
        return float(np.nanmax([self.fitted, self.checked]))

    @property
    def excess(self) -> float:
        """The larger of both relative to its limit."""
        return float(np.nanmax([self.fitted / self.limits[0], self.checked / self.limits[1]]))

    @property
    def is_noise_limited(self) -> bool:
        """Whether sensor noise alone may explain the residual."""
        return self.excess <= 1.0

    sound = RenamedAttribute("is_noise_limited")


@dataclass(frozen=True)
class Explanation(Statement):
    """A hypothesis about the device or its sensors, and the share of a misfit that it explains."""

    name: Suspect
    explained: float  # share of the squared misfit beyond sensor noise; on the validation data if present there
    misfit: NormalisedResidual  # under the hypothesis
    values: dict[str, float]  # of the unknowns of the hypothesis
    estimates: dict[str, tuple[float, float]]  # of the device's under the hypothesis, and their standard errors
    details: Details = field(default_factory=dict)  # the numbers of its sentence

    @property
    def sentence(self) -> str:
        """The sentence of the hypothesis, for use after a colon."""
        return self.name.sentence(self.details)

    @property
    def remedy(self) -> str:
        """Remedy, in Python."""
        return in_python(self.name.remedy(self.details))


@dataclass(frozen=True, eq=False)
class RecordFit:
    """One record as used, the force of the model, and the tests of the residual."""

    experiment: Experiment
    model: Matrix  # (samples,) [N] force as the load cell would read it, with its offset
    offset: float  # [N] of the load cell
    fitted: NDArray[np.bool_]  # samples that were fitted
    checked: NDArray[np.bool_]  # samples of the validation data
    draws: Matrix  # (draws, samples) [N] residuals that sensor noise alone would cause
    whitened: Matrix  # residuals after weighting and whitening, of the fitted samples
    lead: float  # [s] discarded at the start
    whiteness: float  # p-value of residuals no more autocorrelated than sensor noise
    openings: Mapping[str, int]  # number of openings of each gap in the model

    @property
    def record(self) -> Record:
        return self.experiment.record

    @property
    def residual(self) -> Matrix:
        """Measured less model [N]."""
        return self.record.force - self.model

    def rms(self, check: bool = False) -> float:
        """R.m.s. residual on the fitted or validation samples [N]; nan if there are none."""
        mask = self.checked if check else self.fitted
        return float(np.sqrt(np.mean(self.residual[mask] ** 2))) if mask.any() else float("nan")

    def noise_level(self, check: bool = False) -> float:
        """R.m.s. residual that sensor noise alone would cause on these samples [N]."""
        mask = self.checked if check else self.fitted
        return float(np.sqrt(np.mean(self.draws[:, mask] ** 2))) if mask.any() else float("nan")

    def variance_explained(self, check: bool = False) -> float:
        """Share of the variance of the force that the model explains."""
        mask = self.checked if check else self.fitted
        if not mask.any():
            return float("nan")
        total = float(np.var(self.record.force[mask]))
        return 1.0 - float(np.mean(self.residual[mask] ** 2)) / max(total, 1e-300)

    sound, explained = RenamedAttribute("noise_level"), RenamedAttribute("variance_explained")


@dataclass(frozen=True)
class Localisation(Statement):
    """Patterns in the residual of one record, those that explain most of it first."""

    source: str
    patterns: tuple[Finding, ...] = ()

    @property
    def about(self) -> str:
        """The record."""
        return self.source

    @property
    def sentence(self) -> str:
        """The strongest pattern, for use after a colon."""
        if not self.patterns:
            return "the residual has no tested pattern"
        first = self.patterns[0]
        return first.sentence if float(first.numbers.get("p", 0.0)) < 1.0 else f"{first.sentence} (not significant)"

    @property
    def changes(self) -> tuple[float, ...]:
        """Times [s] at which the residual changes."""
        steps = (MisfitPattern.BEGINS, MisfitPattern.ENDS, MisfitPattern.LEVEL_STEP, MisfitPattern.COEFFICIENT_STEP)
        return tuple(float(f.numbers["time"]) for f in self.patterns if f.kind in steps)


@dataclass(frozen=True, eq=False)
class Fit:
    """The result of `identify`.

    >>> import inerter as it
    >>> rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), sampling=500.0)
    >>> fit = it.identify(rig.run(it.cosine(1e-3, 3.0), 2.0), "friction", starts=8)
    >>> b, f = fit.parameters["b"], fit.parameters["f"]
    >>> fit.status.ok, abs(b.value - 113.0) < 1.0, abs(f.value - 10.0) < 0.1  # kg, N
    (True, True, True)
    """

    _repr_html_ = shown_by("inerter.report.notebook:fit_html")

    parameters: dict[str, Parameter]
    identifiable: dict[str, Identifiability]
    correlation: Matrix  # (parameters, parameters)
    covariance: Matrix  # the same shape, in units of the values
    device: Network  # the model with the best values
    comparisons: tuple[RecordFit, ...]
    criterion: float  # Bayesian information criterion, lower is better
    costs: tuple[float, ...]  # of the different fits to half of the records reached by the best starts, sorted
    simulations: int
    predicted: float  # share of the variance of the force that encoder noise does not change
    misfit: NormalisedResidual
    explanations: tuple[Explanation, ...] = ()  # of the misfit, if there is one; the most likely first
    localisations: tuple[Localisation, ...] = ()  # of the misfit, if there is one, in each record
    status: Status = OK
    reliability_warning: Finding | None = None  # reason why the estimates are unreliable
    findings: tuple[Finding, ...] = ()  # notes on the estimates
    suggestions: tuple[Finding, ...] = ()  # recommended experiments
    settings: dict[str, object] = field(default_factory=dict)

    @property
    def notes(self) -> tuple[str, ...]:
        """The findings in sentences."""
        return tuple(finding.sentence for finding in self.findings)

    @property
    def next_experiment(self) -> tuple[str, ...]:
        """The suggestions in sentences."""
        return tuple(finding.sentence for finding in self.suggestions)

    @property
    def variance_explained(self) -> float:
        """Share of the variance of all fitted forces that the model explains."""
        left = sum(float(np.sum(c.residual[c.fitted] ** 2)) for c in self.comparisons)
        total = sum(
            float(np.sum((c.record.force[c.fitted] - c.record.force[c.fitted].mean()) ** 2)) for c in self.comparisons
        )
        return 1.0 - left / max(total, 1e-300)

    explained, doubt = RenamedAttribute("variance_explained"), RenamedAttribute("reliability_warning")
