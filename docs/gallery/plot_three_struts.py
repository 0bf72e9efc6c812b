"""
Three struts of a quarter car
=============================

The best conventional strut, and the best with an inerter in parallel or in series with the damper. Each is
optimal for ride comfort; the inerter in series lowers the peak at
the body's resonance by a third; somewhat below that and from 5 to 10 Hz the response is a little larger.
"""

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


struts = {"S1": k | c, "S2": k | c | b, "S3": k | c - b}
best = {name: it.optimise(car(strut), comfort, it.Norm(), seed=0).design for name, strut in struts.items()}
for name, design in best.items():
    print(name, it.evaluate(design, comfort, it.Norm()).value)
gain, phase = it.plot_bode(best, comfort)
