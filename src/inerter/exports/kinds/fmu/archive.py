"""The archive of an FMU: description, sources, and the libraries that compilers make of them."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError
from inerter.exports.kind import OPTIONS, ExportKind
from inerter.exports.kinds.fmu.arrivals import on_one_road
from inerter.exports.kinds.fmu.descriptions import FmuModel, build_description, description_2, description_3
from inerter.exports.kinds.fmu.equations import equations_of
from inerter.exports.kinds.fmu.platforms import libraries
from inerter.exports.kinds.fmu.strut import port_masses, strut_system
from inerter.exports.kinds.fmu.switching import SwitchingSystem, switching_system, without_reactions
from inerter.exports.kinds.modelica import package_name
from inerter.exports.named_system import NamedQuantity
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Network
from inerter.systems.graph import switching
from inerter.systems.linear import LinearSystem, check_names
from inerter.systems.outputs import input_names, main_outputs
from inerter.vehicle.mechanism import LARGEST, SMALLEST, Mechanism

Matrix = NDArray[np.float64]
_DATE = (1980, 1, 1, 0, 0, 0)  # of all files, so that equal designs are equal archives


@dataclass(frozen=True)
class FmiVersion:
    """A version of FMI, and its source file."""

    number: int
    source: str


FMI_2, FMI_3 = FmiVersion(2, "fmi2.c"), FmiVersion(3, "fmi3.c")


def _make(version: FmiVersion, request: ExportSpec, suffix: str) -> bytes:
    return fmu_archive(_system(request), request.title, version, request.platforms)


def _system(request: ExportSpec) -> SwitchingSystem:
    """A strut alone, or a whole vehicle."""
    if isinstance(request.of, Network) or request.part:
        _refuse_options(request, ("inputs", "outputs", "linear", "speed"), "a strut alone")
        ((name, network),) = request.networks.items()
        ends = port_masses(request.mechanism, request.strut) if request.part else (0.0, 0.0)
        return strut_system(network, ends, request.title or name)
    found = _vehicle_system(request)
    return found if request.speed is None else on_one_road(found, request.mechanism, request.speed)


def _vehicle_system(request: ExportSpec) -> SwitchingSystem:
    """The state space, by default with displacements that drift with the road too: they begin at zero."""
    if isinstance(request.of, LinearSystem):
        return without_reactions(request.system())
    mechanism = request.mechanism
    if not request.linear and _is_nonlinear(mechanism):
        _refuse_options(request, ("inputs",), "a design with friction or gaps")
        wanted = None if request.outputs is None else check_names("outputs", request.outputs)
        return switching_system(mechanism, wanted, request.title)
    if request.outputs is None:
        request = replace(request, outputs=main_outputs(mechanism))
    inputs = input_names(mechanism) if request.inputs is None else check_names("inputs", request.inputs)
    equations = equations_of(mechanism, tuple(inputs), check_names("outputs", request.outputs))
    return without_reactions(request.system(), equations)


def _refuse_options(request: ExportSpec, options: Sequence[str], of: str) -> None:
    """Raise `ExportError` for an option that only the FMU of another object has."""
    for option in filter(request.has, options):
        raise ExportError(f"An FMU of {of} does not accept {option}: it does not support {OPTIONS[option]}.")


def _is_nonlinear(mechanism: Mechanism) -> bool:
    """Whether a linear model leaves something out."""
    return any(element.switch is not None for element in switching(mechanism).elements())


def fmu_archive(switches: SwitchingSystem, title: str, version: FmiVersion, platforms: Sequence[str]) -> bytes:
    """An FMU of a linear or a switching system, with libraries for this machine and for other platforms.

    Raises as `libraries`.
    """
    name = package_name(title or "vehicle")
    header = _header(switches)
    model = FmuModel(name, "", title or "vehicle", switches)
    told = header + (description_2(model, version.source) if version is FMI_2 else description_3(model))
    model = replace(model, token=hashlib.sha256(told.encode()).hexdigest()[:32])
    sources = {"model.h": f'#define TOKEN "{model.token}"\n{header}'}
    for file in ("engine.c", "instance.c", version.source):
        sources[file] = (files("inerter.exports.kinds.fmu") / file).read_text(encoding="utf-8")
    entries: dict[str, str | bytes] = {f"sources/{file}": text for file, text in sources.items()}
    if version is FMI_2:
        entries["modelDescription.xml"] = description_2(model, version.source)
    else:
        entries["modelDescription.xml"] = description_3(model)
        entries["sources/buildDescription.xml"] = build_description(model, version.source)
    for platform, library in libraries(sources, version.source, platforms):
        entries[f"binaries/{platform.folders[version.number]}/{name}{platform.suffix}"] = library
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in sorted(entries.items()):
            info = zipfile.ZipInfo(path, _DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    return content.getvalue()


def _header(switches: SwitchingSystem) -> str:
    """`model.h`: sizes, matrices, laws, parameters and their equations."""
    system, reactions = switches.system, len(switches.is_gap)
    equations, parameters = switches.equations, switches.parameters
    rows = np.zeros((1, 0, 0)) if equations is None else equations.rows
    entries = np.argwhere(rows)
    sizes = {
        "NX": len(system.states),
        "NE": len(switches.host_inputs),
        "NU": len(switches.inputs),
        "NR": reactions,
        "NY": len(system.outputs),
        "NM": len(switches.motions),
        "NP": len(parameters),
        "NETA": 0 if equations is None else equations.unknowns,
        "NENTRIES": len(entries),
        "MASSES": parameters.index(switches.host_masses[0]) if switches.host_masses else 0,
        "SPEED": -1 if switches.speed is None else parameters.index(switches.speed),
    }
    lines = [f"#define {name} {size}" for name, size in sizes.items()]
    lines += [f"#define SMALLEST {SMALLEST!r}", f"#define LARGEST {LARGEST!r}"]
    for what, several in (("states", system.states), ("inputs", system.inputs), ("outputs", system.outputs)):
        lines.append(f"/* {what}: {', '.join(one.label for one in several)} */")
    lines.append(f"/* parameters: {', '.join(NamedQuantity(one.name, one.unit).label for one in parameters)} */")
    lines += [f"/* {note} */" for note in system.notes]
    lines += [_matrix(name, getattr(system, name)) for name in "ABCD"]
    lines.append(_matrix("Q", switches.Q))
    places = [-1 if one is None else parameters.index(one) for one in switches.limits]
    gains = [
        0.0 if one is None else high / one.value if one.value else 1.0
        for one, high in zip(switches.limits or (), switches.upper, strict=True)
    ]
    lines += [
        _row("double", "LOW", switches.lower),
        _row("double", "HIGH", switches.upper),
        _row("double", "LIMIT_GAIN", gains),
        _row("int", "LIMIT", places),
        _row("int", "GAP", switches.is_gap),
        _row("int", "CREEPS", switches.creeps),
        _row("double", "START", [one.value for one in parameters]),
        _row("int", "TUNABLE", [one.is_tunable for one in parameters]),
        _row("int", "MAY_VANISH", [one.may_vanish for one in parameters]),
        _row("int", "SOURCE", switches.sources_of_inputs),
        _row("double", "DISTANCE", switches.distances or [0.0] * len(switches.inputs)),
        _row("int", "MOTION_STATE", [one.state for one in switches.motions]),
        _row("int", "MOTION_INPUT", [one.input for one in switches.motions]),
        _row("int", "MOTION_IS_RATE", [one.is_rate for one in switches.motions]),
        _row("int", "ENTRY_PARAMETER", entries[:, 0] - 1),
        _row("int", "ENTRY_ROW", entries[:, 1]),
        _row("int", "ENTRY_COLUMN", entries[:, 2]),
        _row("double", "ENTRY_VALUE", rows[tuple(entries.T)]),
    ]
    return "\n".join([*lines, ""])


def _row(kind: str, name: str, values: Iterable[float]) -> str:
    """An array in C, which may not be empty."""
    numbers = [float(one) if kind == "double" else int(one) for one in values] or [0]
    told = ("HUGE_VAL" if x == np.inf else "-HUGE_VAL" if x == -np.inf else repr(x) for x in numbers)
    return f"static const {kind} {name}[{len(numbers)}] = {{{', '.join(told)}}};"


def _matrix(name: str, matrix: Matrix) -> str:
    """A matrix in C, where no dimension may be zero."""
    rows, columns = (max(size, 1) for size in matrix.shape)
    whole = np.zeros((rows, columns))
    whole[: matrix.shape[0], : matrix.shape[1]] = matrix
    body = ",\n".join("    {" + ", ".join(map(repr, row)) + "}" for row in whole.tolist())
    return f"static const double {name}[{rows}][{columns}] = {{\n{body}\n}};"


_KIND = partial(
    ExportKind,
    suffixes=(".fmu",),
    requires="a C compiler",
    takes=("inputs", "outputs", "linear", "part", "speed", "platforms"),
)
FMU = _KIND(
    "fmu", "FMU of FMI 2.0 for co-simulation, with its sources", make=partial(_make, FMI_2), synonyms=("simulink",)
)
FMU3 = _KIND("fmu3", "FMU of FMI 3.0 for co-simulation, with its sources", make=partial(_make, FMI_3))
