"""Pareto fronts: non-dominated designs of each layout in the indices of a trade-off."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, nan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from inerter.errors import StatusKind
from inerter.files.common.problem import Problem, at
from inerter.files.study.conditions import CONDITION
from inerter.files.study.limits import all_limits
from inerter.files.study.method_labels import method_labels
from inerter.files.study.study import Study
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults
from inerter.formatting import format_count, format_list, format_quantity, label_with_unit
from inerter.methods.registry import with_decisive_method
from inerter.pareto_fronts.front import ParetoFront
from inerter.pareto_fronts.pareto import pareto_front
from inerter.table import Column, Quantity, Row, Table, cells
from inerter.validation import number_or_none

if TYPE_CHECKING:
    import xarray as xr

_LEAST_OF_THREE = 6  # points of a front of three indices
_SAME = 1e-9  # relative; a point that is as good as another in all indices does not better it


@dataclass(frozen=True)
class FrontPart(TaskPart["FrontAnswer"]):
    """Task part: Pareto front of one layout."""

    layout: str

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return f"front of {self.layout}"

    def compute(self, study: Study, designs: Designs, threads: int) -> FrontAnswer:
        """Pareto front of the layout."""
        limits = all_limits(study, self.layout)
        indices = [study.resolve_index(name, self.layout) for name in study.trade_off]
        method = study.method(str(study.optimise), threads)
        design = study.design(self.layout)
        vehicle = design if study.conditions else design.mechanism()
        found = pareto_front(vehicle, indices, method, points=study.points, subject_to=limits, seed=study.seed)
        return _answer(self.layout, found, str(study.optimise))

    def failed_result(self, study: Study, message: str) -> FrontAnswer:
        """Answer without points, with status `failed`."""
        return _without(self.layout, StatusKind.FAILED.value, message)


@dataclass(frozen=True, kw_only=True)
class FrontAnswer(Answer):
    """Points of a Pareto front, in ascending order of the first index [SI]."""

    of = FrontPart
    values: list[list[float]]  # of each point, by index
    parameters: list[dict[str, float]]
    statuses: list[str]
    jumps: list[int]  # points after which the front leaps
    knee: int | None
    standard_errors: list[list[float | None]] = field(default_factory=list)  # of the values; none of an exact method
    error_bounds: list[list[float | None]] = field(default_factory=list)  # of the values, relative, sampling apart
    in_conditions: list[list[list[float]]] = field(default_factory=list)  # the values in each operating condition

    def quantities(self, study: Study, point: int) -> list[Quantity]:
        """The indices at a point with their units and errors."""
        none: list[float | None] = [None] * len(study.trade_off)
        errors, bounds = (known[point] if known else none for known in (self.standard_errors, self.error_bounds))
        return [
            Quantity(value, study.unit(name), nan if error is None else error, nan if bound is None else bound)
            for name, value, error, bound in zip(study.trade_off, self.values[point], errors, bounds, strict=True)
        ]

    def values_in_conditions(self, study: Study, point: int) -> NDArray[np.float64]:
        """The indices at a point in each condition (criteria, conditions), nan where they are not known."""
        known = self.in_conditions[point] if self.in_conditions else None
        return np.array(known or np.full((len(study.trade_off), len(study.conditions)), nan))


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
            yield at(place, fault="nothing is optimised", expected='optimise = "norm", or no trade_off')

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Indices of the trade-off, by the heading of the report."""
        names = [name.replace("-", " ") for name in study.trade_off]
        return {"Trade-off": [" against ".join(names)] if names else []}

    def add_to_dataset(self, study: Study, data: xr.Dataset, answers: Sequence[FrontAnswer]) -> xr.Dataset:
        """Dataset with the fronts: dimensions layout, front_point, criterion, and parameter."""
        points = max([len(front.values) for front in answers] + [1])
        layouts, parameters = data["layout"].values.tolist(), data["parameter"].values.tolist()
        values, errors, bounds = np.full((3, len(layouts), points, len(study.trade_off)), np.nan)
        designs = np.full((len(layouts), points, len(parameters)), np.nan)
        each = np.full((*values.shape, len(study.conditions)), np.nan)
        knees, leaps = np.full((len(layouts), points), False), np.full((len(layouts), points), False)
        status = np.full(len(layouts), "missing", dtype=object)
        for front in answers:
            row = layouts.index(front.layout)
            status[row] = front.status_text
            for i, design in enumerate(front.parameters):
                numbers = front.quantities(study, i)
                values[row, i] = [number.value for number in numbers]
                errors[row, i] = [number.error for number in numbers]
                bounds[row, i] = [number.bound for number in numbers]
                each[row, i] = front.values_in_conditions(study, i)
                designs[row, i] = [design.get(name, np.nan) for name in parameters]
            knees[row, [] if front.knee is None else [front.knee]] = True
            leaps[row, front.jumps] = True
        labelled = data.assign_coords(
            criterion=list(study.trade_off),
            criterion_title=("criterion", [study.objective_title(name) for name in study.trade_off]),
            criterion_unit=("criterion", [study.unit(name) for name in study.trade_off]),
        )
        of_points = ("layout", "front_point", "criterion")
        attributes = {"long_name": "index at a point of the front", "title": _title(study)}
        there = {"long_name": "that index in each condition"}
        if study.conditions:
            labelled = labelled.assign(front_in_conditions=((*of_points, CONDITION), each, there))
        return labelled.assign(
            front_value=(of_points, values, attributes),
            front_standard_error=(of_points, errors, {"long_name": "standard error of that index"}),
            front_error_bound=(of_points, bounds, {"long_name": "its largest relative error, sampling apart"}),
            front_parameter=(("layout", "front_point", "parameter"), designs, {"long_name": "parameter at that point"}),
            front_knee=(("layout", "front_point"), knees, {"long_name": "whether it is the knee"}),
            front_jump=(("layout", "front_point"), leaps, {"long_name": "whether the front is interrupted after it"}),
            front_status=("layout", status, {"long_name": "status of the front"}),
        )

    def table(self, results: TaskResults[FrontAnswer]) -> Table:
        """One row per point, those at the ends and the knee with their labels; one of a front without points."""
        study, free = results.study, results.study.free_units
        names = [name for name in free if any(name in design for one in results.answers for design in one.parameters)]
        heads = [
            Column("Layout", "layout"),
            Column("Design", words=True),
            Column(key="point"),
            *(Column(name, label_with_unit(name, study.unit(name))) for name in study.trade_off),
            *(Column(name, label_with_unit(name, free[name]), listed="Parameters") for name in names),
            *(Column(key=f"{name}_{which}") for name in study.trade_off for which in ("standard_error", "error_bound")),
            *(Column(key=key) for key in ("knee", "jump_after", "status")),
            *(Column(key=f"{name} in {label}") for name in study.trade_off for label in study.condition_labels),
        ]
        rows = [row for one in results.answers for row in _rows(study, one, names)]
        return Table(f"{_title(study)}: the designs at the ends and the knee", heads, rows)

    def introduction(self) -> str:
        """Paragraph above the table: which designs it lists, and the file with all points."""
        return (
            "The ends and the knee of each layout's front: no design of the layout is better in all of these indices. "
            "fronts.csv has all points."
        )

    def sentences(self, results: TaskResults[FrontAnswer]) -> Iterator[str]:
        """Sentence on each Pareto front: indices at its knee, and number of dominated designs of the baseline."""
        study, by_layout = results.study, {front.layout: front for front in results.answers}
        fronts = sorted(
            (one for one in results.answers if one.knee is not None), key=lambda one: one.layout != study.baseline
        )
        clauses = []
        for front in fronts:
            knee = front.quantities(study, front.knee or 0)
            values = format_list([format_quantity(q.value, q.unit, error=q.error, bound=q.bound) for q in knee])
            better = _dominance_clause(front, by_layout[study.baseline]) if study.baseline in by_layout else ""
            clauses.append(f"{front.layout} {values}{better}")
        doubts = [f"{front.layout}, {front.status_text}" for front in fronts if not front.ok]
        if clauses:
            doubt = f"Not certain ({'; '.join(doubts)}). " if doubts else ""
            yield f"{doubt}{_title(study)}, at the knee: {'; '.join(clauses)}."


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
        standard_errors=[[number_or_none(one.standard_error) for one in row] for row in found.estimates],
        error_bounds=[[number_or_none(one.error_bound) for one in row] for row in found.estimates],
        in_conditions=[[[there.value for there in one.in_conditions] for one in row] for row in found.estimates],
        **with_decisive_method(found.status, method).to_json(),
    )


def _without(layout: str, status: str, message: str) -> FrontAnswer:
    return FrontAnswer(
        layout=layout, values=[], parameters=[], statuses=[], jumps=[], knee=None, status=status, message=message
    )


def _title(study: Study) -> str:
    """Title of the trade-off: its indices, and the method if the study has several."""
    titles = [study.objective_title(name) for name in study.trade_off]
    by = method_labels(replace(study, evaluate=study.methods))[str(study.optimise)] if len(study.methods) > 1 else ""
    return f"Trade-off between {format_list(titles)}{by and f', {by}'}"


def _rows(study: Study, front: FrontAnswer, parameters: Sequence[str]) -> Iterator[Row]:
    """Rows on the points of a front; those at its ends and its knee are shown."""
    shown = _labelled_points(study, front)
    for i, design in enumerate(front.parameters):
        values = front.quantities(study, i)
        contents = [
            *(front.layout, shown.get(i), i + 1),
            *values,
            *(Quantity(design[name], study.free_units[name]) if name in design else None for name in parameters),
            *(number_or_none(error) for value in values for error in (value.error, value.bound)),
            *("yes" if i == front.knee else "", "yes" if i in front.jumps else "", front.statuses[i]),
            *front.values_in_conditions(study, i).ravel().tolist(),
        ]
        doubt = front.doubt if i == max(shown, default=0) else ""
        yield Row(cells(*contents), status=doubt, shown=i in shown)
    if not front.values:
        unknown = [None] * (3 * len(study.trade_off) + len(parameters) + 2)
        there = [None] * (len(study.trade_off) * len(study.conditions))
        yield Row(cells(front.layout, "", "", *unknown, front.status_text, *there), status=front.doubt)


def _labelled_points(study: Study, front: FrontAnswer) -> dict[int, str]:
    """Points at the ends of a front and at its knee, with their labels."""
    labels: dict[int, list[str]] = {}
    for i, name in enumerate(study.trade_off):
        known = [(point[i], place) for place, point in enumerate(front.values) if isfinite(point[i])]
        if known:
            labels.setdefault(min(known)[1], []).append(f"least {name}")
    if front.knee is not None:
        labels.setdefault(front.knee, []).append("knee")
    return {place: ", ".join(several) for place, several in labels.items()}


def _dominance_clause(front: FrontAnswer, baseline: FrontAnswer) -> str:
    """Clause on how many designs of the baseline's front this one strictly dominates; empty without points."""
    ours, theirs = (np.array([v for v in one.values if np.isfinite(v).all()]) for one in (front, baseline))
    if front is baseline or not len(ours) or not len(theirs):
        return ""
    beaten = sum(bool(np.any(np.all(ours < point * (1.0 - _SAME), axis=1))) for point in theirs)
    designs = format_count(len(theirs), "designs")
    whole = "the design" if len(theirs) == 1 else f"all {designs}"
    those = whole if beaten == len(theirs) else f"{beaten or 'none'} of the {designs}"
    both = "both" if ours.shape[1] == 2 else "all"
    return f", better in {both} indices than {those} of {baseline.layout}"
