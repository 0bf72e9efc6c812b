"""Registry of the kinds of exports, by key."""

from __future__ import annotations

from inerter.exports.drawings import LATEX, PDF, SVG
from inerter.exports.fmu.archive import FMU, FMU3
from inerter.exports.kind import ExportKind
from inerter.exports.matlab import MATLAB
from inerter.exports.modelica import MODELICA
from inerter.exports.python_objects import CONTROL, SCIPY
from inerter.exports.simulation_file import SIMULATION
from inerter.exports.spice import SPICE
from inerter.exports.tables import CSV, NETCDF
from inerter.registry import Registry

EXPORTS: Registry[ExportKind] = Registry(
    "kind of export",
    "key",
    ("description", "suffixes", "make"),
    (CONTROL, SCIPY, MATLAB, CSV, NETCDF, MODELICA, FMU, FMU3, SPICE, SVG, PDF, LATEX, SIMULATION),
)
