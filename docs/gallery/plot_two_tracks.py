"""
Left and right track
====================

Two tracks of a random surface that is as rough in every direction: alike in long waves, different in short
ones.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

road = it.Road(roughness=5e-7, speed=25, coherence=it.Coherence.isotropic(track=1.5))
left, right = it.two_tracks(road, seed=0, highest=50.0).values()  # Hz: waves of half a metre
time = np.linspace(0, 2, 2000)
fig, ax = plt.subplots()
for name, track in {"left": left, "right": right}.items():
    ax.plot(25 * time, 1e3 * track.sample(time)[0], label=name)
ax.set(xlabel="Distance [m]", ylabel="Height [mm]")
ax.legend()
