"""Warnings on results that are implausible for a vehicle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

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


def result_warnings(results: xr.Dataset, study: Study) -> Iterator[str]:
    """Warnings on bodies without support, accelerations beyond that of gravity, and tyre loads beyond the static."""
    if study.road is None or study.model not in VEHICLES:
        return
    if unsupported := [name for name in study.layouts if lacks_equilibrium(study.design(name).mechanism())]:
        yield f"Warning: {NO_EQUILIBRIUM} with {some(unsupported)}. Put a spring in parallel."
    for name in study.indices:
        kind, values = INDICES.get(study.symbol(name)), results["value"].sel(index=name)
        finite = values.values[np.isfinite(values.values)]  # of an infinite one the status tells the cause
        largest = float(finite.max(initial=0.0))
        if kind is RideComfort and largest > STANDARD_GRAVITY:
            yield (
                f"Warning: {name} reaches {format_quantity(largest, 'm/s^2')} r.m.s., more than the acceleration of "
                f"gravity, which no vehicle stands. Check the road's roughness and speed."
            )
        if kind is TyreLoad and (static := _static_load(study)) and largest > static:
            load, limit = format_alike([largest, static], "N")
            yield (
                f"Warning: {name} reaches {load} r.m.s., more than the static load of {limit}: the tyres would leave "
                f"the road, which the linear model ignores. Check the road's roughness and speed."
            )


def _static_load(study: Study) -> float:
    """Sum of the static loads of all tyres [N]; 0 if unknown."""
    try:
        design = study.design(next(iter(study.layouts)))
        free = {name: free.lower for name, free in design.free_values().items()}
        return sum(static_tyre_loads(design.with_values(free)).values())
    except InerterError:
        return 0.0
