"""
Where the energy goes
=====================

Work of the road, and what dampers and friction take of it: the balance closes to rounding.
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


screw = (it.Spring(1e6) | it.Damper(3200, "cs")) - (it.Inerter(328.7) | it.Friction(60, name="friction"))
design = car(k | it.Damper(7353) - screw)
run = it.simulate(design, road=it.multisine(road, seed=0), duration=10.0, energy=True)
print(run.energy.relative_residual)
taken = {**run.energy.dampers, **run.energy.friction, "stored": run.energy.stored}
fig, ax = plt.subplots()
ax.barh(list(taken), list(taken.values()))
ax.set(xlabel="Energy in 10 s [J]")
