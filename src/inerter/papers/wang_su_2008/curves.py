"""Figures 13 and 14: designs that are best without friction, judged with it by Method 1, over the static stiffness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.method import evaluate
from inerter.methods.norm import Norm
from inerter.papers.wang_su_2008.rows import total_error
from inerter.papers.wang_su_2008.source import index_of, study

if TYPE_CHECKING:
    import xarray

LAYOUTS = {
    "figure13": ("S2-10N", "S2-20N", "S3-10N", "S3-20N"),
    "figure14": ("S2-10N", "S3-10N", "S2-soft-10N", "S3-soft-10N"),
}

_RIGID = 1e5  # [kg]
_REALISATIONS = 8


def names(figure: str) -> list[str]:
    """A name for each curve and stiffness: layout, index, number of the swept value."""
    source = study("friction1")
    (swept,) = source.sweeps
    points = range(len(swept.values))
    return [f"{layout} {index} {i}" for layout in LAYOUTS[figure] for index in source.indices for i in points]


def linear_twin(layout: str) -> str:
    """The layout without friction, for which the design was found: S2 for S2-10N, S2-soft for S2-soft-10N."""
    return layout.rpartition("-")[0]


def compute(name: str, optima: dict[str, float]) -> dict[str, object]:
    """Value and scatter of one point of a curve: the linear optimum's parameters, `optima`, with friction."""
    layout, index, point = name.split()
    source = study("friction1")
    (swept,) = source.sweeps
    design = source.design(layout, swept.values[int(point)]).with_values(optima)
    rigid = optima["b"] > _RIGID  # an inerter that does not move feels no friction
    found = evaluate(
        design, index_of(index, source), Norm() if rigid else ApproximateLinear(realisations=_REALISATIONS)
    )
    return {
        "value": found.value,
        "error": total_error(found),
        "deviations": [sample - found.value for sample in found.samples],
        "status": str(found.status),
    }


def dataset(found: dict[str, dict[str, Any]], figure11: xarray.Dataset) -> xarray.Dataset:
    """Dataset of the curves and those of Figure 11: value, standard error, improvement over S1, status.

    `deviation` holds what each realisation adds to the mean, and `unsampled_error` what of the standard error does not
    come from them; both are zero for linear designs.
    """
    import xarray as xr  # noqa: PLC0415 - heavy

    layouts = list(dict.fromkeys(name.split()[0] for name in found))
    base = figure11["value"].sel(layout="S1")
    shape = (len(layouts), figure11.sizes["index"], figure11.sizes["k"])
    value, error, rest = np.full((3, *shape), np.nan)
    deviation, status = np.zeros((*shape, _REALISATIONS)), np.full(shape, "ok", dtype=object)
    symbols = figure11["index"].values.tolist()
    for name, numbers in found.items():
        layout, index, point = name.split()
        at = layouts.index(layout), symbols.index(index), int(point)
        value[at], error[at], status[at] = numbers["value"], numbers["error"], numbers["status"]
        if numbers["deviations"]:
            deviation[at] = numbers["deviations"]
        sampled = np.sum(deviation[at] ** 2) / (_REALISATIONS * (_REALISATIONS - 1))
        rest[at] = np.sqrt(max(error[at] ** 2 - sampled, 0.0))
    dims = ("layout", "index", "k")
    data = xr.Dataset(
        {
            "value": (dims, value),
            "standard_error": (dims, error),
            "unsampled_error": (dims, rest),
            "deviation": ((*dims, "realisation"), deviation),
        },
        coords={"layout": layouts, **{c: figure11[c] for c in ("index", "k", "index_unit", "index_title")}},
        attrs=figure11.attrs,
    )
    data["improvement"] = 100.0 * (1.0 - data["value"] / base)
    every = [*figure11["layout"].values, *layouts]
    together = xr.concat([figure11[["value", "improvement"]], data[["value", "improvement"]]], dim="layout")
    scatter = data[["standard_error", "unsampled_error", "deviation"]].reindex(layout=every, fill_value=0.0)
    statuses = [figure11["status"].astype(object), xr.DataArray(status, data.coords, dims)]
    return together.assign({**scatter.data_vars, "status": xr.concat(statuses, dim="layout")})
