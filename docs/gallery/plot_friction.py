"""
How much friction takes the gain away?
======================================

Comfort of a real device over its friction, by statistical linearisation (line) and by simulation on random
roads (points with two standard errors), against the best conventional strut. Where friction sticks for a part of
the time, one damper represents it poorly, and the estimates say that they are inaccurate (dotted). At the end
of the line the linearised friction sticks for good: the value is that of a rigid link, which the simulated device
approaches only slowly.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


shaft = it.Spring(1e6) | it.Damper(3200)


def real(friction):
    return car(k | it.Damper(7353) - shaft - (it.Inerter(328.7) | it.Friction(friction)))


forces = np.linspace(5, 600, 30)
line = [it.evaluate(real(f), comfort, it.StatisticalLinearisation()) for f in forces]
values, accurate = np.array([e.value for e in line]), np.array([e.status.ok for e in line])
some = np.array([10.0, 150.0, 300.0, 450.0])
found = [it.evaluate(real(f), comfort, it.ExpectedValue(realisations=8, seed=0)) for f in some]
fig, ax = plt.subplots()
ax.plot(forces, np.where(accurate, values, np.nan), "C0", label="statistical linearisation")
ax.plot(forces, values, "C0:", label="the same, where inaccurate")
ax.errorbar(some, [e.value for e in found], [2 * e.standard_error for e in found], fmt="C1o", label="simulation")
ax.axhline(it.evaluate(car(k | it.Damper(4981)), comfort, it.Norm()).value, color="black", linestyle="--", label="S1")
ax.set(xlabel="Friction [N]", ylabel="J1 [m/s²]")
ax.legend()
