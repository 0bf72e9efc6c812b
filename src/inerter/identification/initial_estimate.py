"""Initial estimate without simulation, for chains, whose parts in series all transmit the measured force.

In a chain of an elastic part (k | c), a gap and an inertia (b | f | c2) the displacement is the sum of the elongations
under the measured force F: x of the spring with k x + c x' = F, +-gap while in contact, and y of the
inertia with b y'' + f sgn(y') + c2 y' = F. Two derivatives of the sum are linear in 1/b, f/b, 1/k and the gap once
c/k and the signs are given. A filter s^2 / (s + w)^4 takes the derivatives, so that no noise is differentiated
(state-variable filters, Young 1981); the signs follow from the estimates in a few rounds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from operator import or_, sub

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.signal import bilinear, lfilter

from inerter.identification.experiment import Experiment
from inerter.identification.statements.findings import FitFinding
from inerter.networks.elements import Element, Free, Network, Parallel, Series
from inerter.networks.elements.roles import LinearRole
from inerter.records.filtering import low_pass
from inerter.records.finding import Finding
from inerter.statements import Severity

Matrix = NDArray[np.float64]
_ROUNDS = 4
_TIMES = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 31)])  # [s] of c/k
_FORCE_BAND = 200.0  # [Hz] in which contact is detected
_SLIGHT = 0.3  # share of the apparent power, below which the sign of the power is not significant
_WELL, _POORLY = 0.04, 0.6  # relative half-widths of the search ranges


_PLACES = {  # in a chain: in parallel with an inertia or not
    (LinearRole.MASS, True): "inerter",
    (LinearRole.OPEN, True): "friction",
    (LinearRole.DAMPING, True): "drag",
    (LinearRole.DAMPING, False): "damper",
    (LinearRole.STIFFNESS, False): "spring",
    (LinearRole.CLOSED, False): "gap",
}


@dataclass(frozen=True)
class Chain:
    """The elements of a chain; None for an absent one."""

    spring: Element | None
    damper: Element | None
    gap: Element | None
    inerter: Element
    friction: Element | None
    drag: Element | None  # a damper in parallel with the inerter

    def network(self) -> Network:
        """The chain as a device."""
        shaft, turning = (self.spring, self.damper), (self.inerter, self.friction, self.drag)
        parallel = [[e for e in part if e is not None] for part in (shaft, (self.gap,), turning)]
        return reduce(sub, (reduce(or_, elements) for elements in parallel if elements))


def chain_of(device: Network) -> Chain | None:
    """The device as such a chain; None if it is not a chain."""
    parts = device.parts if isinstance(device, Series) else (device,)
    found: dict[str, Element] = {}
    for part in parts:
        elements = part.parts if isinstance(part, Parallel) else (part,)
        inertial = any(isinstance(e, Element) and e.linear is LinearRole.MASS for e in elements)
        for e in elements:
            place = _PLACES.get((e.linear, inertial)) if isinstance(e, Element) and e.plain else None
            if place is None or place in found:
                return None
            found[place] = e  # type: ignore[assignment]
    if "inerter" not in found or ("damper" in found and "spring" not in found):
        return None
    names = ("spring", "damper", "gap", "inerter", "friction", "drag")
    return Chain(*(found.get(name) for name in names))  # type: ignore[arg-type]


def guess_of(chain: Chain, experiments: list[Experiment]) -> dict[str, tuple[float, float]]:
    """Values of free elements except the gap, by name, each with the half-width of its search range."""
    best: dict[str, tuple[float, float]] = {}
    for experiment in experiments:
        for element, value, width in _regress(chain, experiment)[1]:
            if element is None or not isinstance(element.value, Free) or element.value.name is None:
                continue
            name = element.value.name
            if name not in best or width / max(value, 1e-300) < best[name][1] / max(best[name][0], 1e-300):
                best[name] = (value, width)
    return best


def apparent_inertance(chain: Chain, experiment: Experiment) -> float:
    """Inertance [kg] of the regression, with the fixture mass, of a force of either sign."""
    bare = replace(experiment.record, fixture_mass=None)
    signed = (replace(experiment, record=replace(bare, force=sign * bare.force)) for sign in (1.0, -1.0))
    values = min((_regress(chain, e) for e in signed), key=lambda found: found[0])[1]
    return next(value for element, value, _ in values if element is chain.inerter)


def sign_of(chain: Chain | None, experiment: Experiment) -> tuple[Experiment, list[Finding]]:
    """The experiment with force positive in tension, and findings if it was reversed.

    Every passive device dissipates energy; where it dissipates hardly any, a chain must explain the displacement with
    positive values.
    """
    force = experiment.record.force - np.median(experiment.record.force)
    velocity, use = experiment.motion.velocity, experiment.kept
    power = force[use] * velocity[use]
    share = float(np.mean(power)) / max(float(np.std(force[use]) * np.std(velocity[use])), 1e-300)
    record = experiment.record.with_notes("Force reversed: tension is positive.", force=-experiment.record.force)
    turned = replace(experiment, record=record)
    if chain is not None and abs(share) < _SLIGHT:
        right = _regress(chain, experiment)[0] <= _regress(chain, turned)[0]
    else:
        right = share >= 0.0
    if right:
        return experiment, []
    return turned, [Finding(FitFinding.FORCE_REVERSED, Severity.INFO, experiment.record.source)]


def _regress(chain: Chain, experiment: Experiment) -> tuple[float, list[tuple[Element | None, float, float]]]:
    """Residual of the regression of the displacement, and the values of the elements with their search widths."""
    h, motion = experiment.record.interval, experiment.motion
    z, v = motion.displacement, motion.velocity
    F = experiment.record.force - (experiment.record.fixture_mass or 0.0) * motion.acceleration
    w = 2.0 * max(float(np.std(motion.acceleration)) / max(float(np.std(v)), 1e-30), 1.2)
    first = min(int(6.0 / (w * h)) + 1, z.size // 2)
    use = experiment.kept.copy()
    use[:first] = False

    denominator = np.poly([-w] * 4)
    filters = [bilinear([w**4] + [0.0] * order, denominator, 1.0 / h) for order in range(3)]

    def apply_filter(x: Matrix, derivatives: int) -> Matrix:
        return np.asarray(lfilter(*filters[derivatives], x - x[0] if derivatives else x))[use]

    left = apply_filter(z, 2)
    contact = _contact(F, h, experiment.noise)
    direction = np.sign(v)
    solution: tuple[float, Matrix, float] = (np.inf, np.zeros(6), 0.0)
    for _ in range(_ROUNDS):
        fixed = [apply_filter(F, 0), apply_filter(np.ones_like(F), 0)]
        if chain.friction is not None:
            fixed.append(-apply_filter(direction, 0))
        if chain.drag is not None:
            fixed.append(-apply_filter(z, 1))
        if chain.gap is not None:
            fixed.append(apply_filter(contact, 2))
        tried = []
        for tau in _TIMES if chain.damper is not None else _TIMES[:1]:
            columns = fixed if chain.spring is None else [*fixed, apply_filter(_compliant_elongation(F, tau, h), 2)]
            A = np.stack(columns, axis=1)
            size = np.linalg.norm(A, axis=0)
            size[size == 0.0] = 1.0
            low = np.zeros(A.shape[1])
            low[0], low[1] = 1e-12, -np.inf
            solved = lsq_linear(A / size, left, bounds=(low, np.inf))
            tried.append((float(solved.cost), solved.x / size, float(tau)))
        solution = min(tried, key=lambda t: t[0])
        direction = _direction(chain, solution[1], solution[2], z, F, contact, h, motion.bandwidth)
    p, tau = list(solution[1]), solution[2]
    b = 1.0 / p[0]
    rest = p[2:]
    f = b * rest.pop(0) if chain.friction is not None else 0.0
    drag = b * rest.pop(0) if chain.drag is not None else 0.0
    if chain.gap is not None:
        rest.pop(0)  # needed for the others; its own estimate may be wrong by a factor
    k = 1.0 / max(rest.pop(0), 1e-15) if chain.spring is not None else np.inf
    values: list[tuple[Element | None, float, float]] = [
        (chain.inerter, b, _WELL * b),
        (chain.friction, f, _WELL * f + 3.0 * experiment.noise),
        (chain.drag, drag, _POORLY * drag),
    ]
    return solution[0], values + ([(chain.spring, k, _POORLY * k)] if chain.gap is None else [])


def _contact(force: Matrix, h: float, noise: float) -> Matrix:
    """The side on which the gap touches, -1 or 1, and a straight line between where there is no force.

    The largest force touches, even if it is noise.
    """
    calm = low_pass(force, h, min(_FORCE_BAND, 0.2 / h))
    peak = float(np.abs(calm).max())
    touching = np.abs(calm) >= min(max(4.0 * noise, 0.01 * peak), peak)
    n = np.arange(force.size)
    return np.interp(n, n[touching], np.sign(calm[touching]))


def _compliant_elongation(force: Matrix, tau: float, h: float) -> Matrix:
    """Elongation of a spring of 1 N/m in parallel with a damper of `tau` N s/m."""
    if tau == 0.0:
        return force
    ratio = 2.0 * tau / h  # of the bilinear transform
    gain, pole = 1.0 / (1.0 + ratio), (1.0 - ratio) / (1.0 + ratio)
    return np.asarray(lfilter([gain, gain], [1.0, pole], force))


def _direction(
    chain: Chain, p: Matrix, tau: float, z: Matrix, force: Matrix, contact: Matrix, h: float, band: float
) -> Matrix:
    """The direction in which the inertia moves, nearly a sign."""
    y = z.copy()
    rest = list(p[2 + (chain.friction is not None) + (chain.drag is not None) :])
    if chain.gap is not None:
        y -= rest.pop(0) * contact
    if chain.spring is not None:
        y -= rest.pop(0) * _compliant_elongation(force, tau, h)
    v = np.gradient(low_pass(y, h, band), h)
    return np.clip(v / (0.02 * max(float(np.std(v)), 1e-30)), -1.0, 1.0)
