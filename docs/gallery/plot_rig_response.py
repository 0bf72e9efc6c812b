"""
Dynamic stiffness of a record
=============================

Measured force over displacement with its band, and the linear device.
"""

import matplotlib.pyplot as plt

import inerter as it

device = (it.Spring(1e6) | it.Damper(3200)) - (it.Inerter(113) | it.Friction(10))
record = it.VirtualRig(device, seed=0).run(it.flat_multisine(0, 3e-4, 0.5, 20), 16.0)
found = it.frequency_response(record)
linear = it.linear_response(device, found.omega)
fig, ax = plt.subplots()
ax.loglog(found.frequency, found.gain, ".", label="measured")
ax.loglog(found.frequency, linear.gain, label="without friction")
ax.set(xlabel="Frequency [Hz]", ylabel="Dynamic stiffness [N/m]")
ax.legend()
