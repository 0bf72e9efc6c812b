"""Simulation files: one motion of a vehicle or rig, requested in TOML, and its results."""

from inerter.files.common.kinds import FileKind

KIND = FileKind(
    "simulation files",
    "simulate",
    ("simulation", "signal"),
    __name__,
    "simulation_codec",
    "Vehicle or rig, elements, layouts and a signal. Every quantity is text with its unit.",
)
