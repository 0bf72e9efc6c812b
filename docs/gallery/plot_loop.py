"""
Loop of a device on a rig
=========================

Force over displacement of a ball screw at 3 Hz: friction makes the jumps at both ends, the inertance the
slope.
"""

import inerter as it

device = (it.Spring(1e6) | it.Damper(3200)) - (it.Inerter(113) | it.Friction(10))
run = it.simulate(it.Rig(device), displacement=it.sine(1e-3, 3.0), duration=2.0)
ax = it.plot_loop(run, "displacement", "device_force", window=(1.0, 2.0))
