"""
A tuned mass damper with an inerter
===================================

An absorber of 5 % of the mass, tuned for the least peak; an inerter to the ground makes its mass as large as
one likes.
"""

import inerter as it

k, c = it.Spring(it.free(100, 200e3, "k")), it.Damper(it.free(1, 50e3, "c"))
peak = it.LoadCarrying()
best = {
    "none": it.Absorber(1000, 40e3, 1e-3, it.Spring(1.0) | it.Damper(1.0), primary_damping=100),
    "TMD": it.optimise(it.Absorber(1000, 40e3, 50, k | c, primary_damping=100), peak, it.Norm(), seed=0).design,
    "TMDI": it.optimise(
        it.Absorber(1000, 40e3, 50, k | c, ground=it.Inerter(100), primary_damping=100), peak, it.Norm(), seed=0
    ).design,
}
gain, phase = it.plot_bode(best, peak)
