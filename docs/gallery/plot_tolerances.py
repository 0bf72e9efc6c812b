"""
Tolerances of a damper and an inertance
=======================================

Comfort of 1024 cars whose damper lies within 20 % and whose inertance within 10 % of the nominal value, all values
equally likely.
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


best = it.optimise(car(k | c - b), comfort, it.Norm(), seed=0)
scatter = it.tolerance_analysis(best.design, comfort, it.Norm(), spread={"c": 0.2, "b": 0.1}, seed=0)
fig, ax = plt.subplots()
ax.hist(scatter.values, bins=40)
ax.axvline(best.value, color="black", linestyle="--", label="nominal")
ax.axvline(scatter.quantile(0.95), color="tab:red", label="95 % are below")
ax.set(xlabel="J1 [m/s²]", ylabel="Cars")
ax.legend()
