"""
A building in an earthquake
===========================

R.m.s. sway of a building in its first mode, over the inertance between its absorber and the ground.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

k, c = it.Spring(it.free(1e3, 1e6, "k")), it.Damper(it.free(100, 1e6, "c"))
soil = it.Filter([18.72, 243.36], [1.0, 18.72, 243.36])  # Kanai-Tajimi, highest power first
shaking = it.FilteredExcitation(it.GroundAcceleration(0.02), soil)
sway = it.RandomResponse({"primary_relative_displacement": 1.0}, shaking)
inertances = np.array([1.0, 500.0, 2e3, 5e3, 10e3, 20e3])
values = [
    it.optimise(
        it.Absorber(100e3, 4e6, 2e3, k | c, ground=it.Inerter(b), primary_damping=25e3), sway, it.Norm(), seed=0
    ).value
    for b in inertances
]
fig, ax = plt.subplots()
ax.plot(inertances / 1e3, np.array(values) * 1e3, "o-")
ax.set(xlabel="Inertance to the ground [t]", ylabel="R.m.s. sway [mm]")
