"""Parts that a chain of a shaft, a gap and an inertance may have or lack beyond its model, and laws of its friction.

The event-driven integrator knows Coulomb's law alone. So under another law a chain is stepped twice in time here,
with it and without, and the difference joins the exact force: what the stepping is off by cancels. Steps are those of
the midpoint rule, with the impulse of friction at the end of each (Moreau 1988), so that it sticks truly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment
from inerter.identification.hypotheses import Hypothesis, Unknown, Values, read_by_load_cell
from inerter.identification.initial_estimate import Chain
from inerter.identification.statements.causes import Details, Suspect
from inerter.kernels.decorators import kernel, part
from inerter.networks.elements import Damper, Element, Free, Friction, Gap, Spring, Tied, free
from inerter.networks.parser import format_expression

Matrix = NDArray[np.float64]
QUADRATIC_DAMPING, QUADRATIC_UNIT = "quadratic damping", "N s^2/m^2"
_STEPS = 30.0  # in a period of the shaft's resonance, at least
_MOST_PARTS = 64  # of a sampling interval
_FINEST = 1.25e-4  # [s] of a step, at most
_ONE_SIDED = 0.99  # of the friction: largest asymmetry, so that it opposes motion in both directions


@dataclass(frozen=True)
class ChainValues:
    """A chain in numbers. A rigid shaft has infinite `ks`."""

    ks: float = math.inf
    cs: float = 0.0
    gap: float = 0.0
    b: float = 0.0
    f: float = 0.0  # friction at high speed
    c: float = 0.0
    rise: float = 0.0  # [N] of the friction towards rest (Stribeck) ...
    speed: float = 1.0  # [m/s] ... below about this speed
    tilt: float = 0.0  # [N/m] of the friction over the position
    bend: float = 0.0  # [N/m^2]
    skew: float = 0.0  # part of the friction that it has more when it slides up, less when down
    reach: float = 0.0  # [m] of travel over which the friction builds up after a reversal (Dahl 1968)
    square: float = 0.0  # [N s^2/m^2] of quadratic damping in parallel with the inertance
    cubic: float = 0.0  # [N/m^3] of the shaft
    slack: float = 0.0  # [m] deflection of the shaft beyond which ...
    beyond: float = 0.0  # ... it is stiffer by this [N/m]
    cosine: float = 0.0  # [N] of the friction along the position ...
    sine: float = 0.0
    pitch: float = 1.0  # [m] ... over which it repeats


def law_hypotheses(chain: Chain, fastest: float, stroke: float, peak: float = 0.0) -> Iterator[Hypothesis]:
    """Hypotheses on further laws of a chain, for motions of this largest speed [m/s], stroke [m] and force [N]."""
    yield from _parts(chain)
    yield quadratic_damping(chain, fastest, peak)
    if chain.spring is not None and peak > 0.0:
        yield _stiffening(chain, peak)
        yield _second_gap(chain, peak)
    if chain.friction is not None:
        yield _presliding(chain, stroke)
        yield _ripple(chain, stroke)
        yield _stribeck(chain, fastest)
        yield _position(chain, stroke)
        yield _direction(chain)


def _parts(chain: Chain) -> Iterator[Hypothesis]:
    """Hypotheses of a chain with one element added or removed."""
    if chain.friction is None:
        friction = Friction(free(0.0, 500.0, name="dry_friction"))
        with_it = replace(chain, friction=friction)
        yield _with_device(Suspect.DRY_FRICTION, with_it, "one with friction", {"dry_friction": 1.0})
    if chain.drag is None:
        drag = Damper(free(1e-3, 1e5, name="viscous"))
        yield _with_device(Suspect.VISCOUS_FRICTION, replace(chain, drag=drag), "one with a damper", {"viscous": 10.0})
    if chain.spring is None:
        spring, damper = Spring(free(1e4, 1e9, name="shaft")), Damper(free(1.0, 1e6, name="shaft_damping"))
        starts = ({"shaft": k, "shaft_damping": 3e-3 * k} for k in (2e5, 1e6, 5e6))
        elastic = replace(chain, spring=spring, damper=damper)
        yield _with_device(Suspect.ELASTIC, elastic, "elastic or elastic-friction", *starts)
        return
    is_rigid = replace(chain, spring=None, damper=None, gap=None)
    yield _with_device(Suspect.RIGID, is_rigid, "ideal or friction")
    if chain.gap is None:
        loose = replace(chain, gap=Gap(free(0.0, 2e-3, name="play")))
        yield _with_device(Suspect.BACKLASH, loose, "backlash or ball-screw", {"play": 1e-5}, {"play": 1e-4})


def _with_device(name: Suspect, chain: Chain, model: str, *starts: Values) -> Hypothesis:
    device = chain.network()
    layout = format_expression(device, [e.label for e in device.elements()])
    details = {"layout": layout, "model": model}
    return Hypothesis(name, device=device, starts=starts or ({},), details=lambda values: details)


def _stribeck(chain: Chain, fastest: float) -> Hypothesis:
    rise = Unknown("rise of the friction", "N", 0.0, 1e3, 1.0)
    speed = Unknown("Stribeck speed", "m/s", 1e-3 * fastest, fastest, 0.1 * fastest)

    def details(values: Values) -> Details:
        low = _value(chain.friction, values)
        return {"at_rest": low + values[rise.name], "beyond": low, "speed": 2.0 * values[speed.name]}

    starts = tuple({speed.name: share * fastest} for share in (0.05, 0.2))
    return _changed_values(chain, Suspect.STRIBECK, {"rise": rise, "speed": speed}, details, starts)


def _position(chain: Chain, stroke: float) -> Hypothesis:
    tilt = Unknown("tilt of the friction", "N/m", -1e3 / stroke, 1e3 / stroke, 1.0 / stroke)
    bend = Unknown("bend of the friction", "N/m^2", -1e3 / stroke**2, 1e3 / stroke**2, 1.0 / stroke**2)

    def details(values: Values) -> Details:
        x = np.linspace(-stroke, stroke, 101)
        level = _value(chain.friction, values) + values[tilt.name] * x + values[bend.name] * x**2
        return {"range": float(np.ptp(np.maximum(level, 0.0)))}

    return _changed_values(chain, Suspect.BY_POSITION, {"tilt": tilt, "bend": bend}, details, ({},))


def _direction(chain: Chain) -> Hypothesis:
    skew = Unknown("skew of the friction", "", -_ONE_SIDED, _ONE_SIDED, 0.1)

    def details(values: Values) -> Details:
        mean, more = _value(chain.friction, values), values[skew.name]
        return {"up": mean * (1.0 + more), "down": mean * (1.0 - more)}

    return _changed_values(chain, Suspect.ASYMMETRIC, {"skew": skew}, details, ({},))


def _presliding(chain: Chain, stroke: float) -> Hypothesis:
    reach = Unknown("presliding distance", "m", 0.0, stroke, 0.02 * stroke)
    starts = tuple({reach.name: share * stroke} for share in (0.01, 0.1))
    return _changed_values(
        chain, Suspect.PRESLIDING, {"reach": reach}, lambda values: {"distance": 2.0 * values[reach.name]}, starts
    )


def quadratic_damping(chain: Chain, fastest: float, peak: float) -> Hypothesis:
    """Hypothesis of a damping force that grows with the square of the speed, in parallel with the inertance."""
    square = Unknown(QUADRATIC_DAMPING, QUADRATIC_UNIT, 0.0, max(1e3, 2.0 * peak) / fastest**2, 1.0 / fastest**2)
    starts = tuple({square.name: max(share * peak, 1.0) / fastest**2} for share in (0.05, 0.4))
    return _changed_values(chain, Suspect.QUADRATIC, {"square": square}, partial(_quadratic_details, fastest), starts)


def _quadratic_details(fastest: float, values: Values) -> Details:
    return {"most": values[QUADRATIC_DAMPING] * fastest**2}


def _ripple(chain: Chain, stroke: float) -> Hypothesis:
    cosine, sine = Unknown("ripple, cosine", "N", -500.0, 500.0, 1.0), Unknown("ripple, sine", "N", -500.0, 500.0, 1.0)
    pitch = Unknown("pitch of the ripple", "m", 0.05 * stroke, 2.0 * stroke, 0.5 * stroke)

    def details(values: Values) -> Details:
        return {"size": math.hypot(values[cosine.name], values[sine.name]), "pitch": values[pitch.name]}

    unknowns = {"cosine": cosine, "sine": sine, "pitch": pitch}
    starts = tuple({pitch.name: share * stroke} for share in (0.25, 0.33, 0.45, 0.6, 0.9, 1.3))
    return _changed_values(chain, Suspect.RIPPLE, unknowns, details, starts)


def _stiffening(chain: Chain, peak: float) -> Hypothesis:
    """A cubic term, over the stiffness at the deflection under the largest force."""
    share = Unknown("stiffening", "", -0.25, 20.0, 0.1)

    def change(plain: ChainValues, values: Values) -> ChainValues:
        return replace(plain, cubic=values[share.name] * plain.ks**3 / peak**2)

    starts = ({share.name: 0.1}, {share.name: 1.0})
    return _law(chain, Suspect.STIFFENING, (share,), change, lambda values: {"share": values[share.name]}, starts)


def _second_gap(chain: Chain, peak: float) -> Hypothesis:
    """A spring in parallel with the shaft that engages at a part of the deflection under the largest force."""
    part, ratio = Unknown("second gap", "", 0.02, 1.0, 0.3), Unknown("stiffness behind it", "", 0.0, 50.0, 0.3)

    def change(plain: ChainValues, values: Values) -> ChainValues:
        slack, stiffness = values[part.name] * peak / plain.ks, values[ratio.name] * plain.ks
        return replace(plain, slack=slack, beyond=stiffness)

    def details(values: Values) -> Details:
        ks = _value(chain.spring, values)
        return {"slack": values[part.name] * peak / ks, "stiffness": values[ratio.name] * ks}

    starts = tuple({part.name: share, ratio.name: more} for share, more in ((0.15, 0.5), (0.4, 0.5), (0.3, 4.0)))
    return _law(chain, Suspect.SECOND_GAP, (part, ratio), change, details, starts)


def _changed_values(
    chain: Chain,
    name: Suspect,
    unknowns: dict[str, Unknown],
    details: Callable[[Values], Details],
    starts: tuple[Values, ...],
) -> Hypothesis:
    """A hypothesis that changes some of the numbers of a chain."""
    change = partial(_with_values, {what: unknown.name for what, unknown in unknowns.items()})
    return _law(chain, name, tuple(unknowns.values()), change, details, starts)


def _with_values(names: Mapping[str, str], plain: ChainValues, values: Values) -> ChainValues:
    return replace(plain, **{what: values[name] for what, name in names.items()})


def _law(
    chain: Chain,
    name: Suspect,
    unknowns: tuple[Unknown, ...],
    change: Callable[[ChainValues, Values], ChainValues],
    details: Callable[[Values], Details],
    starts: tuple[Values, ...],
) -> Hypothesis:
    """A hypothesis under which a chain is another one."""
    return Hypothesis(name, unknowns, read=partial(_read_under_law, chain, change), details=details, starts=starts)


def _read_under_law(
    chain: Chain, change: Callable[[ChainValues, Values], ChainValues], force: Matrix, e: Experiment, values: Values
) -> Matrix:
    plain = _numbers(chain, values)
    difference = simulate_chain(change(plain, values), e, force.size) - simulate_chain(plain, e, force.size)
    return np.asarray(force + read_by_load_cell(difference, e))


def _numbers(chain: Chain, values: Values) -> ChainValues:
    parts = {"ks": chain.spring, "cs": chain.damper, "gap": chain.gap, "b": chain.inerter, "f": chain.friction}
    parts["c"] = chain.drag
    known = {what: _value(part, values) for what, part in parts.items() if part is not None}
    return ChainValues(**known)


def _value(element: Element | None, values: Values) -> float:
    assert element is not None
    value = element.value
    assert not isinstance(value, Tied)
    return values[str(value.name)] if isinstance(value, Free) else value


def simulate_chain(chain: ChainValues, experiment: Experiment, samples: int) -> Matrix:
    """The force of a chain [N] at the first samples of a record, from rest."""
    motion, interval = experiment.motion, experiment.record.interval
    z, v = motion.displacement[:samples] - motion.displacement[0], motion.velocity[:samples]
    if math.isinf(chain.ks):
        level = np.maximum(_level(chain, z, v), 0.0)
        friction = _presliding_friction(z, v, level, chain.reach) if chain.reach > 0.0 else level * np.sign(v)
        return np.asarray(
            chain.b * motion.acceleration[:samples]
            + (chain.c + chain.square * np.abs(v)) * v
            + friction
            + chain.skew * chain.f
        )
    omega = math.sqrt(chain.ks / chain.b)
    parts = math.ceil(max(interval / _FINEST, _STEPS * omega * interval / (2.0 * math.pi)))
    numbers = np.array([getattr(chain, field.name) for field in fields(chain)])
    return np.asarray(_march(z, v, interval, min(parts, _MOST_PARTS), numbers))


def _level(chain: ChainValues, z: Matrix, v: Matrix) -> Matrix:
    wave = 2.0 * math.pi / chain.pitch * z
    return np.asarray(
        chain.f
        + chain.rise * np.exp(-((v / chain.speed) ** 2))
        + chain.tilt * z
        + chain.bend * z**2
        + chain.cosine * np.cos(wave)
        + chain.sine * np.sin(wave),
        dtype=float,
    )


def _presliding_friction(z: Matrix, v: Matrix, level: Matrix, reach: float) -> Matrix:
    """Friction that approaches its level exponentially with the travel since each reversal (Dahl 1968)."""
    turned = [0, *(np.flatnonzero(np.diff(np.sign(v)) != 0.0) + 1), v.size]
    share, last = np.zeros(v.size), 0.0
    for start, stop in pairwise(turned):
        way = float(np.sign(v[start]))
        travel = np.abs(z[start:stop] - z[max(start - 1, 0)])
        share[start:stop] = way + (last - way) * np.exp(-travel / reach)
        last = float(share[stop - 1])
    return np.asarray(share * level)


@kernel("force of a device", "(float64[::1], float64[::1], float64, int64, float64[::1])")
def _march(z: Any, v: Any, interval: float, parts: int, numbers: Any) -> Any:
    ks, cs, gap, b, f, c, rise, speed, tilt, bend, skew, reach, square, cubic, slack, beyond, cosine, sine, pitch = (
        numbers
    )
    bias = skew * f
    h = interval / parts
    force = np.zeros(z.size)
    y, w, shaft, side, bristle = 0.0, 0.0, 0.0, 0, 0.0
    stiff = b / h + 0.25 * ks * h + 0.5 * (cs + c)
    loose = b / h + 0.5 * c
    for n in range(1, z.size):
        before, slope = z[n - 1], v[n - 1]
        for i in range(1, parts + 1):
            s = i / parts  # the cubic through both samples with their slopes
            p, q = s * s * (3.0 - 2.0 * s), s * (1.0 - s)
            after = z[n - 1] + p * (z[n] - z[n - 1]) + interval * q * ((1.0 - s) * v[n - 1] - s * v[n])
            rate = 6.0 * q * (z[n] - z[n - 1]) / interval
            rate += (1.0 - s) * (1.0 - 3.0 * s) * v[n - 1] + s * (3.0 * s - 2.0) * v[n]
            middle, mean = 0.5 * (before + after), 0.5 * (slope + rate)
            level = f + rise * math.exp(-((w / speed) ** 2)) + tilt * y + bend * y * y
            if cosine != 0.0 or sine != 0.0:
                level += cosine * math.cos(2.0 * math.pi * y / pitch) + sine * math.sin(2.0 * math.pi * y / pitch)
            drag = 0.5 * square * abs(w)
            touching = gap == 0.0 or side != 0
            if not touching and abs(after - y - h * w - shaft) >= gap:
                side = 1 if after - y - h * w - shaft > 0.0 else -1
                touching = True
            before_w = w
            if touching:
                spring = ks * (middle - side * gap - y - 0.25 * h * w)
                inertia = stiff + drag
                if cubic != 0.0 or beyond != 0.0:
                    more, slope_more = nonlinear_shaft_force(
                        middle - side * gap - y - 0.5 * h * w, cubic, slack, beyond
                    )
                    spring += more + 0.25 * h * slope_more * w
                    inertia += 0.25 * h * slope_more
                push = b * w / h + spring + cs * (mean - 0.5 * w) - (0.5 * c + drag) * w - bias
                if reach > 0.0:
                    w, bristle = velocity_with_presliding(push, max(level, 0.0), inertia, h, reach, w, bristle)
                else:
                    w = velocity_after_push(push, level, inertia)
                y += 0.5 * h * (before_w + w)
                shaft = after - y - side * gap
                pull = ks * shaft + cs * (rate - w)
                if cubic != 0.0 or beyond != 0.0:
                    pull += nonlinear_shaft_force(shaft, cubic, slack, beyond)[0]
                if gap > 0.0 and side * pull < 0.0:
                    side, pull = 0, 0.0
            else:
                push = b * w / h - (0.5 * c + drag) * w - bias
                if reach > 0.0:
                    w, bristle = velocity_with_presliding(push, max(level, 0.0), loose + drag, h, reach, w, bristle)
                else:
                    w = velocity_after_push(push, level, loose + drag)
                y += 0.5 * h * (before_w + w)
                shaft *= math.exp(-h * ks / cs) if cs > 0.0 else 0.0
                pull = 0.0
            before, slope = after, rate
        force[n] = pull
    return force


@part()
def velocity_after_push(push: float, level: float, inertia: float) -> float:
    """Velocity [m/s] after a step under a force against Coulomb friction of this level; zero where it sticks."""
    if push > level:
        return (push - max(level, 0.0)) / inertia
    if push < -level:
        return (push + max(level, 0.0)) / inertia
    return 0.0


@part()
def velocity_with_presliding(
    push: float, level: float, inertia: float, h: float, reach: float, w: float, bristle: float
) -> tuple[float, float]:
    """Velocity [m/s] after a step against presliding friction (Dahl 1968), and its share of the level; implicit."""
    way = 1.0 if w > 0.0 or (w == 0.0 and push > 0.0) else -1.0
    rate = max(1.0 - bristle * way, 0.0) / reach
    w = (push - level * bristle) / (inertia + level * rate * h)
    rate = max(1.0 - bristle * (1.0 if w > 0.0 else -1.0), 0.0) / reach
    return w, min(max(bristle + h * rate * w, -1.0), 1.0)


@part()
def nonlinear_shaft_force(shaft: float, cubic: float, slack: float, beyond: float) -> tuple[float, float]:
    """Force [N] of a shaft beyond its linear stiffness at a deflection, and its derivative [N/m]."""
    more, slope = cubic * shaft**3, 3.0 * cubic * shaft**2
    if beyond > 0.0 and abs(shaft) > slack:
        more += beyond * (shaft - slack if shaft > 0.0 else shaft + slack)
        slope += beyond
    return more, slope
