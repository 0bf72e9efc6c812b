"""The archive of an FMU: description, sources, and the library that the C compiler of this machine makes of them."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError, WorkError
from inerter.exports.fmu.descriptions import FmuModel, build_description, description_2, description_3
from inerter.exports.fmu.switching import SwitchingSystem, switching_system, without_reactions
from inerter.exports.kind import ExportKind
from inerter.exports.modelica import package_name
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Element
from inerter.systems.graph import switching
from inerter.systems.linear import LinearSystem, check_names
from inerter.systems.outputs import main_outputs
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
_OPTIONS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
_DATE = (1980, 1, 1, 0, 0, 0)  # of all files, so that equal designs are equal archives
_LONGEST = 120.0  # of a compilation [s]


@dataclass(frozen=True)
class FmiVersion:
    """A version of FMI: its source file, and its name of this platform."""

    number: int
    source: str
    platform: str


FMI_2, FMI_3 = FmiVersion(2, "fmi2.c", "linux64"), FmiVersion(3, "fmi3.c", "x86_64-linux")


def _make_2(request: ExportSpec, suffix: str) -> bytes:
    return fmu_archive(_system(request), request.title, FMI_2)


def _make_3(request: ExportSpec, suffix: str) -> bytes:
    return fmu_archive(_system(request), request.title, FMI_3)


def _system(request: ExportSpec) -> SwitchingSystem:
    """The state space, by default with displacements that drift with the road too: they begin at zero."""
    if isinstance(request.of, LinearSystem):
        return without_reactions(replace(request, form="").system())
    mechanism = request.mechanism
    if not request.linear and _is_nonlinear(mechanism):
        wanted = None if request.outputs is None else check_names("outputs", request.outputs)
        return switching_system(mechanism, wanted, request.title)
    if request.outputs is None:
        request = replace(request, outputs=main_outputs(mechanism))
    return without_reactions(replace(request, form="").system())


def _is_nonlinear(mechanism: Mechanism) -> bool:
    """Whether a linear model leaves something out."""
    return any(element.switch is not None for element in _elements(mechanism))


def _elements(mechanism: Mechanism) -> Iterator[Element]:
    """Elements of the mechanism as simulation has them."""
    for mount in switching(mechanism).mounts():
        yield from mount.network.elements()


def fmu_archive(switches: SwitchingSystem, title: str, version: FmiVersion) -> bytes:
    """An FMU of a linear or a switching system.

    Raises `ExportError` where there is no C compiler, or on other platforms than Linux on x86-64; `WorkError` if the
    compiler fails.
    """
    name = package_name(title or "vehicle")
    header = _header(switches)
    system = replace(switches.system, inputs=switches.inputs)
    told = "".join([header, *(one.label for one in (*system.inputs, *system.outputs)), name, str(version.number)])
    token = hashlib.sha256(told.encode()).hexdigest()[:32]
    sources = {"model.h": f'#define TOKEN "{token}"\n{header}'}
    for file in ("engine.c", version.source):
        sources[file] = (files("inerter.exports.fmu") / file).read_text(encoding="utf-8")
    model = FmuModel(name, token, title or "vehicle", system)
    entries: dict[str, str | bytes] = {f"sources/{file}": text for file, text in sources.items()}
    if version is FMI_2:
        entries["modelDescription.xml"] = description_2(model, version.source)
    else:
        entries["modelDescription.xml"] = description_3(model)
        entries["sources/buildDescription.xml"] = build_description(model, version.source)
    entries[f"binaries/{version.platform}/{name}.so"] = _compile(sources, version.source)
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in sorted(entries.items()):
            info = zipfile.ZipInfo(path, _DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    return content.getvalue()


def _compile(sources: dict[str, str], main: str) -> bytes:
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        raise ExportError("FMUs are made on Linux on x86-64 only. Export the design there.")
    if compiler is None:
        raise ExportError("An FMU needs a C compiler, and there is none called cc. Install one, or name it in CC.")
    with tempfile.TemporaryDirectory() as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        command = [compiler, *_OPTIONS, "-o", "model.so", main, "-lm"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=_LONGEST, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise WorkError(f"The C compiler {compiler} failed: {error}.") from None
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if "error" in line] or ["no message"]
            raise WorkError(f"The C compiler {compiler} failed: {lines[0]}.")
        return (Path(folder) / "model.so").read_bytes()


def _header(switches: SwitchingSystem) -> str:
    system, reactions = switches.system, len(switches.is_gap)
    sizes = {"NX": len(system.states), "NU": len(switches.inputs), "NR": reactions, "NY": len(system.outputs)}
    lines = [f"#define {name} {size}" for name, size in sizes.items()]
    for what, several in (("states", system.states), ("inputs", system.inputs), ("outputs", system.outputs)):
        lines.append(f"/* {what}: {', '.join(one.label for one in several)} */")
    lines += [f"/* {note} */" for note in system.notes]
    lines += [_array(name, getattr(system, name)) for name in "ABCD"]
    lines.append(_array("Q", switches.Q))
    limits = {"LOW": switches.lower, "HIGH": switches.upper, "GAP": np.array(switches.is_gap, dtype=float)}
    for name, values in limits.items():
        numbers = ", ".join(
            "HUGE_VAL" if x == np.inf else "-HUGE_VAL" if x == -np.inf else repr(x) for x in values.tolist()
        )
        lines.append(f"static const double {name}[{max(reactions, 1)}] = {{{numbers or '0.0'}}};")
    return "\n".join([*lines, ""])


def _array(name: str, matrix: Matrix) -> str:
    """A matrix in C, where no dimension may be zero."""
    rows, columns = (max(size, 1) for size in matrix.shape)
    whole = np.zeros((rows, columns))
    whole[: matrix.shape[0], : matrix.shape[1]] = matrix
    body = ",\n".join("    {" + ", ".join(map(repr, row)) + "}" for row in whole.tolist())
    return f"static const double {name}[{rows}][{columns}] = {{\n{body}\n}};"


FMU = ExportKind("fmu", "FMU of FMI 2.0 for co-simulation, with its sources", (".fmu",), _make_2, "a C compiler")
FMU3 = ExportKind("fmu3", "FMU of FMI 3.0 for co-simulation, with its sources", (".fmu",), _make_3, "a C compiler")
