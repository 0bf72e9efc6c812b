"""A measured frequency response: gain, phase, coherence, and their confidence bands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.atomic_io import export_csv
from inerter.errors import OK, RecordError, Status
from inerter.records.record import Record

if TYPE_CHECKING:
    import xarray

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
_CONFIDENCE = 0.95
_COLUMNS = {  # name: unit, long name
    "gain": ("N/m", "force over displacement"),
    "gain_low": ("N/m", "gain, lower end of the 95 % interval"),
    "gain_high": ("N/m", "gain, upper end of the 95 % interval"),
    "phase": ("rad", "phase of force over displacement"),
    "phase_low": ("rad", "phase, lower end of the 95 % interval"),
    "phase_high": ("rad", "phase, upper end of the 95 % interval"),
    "coherence": ("1", "share of the force's mean square that goes with the displacement"),
    "averages": ("1", "averages, as if they were independent"),
}


@dataclass(frozen=True, eq=False)
class Response:
    """Dynamic stiffness, force over displacement, at some frequencies, at the amplitude of the records.

    Only frequencies of the displacement are included. The bands are 95 % confidence intervals at each frequency, for
    random scatter; a response without scatter, such as that of a model, has infinite averages and bands of zero width.
    A phase of pi is that of an inerter, pi/2 that of a damper, 0 that of a spring.

    >>> import inerter as it
    >>> response = it.linear_response(it.Spring(1e6) - it.Inerter(100.0), [10.0])  # rad/s
    >>> round(response.gain[0]) == round(1 / (1 / (100.0 * 10.0**2) - 1 / 1e6))  # force over displacement [N/m]
    True
    """

    omega: Matrix  # (n,) [rad/s], increasing
    gain: Matrix  # (n,) [N/m]
    phase: Matrix  # (n,) [rad] from -pi/2 to 3 pi/2
    coherence: Matrix  # (n,) from 0 to 1
    band: Matrix  # (2, n) [N/m] lower and upper end
    phase_band: Matrix  # (2, n) [rad]
    averages: Matrix  # (n,) as if they were independent
    amplitude: float  # [m] r.m.s. displacement of the records, to which the response belongs
    estimator: str  # "periodic", "H1", "H2", "Hv" or "exact"
    source: str
    status: Status = OK
    notes: tuple[str, ...] = ()

    @property
    def value(self) -> Complex:
        """The complex response [N/m]."""
        return np.asarray(self.gain * np.exp(1j * self.phase))

    @property
    def frequency(self) -> Matrix:
        """Frequency [Hz], shape (n,)."""
        return np.asarray(self.omega / (2.0 * np.pi))

    def lines(self, chosen: NDArray[np.bool_]) -> Response:
        """The same response at some of its frequencies."""
        parts = ("omega", "gain", "phase", "coherence", "band", "phase_band", "averages")
        return replace(self, **{name: getattr(self, name)[..., chosen] for name in parts})

    def columns(self) -> dict[str, Matrix]:
        """All numbers by name, one for each frequency."""
        ends = {"gain_low": self.band[0], "gain_high": self.band[1]}
        ends |= {"phase_low": self.phase_band[0], "phase_high": self.phase_band[1]}
        return {name: ends[name] if name in ends else getattr(self, name) for name in _COLUMNS}

    def to_xarray(self) -> xarray.Dataset:
        """A dataset over `omega`, with units and long names."""
        import xarray  # noqa: PLC0415 - heavy

        data = {
            name: ("omega", values, {"units": _COLUMNS[name][0], "long_name": _COLUMNS[name][1]})
            for name, values in self.columns().items()
        }
        coords = {
            "omega": ("omega", self.omega, {"units": "rad/s", "long_name": "angular frequency"}),
            "frequency": ("omega", self.frequency, {"units": "Hz", "long_name": "frequency"}),
        }
        about = {"source": self.source, "estimator": self.estimator, "amplitude": self.amplitude}
        return xarray.Dataset(data, coords, {**about, "status": str(self.status), "notes": "\n".join(self.notes)})

    def to_csv(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write a table with a header `name [unit]`; numbers read back to the last bit.

        Raises `RecordError` if the file cannot be written, or exists and `overwrite` is false.
        """
        columns = self.columns()
        header = ["frequency [Hz]", *(f"{name} [{_COLUMNS[name][0]}]" for name in columns)]
        rows = np.column_stack([self.frequency, *columns.values()]).tolist()
        export_csv(path, RecordError, header, rows, overwrite=overwrite)


def response_from_values(
    records: Sequence[Record],
    omega: Matrix,
    value: Complex,
    coherence: Matrix,
    scatter: Matrix,
    averages: Matrix,
    estimator: str,
    notes: tuple[str, ...],
    status: Status = OK,
) -> Response:
    """A response from complex values and their relative standard deviations.

    Half of the variance of a complex value is radial, and half tangential; Student's t has two degrees of freedom for
    each average but the first.
    """
    gain, phase = np.abs(value), wrap_phase(np.angle(value))
    reach = _student_quantile(averages) * scatter / math.sqrt(2.0)
    turn = np.minimum(reach, np.pi)
    return Response(
        omega=omega,
        gain=gain,
        phase=phase,
        coherence=coherence,
        band=np.array([np.maximum(gain * (1.0 - reach), 0.0), gain * (1.0 + reach)]),
        phase_band=np.array([phase - turn, phase + turn]),
        averages=averages,
        amplitude=math.sqrt(np.mean([np.var(record.displacement) for record in records])),
        estimator=estimator,
        source=format_sources(records),
        status=status,
        notes=notes,
    )


def exact_response(omega: Matrix, value: Complex, amplitude: float = math.nan) -> Response:
    """A response without scatter, from its complex values [N/m]."""
    gain, phase = np.abs(value), wrap_phase(np.angle(value))
    return Response(
        omega=omega,
        gain=gain,
        phase=phase,
        coherence=np.ones(gain.size),
        band=np.array([gain, gain]),
        phase_band=np.array([phase, phase]),
        averages=np.full(gain.size, np.inf),
        amplitude=amplitude,
        estimator="exact",
        source="model",
    )


def wrap_phase(angle: Matrix) -> Matrix:
    """Phases from -pi/2 to 3 pi/2: those of passive devices, 0 to pi, are in the middle and do not jump.

    Unwrapping by differences instead would carry the error of one noisy line to all that follow.

    >>> wrap_phase(np.array([-3.1, 3.1]))  # an inerter
    array([3.18318531, 3.1       ])
    """
    return np.asarray((angle + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi)


def format_sources(records: Sequence[Record]) -> str:
    """The sources of some records, separated by commas."""
    return ", ".join(dict.fromkeys(record.source for record in records))


def _student_quantile(averages: Matrix) -> Matrix:
    """Quantile of Student's t for two degrees of freedom per average but the first."""
    return np.asarray(scipy.stats.t.isf(0.5 * (1.0 - _CONFIDENCE), 2.0 * (averages - 1.0)))
