"""Figures 13 and 14: designs that are best without friction, judged with it by Method 1, over the static stiffness."""

from __future__ import annotations

import numpy as np
import xarray as xr

from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.method import evaluate
from inerter.methods.norm import Norm
from inerter.papers.wang_su_2008.source import index_of, study

LAYOUTS = {
    "figure13": ("S2-10N", "S2-20N", "S3-10N", "S3-20N"),
    "figure14": ("S2-10N", "S3-10N", "S2-soft-10N", "S3-soft-10N"),
}

_RIGID = 1e5  # [kg]


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
    """One point of a curve: the linear optimum's parameters, `optima`, with friction."""
    layout, index, point = name.split()
    source = study("friction1")
    (swept,) = source.sweeps
    design = source.design(layout, swept.values[int(point)]).with_values(optima)
    rigid = optima["b"] > _RIGID  # an inerter that does not move feels no friction
    found = evaluate(design, index_of(index, source), Norm() if rigid else ApproximateLinear(realisations=4))
    return {"value": found.value, "error": found.standard_error or 0.0, "status": str(found.status)}


def dataset(found: dict[str, dict[str, object]], figure11: xr.Dataset) -> xr.Dataset:
    """The curves as a dataset beside those of Figure 11: value, standard error and improvement over S1."""
    layouts = list(dict.fromkeys(name.split()[0] for name in found))
    base = figure11["value"].sel(layout="S1")
    shape = (len(layouts), figure11.sizes["index"], figure11.sizes["k"])
    value, error, status = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, "ok", dtype=object)
    symbols = figure11["index"].values.tolist()
    for name, numbers in found.items():
        layout, index, point = name.split()
        at = layouts.index(layout), symbols.index(index), int(point)
        value[at], error[at] = float(numbers["value"]), float(numbers["error"])  # type: ignore[arg-type]
        status[at] = numbers["status"]
    dims = ("layout", "index", "k")
    data = xr.Dataset(
        {"value": (dims, value), "standard_error": (dims, error)},
        coords={"layout": layouts, **{c: figure11[c] for c in ("index", "k", "index_unit", "index_title")}},
        attrs=figure11.attrs,
    )
    data["improvement"] = 100.0 * (1.0 - data["value"] / base)
    every = [*figure11["layout"].values, *layouts]
    together = xr.concat([figure11[["value", "improvement"]], data[["value", "improvement"]]], dim="layout")
    return together.assign(
        standard_error=data["standard_error"].reindex(layout=every, fill_value=0.0),
        status=xr.concat([figure11["status"].astype(object), xr.DataArray(status, data.coords, dims)], dim="layout"),
    )
