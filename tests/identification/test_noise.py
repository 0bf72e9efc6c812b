"""Sizes of errors that residuals tell, against those with which they were drawn."""

from __future__ import annotations

import numpy as np
import pytest

from inerter.identification.noise import uniform_whitening, whitening_of


@pytest.mark.parametrize("size", [0.5, 2.0, 30.0])
def test_residuals_of_any_size_become_as_large_as_one(size: float) -> None:
    """Some that strike far out are not errors of the sensors, and do not count for their size."""
    residual = size * np.random.default_rng(3).standard_normal(20_000)
    residual[::100] *= 50.0
    whitened = whitening_of(residual, uniform_whitening(np.ones(residual.size, dtype=bool), 1.0))(residual)
    assert np.std(np.delete(whitened, np.s_[::100])) == pytest.approx(1.0, rel=0.03)
