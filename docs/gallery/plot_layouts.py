"""
Layouts as drawings
===================

The eight layouts of the literature, drawn from their networks.
"""

import inerter as it

k, c, b = it.Spring(120e3), it.Damper(3e3), it.Inerter(100.0)
k1, k2 = it.Spring(60e3, "k1"), it.Spring(90e3, "k2")
layouts = {
    "S1": k | c,
    "S2": k | c | b,
    "S3": k | c - b,
    "S4": k | c - k1,
    "S5": k | c - k1 - b,
    "S6": k | (c | k1) - b,
    "S7": k | c - (b | k1),
    "S8": k | (c | k1) - (b | k2),
}
figure = it.plot_network(layouts)
