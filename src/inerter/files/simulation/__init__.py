"""Simulation files: one motion of a vehicle or rig, asked for in TOML, and what comes of it."""

from inerter.files.common.kinds import FileKind

KIND = FileKind("simulation files", "simulate", ("simulation", "signal"), __name__)
