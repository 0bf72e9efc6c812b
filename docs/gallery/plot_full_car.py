"""
Four wheels on two tracks
=========================

R.m.s. roll acceleration of a full car where left and right differ, over the distance of the tracks.
"""

import matplotlib.pyplot as plt

import inerter as it

strut = it.Spring(30e3) | it.Damper(2500)
car = it.FullCar(
    sprung_mass=1300, pitch_inertia=2000, roll_inertia=500, unsprung_mass_front=45, unsprung_mass_rear=45,
    tyre_stiffness_front=190e3, tyre_stiffness_rear=190e3, distance_front=1.2, distance_rear=1.5, track_front=1.5,
    track_rear=1.5, front=strut, rear=strut, anti_roll_front=it.Spring(15e3), anti_roll_rear=it.Spring(10e3),
)  # fmt: skip
tracks = [0.5, 1.0, 1.5, 2.0, 3.0]
values = []
for track in tracks:
    road = it.Road(roughness=1e-6, speed=25, coherence=it.Coherence.isotropic(track=track))
    values.append(it.evaluate(car, it.RandomResponse({"roll_acceleration": 1.0}, road), it.Norm()).value)
fig, ax = plt.subplots()
ax.plot(tracks, values, "o-")
ax.set(xlabel="Distance of the tracks of the surface [m]", ylabel="Roll acceleration [rad/s²]")
