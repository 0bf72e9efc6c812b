"""
A bridge
========

Five arms between two ends and two inner nodes: not a series-parallel network. Its admittance is compared
with that without the middle arm.
"""

import inerter as it

arms = it.Spring(10e3), it.Damper(2e3), it.Inerter(50), it.Damper(1e3)
bridge = it.Bridge(*arms, it.Spring(20e3))
without = arms[0] - arms[1] | arms[2] - arms[3]
size, phase = it.plot_admittance({"without": without, "bridge": bridge})
