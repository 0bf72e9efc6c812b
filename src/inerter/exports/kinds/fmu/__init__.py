"""Functional mock-up units (FMI 2.0 and 3.0) for co-simulation, in C99 without Python."""

from inerter.exports.kinds.fmu.archive import FMU as FMU
from inerter.exports.kinds.fmu.archive import FMU3 as FMU3
