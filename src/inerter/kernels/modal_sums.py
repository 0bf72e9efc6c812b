"""Sums over modes at many frequencies."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import kernel

Array = Any
_BLOCK = 128  # frequencies whose sums stay in the cache


@kernel("sums over modes", "void(float64[::1], complex128[::1], complex128[:,:,::1], complex128[:,:,::1])", fused=True)
def add_modes(omega: Array, poles: Array, residues: Array, out: Array) -> None:
    """Add residues (poles, outputs, inputs) over j omega - pole, for all poles, to `out` (frequencies, ...).

    Real and imaginary parts are apart, so that the compiler takes several frequencies at a time.
    """
    real, imaginary = np.empty(_BLOCK), np.empty(_BLOCK)
    sums = np.empty((residues.shape[1], residues.shape[2], 2, _BLOCK))
    for first in range(0, omega.size, _BLOCK):
        count = min(_BLOCK, omega.size - first)
        sums[:] = 0.0
        for k in range(poles.size):
            decay, turn = -poles[k].real, poles[k].imag
            for i in range(count):
                apart = omega[first + i] - turn
                inverse = 1.0 / (decay * decay + apart * apart)
                real[i], imaginary[i] = decay * inverse, -apart * inverse
            for o in range(residues.shape[1]):
                for s in range(residues.shape[2]):
                    x, y, into = residues[k, o, s].real, residues[k, o, s].imag, sums[o, s]
                    for i in range(count):
                        into[0, i] += x * real[i] - y * imaginary[i]
                        into[1, i] += x * imaginary[i] + y * real[i]
        for o in range(residues.shape[1]):
            for s in range(residues.shape[2]):
                for i in range(count):
                    out[first + i, o, s] += complex(sums[o, s, 0, i], sums[o, s, 1, i])
