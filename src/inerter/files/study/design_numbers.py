"""Further numbers of best designs: a row of `DESIGN_NUMBERS` is in results.nc, summary.csv, `--json` and reports."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Any

from inerter.errors import Status, StatusKind
from inerter.files.study.parts import FAILURES
from inerter.methods.method import Estimate
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    import xarray as xr

    from inerter.files.study.study import Study

NUMBER = "number."  # begins the names of their variables, which no element can have
ENDS = ("value", "error_bound", "status")  # of these names


@dataclass(frozen=True)
class DesignNumber:
    """Number of the best design of a layout for an index; `heading` is that of its column, `words` say what it is.

    `estimate` computes it, with unit, error sources and status, from the study and the vehicle with its best values.
    """

    heading: str
    words: str
    unit: str
    estimate: Callable[[Study, Vehicle], Estimate]

    def entry(self, study: Study, vehicle: Vehicle) -> dict[str, Any]:
        """Value, largest relative error and status, for JSON."""
        try:
            found = self.estimate(study, vehicle)
        except FAILURES as error:
            found = Estimate(nan, self.unit, Status(StatusKind.FAILED, str(error)))
        return dict(zip(ENDS, (found.value, found.error_bound, str(found.status)), strict=True))

    def variables(self) -> dict[str, tuple[tuple[str, ...], float | str, str]]:
        """Further dimensions, empty value and long name of each variable in results, by the end of its name."""
        bound, status = f"{self.words}, largest relative error", f"{self.words}, status"
        return dict(zip(ENDS, (((), nan, self.words), ((), nan, bound), ((), "missing", status)), strict=True))


DESIGN_NUMBERS: dict[str, DesignNumber] = {}  # by name


def numbers_in(results: xr.Dataset) -> list[str]:
    """Names of the numbers that results have."""
    known = (str(name) for name in results.data_vars if "heading" in results[name].attrs)
    return [name.removeprefix(NUMBER).removesuffix(f".{ENDS[0]}") for name in known]


def number_entry(name: str, row: Mapping[str, Any] | xr.Dataset) -> dict[str, Any]:
    """Value, largest relative error and status of a number, of a design with its variables."""
    return {end: row[f"{NUMBER}{name}.{end}"] for end in ENDS}
