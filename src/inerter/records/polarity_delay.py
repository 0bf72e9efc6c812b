"""Polarity of the force, and its delay against the motion."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from inerter.records.apparent_mass import RatioLines, force_over_acceleration, ratio_lines
from inerter.records.finding import Finding
from inerter.records.finding_texts import CLEAR, SEEN, RecordFinding
from inerter.records.record import Record
from inerter.records.smoothing import Motion
from inerter.statements import Severity

Vector = NDArray[np.float64]
STIFF = 0.3  # of the mass: more than that is elasticity near its resonance
WIDE = 3.0  # highest over lowest frequency of an excitation that separates a delay from a damper


def polarity_finding(record: Record, motion: Motion) -> list[Finding]:
    """Finding on the polarity of the force: its correlations with acceleration (inertia) and velocity (losses).

    A passive device dissipates energy. So a force that opposes both is reversed; a force that opposes the acceleration
    alone is that of a spring (below a resonance), or delayed.
    """
    force = record.force - np.mean(record.force)
    inertia = _correlation(force, motion.acceleration if record.acceleration is None else record.acceleration)
    loss = _correlation(force, motion.velocity if record.velocity is None else record.velocity)
    numbers = {"with_acceleration": inertia, "with_velocity": loss}
    clear = max(abs(inertia), abs(loss)) >= CLEAR
    if clear and ((inertia < -CLEAR and loss < 0.05) or (loss < -CLEAR and inertia < CLEAR)):
        return [Finding(RecordFinding.FORCE_REVERSED, Severity.WARNING, "force", numbers)]
    return [Finding(RecordFinding.SIGN, Severity.INFO, "force", numbers)]


def delay_finding(record: Record, motion: Motion) -> list[Finding]:
    """Finding on the delay of the recorded force against the motion.

    A measured acceleration is compared with that from the displacement, which gives the delay of the displacement
    against the other channels for any device. Without it, the phase of the device is assumed to grow as 1/omega
    (dampers, friction) and omega^3 (elasticity below its resonance), and the part that grows as omega is the delay.
    That requires an excitation over a factor of 3 in frequency.
    """
    if record.acceleration is not None:
        found = ratio_lines(motion.acceleration, record.acceleration, record.interval, highest=motion.highest)
        if not found.omega.size:
            return [_unknown_delay("acceleration")]
        return [_delay_finding(record, *_fit_delay(found, (1,)), "acceleration")]
    found = _inertial_lines(force_over_acceleration(record, motion))
    if found.omega.size < 6 or found.spread < WIDE:
        return [_unknown_delay("force")]
    return [_delay_finding(record, *_robust_delay(found), "force")]


def _inertial_lines(found: RatioLines) -> RatioLines:
    """The lines at which the real part is that of a mass, the same for most, within `STIFF`."""
    if not found.omega.size:
        return found
    mass = found.ratio.real
    usual = float(np.median(mass))
    kept = np.abs(mass - usual) <= STIFF * max(usual, 0.0)
    return RatioLines(found.omega[kept], found.ratio[kept], found.phase_error[kept])


def _robust_delay(found: RatioLines) -> tuple[float, float]:
    """The delay apart from the phase of the device; its error includes other choices of lines and terms."""
    late, error = _fit_delay(found, (1, -1, 3))
    half = slice(found.omega.size // 2, None)
    upper = RatioLines(found.omega[half], found.ratio[half], found.phase_error[half])
    others = (_fit_delay(found, (1, -1))[0], _fit_delay(upper, (1, -1))[0])
    return late, math.hypot(error, *(late - other for other in others))


def _fit_delay(found: RatioLines, powers: tuple[int, ...]) -> tuple[float, float]:
    """The delay in Im(ratio) = - mass delay omega + ... by weighted least squares, and its standard error.

    The error is scaled by the residual scatter, where that exceeds the stated errors of the lines.
    """
    scale = float(np.median(found.omega))
    mass = float(np.median(found.ratio.real))
    weight = 1.0 / (np.abs(found.ratio) * np.maximum(found.phase_error, 1e-5))
    design = np.stack([(found.omega / scale) ** power for power in powers], axis=1) * weight[:, None]
    solution, *_ = np.linalg.lstsq(design, found.ratio.imag * weight, rcond=None)
    left = found.ratio.imag * weight - design @ solution
    scatter = float(left @ left) / max(left.size - len(powers), 1)
    covariance = np.linalg.pinv(design.T @ design) * max(scatter, 1.0)
    return -float(solution[0]) / (mass * scale), float(np.sqrt(covariance[0, 0])) / abs(mass * scale)


def _delay_finding(record: Record, late: float, error: float, by: str) -> Finding:
    unseen = abs(late) < SEEN * error or abs(late) < 0.05 * record.interval
    numbers = {"delay": late, "standard_error": error}
    return Finding(RecordFinding.DELAY, Severity.INFO if unseen else Severity.WARNING, by, numbers)


def _unknown_delay(by: str) -> Finding:
    return Finding(RecordFinding.DELAY, Severity.INFO, by)


def _correlation(a: Vector, b: Vector) -> float:
    a, b = a - np.mean(a), b - np.mean(b)
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0
