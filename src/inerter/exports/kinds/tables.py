"""Tables of what a figure shows, as CSV or netCDF: frequency responses of a design, a trajectory, or a record."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from inerter.atomic_io import netcdf_content
from inerter.errors import ExportError, LinearSystemError
from inerter.exports.kind import ExportKind
from inerter.exports.named_system import NamedSystem
from inerter.exports.request import ExportSpec
from inerter.indices.definition import Index
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.norms.response import frequency_response, resonant_range
from inerter.records.record import CHANNELS, Record
from inerter.records.writers import write_record_table
from inerter.simulation.trajectory import Trajectory
from inerter.systems.assemble import state_space
from inerter.systems.descriptor import close
from inerter.systems.linear import check_names

if TYPE_CHECKING:
    import xarray

Matrix = NDArray[np.float64]
_AT_POLE = 1e-6  # of a frequency: nearer to a pole than this it is left out


@dataclass(frozen=True, eq=False)
class ExportedResponses:
    """Frequency responses of a linear model, and of indices the gain of each weighted output from their source."""

    frequency: Matrix  # [Hz]
    system: NamedSystem
    values: NDArray[np.complex128]  # (frequencies, outputs, inputs)
    of_indices: dict[str, tuple[tuple[str, ...], Matrix]]  # outputs, and gains (outputs, frequencies)

    @property
    def phase(self) -> Matrix:
        """Phase [deg], unwrapped over the frequencies."""
        return np.degrees(np.unwrap(np.angle(self.values), axis=0))

    def unit(self, output: int, inp: int) -> str:
        """Unit of the gain of an output from an input."""
        top, below = self.system.outputs[output].unit, self.system.inputs[inp].unit
        return f"{_in_brackets(top)}/{_in_brackets(below)}" if below else top


def responses_of(request: ExportSpec) -> ExportedResponses:
    """The responses that a request asks for.

    Raises `ExportError` for a pole at one of the frequencies that were asked for.
    """
    system = request.system("descriptor")
    hertz = request.hertz
    if hertz is None:
        dynamics = system.A if system.E is None else state_space(request.mechanism).A
        hertz = _frequencies_off_poles(dynamics) / (2.0 * np.pi)
    omega = 2.0 * np.pi * hertz
    values = system.response(omega)
    if not np.all(np.isfinite(values)):
        raise ExportError("A frequency is that of an undamped pole, where the response is infinite. Choose others.")
    found = {}
    for name, index in (request.indices or {}).items():
        found[name] = _index_gains(request, name, index, omega)
    return ExportedResponses(hertz, system, values, found)


def _frequencies_off_poles(dynamics: Matrix) -> Matrix:
    """Frequencies of `resonant_range` [rad/s], without those at an undamped pole, where no digit of a gain is left."""
    omega, poles = resonant_range([dynamics]), np.linalg.eigvals(dynamics)
    away = np.abs(1j * omega[:, None] - poles).min(axis=1, initial=np.inf)
    return np.asarray(omega[away > _AT_POLE * omega])


def _index_gains(request: ExportSpec, name: str, index: Index, omega: Matrix) -> tuple[tuple[str, ...], Matrix]:
    """Weighted gains of the outputs of an index, with the delays of its road, over all of its sources."""
    mechanism = request.mechanism
    try:
        problem = linear_problem(mechanism, index.definition(mechanism), CONVENTIONS[request.conventions])
    except LinearSystemError as error:
        raise ExportError(f"{name}: {error}") from error
    system = problem.system(close(problem.descriptor, {}))
    response = problem.with_true_densities(frequency_response(system, omega, problem.pade_order), omega)
    sizes = np.linalg.norm(response, axis=2).T
    weights = np.array([abs(output.weight) for output in problem.definition.outputs])
    return tuple(output.output for output in problem.definition.outputs), weights[:, None] * sizes


def _make_csv(request: ExportSpec, suffix: str) -> str:
    content = io.StringIO()
    if (record := request.record) is not None:
        write_record_table(record, content, ",")
        return content.getvalue()
    writer = csv.writer(content, lineterminator="\n")
    if isinstance(request.of, Trajectory):
        names = _outputs_of(request)
        run = request.of
        writer.writerow(["time [s]", *(f"{name} [{run.unit(name)}]" for name in names)])
        columns = [run.time, *(run[name] for name in names)]
    else:
        found = responses_of(request)
        for note in found.system.notes:
            content.write(f"# {note}\n")
        headed = dict(_columns(found))
        writer.writerow(headed)
        columns = list(headed.values())
    writer.writerows(map(repr, row) for row in np.column_stack(columns).tolist())
    return content.getvalue()


def _columns(found: ExportedResponses) -> Iterator[tuple[str, Matrix]]:
    yield "frequency [Hz]", found.frequency
    phase = found.phase
    for i, output in enumerate(found.system.outputs):
        for j, inp in enumerate(found.system.inputs):
            named = f"{output.name} from {inp.name}"
            yield f"gain of {named} [{found.unit(i, j)}]", np.abs(found.values[:, i, j])
            yield f"phase of {named} [deg]", phase[:, i, j]
    for name, (outputs, gains) in found.of_indices.items():
        for output_name, gain in zip(outputs, gains, strict=True):
            yield f"gain of {output_name} in {name}", gain


def _make_netcdf(request: ExportSpec, suffix: str) -> bytes:
    if isinstance(request.of, Trajectory):
        return netcdf_content(request.of.to_xarray(_outputs_of(request)))
    if (record := request.record) is not None:
        return netcdf_content(_record_dataset(record))
    return netcdf_content(responses_dataset(responses_of(request)))


def _record_dataset(record: Record) -> xarray.Dataset:
    import xarray  # noqa: PLC0415 - heavy

    channels = record.channels() | {name: values for name, values in record.further.items() if name not in CHANNELS}
    data = {
        name: ("time", values, {"long_name": name} | ({"units": CHANNELS[name]} if name in CHANNELS else {}))
        for name, values in channels.items()
    }
    return xarray.Dataset(data, attrs={"title": record.source, "notes": "\n".join(record.notes)})


def responses_dataset(found: ExportedResponses) -> xarray.Dataset:
    """Gain, phase and complex response of every output from every input over the frequency, with units."""
    import xarray  # noqa: PLC0415 - heavy

    system, dims = found.system, ("frequency", "output", "input")
    units = [[found.unit(i, j) for j in range(len(system.inputs))] for i in range(len(system.outputs))]
    data = xarray.Dataset(
        {
            "gain": (dims, np.abs(found.values), {"long_name": "gain"}),
            "phase": (dims, found.phase, {"units": "deg", "long_name": "phase"}),
            "real": (dims, found.values.real, {"long_name": "real part of the response"}),
            "imaginary": (dims, found.values.imag, {"long_name": "imaginary part of the response"}),
            "gain_unit": (("output", "input"), np.array(units, dtype=object)),
        },
        {
            "frequency": ("frequency", found.frequency, {"units": "Hz", "long_name": "frequency"}),
            "output": [one.name for one in system.outputs],
            "output_unit": ("output", [one.unit for one in system.outputs]),
            "input": [one.name for one in system.inputs],
            "input_unit": ("input", [one.unit for one in system.inputs]),
        },
        {"title": system.title, "notes": "\n".join(system.notes)},
    )
    for name, (outputs, gains) in found.of_indices.items():
        place = f"output_{name}"
        data = data.assign_coords({place: list(outputs)})
        data[f"gain_{name}"] = ((place, "frequency"), gains, {"long_name": f"gain of the outputs of {name}"})
    return data


def _outputs_of(request: ExportSpec) -> list[str]:
    assert isinstance(request.of, Trajectory)
    return list(request.of.outputs if request.outputs is None else check_names("outputs", request.outputs))


def _in_brackets(unit: str) -> str:
    return f"({unit})" if "/" in unit or " " in unit else unit or "1"


_OPTIONS = ("inputs", "outputs", "linear", "frequencies", "indices")
CSV = ExportKind(
    "csv",
    "table of the frequency responses, of a trajectory or of a record",
    (".csv",),
    _make_csv,
    takes=_OPTIONS,
    synonyms=("excel",),
)
NETCDF = ExportKind(
    "netcdf",
    "dataset of the frequency responses, of a trajectory or of a record",
    (".nc",),
    _make_netcdf,
    takes=_OPTIONS,
)
