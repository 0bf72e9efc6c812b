"""Pareto fronts: non-dominated designs of each layout in the indices of a trade-off."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from textwrap import TextWrapper, wrap
from typing import TYPE_CHECKING

import numpy as np

from inerter.errors import StatusKind
from inerter.figures.labels import (
    criteria,
    criterion_unit,
    format_list,
    layouts,
    trade_off_title,
    typeset_quantity,
    which_front,
    with_unit,
)
from inerter.files.common.problem import Problem, at
from inerter.files.study.limits import limits_in
from inerter.files.study.study import Study
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults
from inerter.files.study.ways import ways
from inerter.methods.registry import decisive_method_clause
from inerter.pareto_fronts.front import ParetoFront
from inerter.pareto_fronts.pareto import pareto_front
from inerter.report.problem_statement import key_in_words
from inerter.table import Cell, Row, Table, Writer
from inerter.units import label_with_unit

if TYPE_CHECKING:
    import xarray as xr

_LEAST_OF_THREE = 6  # points of a front of three indices
_NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
_SAME = 1e-9  # relative; a point that is as good as another in all indices does not better it


@dataclass(frozen=True)
class FrontPart(TaskPart["FrontAnswer"]):
    """Task part: Pareto front of one layout."""

    layout: str

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return f"front of {self.layout}"

    def answer(self, study: Study, designs: Designs, threads: int) -> FrontAnswer:
        """Pareto front of the layout."""
        limits = [limit for several in limits_in(study) for limit in several]
        indices = [study.resolve_index(name, self.layout) for name in study.trade_off]
        method = study.method(str(study.optimise), threads)
        design = study.design(self.layout)
        vehicle = design if study.conditions else design.mechanism()
        found = pareto_front(vehicle, indices, method, points=study.points, subject_to=limits, seed=study.seed)
        return _answer(self.layout, found, str(study.optimise))

    def failure_answer(self, study: Study, message: str) -> FrontAnswer:
        """Answer without points, with status `failed`."""
        return _without(self.layout, StatusKind.FAILED.value, message)


@dataclass(frozen=True, kw_only=True)
class FrontAnswer(Answer):
    """Points of a Pareto front, in ascending order of the first index [SI]."""

    values: list[list[float]]  # of each point, by index
    parameters: list[dict[str, float]]
    statuses: list[str]
    jumps: list[int]  # points after which the front leaps
    knee: int | None

    @property
    def part(self) -> FrontPart:
        """Task part to which the answer belongs."""
        return FrontPart(self.layout)


class Fronts(Task[FrontAnswer]):
    """Task: Pareto front of each layout in two or three indices."""

    key = "fronts"
    title = "Trade-off"
    answer = FrontAnswer

    def parts(self, study: Study) -> list[FrontPart]:
        """Task parts, one for each layout with design variables; empty without `trade_off`."""
        if not study.trade_off:
            return []
        return [FrontPart(layout) for layout in study.layouts if study.design(layout).free_values()]

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of `trade_off` and `points`: numbers of indices and points, a sweep, nothing optimised."""
        place = ("study", "trade_off")
        if "points" in given and not study.trade_off:
            yield at(("study", "points"), fault="there is no front", expected="trade_off, or no points")
        if not study.trade_off:
            return
        several = len({study.index(name) for name in study.trade_off})  # which may be one by two names
        if several not in (2, 3) or several < len(study.trade_off):
            got = f"{len(study.trade_off)} indices" if several == len(study.trade_off) else "the same index twice"
            yield at(place, got=got, expected="two or three that differ")
        if several == 3 and study.points < _LEAST_OF_THREE:
            few = f"at least {_LEAST_OF_THREE} points for three indices"
            yield at(("study", "points"), got=str(study.points), expected=few)
        if study.sweeps:
            yield at(place, fault="given together with a sweep", expected="one of the two")
        if study.optimise is None:
            yield at(place, fault="nothing is optimised", expected="optimise, or no trade_off")

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Indices of the trade-off, by the heading of the report."""
        return {"Trade-off": [" against ".join(map(key_in_words, study.trade_off))] if study.trade_off else []}

    def csv(self, study: Study, answers: Sequence[FrontAnswer]) -> Iterator[Sequence[object]]:
        """Header and one row per point; one row with the status for an empty front."""
        free = study.free_units
        names = [name for name in free if any(name in design for front in answers for design in front.parameters)]
        indices = [label_with_unit(name, study.unit(name)) for name in study.trade_off]
        parameters = [f"{name} [{free[name]}]" for name in names]
        yield ["layout", "point", *indices, *parameters, "knee", "jump_after", "status"]
        for front in answers:
            for i, (values, design) in enumerate(zip(front.values, front.parameters, strict=True)):
                marks = ["yes" if i == front.knee else "", "yes" if i in front.jumps else ""]
                yield [front.layout, i + 1, *values, *map(design.get, names), *marks, front.statuses[i]]
            if not front.values:
                yield [front.layout, "", *([""] * (len(indices) + len(names) + 2)), front.status_text]

    def add_to_dataset(self, study: Study, data: xr.Dataset, answers: Sequence[FrontAnswer]) -> xr.Dataset:
        """Dataset with the fronts: dimensions layout, front_point, criterion, and parameter."""
        points = max([len(front.values) for front in answers] + [1])
        layouts, parameters = data["layout"].values.tolist(), data["parameter"].values.tolist()
        values = np.full((len(layouts), points, len(study.trade_off)), np.nan)
        designs = np.full((len(layouts), points, len(parameters)), np.nan)
        knees, leaps = np.full((len(layouts), points), False), np.full((len(layouts), points), False)
        status = np.full(len(layouts), "missing", dtype=object)
        for front in answers:
            row = layouts.index(front.layout)
            status[row] = front.status_text
            for i, (numbers, design) in enumerate(zip(front.values, front.parameters, strict=True)):
                values[row, i] = numbers
                designs[row, i] = [design.get(name, np.nan) for name in parameters]
            knees[row, [] if front.knee is None else [front.knee]] = True
            leaps[row, front.jumps] = True
        indices = {name: study.resolve_index(name, layouts[0]) for name in study.trade_off}
        labelled = data.assign_coords(
            criterion=list(indices),
            criterion_title=("criterion", [index.title for index in indices.values()]),
            criterion_unit=("criterion", [study.unit(name) for name in indices]),
        )
        by = ways(replace(study, evaluate=study.methods))[str(study.optimise)] if len(study.methods) > 1 else ""
        attributes = {"long_name": "index at a point of the front", "method_words": by}
        return labelled.assign(
            front_value=(("layout", "front_point", "criterion"), values, attributes),
            front_parameter=(("layout", "front_point", "parameter"), designs, {"long_name": "parameter at that point"}),
            front_knee=(("layout", "front_point"), knees, {"long_name": "whether it is the knee"}),
            front_jump=(("layout", "front_point"), leaps, {"long_name": "whether the front is interrupted after it"}),
            front_status=("layout", status, {"long_name": "status of the front"}),
        )

    def lines(self, results: TaskResults[FrontAnswer], width: int) -> Iterator[str]:
        """The designs at the ends and the knee of each front."""
        data = results.data
        title = f"trade-off of {', '.join(criteria(data))}{which_front(data)}: designs at the ends and the knee"
        yield from ("", *wrap(title, width))
        for layout in layouts(data):
            status = str(data["front_status"].sel(layout=layout).item())
            yield f"  {layout}" if status == "ok" else f"  {layout}: {status}"
            for what, point in _told_points(data, layout):
                items = [*_values(data, layout, point, with_unit), *_parameters(data, layout, point, with_unit)]
                text = ", ".join(item.replace(" ", _NO_BREAK_SPACE) for item in items)
                hanging = TextWrapper(width, "    ", "      ", break_on_hyphens=False)
                lines = hanging.wrap(f"{what}: {text}")
                yield from (line.replace(_NO_BREAK_SPACE, " ") for line in lines)

    def tables(self, results: TaskResults[FrontAnswer]) -> list[Table]:
        """The designs at the ends and the knee of each front."""
        data, names = results.data, criteria(results.data)
        parameters = [p for p in data["parameter"].values.tolist() if _has(data, p)]
        rows = []
        for layout in layouts(data):
            for what, point in _told_points(data, layout):
                cells = [Cell(text) for text in _values(data, layout, point, typeset_quantity, bare=True)]
                told = dict(
                    zip(
                        _own(data, layout, point),
                        _parameters(data, layout, point, typeset_quantity, bare=True),
                        strict=True,
                    )
                )
                rows.append(Row(f"{layout}, {what}", [*cells, *(Cell(told.get(name, "–")) for name in parameters)]))
        return [Table(trade_off_title(data), ["Design", *names, *parameters], rows)]

    def introduction(self) -> str:
        """Paragraph above the table: which designs it lists, and the file with all points."""
        return (
            "The ends and the knee of each layout's front: no design of the layout is better in all of these indices. "
            "fronts.csv has all points."
        )

    def sentences(self, results: TaskResults[FrontAnswer], write: Writer) -> Iterator[str]:
        """Sentence on each Pareto front: indices at its knee, and number of dominated designs of the baseline."""
        data = results.data
        names, baseline = criteria(data), data.attrs["baseline"]
        found, doubts = [], []
        for layout in layouts(data):
            knee = np.flatnonzero(data["front_knee"].sel(layout=layout).values)
            if not knee.size:
                continue
            values = data["front_value"].sel(layout=layout).values[knee[0]]
            told = format_list(
                [
                    write(float(value), criterion_unit(data, name), np.nan)
                    for name, value in zip(names, values, strict=True)
                ]
            )
            better = _dominance_clause(data, layout, baseline) if baseline and layout != baseline else ""
            status = str(data["front_status"].sel(layout=layout).item())
            if status != StatusKind.OK:
                doubts.append(f"{layout}, {status}")
            found.append(f"{layout} {told}{better}")
        doubt = f"Not certain ({'; '.join(doubts)}). " if doubts else ""
        if found:
            yield f"{doubt}{trade_off_title(data)}, at the knee: {'; '.join(found)}."


def _answer(layout: str, found: ParetoFront, method: str) -> FrontAnswer:
    if not len(found.values):
        return _without(layout, found.status.kind.value, found.status.message)
    return FrontAnswer(
        layout=layout,
        values=found.values.tolist(),
        parameters=list(found.parameters),
        statuses=list(map(str, found.statuses)),
        jumps=[before for before, _ in found.jumps],
        knee=found.knee,
        status=found.status.kind.value,
        message=found.status.message + decisive_method_clause(method, found.status),
    )


def _without(layout: str, status: str, message: str) -> FrontAnswer:
    return FrontAnswer(
        layout=layout, values=[], parameters=[], statuses=[], jumps=[], knee=None, status=status, message=message
    )


def _told_points(data: xr.Dataset, layout: str) -> list[tuple[str, int]]:
    """Labels and numbers of the listed points: minimum of each index, and the knee."""
    values = data["front_value"].sel(layout=layout).values
    if not np.isfinite(values).any():
        return []
    ends = [(f"least {name}", int(np.nanargmin(values[:, i]))) for i, name in enumerate(criteria(data))]
    knee = np.flatnonzero(data["front_knee"].sel(layout=layout).values)
    return [*ends[:1], *(("knee", int(point)) for point in knee), *ends[1:]]


def _values(data: xr.Dataset, layout: str, point: int, write: Writer, *, bare: bool = False) -> list[str]:
    row = data["front_value"].sel(layout=layout).values[point]
    texts = [write(float(v), criterion_unit(data, n), np.nan) for n, v in zip(criteria(data), row, strict=True)]
    return texts if bare else [f"{name} = {text}" for name, text in zip(criteria(data), texts, strict=True)]


def _own(data: xr.Dataset, layout: str, point: int) -> list[str]:
    row = data["front_parameter"].sel(layout=layout).values[point]
    return [name for name, value in zip(data["parameter"].values.tolist(), row, strict=True) if np.isfinite(value)]


def _parameters(data: xr.Dataset, layout: str, point: int, write: Writer, *, bare: bool = False) -> list[str]:
    row = data["front_parameter"].sel(layout=layout).isel(front_point=point)
    found = []
    for name in _own(data, layout, point):
        entry = row.sel(parameter=name)
        text = write(float(entry), str(entry["parameter_unit"].item()), np.nan)
        found.append(text if bare else f"{name} = {text}")
    return found


def _has(data: xr.Dataset, parameter: str) -> bool:
    return bool(np.isfinite(data["front_parameter"].sel(parameter=parameter)).any())


def _dominance_clause(data: xr.Dataset, layout: str, baseline: str) -> str:
    """Clause on how many designs of the baseline's front `layout` strictly dominates; empty without points."""
    ours, theirs = (data["front_value"].sel(layout=name).values for name in (layout, baseline))
    ours, theirs = (values[np.isfinite(values).all(axis=1)] for values in (ours, theirs))
    if not len(ours) or not len(theirs):
        return ""
    beaten = sum(bool(np.any(np.all(ours < point * (1.0 - _SAME), axis=1))) for point in theirs)
    return f", better in all than {beaten or 'none'} of the {len(theirs)} designs of {baseline}"
