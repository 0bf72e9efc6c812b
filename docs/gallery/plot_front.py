"""
Comfort against load carrying
=============================

Every design on a curve is the most comfortable for its compliance under load. The circle is the knee.
"""

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


fronts = {
    name: it.pareto_front(car(strut), [comfort, it.LoadCarrying()], it.Norm(), points=15, seed=0)
    for name, strut in {"S1": k | c, "S3": k | c - b}.items()
}
ax = it.plot_front(fronts)
