"""
Over a bump
===========

A bump of 50 mm, 1 m long, at 5 m/s: a real wheel would lift off where the tension of its tyre exceeds the
static load; the model, whose tyre can pull, reports that.
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


designs = {"S1": car(k | it.Damper(4981)), "S3": car(k | it.Damper(7544) - it.Inerter(366.5))}
fig, ax = plt.subplots()
for name, design in designs.items():
    run = it.simulate(design, road=it.bump(height=0.05, length=1.0, speed=5.0), duration=1.5)
    ax.plot(run.time, run["tyre_load"], label=name)
    print(name, *run.notes)
ax.set(xlabel="Time [s]", ylabel="Dynamic tyre load [N]")
ax.legend()
