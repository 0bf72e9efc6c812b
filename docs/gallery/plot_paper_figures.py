"""
Figures of Wang and Su (2008)
=============================

Figures 9, 11 and 12 of the paper, drawn anew. ``inerter reproduce wang-su-2008 -o paper`` draws the others too, those
with friction on the road among them, and compares every printed number and claim.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

# %%
# Figure 9: force of the ball screw at 3 Hz, on a virtual rig with the printed parameters, since the records are not
# published. Its load cell is a little late.
soft = it.Spring(1e6) | it.Damper(3200)
screw = soft - (it.Inerter(113) | it.Friction(10))
record = it.VirtualRig(screw, seed=1).run(it.cosine(1e-3, 3.0), duration=3.0)
model = it.simulate(it.Rig(screw), displacement=it.cosine(1e-3, 3.0), duration=3.0)
fig9, ax = plt.subplots()
ax.plot(record.time, record.force, color="0.6", label="measured (virtual rig)")
ax.plot(model.time, model["device_force"], label="model")
ax.set(xlabel="Time [s]", ylabel="Force [N]", xlim=(2, 3))
ax.legend()

# %%
# Figure 11: best value of each index and its improvement over the static stiffness, for ideal inerters and for
# elastic ones, whose shafts are hard or soft.
road = it.Road(roughness=5e-7, speed=25)
indices = {
    "J1 [m/s²]": (it.RideComfort(road), 1.0),
    "J3 [N]": (it.TyreLoad(road), 1.0),
    "J5 [µm/N]": (it.LoadCarrying(), 1e6),
}
hard = it.Spring(2e6) | it.Damper(6400)
c, b = it.Damper(it.free(100, 100e3, "c")), it.Inerter(it.free(1, 2000, "b"))
struts = {"S1": c, "S2": c | b, "S2 hard": c | hard - b, "S2 soft": c | soft - b}
struts |= {"S3": c - b, "S3 hard": c - hard - b, "S3 soft": c - soft - b}
stiffness = np.linspace(10e3, 300e3, 15)


def best(part, index):
    cars = [it.QuarterCar(181.75, 25, 120e3, it.Spring(k) | part) for k in stiffness]
    return np.array([it.optimise(car, index, it.Norm(), seed=0).value for car in cars])


fig11, axes = plt.subplots(3, 2, figsize=(8, 9), sharex=True, layout="constrained")
for (name, (index, scale)), (left, right) in zip(indices.items(), axes, strict=True):
    values = {strut: best(part, index) for strut, part in struts.items()}
    for strut, value in values.items():
        colour = {"S1": "black", "S2": "tab:blue", "S3": "tab:orange"}[strut[:2]]
        style = "--" if strut == "S1" else {"": "-", "hard": "--", "soft": ":"}[strut[3:]]
        left.plot(stiffness / 1e3, scale * value, color=colour, linestyle=style, label=strut)
        right.plot(stiffness / 1e3, 100 * (1 - value / values["S1"]), color=colour, linestyle=style)
    left.set_ylabel(f"Best {name}")
    right.set_ylabel(f"Improvement of {name[:2]} [%]")
for ax in axes[-1]:
    ax.set_xlabel("Static stiffness [kN/m]")
fig11.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=7)

# %%
# Figure 12: a road of eq. (17), harmonics of 0.1 Hz with random phases.
time = np.arange(10001) * 1e-3
fig12, ax = plt.subplots()
ax.plot(time, 1e3 * it.multisine(road, seed=0).grid(0.0, 1e-3, time.size)[0])
ax.set(xlabel="Time [s]", ylabel="Road height [mm]", xlim=(0, 10))
