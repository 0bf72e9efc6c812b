"""Candidate devices by name, with every value free within wide bounds."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import sub
from types import MappingProxyType

from inerter.formatting import format_list
from inerter.networks.elements import (
    Damper,
    Element,
    Free,
    Friction,
    Gap,
    Inerter,
    Network,
    Series,
    Spring,
    check_network,
    free,
)
from inerter.networks.elements.roles import GuardRole
from inerter.networks.parser import names, network
from inerter.networks.transform import map_elements
from inerter.vehicle.rig import Rig

_ELEMENTS: dict[str, Network] = {
    "ks": Spring(free(1e4, 1e8, name="ks")),
    "cs": Damper(free(10.0, 2e5, name="cs")),
    "gap": Gap(free(0.0, 2e-3, name="gap")),
    "b": Inerter(free(0.5, 5000.0, name="b")),
    "f": Friction(free(0.0, 500.0, name="f")),
    "c": Damper(free(1.0, 2e4, name="c")),
}
# in series with the inerter, and in parallel: Wang and Su (2008), Figure 6b, and its parts
_ROWS = {
    "ideal": ("", "b"),
    "friction": ("", "b | f"),
    "elastic": ("(ks | cs) - ", "b"),
    "elastic-friction": ("(ks | cs) - ", "b | f"),
    "backlash": ("(ks | cs) - gap - ", "b"),
    "ball-screw": ("(ks | cs) - gap - ", "b | f"),
}
VISCOUS: Mapping[str, str] = MappingProxyType({name: f"{name}-viscous" for name in _ROWS})
"""Names of models without a damper in parallel with the inerter, and the name of each with one."""


def _model(before: str, parallel: str) -> Network:
    text = f"{before}({parallel})"
    return network(text, **{name: element for name, element in _ELEMENTS.items() if name in names(text)})


MODELS: Mapping[str, Network] = MappingProxyType(
    {
        **{name: _model(*parts) for name, parts in _ROWS.items()},
        **{VISCOUS[name]: _model(before, f"{parallel} | c") for name, (before, parallel) in _ROWS.items()},
    }
)
"""From the ideal inerter to the ball screw of Wang and Su (2008): shaft `ks` [N/m] in parallel with `cs` [N s/m],
backlash `gap` [m] to each side, inertance `b` [kg], friction `f` [N]; each also `-viscous`, with a damper `c` [N s/m]
in parallel with the inerter. Shorter chains are parts of longer ones, so that a fit can be compared with those of its
parts."""
_WORDS = {"f": "dry friction", "c": "viscous damping", "ks": "an elastic shaft", "gap": "backlash"}


def model_words(name: str) -> str:
    """A model of the catalogue in words.

    >>> model_words("ball-screw")
    'inerter with dry friction, an elastic shaft and backlash'
    """
    labels = {element.label for element in MODELS[name].elements()}
    parts = [words for label, words in _WORDS.items() if label in labels]
    return f"inerter with {format_list(parts)}" if parts else "ideal inerter"


MOUNT = Spring(2e8, name="mount_k") | Damper(2e4, name="mount_c")  # deflects by 1 um under 200 N
_STANDING = 300.0  # [Hz] default bandwidth of the load cell under a rigid device; the force does not depend on it


def on_rig(model: Network, cell_bandwidth: float | None) -> Rig:
    """`model` on a rig with a load cell of this bandwidth [Hz].

    The force of sticking dry friction on a table is determined only with some compliance: for a rigid device that is a
    load cell of 1e13 N/m, whether its bandwidth is known or not.

    >>> on_rig(Inerter(113.0), None).cell_bandwidth, on_rig(Spring(1e4), None).cell_bandwidth
    (300.0, None)
    """
    return Rig(model, _STANDING if cell_bandwidth is None and is_rigid(model) else cell_bandwidth)


def with_mount(model: Network) -> Network:
    """`model` with a very stiff mount in series if its gaps would strike between inertias, else unchanged.

    >>> with_mount(Gap(1e-4) - Inerter(113.0)) == MOUNT - Gap(1e-4) - Inerter(113.0)
    True
    >>> with_mount(Inerter(113.0)) == Inerter(113.0)
    True
    """
    return (
        MOUNT - model
        if is_rigid(model) and any(e.switches_by(GuardRole.ELONGATION) for e in model.elements())
        else model
    )


def without_mount(model: Network) -> Network:
    """The device without the mount of `with_mount`."""
    parts = model.parts if isinstance(model, Series) else ()
    return reduce(sub, parts[1:]) if len(parts) > 1 and parts[0] == MOUNT else model


def is_rigid(model: Network) -> bool:
    """Whether a device is rigid, so that its admittance grows without bound."""
    check_network(model)
    low, high = (complex(abs(map_elements(model, _midway).admittance(1j * omega))) for omega in _FAST)
    return abs(high) > _RISES * abs(low) or not abs(high) < float("inf")


_FAST, _RISES = (1e9, 1e10), 3.0  # [rad/s]; an admittance that still grows there is that of an inerter without a spring


def _midway(element: Element) -> Network:
    value = element.value
    return element.with_value(0.5 * (value.lower + value.upper)) if isinstance(value, Free) else element
