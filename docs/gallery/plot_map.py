"""
Comfort over damper and inerter
===============================

Ride comfort of 2500 designs by one call, with the best of them.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


damping, inertance = np.geomspace(1e3, 3e4, 50), np.geomspace(30, 2000, 50)
grid = np.meshgrid(damping, inertance)
values = it.evaluate_many(car(k | c - b), comfort, {"c": grid[0].ravel(), "b": grid[1].ravel()}, it.Norm())
best = it.optimise(car(k | c - b), comfort, it.Norm(), seed=0)
fig, ax = plt.subplots()
drawn = ax.contourf(*grid, values.reshape(grid[0].shape), levels=np.linspace(2.4, 4.0, 17), extend="max")
ax.plot(best.parameters["c"], best.parameters["b"], "w*", markersize=10)
ax.set(xscale="log", yscale="log", xlabel="Damping [N s/m]", ylabel="Inertance [kg]")
fig.colorbar(drawn, label="J1 [m/s²]")
