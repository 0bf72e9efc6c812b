"""Warnings on results that are implausible for a vehicle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from inerter.errors import InerterError
from inerter.files.common.suggest import some
from inerter.files.study.cases import NO_EQUILIBRIUM, lacks_equilibrium
from inerter.files.study.study import Study
from inerter.formatting import format_alike, format_quantity
from inerter.indices.registry import INDICES
from inerter.indices.ride_comfort import RideComfort
from inerter.indices.tyre_load import TyreLoad
from inerter.systems.static_loads import static_tyre_loads
from inerter.units import STANDARD_GRAVITY
from inerter.vehicle.registry import VEHICLES

_LIFT_OFF = 3.0  # times the r.m.s. load, which a load exceeds 0.1 % of the time


def result_warnings(results: xr.Dataset, study: Study) -> Iterator[str]:
    """Warnings on bodies without support, accelerations beyond that of gravity, and tyres that leave the road."""
    if study.road is None or study.model not in VEHICLES:
        return
    if unsupported := [name for name in study.layouts if lacks_equilibrium(study.design(name).mechanism())]:
        yield f"Warning: {NO_EQUILIBRIUM} with {some(unsupported)}. Put a spring in parallel."
    for text in value_warnings(study, {name: results["value"].sel(index=name).values for name in study.indices}):
        yield f"Warning: {text}"


def value_warnings(study: Study, values: Mapping[str, ArrayLike]) -> Iterator[str]:
    """Warnings on accelerations beyond that of gravity, and on tyres that leave the road, by values of each index."""
    for name in values if study.road is not None and study.model in VEHICLES else ():
        kind, known = INDICES.get(study.symbol(name)), np.asarray(values[name], dtype=float)
        largest = float(known[np.isfinite(known)].max(initial=0.0))  # of an infinite one the status tells the cause
        if kind is RideComfort and largest > STANDARD_GRAVITY:
            yield (
                f"{name} reaches {format_quantity(largest, 'm/s^2')} r.m.s., more than the acceleration of "
                f"gravity, which no vehicle stands. Check the road's roughness and speed."
            )
        if kind is TyreLoad:
            yield from _lift_off_warning(name, largest, study)


def _lift_off_warning(name: str, largest: float, study: Study) -> Iterator[str]:
    """Warning where a load has three times its r.m.s. value in more than its static load, or that alone in all of it.

    If no tyre exceeded a third of its static load, the root of the sum of squares would not exceed a third of theirs.
    """
    weighted = [weight * static for static, weight in _static_loads(study)]
    if not weighted or largest <= hypot(*weighted) / _LIFT_OFF:
        return
    load, limit = format_alike([largest, sum(weighted)], "N")
    beyond = largest > sum(weighted)
    how = f"more than the static load of {limit}" if beyond else f"with a static load of {limit} in all"
    when = "the tyres would leave the road" if beyond else "a tyre leaves the road at times"
    yield (
        f"{name} reaches {load} r.m.s., {how}: {when}, which the linear model ignores. Check the road's "
        "roughness and speed."
    )


def _static_loads(study: Study) -> list[tuple[float, float]]:
    """Static load of each tyre [N] with its weight in J3; none if they are unknown, or not all that J3 is of."""
    try:
        design = study.design(next(iter(study.layouts)))
        free = {name: free.lower for name, free in design.free_values().items()}
        loads = static_tyre_loads(design.with_values(free))
    except InerterError:
        return []
    weights = {output.output: abs(output.weight) for output in design.mechanism().tyre_loads}
    known = {f"{tyre}_load": load for tyre, load in loads.items()}
    return [(known[name], weight) for name, weight in weights.items()] if weights.keys() <= known.keys() else []
