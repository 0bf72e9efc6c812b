"""Results of studies that were never computed: plausible numbers in the shape that `inerter.files.study` gives them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from inerter.methods.registry import brief_words_of
from inerter.report.sections import design_sections
from inerter.report.text import section_text

UNITS = {"J1": "m/s^2", "J3": "N", "J5": "m/N"}
TITLES = {"J1": "ride comfort", "J3": "dynamic tyre load", "J5": "dynamic load carrying"}
SIZES = {"J1": 2.5, "J3": 550.0, "J5": 2.4e-5}
OUTPUTS = {"J1": ["sprung_acceleration", "pitch_acceleration"], "J3": ["tyre_load"], "J5": ["sprung_displacement"]}
GAINS = {
    "J1": ("(m/s^2)/(m/s)", "body acceleration per road velocity", 60.0),
    "J3": ("N/(m/s)", "tyre force per road velocity", 1.5e4),
    "J5": ("m/N", "displacement per force", 3e-5),
}
LONG = ["S1", "S2", "S3", "a-layout-with-a-name-of-forty-characters", *(f"layout_{i}_of_many" for i in range(4, 10))]


def designs(layouts: Sequence[str] = ("S1", "S2", "S3"), baseline: str = "S1") -> xr.Dataset:
    """Results of a study without a sweep; the baseline has no inerter."""
    data = _results(layouts, baseline, None)
    omega = np.geomspace(1.0, 600.0, 600)
    data = data.assign_coords(omega=("omega", omega, {"units": "rad/s", "long_name": "angular frequency"}))
    for index, (unit, name, height) in GAINS.items():
        gains = [
            [_gain(omega, height, 18.0 + 2 * i, 0.15 + 0.02 * j) for j in range(len(OUTPUTS[index]))]
            for i in range(len(layouts))
        ]
        attributes = {"units": unit, "long_name": name}
        data[f"gain_{index}"] = (("layout", f"output_{index}", "omega"), np.array(gains), attributes)
        data = data.assign_coords({f"output_{index}": OUTPUTS[index]})
    return data


def sweep(
    layouts: Sequence[str] = ("S1", "S2", "S3"),
    baseline: str = "S1",
    stiffness: Sequence[float] = (10e3, 60e3, 120e3, 200e3, 300e3),
) -> xr.Dataset:
    """Results of a study that sweeps the spring k [N/m]."""
    return _results(layouts, baseline, np.asarray(stiffness, dtype=float))


def a_map(layouts: Sequence[str] = ("S1", "S2", "S3"), baseline: str = "S1") -> xr.Dataset:
    """Results of a study that sweeps the speed and the spring."""
    speeds = [10.0, 20.0, 30.0, 40.0]
    data = _results(layouts, baseline, np.array([10e3, 60e3, 120e3, 200e3]))
    data = data.expand_dims({"road.speed": speeds}).transpose("layout", "index", "k", "road.speed", ...)
    data["road.speed"].attrs = {"units": "m/s", "long_name": "speed"}
    faster = xr.DataArray(np.linspace(1.0, 1.4, len(speeds)), dims="road.speed")
    return data.assign(value=(data["value"] * faster).transpose(*data["value"].dims)).copy(deep=True)


def judged(data: xr.Dataset, methods: Sequence[str] = ("norm", "expected-value"), roads: int = 8) -> xr.Dataset:
    """The same results by several methods: the first is exact, each further one a little worse, with errors."""
    factors = xr.DataArray(1.0 + 0.01 * np.arange(len(methods)), coords={"method": list(methods)}, dims="method")
    dims = (*data["value"].dims, "method")
    data = data.assign(value=(data["value"] * factors).transpose(*dims))
    exact = (
        xr.DataArray([0.0 if i else np.nan for i in range(len(methods))], dims="method") if len(methods) > 1 else 0.0
    )
    error = (0.004 * data["value"] + exact).transpose(*dims)
    data = data.assign(
        standard_error=error.where(data["layout"] != data.attrs["baseline"]),
        realisations=(dims, np.full(error.shape, roads)),
    )
    data = improved(data) if data.attrs["baseline"] else data.assign(improvement=data["value"] * np.nan)
    words = [f"by {brief_words_of(method)}" for method in methods] if len(methods) > 1 else [""]
    data = data.assign_coords(method_words=("method", words))
    return data.assign(improvement_error=data["standard_error"] * 0.0 + 0.31)


def limited(data: xr.Dataset, active: np.ndarray, missed: np.ndarray) -> xr.Dataset:
    """The same results within two limits: where each holds the design back, and where no design keeps them.

    `missed` has the dimensions of the status, and `active` one more.
    """
    dims, limits = data["status"].dims, ["suspension-travel at most 9 mm", "tyre-load at most 1.3 kN"]
    size = np.where(active | missed[..., None], 1.0, 0.8) * np.where(missed[..., None], 1.2, 1.0)
    words = ["r.m.s. suspension travel at most 9 mm", "r.m.s. dynamic tyre load at most 1.3 kN"]
    each = {"limit.each": ("limit", ["", ""]), "limit.words": ("limit", words)}
    data = data.assign_coords(limit=limits, limit_unit=("limit", ["m", "N"]), **each)
    data = data.assign(
        **{"limit.part": ((*dims, "limit"), np.full(size.shape, "", dtype=object))},
        **{
            f"limit.{error}": ((*dims, "limit"), np.full(size.shape, np.nan))
            for error in ("standard_error", "error_bound")
        },
        limit_value=((*dims, "limit"), size * [9e-3, 1300.0], {"basis": ""}),
        limit_active=((*dims, "limit"), active | missed[..., None]),
        limit_cost=((*dims, "limit"), np.where(active, -0.4, 0.0)),
        status=(dims, np.where(missed, "infeasible: no feasible design was found", "ok").astype(object)),
    )
    return improved(data.assign(value=data["value"].where(~data["status"].str.startswith("infeasible"))))


def improved(data: xr.Dataset) -> xr.Dataset:
    """The same results with improvements that belong to their values."""
    base = data["value"].sel(layout=data.attrs["baseline"], drop=True)
    base = base.where(np.isfinite(base))  # nothing is a share of an infinite value
    with np.errstate(invalid="ignore"):
        return data.assign(improvement=(100.0 * (1.0 - data["value"] / base)).transpose(*data["value"].dims))


def with_value(data: xr.Dataset, value: float, status: str = "ok", **where: object) -> xr.Dataset:
    """The same results with one value and its status replaced, where labels are `where`."""
    data = data.copy(deep=True)
    data["status"] = data["status"].astype(object)
    data["value"].loc[where] = value
    data["status"].loc[where] = status
    return improved(data)


def _results(layouts: Sequence[str], baseline: str, stiffness: np.ndarray | None) -> xr.Dataset:
    swept = np.ones(1) if stiffness is None else stiffness / 120e3
    n = len(layouts)
    better = 1.0 - 0.06 * (np.arange(n) % 4)
    size = np.array(list(SIZES.values()))
    value = better[:, None, None] * size[None, :, None] * (swept[None, None, :] ** 0.5 * (1.0 + 0.01 * n))
    parameter = np.stack([4e3 * value / size[None, :, None], 250.0 * swept * np.ones_like(value)], axis=-1)
    parameter[[name == baseline for name in layouts], ..., 1] = np.nan
    bound = np.full(parameter.shape, "", dtype=object)
    bound[-1, 0, -1, 1] = "upper"
    dims = ("layout", "index", "k")
    data = xr.Dataset(
        {
            "value": (dims, value),
            "improvement": (dims, np.full(value.shape, np.nan)),
            "other_value": ((*dims, "other"), value.swapaxes(1, 2)[:, None] * (1.1 - 0.1 * np.eye(3))[:, None]),
            "parameter_value": ((*dims, "parameter"), parameter),
            "parameter_low": ((*dims, "parameter"), 1.0 * parameter),
            "parameter_high": ((*dims, "parameter"), 1.0 * parameter),
            "at_bound": ((*dims, "parameter"), bound.astype(str)),
            "status": (dims, np.full(value.shape, "ok")),
            "starts": (dims, np.full(value.shape, 16)),
            "agreed": (dims, np.full(value.shape, 14)),
        },
        coords={
            "layout": list(layouts),
            "index": list(UNITS),
            "other": list(UNITS),
            "parameter": ["c", "b"],
            "parameter_unit": ("parameter", ["N s/m", "kg"]),
            "index_unit": ("index", list(UNITS.values())),
            "index_title": ("index", list(TITLES.values())),
        },
        attrs={
            "title": "A quarter car",
            "baseline": baseline,
            "conventions": "exact",
            "model": "quarter-car",
            "seed": 0,
            "inerter_version": "0.1.0",
            "notes": "",
        },
    )
    if stiffness is None:
        data = data.isel(k=0)
    else:
        data = data.assign_coords(k=("k", stiffness, {"units": "N/m", "long_name": "k"}))
    return improved(data) if baseline else data


def _gain(omega: np.ndarray, height: float, resonance: float, damping: float) -> np.ndarray:
    """The gain of an oscillator, `height` at its resonance [rad/s]."""
    r = omega / resonance
    return height * 2 * damping * r / np.abs(1 - r**2 + 2j * damping * r)


def terminal_text(results: xr.Dataset) -> str:
    """What a terminal shows of the designs."""
    return section_text(design_sections(results))
