"""
Poles with and without an inerter
=================================

The body on its conventional strut has one mode, at 3.05 Hz with a damping ratio of 0.15. With the inerter in series it
has two: one at 2.37 Hz, with the same damping ratio, and one at 4.70 Hz with 0.38.
"""

import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


designs = {"S1": car(k | it.Damper(4981)), "S3": car(k | it.Damper(7544) - it.Inerter(366.5))}
for name, design in designs.items():
    for pole in np.linalg.eigvals(it.state_space(design).A):
        if pole.imag > 0:
            print(f"{name}: {abs(pole) / (2 * np.pi):.2f} Hz, damping ratio {-pole.real / abs(pole):.2f}")
ax = it.plot_poles(designs)
