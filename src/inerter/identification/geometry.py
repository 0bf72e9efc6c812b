"""Inertance from the geometry of a flywheel and its drive."""

from __future__ import annotations

import math

from inerter.errors import IdentificationError
from inerter.validation import check_positive, is_number


def ball_screw_inertance(flywheel_inertia: float, pitch: float) -> float:
    """Inertance b = I (2 pi / p)^2 [kg] of a ball screw: flywheel and screw of inertia I [kg m^2], pitch p [m] a turn.

    A turn of the screw moves the nut by p, so the flywheel turns by 2 pi / p a metre and b v^2 / 2 = I omega^2 / 2.
    The nut's own mass is not in it, for both ends of the device move. Source: Wang and Su (2008), section 3.

    Raises `IdentificationError` unless both are positive numbers.

    >>> round(ball_screw_inertance(flywheel_inertia=1e-3, pitch=5e-3), 1)
    1579.1
    """
    check_positive(IdentificationError, "The inertia of a flywheel", flywheel_inertia, "kg m^2")
    check_positive(IdentificationError, "The pitch of a screw", pitch, "m a turn")
    return float(flywheel_inertia) * (2.0 * math.pi / float(pitch)) ** 2


def rack_and_pinion_inertance(
    flywheel_inertia: float, pinion_radius: float, gear_ratio: float = 1.0, pinion_inertia: float = 0.0
) -> float:
    """Inertance b = (J + n^2 I) / r^2 [kg] of a rack and pinion of pitch radius r [m], flywheel of inertia I [kg m^2].

    The flywheel turns n = `gear_ratio` times as fast as the pinion: with a gear of radius r_g on the pinion's shaft
    and a flywheel pinion of radius r_f, n = r_g / r_f. J [kg m^2] is the inertia of what turns with the pinion.
    Source: Smith (2002), section III: b = m alpha_1^2 alpha_2^2 for a flywheel of mass m and radius of gyration gamma,
    with alpha_1 = gamma / r_f and alpha_2 = r_g / r.

    Raises `IdentificationError` unless inertia, radius and ratio are positive, and J is not negative.

    >>> rack_and_pinion_inertance(flywheel_inertia=2e-4, pinion_radius=0.01, gear_ratio=3.0)
    18.0
    """
    check_positive(IdentificationError, "The inertia of a flywheel", flywheel_inertia, "kg m^2")
    check_positive(IdentificationError, "The radius of a pinion", pinion_radius, "m")
    check_positive(IdentificationError, "The ratio of a gear", gear_ratio, "turns of the flywheel a turn of the pinion")
    if not is_number(pinion_inertia) or pinion_inertia < 0.0:
        raise IdentificationError(
            f"The inertia of a pinion must be a non-negative number of kg m^2, got {pinion_inertia!r}."
        )
    turning = float(pinion_inertia) + float(gear_ratio) ** 2 * float(flywheel_inertia)
    return turning / float(pinion_radius) ** 2
