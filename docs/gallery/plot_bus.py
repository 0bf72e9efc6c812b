"""
A bus, empty and full
=====================

One damper and one inerter for all loads, on springs of constant stiffness. (That of an air spring grows with its load.)
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=2e-6, speed=20)
comfort = it.RideComfort(road, weighting="Wk")


def bus(mass, strut):
    return it.QuarterCar(sprung_mass=mass, unsprung_mass=400, tyre_stiffness=1.6e6, strut=strut)


k = it.Spring(200e3)
c, b = it.Damper(it.free(1e3, 100e3, "c")), it.Inerter(it.free(10, 10e3, "b"))
masses = [3000, 3500, 4000, 4500]
fig, ax = plt.subplots()
for name, part in {"S1": k | c, "S3": k | c - b}.items():
    best = it.optimise(bus(3750, part), comfort, it.Norm(), seed=0)
    fixed = {"c": best.parameters["c"], "b": best.parameters.get("b", 1.0)}
    own = k | it.Damper(fixed["c"]) if name == "S1" else k | it.Damper(fixed["c"]) - it.Inerter(fixed["b"])
    ax.plot(masses, [it.evaluate(bus(m, own), comfort, it.Norm()).value for m in masses], "o-", label=name)
ax.set(xlabel="Body mass at an axle [kg]", ylabel="Weighted acceleration [m/s²]")
ax.legend()
