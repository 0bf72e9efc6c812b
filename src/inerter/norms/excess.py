"""Corrections of mean squares for sources whose density is not quite that behind the filters that stand in for them.

The correction is the integral of the squared gain times what the density has more, by Gauss-Kronrod rules on panels
that are no wider than their distance from each pole, so that they resolve the lightest damping and converge at a rate
that is known beforehand. It need not be as accurate as a mean square, of which it is a few per cent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.norms.response import modal_response
from inerter.norms.stability import balance
from inerter.systems.linear import LinearSystem

Array = NDArray[np.float64]
Excesses = Mapping[str, Callable[[Array], Array]]  # by the name of a source, over omega [rad/s]
# Places, weights, and weights of the Gauss rule at every second of them. Source: Piessens et al., QUADPACK (1983).
_PLACES = (
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851, 0.864864423359769072789712788640926,
    0.741531185599394439863864773280788, 0.586087235467691130294144691838259, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0,
)  # fmt: skip
_WEIGHTS = (
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204, 0.104790010322250183839876322541518,
    0.140653259715525918745189590510238, 0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714,
)  # fmt: skip
_GAUSS = (
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780, 0.381830050505118944950369775488975,
    0.417959183673469387755102040816327,
)  # fmt: skip
_AT = np.array([*(-p for p in _PLACES), *_PLACES[-2::-1]])
_KRONROD = np.array([*_WEIGHTS, *_WEIGHTS[-2::-1]])
_LESS = np.zeros(_AT.size)
_LESS[1::2] = [*_GAUSS, *_GAUSS[-2::-1]]
_APART = 2.0  # half-widths of a panel that its centre keeps from each pole: the rules then gain 1.1 digits a place
_ANGLE = 4.0  # [rad] by which a delay turns the phase over half a panel at most
_NEGLIGIBLE = 1e-9  # of a mean square: what a panel may have without resolving the phases of delays
_MOST_PANELS, _AT_ONCE = 25_000, 10_000  # that resolve phases, in all and in memory; beyond, phases are in the error
_AT_ZERO = 1e-12  # size of a pole relative to the fastest that is one at zero
_SHORTEST, _FASTEST = 1e4, 1e4  # where to end: times the inverse of the time of an excess, or the fastest pole
_NARROWEST = 1e-14  # width of a panel relative to its frequency
_POWER = 6  # of the variable in the lowest panel, in which densities have a logarithm
_MODAL = 1e-10  # of the largest gain by which a sum over modes may be off
_EPS = float(np.finfo(float).eps)


def excess_squares(system: LinearSystem, excesses: Excesses, pade_order: int | None) -> tuple[Array, Array]:
    """Corrections of the squared norms of the outputs of `system` for true densities, and their uncertainties.

    `excesses` has the functions of the sources that have one; the system has the filters that stand in for them.
    """
    poles, largest, rounding = _modes(system)
    names = [s for s in dict.fromkeys(system.sources) if s in excesses]
    if not names:
        return np.zeros(len(system.outputs)), np.zeros(len(system.outputs))
    columns = [list(dict.fromkeys(system.sources)).index(name) for name in names]

    def densities(omega: Array) -> tuple[Array, Array]:
        """Squared gains (omega, outputs), and times the excess."""
        gains = np.abs(modal_response(system, omega, pade_order, _MODAL)[:, :, columns]) ** 2
        more = np.column_stack([excesses[name](omega) for name in names])
        return gains.sum(axis=2), np.einsum("wos,ws->wo", gains, more)

    fastest = float(np.abs(poles).max(initial=0.0))
    are_moving = np.abs(poles) > _AT_ZERO * fastest
    moving = poles[are_moving]
    times = [getattr(excesses[name], "time", 0.0) for name in names]
    late = float(np.ptp(system.delays)) if len(system.delays) else 0.0
    high = max(min(_SHORTEST / max(*times, 1e-300), _FASTEST * fastest), 1e-300)
    low = 0.25 * min([*np.abs(moving).tolist(), high, 1.0 / max(late, 1e-300)])
    panels = _panels(moving, low, high)
    at = 0.5 + 0.5 * _AT
    weights = _KRONROD * 0.5 * low * _POWER * at ** (_POWER - 1)
    power, more = densities(low * at**_POWER)
    total, added = weights @ power, weights @ more
    unsure = np.abs((weights * (1.0 - _LESS / _KRONROD)) @ more)
    power, more = _on_panels(densities, panels)
    coarse = _KRONROD @ power, _KRONROD @ more
    total = total + coarse[0].sum(axis=0)
    share = np.max(_KRONROD @ np.abs(more) / np.maximum(total, 1e-300), axis=1)
    turns = np.diff(panels, axis=1)[:, 0] * late / (2.0 * _ANGLE)
    wide = np.flatnonzero((turns > 1.0) & (share > _NEGLIGIBLE))
    if wide.size:
        wide = wide[np.argsort(-share[wide], kind="stable")]
        resolved = wide[np.cumsum(1.0 + turns[wide]) <= _MOST_PANELS]
        unsure = unsure + 2.0 * np.abs(more[np.setdiff1d(wide, resolved)]).max(axis=1, initial=0.0).sum(axis=0)
        edges = [np.linspace(panels[i, 0], panels[i, 1], 2 + int(turns[i])) for i in np.sort(resolved)]
        finer = [np.column_stack([several[:-1], several[1:]]) for several in edges]
        fine = [_on_panels(densities, part)[1] for part in _in_parts(finer)]
        more = np.concatenate([np.delete(more, resolved, axis=0), *fine])
    added = added + (_KRONROD @ more).sum(axis=0)
    unsure = unsure + np.abs((_KRONROD - _LESS) @ more).sum(axis=0)
    with np.errstate(divide="ignore"):
        blurred = np.minimum(rounding / np.abs(moving.real), 1.0)
    for name in names:
        inputs = [i for i, source in enumerate(system.sources) if source == name]
        residues = largest[:, are_moving][:, :, inputs].sum(axis=2)
        resonances = np.minimum(residues**2 * np.pi / np.maximum(np.abs(moving.real), rounding), total[:, None])
        unsure = unsure + resonances @ (np.abs(excesses[name](np.maximum(np.abs(moving), low))) * blurred)
    return added / np.pi, unsure / np.pi


def _modes(system: LinearSystem) -> tuple[NDArray[np.complex128], Array, float]:
    """Poles, sizes of their residues (outputs, poles, inputs), infinite where they are unknown, and rounding of a pole.

    A mode that no input moves or no output sees has residues of rounding alone, however light its damping.
    """
    A, scale = balance(system.A)
    if not len(A):
        return np.zeros(0, dtype=complex), np.zeros((len(system.outputs), 0, len(system.sources))), 0.0
    eigen: tuple[Any, Any, Any] = scipy.linalg.eig(A, left=True)  # type: ignore[assignment]
    poles, left, right = eigen
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        driven = (left.conj().T @ (system.B / scale[:, None])) / np.sum(left.conj() * right, axis=0)[:, None]
        residues = np.abs((system.C * scale) @ right)[:, :, None] * np.abs(driven)
    rounding = len(A) * _EPS * float(np.abs(A).sum(axis=1).max())
    return poles, np.nan_to_num(residues, nan=np.inf, posinf=np.inf), rounding


def _in_parts(panels: Sequence[Array]) -> list[Array]:
    """All panels in arrays that fit into memory."""
    every = np.concatenate(panels) if panels else np.zeros((0, 2))
    return np.array_split(every, range(_AT_ONCE, len(every), _AT_ONCE)) if len(every) else []


def _panels(poles: NDArray[np.complex128], low: float, high: float) -> Array:
    """Panels (n, 2) from `low` to `high`, with the centre of each at least one panel width from every pole."""
    edges = low * 2.0 ** np.arange(np.ceil(np.log2(high / low)) + 1.0)
    open_, closed = np.column_stack([edges[:-1], edges[1:]]), []
    while len(open_):
        centre, half = open_.mean(axis=1), 0.5 * np.diff(open_, axis=1)[:, 0]
        near = np.abs(1j * centre[:, None] - poles).min(axis=1, initial=np.inf) < _APART * half
        near &= half > _NARROWEST * centre
        closed.append(open_[~near])
        a, b, c = open_[near, 0], open_[near, 1], centre[near]
        open_ = np.concatenate([np.column_stack([a, c]), np.column_stack([c, b])])
    return np.concatenate(closed)


def _on_panels(densities: Callable[[Array], tuple[Array, Array]], panels: Array) -> tuple[Array, Array]:
    """Densities at the places of all panels (panels, places, outputs), times half their widths."""
    centre, half = panels.mean(axis=1)[:, None], 0.5 * np.diff(panels, axis=1)
    shape = (len(panels), _AT.size, -1)
    first, second = densities((centre + half * _AT).ravel())
    return first.reshape(shape) * half[:, :, None], second.reshape(shape) * half[:, :, None]
