"""
A design that bears scatter
===========================

Best at the 95 % quantile instead of at its nominal values: a little worse where all is right, better where it
is not.
"""

import matplotlib.pyplot as plt

import inerter as it

road = it.Road(roughness=5e-7, speed=25)
comfort, grip = it.RideComfort(road), it.TyreLoad(road)
k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))


def car(strut):
    return it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)


spread = {"c": 0.3, "b": 0.3}
nominal = it.optimise(car(k | c - b), comfort, it.Norm(), seed=0).design
robust = it.optimise_robust(car(k | c - b), comfort, it.Norm(), spread=spread, samples=64, seed=0).design
fig, ax = plt.subplots()
for name, design in {"nominal": nominal, "robust": robust}.items():
    scatter = it.tolerance_analysis(design, comfort, it.Norm(), spread=spread, seed=0)
    print(name, scatter.quantile(0.95))
    ax.hist(scatter.values, bins=40, histtype="step", label=name)
ax.set(xlabel="J1 [m/s²]", ylabel="Cars")
ax.legend()
