"""
Backlash that rattles
=====================

A gap of 0.05 mm to each side in the shaft of the device; shaded where it is open.
"""

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


screw = (it.Spring(1e6) | it.Damper(3200)) - it.Gap(5e-5, name="gap") - (it.Inerter(328.7) | it.Friction(10))
run = it.simulate(car(k | it.Damper(7353) - screw), road=it.cosine(1e-3, 3.0), duration=3.0)
axes = it.plot_trajectory(run, ["sprung_acceleration", "tyre_load"], window=(2.0, 3.0))
