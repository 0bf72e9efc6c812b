"""
Layouts as drawings
===================

The eight layouts of Smith and Wang (2004), drawn from their networks. K carries the car; kb, k1 and k2 are further
springs.
"""

import inerter as it

values = {"K": 120e3, "kb": 200e3, "k1": 60e3, "k2": 90e3}
elements = {"c": it.Damper(3e3), "b": it.Inerter(100.0)} | {name: it.Spring(k, name) for name, k in values.items()}
layouts = {
    layout.name: it.network(layout.expression, **elements)
    for layout in it.LAYOUTS.values()
    if layout.source.startswith("Smith and Wang (2004)")
}
figure = it.plot_network(layouts)
