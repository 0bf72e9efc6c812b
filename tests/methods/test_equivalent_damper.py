"""Equivalent dampers against what defines them: the least mean square of the error of the force, and equal power."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from inerter.methods.equivalent_damper import GAUSSIAN, SINUSOIDAL, VelocityShape


def moments(shape: VelocityShape, speed: float) -> tuple[float, float]:
    """Mean size and mean square of a velocity of the size `speed`, by quadrature."""
    if shape is GAUSSIAN:
        density = norm(scale=speed).pdf
        return (
            quad(lambda v: abs(v) * density(v), -12.0 * speed, 12.0 * speed, points=[0.0])[0],
            quad(lambda v: v * v * density(v), -12.0 * speed, 12.0 * speed)[0],
        )
    turn = 2.0 * np.pi
    return (
        quad(lambda t: abs(speed * np.cos(t)), 0.0, turn, points=[0.25 * turn, 0.75 * turn])[0] / turn,
        quad(lambda t: (speed * np.cos(t)) ** 2, 0.0, turn)[0] / turn,
    )


@pytest.mark.parametrize("shape", [GAUSSIAN, SINUSOIDAL], ids=lambda shape: shape.size)
@pytest.mark.parametrize("speed", [1e-3, 0.7])
def test_the_damper_is_nearest_in_the_mean_square_and_dissipates_as_much(shape: VelocityShape, speed: float) -> None:
    friction = 12.0
    mean, square = moments(shape, speed)
    damping = float(shape.damping(np.array(friction), np.array(speed)))

    def miss(c: float) -> float:
        """E (f sgn v - c v)^2."""
        return friction**2 - 2.0 * c * friction * mean + c * c * square

    assert miss(damping) < min(miss(1.001 * damping), miss(0.999 * damping))
    assert damping * square == pytest.approx(friction * mean, rel=1e-9)
    assert float(shape.force(np.array(friction))) == pytest.approx(damping * speed, rel=1e-15)
