"""State spaces of python-control and of SciPy."""

from __future__ import annotations

from inerter.exports.kind import LINEAR_MODEL, ExportKind

CONTROL = ExportKind(
    "control",
    "StateSpace of python-control, in Python only",
    (),
    lambda request, suffix: request.system().to_control(),
    takes=LINEAR_MODEL,
)
SCIPY = ExportKind(
    "scipy",
    "StateSpace of SciPy, in Python only",
    (),
    lambda request, suffix: request.system().to_scipy(),
    takes=LINEAR_MODEL,
)
