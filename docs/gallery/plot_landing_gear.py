"""
A landing gear on a runway
==========================

A bump of 40 mm and 10 m in the runway, taken at 60 m/s: force of the strut, with an inerter in series with the
damper or without.
"""

import matplotlib.pyplot as plt

import inerter as it


def gear(strut):
    return it.QuarterCar(sprung_mass=2500, unsprung_mass=60, tyre_stiffness=1.2e6, strut=it.Spring(150e3) | strut)


fig, ax = plt.subplots()
for name, strut in {"S1": it.Damper(20e3), "S3": it.Damper(25e3) - it.Inerter(800)}.items():
    run = it.simulate(gear(strut), road=it.bump(height=0.04, length=10.0, speed=60.0), duration=2.0)
    ax.plot(run.time, run["strut_force"] / 1e3, label=name)
ax.set(xlabel="Time [s]", ylabel="Strut force [kN]")
ax.legend()
