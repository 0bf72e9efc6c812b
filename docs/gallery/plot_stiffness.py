"""
On which springs is an inerter worth it?
========================================

The best comfort of each layout over the stiffness of the spring: on soft springs an inerter is worth a few
per cent, on stiff ones a third. Figure 11 of Wang and Su (2008) is this curve.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
c, b = it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))
stiffness = np.linspace(10e3, 300e3, 15)
fig, ax = plt.subplots()
for name, part in {"S1": c, "S2": c | b, "S3": c - b}.items():
    values = [
        it.optimise(it.QuarterCar(181.75, 25, 120e3, it.Spring(k) | part), comfort, it.Norm(), seed=0).value
        for k in stiffness
    ]
    ax.plot(stiffness / 1e3, values, label=name)
ax.set(xlabel="Stiffness of the strut [kN/m]", ylabel="Best J1 [m/s²]")
ax.legend()
