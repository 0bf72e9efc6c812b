"""MATLAB and Octave: matrices in a file of version 5, or a script that builds `ss` or `dss`; channels of a record."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import ExportError
from inerter.exports.kind import LINEAR_MODEL, ExportKind
from inerter.exports.named_system import NamedQuantity, NamedSystem
from inerter.exports.request import ExportSpec
from inerter.records.writers import write_record_matlab

Matrix = NDArray[np.float64]


def _make(request: ExportSpec, suffix: str) -> str | bytes:
    if (record := request.record) is not None:
        if suffix == ".m":
            raise ExportError("A record goes to MATLAB as a .mat file; a script holds a linear model.")
        content = io.BytesIO()
        write_record_matlab(record, content)
        return content.getvalue()
    # A descriptor keeps digits far below all resonances that elimination of its unknowns would lose.
    system = request.system("descriptor")
    return matlab_script(system) if suffix == ".m" else matlab_file(system)


def matlab_file(system: NamedSystem) -> bytes:
    """Variables A, B, C, D, E of a descriptor, and names, units, notes and title."""
    data: dict[str, object] = {**_matrices(system)}
    for what, several in _quantities(system).items():
        data[f"{what.lower()}_names"] = _cells([one.name for one in several])
        data[f"{what.lower()}_units"] = _cells([one.unit for one in several])
    data |= {"notes": _cells(system.notes), "title": system.title}
    content = io.BytesIO()
    scipy.io.savemat(content, data, format="5", oned_as="column")  # type: ignore[arg-type]
    return re.sub(
        rb"\A.{116}", b"MATLAB 5.0 MAT-file, written by inerter".ljust(116), content.getvalue(), flags=re.DOTALL
    )


def matlab_script(system: NamedSystem) -> str:
    """A script that makes the variable `sys`; numbers have 17 digits."""
    lines = [f"% {' '.join(system.title.split())}, written by inerter", *(f"% {note}" for note in system.notes)]
    for name, matrix in _matrices(system).items():
        lines += _matrix_lines(name, matrix)
    lines.append("sys = ss(A, B, C, D);" if system.E is None else "sys = dss(A, B, C, D, E);")
    named = _quantities(system).items()
    lines += [f"sys.{what}Name = {_cell_text([one.name for one in several])};" for what, several in named]
    lines.append("if ~exist('OCTAVE_VERSION', 'builtin')  % whose systems have no units")
    lines += [f"    sys.{what}Unit = {_cell_text([one.unit for one in several])};" for what, several in named]
    return "\n".join([*lines, "end", ""])


def _matrices(system: NamedSystem) -> dict[str, Matrix]:
    """Matrices of a system by their names; E of a descriptor alone."""
    matrices = {"A": system.A, "B": system.B, "C": system.C, "D": system.D}
    return matrices if system.E is None else {**matrices, "E": system.E}


def _quantities(system: NamedSystem) -> dict[str, Sequence[NamedQuantity]]:
    """States, inputs and outputs of a system, by the words that begin the names of their properties."""
    return {"State": system.states, "Input": system.inputs, "Output": system.outputs}


def _cells(texts: Sequence[str]) -> NDArray[np.object_]:
    found = np.empty((len(texts), 1), dtype=object)
    found[:, 0] = texts
    return found


def _cell_text(texts: Sequence[str]) -> str:
    quoted = ("'" + text.replace("'", "''") + "'" for text in texts)
    return "{" + "; ".join(quoted) + "}"


def _matrix_lines(name: str, matrix: Matrix) -> list[str]:
    if not matrix.size:
        return [f"{name} = zeros({matrix.shape[0]}, {matrix.shape[1]});"]
    rows = [" ".join(map(exact, row)) for row in matrix.tolist()]
    return [f"{name} = [", *(f"    {row}" for row in rows), "];"]


def exact(number: float) -> str:
    """A number with the digits that read back to the last bit."""
    return repr(float(number)) if number else "0"


MATLAB = ExportKind(
    "matlab",
    "matrices with names and units for MATLAB and Octave",
    (".mat", ".m"),
    _make,
    takes=LINEAR_MODEL,
    synonyms=("octave",),
)
