"""
Roads of ISO 8608
=================

Spectral density of the classes A to E, and the comfort on each of them.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


wavenumber = np.geomspace(0.01, 10, 50)
fig, ax = plt.subplots()
for letter in "ABCDE":
    own = it.Road.iso8608(letter, speed=25)
    ax.loglog(wavenumber, 2 * own.roughness / wavenumber**2, label=letter)
    print(letter, it.evaluate(car(k | it.Damper(4981)), it.RideComfort(own), it.Norm()).value)
ax.set(xlabel="Wavenumber [cycle/m]", ylabel="Displacement PSD, one-sided [m³]")
ax.legend(title="class")
