"""Warnings on results that are implausible for a vehicle."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from inerter.errors import InerterError
from inerter.files.study.study import Study
from inerter.formatting import format_alike, format_quantity
from inerter.indices.registry import INDICES
from inerter.indices.ride_comfort import RideComfort
from inerter.indices.tyre_load import TyreLoad
from inerter.systems.static_loads import static_tyre_loads
from inerter.units import STANDARD_GRAVITY
from inerter.vehicle.registry import VEHICLES


def result_warnings(results: xr.Dataset, study: Study) -> Iterator[str]:
    """Warnings on implausible values: accelerations beyond that of gravity, tyre loads beyond the static load."""
    if study.road is None or study.model not in VEHICLES:
        return
    for name in study.indices:
        kind, values = INDICES.get(study.symbol(name)), results["value"].sel(index=name)
        largest = float(values.max()) if np.isfinite(values).any() else np.nan
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
