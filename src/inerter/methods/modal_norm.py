"""Arguments of the compiled norms over modes, for the problems of one source that they can solve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from inerter.methods.linear import LinearProblem
from inerter.norms.delay import pade
from inerter.norms.h2 import ACCURATE
from inerter.signals.coherence import ISOTROPIC_DENSITY, Coherence, Excess, isotropic_exponentials
from inerter.systems.autocorrelation import Autocorrelation, autocorrelation, pole_errors
from inerter.systems.descriptor import Descriptor, describe
from inerter.systems.filters import Filter
from inerter.systems.input_paths import apply_excitation, columns_of, inputs_of


def stacks_of(descriptor: Descriptor) -> tuple[tuple[Any, ...], tuple[Any, Any]]:
    """The descriptor's arrays; also S, [R F], Y_eta and [Y_x Y_u] in a row, and their rounding errors.

    Errors that are all zero have no entries.
    """
    d = descriptor
    stacks = (d.S, np.concatenate([d.R, d.F], axis=2), d.Y_eta, np.concatenate([d.Y_x, d.Y_u], axis=2))
    stack = np.concatenate([part.reshape(part.shape[0], -1) for part in stacks], axis=1)
    rounded = np.ascontiguousarray(stack, dtype=float)
    lost = np.ascontiguousarray(stack - rounded, dtype=float)
    return d.arrays, (rounded, lost if lost.any() else np.zeros((0, 0)))


def modal_arguments(problem: LinearProblem) -> tuple[Any, Any, Any] | None:
    """Descriptor without states of filters, the same extended, and the noise; None if modes cannot serve.

    That is so for approximants of more than one delay, for inputs with different filters, for filters without partial
    fractions, where a state drifts, and where tracks with an isotropic coherence have no half model, or a filter more.
    """
    kinds = {(path.filter, path.excess, path.displacement) for path in problem.paths}
    if len(set(problem.sources)) != 1 or len(kinds) != 1:
        return None
    ((shape, excess, displacement),) = kinds
    if problem.pade_order is not None and (excess is not None or len(set(problem.delays.tolist())) > 2):
        return None  # later arrivals would be delayed by products of approximants
    if excess is not None and shape != _isotropic_filter(excess, displacement):
        return None
    found = _without_states(problem, shape)
    if found is None:
        return None
    descriptor, delays = found
    groups = list(dict.fromkeys(problem.definition.filters))
    noises = [_noise(shape, excess, own) for own in groups]
    known = [noise for noise in noises if noise is not None]
    if len(known) < len(noises):
        return None
    starts = np.cumsum([0, *(noise.poles.size for noise in known)])
    noise = (
        delays,
        np.array([groups.index(own) for own in problem.definition.filters], dtype=np.int64),
        starts.astype(np.int64),
        np.concatenate([one.poles for one in known]),
        np.concatenate([one.residues for one in known]),
        np.concatenate([one.errors for one in known]),
        np.array([one.direct for one in known]),
        delay_poles(problem.pade_order),
        ACCURATE if excess is None else ISOTROPIC_DENSITY,
    )
    return *stacks_of(descriptor), noise


def delay_poles(pade_order: int | None) -> Any:
    """Poles of the approximant of a delay; none where delays are exact."""
    return np.zeros(0, dtype=complex) if pade_order is None else pade(pade_order).poles


def _isotropic_filter(excess: Excess, displacement: bool) -> Filter | None:
    """Filter that alone stands for the density of a source; None for a motion that has no autocorrelation."""
    if displacement != (excess.sign < 0.0):
        return None
    coherence = Coherence.isotropic(excess.time)  # at a speed of one
    ratio = coherence.in_anti_phase(1.0) if displacement else coherence.in_phase(1.0)
    assert ratio is not None
    return Filter(ratio[0][:-1] if displacement else ratio[0], ratio[1])


def _noise(shape: Filter | None, excess: Excess | None, own: Filter | None) -> Autocorrelation | None:
    """Autocorrelation of a source of the true density, behind the filter of an output."""
    if excess is None:
        return autocorrelation(shape, own)
    rates, residues, direct = isotropic_exponentials(excess.sign)
    poles = rates / excess.time
    residues = residues / excess.time if excess.sign > 0.0 else residues * excess.time
    source = Autocorrelation(poles, residues, pole_errors(poles), direct)
    behind = autocorrelation(own)
    return None if behind is None else source if own is None else source.behind(behind)


def _without_states(problem: LinearProblem, shape: Filter | None) -> tuple[Descriptor, Any] | None:
    """Descriptor without the states of the filter of the inputs, nor those that stay at rest, and the delays.

    None if another state has no rate but that of the road.
    """
    descriptor, columns = problem.unfiltered, problem.arrivals
    if shape is not None and shape.order > 0:
        plain = tuple(replace(path, filter=None) for path in problem.paths)
        outputs = [weighted.output for weighted in problem.definition.outputs]
        described = describe(descriptor.mechanism, inputs_of(plain), outputs)
        descriptor, columns = apply_excitation(described, plain), tuple(columns_of(plain))
    delays = np.array([delay for *_, delay in columns])
    drifting = ~(np.any(descriptor.X_eta, axis=1) | np.any(descriptor.X_x, axis=1))
    moved = np.any(descriptor.X_u, axis=1)
    if (
        np.any(drifting & moved)
        or np.any(np.diff(delays) < 0.0)
        or list(descriptor.free) != list(problem.descriptor.free)
    ):
        return None
    d, kept = descriptor, np.flatnonzero(~drifting)
    return replace(
        d, R=d.R[:, :, kept], X_eta=d.X_eta[kept], X_x=d.X_x[np.ix_(kept, kept)], X_u=d.X_u[kept], Y_x=d.Y_x[:, :, kept]
    ), delays  # fmt: skip
