"""
A railway coach on two bogies
=============================

Comfort at the end of a coach over its speed, with an inerter in the secondary suspension or without: four
wheels meet the rail one after the other.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

axles = {"1": 10.78, "2": 8.22, "3": -8.22, "4": -10.78}  # m ahead of the middle


def coach(secondary):
    primary = it.Spring(1.2e6) | it.Damper(10e3) - it.Spring(10e6)
    ends = {"front": 9.5, "rear": -9.5}
    places = {"1": ("front", 1.28), "2": ("front", -1.28), "3": ("rear", 1.28), "4": ("rear", -1.28)}
    return it.Mechanism(
        coordinates=(
            it.Coordinate("body", 19e3),
            it.Coordinate("pitch", 600e3, angle=True),
            *(it.Coordinate(f"bogie_{end}", 1.6e3) for end in ends),
            *(it.Coordinate(f"bogie_pitch_{end}", 900.0, angle=True) for end in ends),
        ),
        struts=tuple(
            it.Strut(end, secondary, upper={"body": 1.0, "pitch": arm}, lower={f"bogie_{end}": 1.0})
            for end, arm in ends.items()
        ),
        tyres=tuple(
            it.Tyre(f"primary_{n}", primary, {f"bogie_{end}": 1.0, f"bogie_pitch_{end}": arm}, f"rail_{n}")
            for n, (end, arm) in places.items()
        ),
        roads=tuple(it.RoadInput(f"rail_{n}", distance=10.78 - place) for n, place in axles.items()),
        points=(it.TrackedPoint("end", {"body": 1.0, "pitch": 9.5}),),
    )


speeds = np.linspace(20, 70, 11)
fig, ax = plt.subplots()
k = it.Spring(400e3)
for name, part in {"S1": it.Damper(30e3), "S3": it.Damper(40e3) - it.Inerter(4e3)}.items():
    index = [it.RandomResponse({"end_acceleration": 1.0}, it.Road(roughness=3e-9, speed=v)) for v in speeds]
    ax.plot(speeds, [it.evaluate(coach(k | part), each, it.Norm()).value for each in index], label=name)
ax.set(xlabel="Speed [m/s]", ylabel="Acceleration at the end [m/s²]")
ax.legend()
