"""
Which network is best?
======================

All networks of up to three elements in parallel with the spring: what one more element gains.
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


part = it.any_network(max_elements=3, springs=(1e3, 1e7), dampers=(10, 1e6), inerters=(0.01, 1e5))
found = it.search(car(k | part), comfort, it.Norm(), seed=0)
fig, ax = plt.subplots()
ax.plot([one.n_elements for one in found.ranking], [one.value for one in found.ranking], ".", color="#999999")
ax.plot([one.n_elements for one in found.frontier], [one.value for one in found.frontier], "o-")
for one in found.frontier:
    ax.annotate(one.layout, (one.n_elements, one.value), textcoords="offset points", xytext=(6, 6))
ax.set(xlabel="Elements in parallel with the spring", ylabel="Best J1 [m/s²]", ylim=(2.3, 3.1), xticks=[1, 2, 3])
