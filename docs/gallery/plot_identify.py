"""
Parameters of a device from its record
======================================

Parameters of a device from a record of a virtual rig, with 95 % intervals.
"""

import inerter as it

rig = it.VirtualRig((it.Spring(1e6) | it.Damper(3200)) - (it.Inerter(113) | it.Friction(10)), seed=0)
record = rig.run(it.flat_multisine(0, 3e-4, 0.5, 20), 2.0)
fit = it.identify([record], "ball-screw", bandwidth=300.0)
for parameter in fit.parameters.values():
    print(parameter.name, parameter.value, parameter.interval, parameter.unit)
figure = it.plot_network(fit.device, values=True)
