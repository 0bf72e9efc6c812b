"""
A measured road
===============

Density of a profile, the line through it, and its roughness index.
"""

import matplotlib.pyplot as plt
import numpy as np

import inerter as it

distance = np.arange(0, 2000, 0.1)
rng = np.random.default_rng(0)
heights = np.cumsum(rng.normal(size=distance.size)) * 6e-4
heights -= np.polyval(np.polyfit(distance, heights, 3), distance)
profile = it.Profile(distance, heights)
spectrum = it.road_spectrum(profile)
print(it.iri(profile), spectrum.waviness)
fig, ax = plt.subplots()
ax.loglog(spectrum.wavenumber, spectrum.density, linewidth=0.6)
ax.set(xlabel="Wavenumber [cycle/m]", ylabel="Density [m³]")
