"""
The cost of a limit
===================

The best comfort of S3 where the dynamic compliance under load is limited.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


limits = np.linspace(28e-6, 64e-6, 10)
values = [
    it.optimise(car(k | c - b), comfort, it.Norm(), subject_to=[it.at_most(it.LoadCarrying(), limit)], seed=0).value
    for limit in limits
]
fig, ax = plt.subplots()
ax.plot(limits * 1e6, values, "o-")
ax.set(xlabel="J5 at most [µm/N]", ylabel="Best J1 [m/s²]")
