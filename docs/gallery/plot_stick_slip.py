"""
Friction that sticks
====================

A ball screw with 60 N of friction on a random road; shaded where it sticks.
"""

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


screw = (it.Spring(1e6) | it.Damper(3200)) - (it.Inerter(328.7) | it.Friction(60, name="friction"))
run = it.simulate(car(k | it.Damper(7353) - screw), road=it.multisine(road, seed=0), duration=4.0)
axes = it.plot_trajectory(run, ["sprung_acceleration", "strut_force", "tyre_load"], window=(2.0, 4.0))
