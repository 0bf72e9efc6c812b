"""Labels and names for the results dataset."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from inerter.errors import Status, StatusKind
from inerter.formatting import (
    Scale,
    capital,
    choose_scale,
    format_percent,
    format_quantity,
    is_prefixed,
    label_with_unit,
    typeset_unit,
)
from inerter.indices.names import title_with_name
from inerter.table import Quantity
from inerter.units import parse_quantity

if TYPE_CHECKING:
    import xarray as xr

_LONGEST_LABEL = 32
WIDE_RANGE = 1.01  # of equally good values, the highest over the lowest, from which on it is told
NOTICEABLE = 0.05  # per cent; what rounds to 0.0 % is no improvement
_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"


def one_method(results: xr.Dataset) -> xr.Dataset:
    """The results by the first of the methods, which is the one that figures and tables are about."""
    if "method" not in results.dims:
        return results
    first = results.isel(method=0, drop=True)
    return (
        first
        if results.sizes["method"] == 1
        else first.assign_attrs(method_label=method_label(results, methods(results)[0]))
    )


def by_which(results: xr.Dataset) -> str:
    """Words for titles: the method of the results if the study has several; else empty."""
    return f", {results.attrs['method_label']}" if "method_label" in results.attrs else ""


def method_label(results: xr.Dataset, method: str) -> str:
    """Method in words that distinguish it from the others, such as "with friction"; may be empty for a single one."""
    return str(results["method_words"].sel({"method": method}).item())


def methods(results: xr.Dataset) -> list[str]:
    """Names of the methods, in the order of the study; none where they have been chosen from."""
    names: list[str] = results["method"].values.tolist() if "method" in results.dims else []
    return names


def by_method(results: xr.Dataset, method: str) -> xr.Dataset:
    """The results by one of the methods."""
    return results.sel({"method": method}, drop=True)  # as a keyword, `method` means another thing to xarray


def error_of(design: xr.Dataset, of: str = "value") -> float:
    """Standard error of the value, the improvement, or another index of one design; nan if unknown."""
    name = {"value": "standard_error", "improvement": "improvement_error", "other": "other.standard_error"}[of]
    return float(design[name]) if name in design else np.nan


def bound_of(design: xr.Dataset, of: str = "value") -> float:
    """The largest error of the value or another index (relative), or of the improvement [%]; nan if none is known."""
    name = {"value": "error_bound", "improvement": "improvement_bound", "other": "other_error_bound"}[of]
    return float(design[name]) if name in design else np.nan


def design_quantity(design: xr.Dataset, unit: str, scale: Scale | None = None) -> Quantity:
    """Value of one design [`unit`] with its uncertainties."""
    return Quantity(float(design["value"]), unit, error_of(design), bound_of(design), scale)


def improvement_text(design: xr.Dataset) -> str:
    """The improvement of one design with its sign."""
    return format_percent(
        float(design["improvement"]), error_of(design, "improvement"), bound_of(design, "improvement")
    )


def improvement_over_baseline(design: xr.Dataset) -> str:
    """The improvement of one design with its sign; empty for the baseline itself, and without one."""
    baseline = design.attrs["baseline"]
    return improvement_text(design) if baseline and design["layout"].item() != baseline else ""


def swept_places(results: xr.Dataset) -> list[str]:
    """Names of the swept places, such as elements; also names of dimensions."""
    return [str(name) for name in results["status"].dims if name not in ("layout", "index")]


def swept_element(results: xr.Dataset) -> str | None:
    """The place that the study sweeps, where it sweeps but one."""
    return next(iter(swept_places(results)), None)


def swept_words(results: xr.Dataset) -> list[str]:
    """Names of the swept parameters, in words."""
    return [str(results[place].attrs["long_name"]) for place in swept_places(results)]


def swept_scale(results: xr.Dataset, place: str) -> Scale:
    """The unit of swept values for people: that in which the file gives them, or a prefix of the SI unit that suits."""
    unit, written = results[place].attrs["units"], results[place].attrs.get("written", "")
    if not written or is_prefixed(written, unit):
        return choose_scale(results[place].values, unit)
    return Scale(1.0 / parse_quantity(f"1 {written}", unit), written)


def swept_text(results: xr.Dataset, place: str, value: float, error: float = np.nan) -> str:
    """A swept value [SI] with its unit: that in which the file gives it, or one with a suitable prefix."""
    unit, written = results[place].attrs["units"], results[place].attrs.get("written", "")
    if not written or is_prefixed(written, unit):
        return format_quantity(value, unit, error=error)
    factor = swept_scale(results, place).factor
    return format_quantity(value * factor, written, error=error * factor)


def swept_label(results: xr.Dataset, place: str, unit: str) -> str:
    """Label of the axis of a swept parameter; the name of an element keeps its case."""
    words = str(results[place].attrs["long_name"])
    return axis_label(words if words == place else capital(words), unit)


def infeasible(results: xr.Dataset) -> xr.DataArray:
    """True where no design satisfies the constraints; dimensions as `status`."""
    kept_by_none = np.vectorize(lambda text: Status.parts(str(text))[0] == StatusKind.INFEASIBLE, otypes=[bool])
    return results["status"].copy(data=kept_by_none(results["status"].values))


def held_back(results: xr.Dataset) -> xr.DataArray:
    """True where a constraint of the best design is active; False everywhere in a study without limits."""
    if "limit_active" not in results:
        return results["status"].copy(data=np.zeros(results["status"].shape, dtype=bool))
    return results["limit_active"].any("limit") & ~infeasible(results)


def layouts(results: xr.Dataset) -> list[str]:
    """Names of all layouts, the baseline first if there is one, then in the order of the study."""
    names: list[str] = results["layout"].values.tolist()
    return sorted(names, key=lambda name: name != results.attrs["baseline"])


def marked_layouts(results: xr.Dataset) -> list[str]:
    """Names of all layouts as headings, of which the baseline is marked."""
    baseline = results.attrs["baseline"]
    return [f"{name} (baseline)" if name == baseline else name for name in layouts(results)]


def compared_layouts(results: xr.Dataset) -> list[str]:
    """The layouts that are compared with the baseline."""
    return layouts(results)[1:] if results.attrs["baseline"] else []


def indices(results: xr.Dataset) -> list[str]:
    """Symbols of the indices, in the order of the study."""
    names: list[str] = results["index"].values.tolist()
    return names


def indices_with_values(results: xr.Dataset) -> list[str]:
    """Indices of which at least one design has a value, by any method and at any swept value."""
    return [index for index in indices(results) if bool(results["value"].sel(index=index).notnull().any())]


def index_title(results: xr.Dataset, index: str) -> str:
    """The name of an index in words, such as "ride comfort"."""
    return str(results["index_title"].sel(index=index).item())


def index_words(results: xr.Dataset, index: str, template: str = "{} ({})") -> str:
    """The title of an index with its name, in that order of the template."""
    return title_with_name(index_title(results, index), index, template)


def index_unit(results: xr.Dataset, index: str) -> str:
    """The unit of an index."""
    return str(results["index_unit"].sel(index=index).item())


def criteria(results: xr.Dataset) -> list[str]:
    """Names of the indices of the trade-off; empty for a study without one."""
    names: list[str] = results["criterion"].values.tolist() if "front_value" in results else []
    return names


def criterion_title(results: xr.Dataset, name: str) -> str:
    """The name of an index of a trade-off in words."""
    return str(results["criterion_title"].sel(criterion=name).item())


def criterion_unit(results: xr.Dataset, name: str) -> str:
    """The unit of an index of a trade-off."""
    return str(results["criterion_unit"].sel(criterion=name).item())


def flat_range(entry: xr.Dataset) -> str:
    """Range of a parameter over equally good optima as text; empty if less than 1 % wide."""
    low, high = float(entry["parameter_low"]), float(entry["parameter_high"])
    unit = str(entry["parameter_unit"].item())
    return f"{format_quantity(low, unit)} to {format_quantity(high, unit)}" if high > WIDE_RANGE * low else ""


def axis_label(what: str, unit: str) -> str:
    """Label of an axis: quantity and unit in brackets; on two lines if long."""
    text = label_with_unit(what, typeset_unit(unit).replace(" ", _NO_BREAK_SPACE))
    return text if len(text) <= _LONGEST_LABEL else fill(text, _LONGEST_LABEL, break_long_words=False)
