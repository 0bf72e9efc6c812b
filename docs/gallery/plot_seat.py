"""
A driver on a seat
==================

Comfort as ISO 2631-1 weighs it, on the seat, with an inerter in the strut or in the seat.
"""

import matplotlib.pyplot as plt

import inerter as it

comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25), weighting="Wk")
k, ks = it.Spring(22e3), it.Spring(12e3, "ks")
c, cs = it.Damper(it.free(100, 10e3, "c")), it.Damper(it.free(50, 5e3, "cs"))
b, bs = it.Inerter(it.free(1, 500, "b")), it.Inerter(it.free(1, 200, "bs"))
layouts = {
    "S1": (k | c, ks | cs),
    "inerter in the strut": (k | c - b, ks | cs),
    "inerter in the seat": (k | c, ks | cs - bs),
}
found = {}
for name, (strut, seat) in layouts.items():
    car = it.Seat(it.QuarterCar(320, 40, 200e3, strut), 70.0, seat)
    found[name] = it.optimise(car, comfort, it.Norm(), seed=0).value
fig, ax = plt.subplots()
ax.barh(list(found), list(found.values()))
ax.set(xlabel="Weighted acceleration of the driver [m/s²]")
