"""Designs whose peak gain equals the static gain, which no damper or inerter can reduce."""

from __future__ import annotations

import numpy as np
import xarray as xr

from inerter.errors import InerterError
from inerter.files.study.study import Study
from inerter.indices.definition import Combination
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.registry import is_blind
from inerter.methods.ties import ACCURACY
from inerter.norms.response import frequency_response
from inerter.systems.descriptor import close


def at_static_limit(study: Study, results: xr.Dataset) -> frozenset[tuple[str, str]]:
    """Pairs of index and layout, of a study without a sweep, whose exact value equals the gain at frequency zero."""
    method = study.evaluate[0]
    if not is_blind(method):
        return frozenset()
    values = results["value"].sel({"method": method}) if "method" in results["value"].dims else results["value"]
    found = set()
    for index in results["index"].values.tolist():
        for layout in results["layout"].values.tolist():
            design = results.sel(layout=layout, index=index)
            value = float(values.sel(layout=layout, index=index))
            static = _static_gain(study, layout, index, design) if np.isfinite(value) else np.nan
            if np.isfinite(static) and abs(value - static) <= 2.0 * ACCURACY * abs(static):
                found.add((index, layout))
    return frozenset(found)


def _static_gain(study: Study, layout: str, index: str, design: xr.Dataset) -> float:
    """Gain at frequency zero of a peak-gain index; nan for another index, infinite with rigid-body drift."""
    numbers = zip(design["parameter"].values.tolist(), design["parameter_value"].values.tolist(), strict=True)
    try:
        vehicle = study.design(layout)
        vehicle = vehicle.with_values({name: n for name, n in numbers if name in vehicle.free_values()})
        definition = study.index(index).definition(mechanism := vehicle.mechanism())
        if definition.combination is not Combination.PEAK_GAIN:
            return np.nan
        problem = linear_problem(mechanism, definition, CONVENTIONS[study.conventions])
        gains = frequency_response(problem.system(close(problem.descriptor, {})), np.zeros(1), problem.pade_order)
    except (InerterError, np.linalg.LinAlgError):
        return np.nan
    weights = np.array([abs(output.weight) for output in problem.definition.outputs])
    return float(np.linalg.norm(weights * np.abs(gains[0, :, 0])))
