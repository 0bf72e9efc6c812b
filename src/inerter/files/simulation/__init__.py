"""Simulation files: one motion of a vehicle or rig, asked for in TOML, and what comes of it."""
