"""Sums over modes at many frequencies."""

from __future__ import annotations

from typing import Any

from inerter.kernels.decorators import kernel

Array = Any


@kernel("sums over modes", "void(float64[::1], complex128[::1], complex128[:,:,::1], complex128[:,:,::1])")
def add_modes(omega: Array, poles: Array, residues: Array, out: Array) -> None:
    """Add residues (poles, outputs, inputs) over j omega - pole, for all poles, to `out` (frequencies, ...)."""
    for i in range(omega.size):
        for k in range(poles.size):
            decay, apart = -poles[k].real, omega[i] - poles[k].imag
            square = decay * decay + apart * apart
            inverse = complex(decay / square, -apart / square)
            for o in range(residues.shape[1]):
                for s in range(residues.shape[2]):
                    out[i, o, s] += residues[k, o, s] * inverse
