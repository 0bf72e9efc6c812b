"""The H-infinity norm with all peaks of the gain and their frequencies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import OK, LinearSystemError, Status, StatusKind
from inerter.formatting import format_quantity
from inerter.norms.exact import EXACT, peaks_exactly
from inerter.norms.response import resolvent
from inerter.norms.stability import pole_rates, split
from inerter.systems.linear import LinearSystem, check_system

Matrix = NDArray[np.float64]
Gain = Callable[[Matrix], Matrix]
_RISE = 1e-11  # a smaller relative change of the gain is rounding


@dataclass(frozen=True)
class GainPeak:
    """A local maximum of the gain."""

    omega: float  # [rad/s], infinite for the gain of the direct term
    gain: float


@dataclass(frozen=True)
class HInfinity:
    """Peak gain, all local maxima of the gain (highest first), and a status if the gain is infinite.

    `error` is the largest relative error of the gain by rounding, nan where it has no bound.
    """

    value: float
    peaks: tuple[GainPeak, ...]
    status: Status
    error: float = np.nan


def hinf_norm(system: LinearSystem) -> HInfinity:
    """Largest singular value of G(j omega) over all frequencies, with every local maximum.

    A system that comes from a mechanism and has one input or one output is a fraction of polynomials with whole
    coefficients: its peaks are all roots of the slope of that, and nothing is left to rounding. For others peaks are
    sought from every pole and on a grid, refined one by one, and the highest is then certified by the level sets of
    the gain: eigenvalues of a Hamiltonian matrix on the imaginary axis tell where the gain crosses a level just above
    it (Bruinsma and Steinbuch, 1990). Motions that do not decay count only if they can be excited and seen. Where
    rounding hides the damping of the highest resonance, the value is nan.

    Raises `LinearSystemError` if inputs of one source arrive at different times.

    >>> import inerter as it
    >>> lag = it.LinearSystem(A=[[-2.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]])  # 1 / (s + 2)
    >>> round(it.hinf_norm(lag).value, 12), it.hinf_norm(lag).peaks[0].omega
    (0.5, 0.0)
    """
    check_system(system)
    merged = _merge(system)
    exact = system.fine is not None
    found = peaks_exactly(system) if exact else None
    if found is not None:
        known, status = found
        return HInfinity(known[0][1] if known else 0.0, tuple(GainPeak(*peak) for peak in known), status, EXACT)
    parts = split(merged)
    if parts.poles.size and np.any(parts.visible()):
        if exact:  # the transfer functions have no such poles
            return HInfinity(np.nan, (), _lost_damping(float(np.abs(parts.poles.imag).max())))
        frequencies = np.unique(np.abs(parts.poles.imag))
        return HInfinity(np.inf, tuple(GainPeak(float(w), np.inf) for w in frequencies), parts.status)
    stable = LinearSystem(parts.decaying.A, parts.decaying.B, parts.decaying.C, merged.D)
    value, peaks = _largest(stable)
    status = _sharpness(stable.A, peaks)
    return HInfinity(value if status.ok else np.nan, tuple(peaks), status)


def _largest(stable: LinearSystem) -> tuple[float, list[GainPeak]]:
    gain = _gain(stable)
    poles = np.linalg.eigvals(stable.A) if stable.order else np.zeros(0)
    grid = _grid(np.asarray(poles, dtype=complex))
    peaks = _peaks(gain, grid, stable.D)
    for _ in range(50):
        higher = _above(stable, gain, peaks[0].gain) if peaks else []
        if not higher:
            break
        grid = np.unique(np.concatenate([grid, higher]))
        peaks = _peaks(gain, grid, stable.D)
    return peaks[0].gain if peaks else 0.0, peaks


def _sharpness(A: Matrix, peaks: list[GainPeak]) -> Status:
    """Status on whether the damping of the resonance at the highest peak is lost to rounding."""
    if A.size == 0 or not peaks or not np.isfinite(peaks[0].omega):
        return OK
    rates, errors = pole_rates(A)
    poles = np.linalg.eigvals(A)
    nearest = int(np.argmin(np.abs(1j * peaks[0].omega - poles)))
    there = int(np.argmin(np.abs(rates - poles[nearest].real)))
    sharp = abs(poles[nearest].imag) > 1e3 * abs(rates[there]) and errors[there] > 1e-6 * abs(rates[there])
    return _lost_damping(peaks[0].omega) if sharp else OK


def _lost_damping(omega: float) -> Status:
    return Status(
        StatusKind.INACCURATE, f"damping of the resonance at {format_quantity(omega, 'rad/s', 6)} lost to rounding"
    )


def _merge(system: LinearSystem) -> LinearSystem:
    sources = list(dict.fromkeys(system.sources))
    merge = np.array([[source == other for other in sources] for source in system.sources], dtype=float)
    for j, source in enumerate(sources):
        delays = system.delays[merge[:, j] > 0.0] if merge.size else np.zeros(0)
        if np.ptp(delays) > 0.0:
            raise LinearSystemError(
                f"The H-infinity norm needs the inputs of {source!r} to arrive together, but they are "
                f"{format_quantity(float(np.ptp(delays)), 's', 6)} apart. Choose one with subsystem(inputs=...)."
            )
    merge = merge.reshape(len(system.sources), len(sources))
    return LinearSystem(system.A, system.B @ merge, system.C, system.D @ merge)


def _gain(system: LinearSystem) -> Gain:
    evaluate = resolvent(system)

    def gain(omega: Matrix) -> Matrix:
        G = evaluate(np.atleast_1d(omega)) + system.D
        if min(G.shape[1:]) == 0:
            return np.zeros(G.shape[0])
        if min(G.shape[1:]) == 1:
            return np.asarray(np.sqrt(np.sum(np.abs(G) ** 2, axis=(1, 2))))
        return np.asarray(np.linalg.norm(G, 2, axis=(1, 2)))

    return gain


def _grid(poles: NDArray[np.complex128]) -> Matrix:
    """Zero, a logarithmic grid over all time scales, and points on and around every resonance."""
    sizes = np.abs(poles)[np.abs(poles) > 0.0]
    if sizes.size == 0:
        return np.array([0.0, 1.0])
    low, high = np.log10(sizes.min()) - 3.0, np.log10(sizes.max()) + 3.0
    spread = np.concatenate([[0.0], np.geomspace(0.03, 30.0, 25)])
    around = np.abs(poles.imag)[:, None] + np.abs(poles.real)[:, None] * np.concatenate([-spread, spread])
    grid = np.concatenate([[0.0], np.logspace(low, high, int(60 * (high - low))), sizes, around.ravel()])
    return np.unique(grid[grid >= 0.0])


def _peaks(gain: Gain, grid: Matrix, D: Matrix) -> list[GainPeak]:
    grid, values = _without_level_steps(grid, gain(grid))
    inner = np.flatnonzero((values[1:-1] > values[:-2]) & (values[1:-1] > values[2:]))
    found = [_refine(gain, grid[i], grid[i + 1], grid[i + 2]) for i in inner]
    if values.size == 1 or values[0] > values[1]:
        found.append(GainPeak(0.0, float(values[0])))
    at_infinity = float(np.linalg.norm(D, 2)) if D.size else 0.0
    if at_infinity > values[-1]:
        found.append(GainPeak(np.inf, at_infinity))
    found = [peak for peak in found if peak.gain > 0.0]
    return _distinct(sorted(found, key=lambda peak: -peak.gain))


def _without_level_steps(grid: Matrix, values: Matrix) -> tuple[Matrix, Matrix]:
    """Grid and gains without points whose gain equals that before, which would hide a peak between them."""
    kept = [0]
    for i, value in enumerate(values.tolist()):
        if abs(value - values[kept[-1]]) > _RISE * value:
            kept.append(i)
    return grid[kept], values[kept]


def _refine(gain: Gain, left: float, middle: float, right: float) -> GainPeak:
    """The maximum in a bracket, by its distance from the middle: a resonance may be much narrower than that."""
    result = scipy.optimize.minimize_scalar(
        lambda shift: -float(gain(np.array([middle + shift]))[0]),
        bounds=(left - middle, right - middle),
        method="bounded",
        options={"xatol": 1e-9 * (right - left), "maxiter": 200},
    )
    best, at_middle = -float(result.fun), float(gain(np.array([middle]))[0])
    return GainPeak(float(middle + result.x), best) if best >= at_middle else GainPeak(float(middle), at_middle)


def _distinct(peaks: list[GainPeak]) -> list[GainPeak]:
    kept: list[GainPeak] = []
    for peak in peaks:
        if all(abs(peak.omega - other.omega) > 1e-7 * other.omega for other in kept if np.isfinite(other.omega)):
            kept.append(peak)
    return kept


def _above(system: LinearSystem, gain: Gain, level: float) -> list[float]:
    """Frequencies at which the gain exceeds `level`: between crossings of a level set just above it."""
    gamma = level * (1.0 + 1e-7)
    R = gamma**2 * np.eye(system.D.shape[1]) - system.D.T @ system.D
    A, B = system.A, system.B / gamma
    inverse = np.linalg.inv(R) * gamma**2
    F = A + B @ inverse @ (system.D.T / gamma) @ system.C
    lower = system.C.T @ (np.eye(system.D.shape[0]) + system.D @ np.linalg.inv(R) @ system.D.T) @ system.C
    H = np.block([[F, B @ inverse @ B.T], [-lower, -F.T]])
    if not H.size:
        return []
    H = np.asarray(scipy.linalg.matrix_balance(H, permute=False)[0])
    eigenvalues = np.linalg.eigvals(H)
    near_axis = np.abs(eigenvalues.real) <= 1e-5 * np.abs(eigenvalues) + 1e-12 * np.abs(eigenvalues).max()
    crossings = np.unique(np.abs(eigenvalues[near_axis].imag))
    if crossings.size == 0:
        return []
    edges = np.concatenate([[0.0], crossings, [2.0 * crossings[-1]]])
    middles = 0.5 * (edges[1:] + edges[:-1])
    return [float(w) for w, g in zip(middles, gain(middles), strict=True) if g > gamma]
