"""
Admittance of a strut
=====================

Force over velocity at each frequency: -90 degrees is a spring, 0 a damper, 90 an inerter. In series the
inerter takes the damper out at low frequencies, where only the spring is left.
"""

import inerter as it

k, c, b = it.Spring(120e3), it.Damper(7544.0), it.Inerter(366.5)
size, phase = it.plot_admittance({"S1": k | it.Damper(4981.0), "S2": k | c | b, "S3": k | c - b})
