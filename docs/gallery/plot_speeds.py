"""
At every speed
==============

One design from 5 to 50 m/s: on a road of waviness 2 both values grow as the square root of speed, so that the gain is
the same at every speed.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


designs = {"S1": car(k | it.Damper(4981)), "S3": car(k | it.Damper(7544) - it.Inerter(366.5))}
speeds = np.linspace(5, 50, 10)
fig, ax = plt.subplots()
for name, design in designs.items():
    index = [it.RideComfort(it.Road(roughness=5e-7, speed=speed)) for speed in speeds]
    ax.plot(speeds, [it.evaluate(design, each, it.Norm()).value for each in index], label=name)
ax.set(xlabel="Speed [m/s]", ylabel="J1 [m/s²]")
ax.legend()
