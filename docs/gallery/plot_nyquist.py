"""
Tyre load in the complex plane
==============================

Response from the velocity of the road to the force of the tyre.
"""

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


designs = {"S1": car(k | it.Damper(4981)), "S3": car(k | it.Damper(7544) - it.Inerter(366.5))}
ax = it.plot_nyquist(designs, ("road", "tyre_load"))
