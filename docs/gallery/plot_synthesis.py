"""
A network for an admittance
===========================

A biquadratic admittance as a network of springs, dampers and inerters.
"""

import inerter as it

network = it.realise([1.0, 2.0, 3.0], [1.0, 1.0, 1.0])
print(network.admittance(2j))
figure = it.plot_network(network, values=True)
