"""Tolerance analysis: distribution of the index of each best design, and sensitivity to each value."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from inerter.errors import StatusKind
from inerter.figures.labels import index_title
from inerter.files.common.problem import Problem, at
from inerter.files.study.method_labels import neglect_clause
from inerter.files.study.study import Study
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults, best_design
from inerter.formatting import format_decimals, format_list, format_number, format_percent_size, format_share
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.method import AveragingMethod
from inerter.methods.registry import with_decisive_method
from inerter.methods.ties import percent_below
from inerter.systems.descriptor import linear_notes
from inerter.table import MISSING, Column, Quantity, Row, Table, cells
from inerter.uncertainty.tolerance import SAMPLES, tolerance_analysis
from inerter.validation import number_or_none

SHARE = 0.95  # of cases, of the quantile that is told
_NUMBERS = ("nominal", "mean", "standard_deviation", "quantile", "worst")
_KEYS = {"quantile": f"quantile_{format_number(SHARE)}"}  # of the file, of numbers that have another one there
_HEADINGS = {
    "mean": "Mean",
    "standard_deviation": "Standard deviation",
    "quantile": f"{format_share(SHARE)} of cases below",
    "worst": "Worst",
}


@dataclass(frozen=True)
class TolerancePart(TaskPart["ToleranceAnswer"]):
    """Task part: tolerance analysis of the best design of one layout for one index."""

    layout: str
    index: str

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return f"tolerance of {self.layout} {self.index}"

    def compute(self, study: Study, designs: Designs, threads: int) -> ToleranceAnswer:
        """Tolerance analysis of the best design found."""
        method = study.evaluate[0]
        found = tolerance_analysis(
            best_design(study, designs, self.layout, self.index),
            study.over_conditions(self.index),
            study.method(method, threads),
            spread=study.spread(self.layout),
            seed=study.seed,
        )
        numbers = found.nominal.value, found.mean, found.standard_deviation, found.quantile(SHARE), found.worst
        errors = {**found.standard_errors, "quantile": found.quantile_estimate(SHARE).standard_error or np.nan}
        return ToleranceAnswer(
            **vars(self),
            method=method,
            unit=study.unit(self.index),
            numbers=dict(zip(_NUMBERS, numbers, strict=True)),
            effects={name: [found.first_order[name], found.total_order[name]] for name in found.first_order},
            standard_error=found.nominal.standard_error,
            error_bound=number_or_none(found.nominal.error_bound),
            shared_errors=found.nominal.shared_errors,
            errors={name: error for name, error in errors.items() if np.isfinite(error)},
            **with_decisive_method(found.status, method).to_json(),
        )

    def failed_result(self, study: Study, message: str) -> ToleranceAnswer:
        """Answer without numbers, with status `failed`."""
        return ToleranceAnswer(
            **vars(self),
            method=study.evaluate[0],
            unit=study.unit(self.index),
            numbers={},
            effects={},
            status=StatusKind.FAILED.value,
            message=message,
        )


@dataclass(frozen=True, kw_only=True)
class ToleranceAnswer(Answer):
    """Distribution of an index [SI], and first- and total-order Sobol' indices of the values."""

    of = TolerancePart
    index: str
    method: str
    unit: str
    numbers: dict[str, float]  # nominal, mean, standard_deviation, quantile, worst
    effects: dict[str, list[float]]  # by what scatters: its part of the variance by itself, and in all
    standard_error: float | None = None  # of the nominal value, by random inputs that all values have in common
    error_bound: float | None = None  # of the nominal value, relative, sampling apart
    shared_errors: dict[str, tuple[float, ...]] = field(default_factory=dict)  # of that, those of the road
    errors: dict[str, float] = field(default_factory=dict)  # standard errors of the other numbers, by the sample too

    def quantity(self, name: str) -> Quantity | None:
        """A number of the distribution with its unit and its errors; None if it is not known."""
        if name not in self.numbers:
            return None
        error, bound = (np.nan if known is None else known for known in (self.standard_error, self.error_bound))
        nominal = Quantity(self.numbers["nominal"], self.unit, error, bound)
        return nominal.beside(self.numbers[name], self.errors.get(name, np.nan))


class Tolerances(Task[ToleranceAnswer]):
    """Task: distribution of each index at its best design within the tolerances."""

    key = "tolerances"
    title = "Tolerances"
    answer = ToleranceAnswer

    def parts(self, study: Study) -> list[TolerancePart]:
        """Task parts in the order of indices, layouts; only layouts with a value that has a tolerance."""
        layouts = [layout for layout in study.layouts if study.spread(layout)]
        return [TolerancePart(layout, index) for index in study.indices for layout in layouts]

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of tolerances and quantiles: those of nothing that scatters, of no limits, together with a sweep."""
        for key in ("quantile", "limit_quantile"):
            if getattr(study, key) is not None and not study.tolerance:
                yield at(("study", key), fault="nothing scatters", expected=f"a tolerance, or no {key}")
        if study.limit_quantile is not None and not study.limits:
            expected = "constraints in subject_to, or no limit_quantile"
            yield at(("study", "limit_quantile"), fault="there are no constraints", expected=expected)
        if study.tolerance and study.sweeps:
            yield at(("study", "tolerance"), fault="given together with a sweep", expected="one of the two")

    def warnings(self, study: Study) -> Iterator[str]:
        """Warning on tolerances of designs with friction or gaps that are simulated one by one."""
        if not study.evaluate or not isinstance(study.method(study.evaluate[0]), AveragingMethod):
            return
        names = dict.fromkeys(part.layout for part in self.parts(study))
        slow = [name for name in names if linear_notes(study.design(name).mechanism())]
        if slow:
            count = max((2 + len(study.spread(name))) * SAMPLES for name in slow)
            yield (
                f"Warning: the tolerances of {format_list(slow)} are found by {study.evaluate[0]}, the first of "
                f"evaluate, which simulates more than {count} designs for each index. This may take hours; a quick "
                'method in front takes seconds: evaluate = ["statistical-linearisation", "expected-value"].'
            )

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Relative tolerance of each value, and the percentile that is minimised, by the headings of the report."""
        quantile = [f"the {format_share(study.quantile, 4)} quantile"] if study.quantile is not None else []
        parts = [f"{label} ± {format_share(part, 4)}" for label, part in study.tolerance.items()]
        return {"Tolerances": parts, "Best at": quantile}

    def table(self, results: TaskResults[ToleranceAnswer]) -> Table:
        """One row per design; effects are fractions of the variance."""
        names = list(dict.fromkeys(name for one in results.answers for name in one.effects))
        heads = [
            Column("Design"),
            *(Column(key=key) for key in ("layout", "index", "method")),
            *(Column(_HEADINGS.get(name, ""), _KEYS.get(name, name)) for name in _NUMBERS),
            *(Column(key=key) for key in ("unit", "standard_error", "error_bound")),
            *(Column(key=f"{kind} effect of {name}") for name in names for kind in ("main", "total")),
            Column("Due to", prose=True),
            Column(key="status"),
        ]
        rows = []
        for one in results.answers:
            effects = [part for name in names for part in one.effects.get(name, (None, None))]
            contents = [
                f"{one.layout}, {one.index}",
                one.layout,
                one.index,
                one.method,
                *map(one.quantity, _NUMBERS),
                *(one.unit, one.standard_error, one.error_bound),
                *effects,
            ]
            rows.append(Row(cells(*contents, _due(one), one.status_text), status=one.doubt))
        return Table("Best designs with tolerances", heads, rows)

    def introduction(self) -> str:
        """Paragraph above the table: distribution of the values, and meaning of the last column."""
        return (
            "Each best design with values uniformly distributed within their tolerances. "
            "Last column: share of the variance that would vanish if the value were exact (total effect)."
        )

    def sentences(self, results: TaskResults[ToleranceAnswer]) -> Iterator[str]:
        """Layout with the lowest quantile for each index, and layouts without an answer, as sentences."""
        data, answers = results.data, results.answers
        for index in dict.fromkeys(one.index for one in answers):
            own = [one for one in answers if one.index == index]
            title = index_title(data, index)
            known = [one for one in own if np.isfinite(one.numbers.get("quantile", np.nan))]
            told = [_best_sentence(title, known, data.attrs["baseline"], results.study)] if known else []
            told += [
                f"No answer for {title} of {one.layout} with tolerances: {one.message.rstrip('.')}."
                for one in own
                if one not in known
            ]
            yield " ".join(told)


def _best_sentence(title: str, known: Sequence[ToleranceAnswer], baseline: str | None, study: Study) -> str:
    """Sentence on the layout with the lowest quantile, compared with the baseline and the best nominal layout."""
    by_quantile = sorted(known, key=lambda one: one.numbers["quantile"])
    best, nominal = by_quantile[0], min(known, key=lambda one: one.numbers["nominal"])
    deviation, quantile, worst = map(best.quantity, ("standard_deviation", "quantile", "worst"))
    base = next((one for one in known if one.layout == baseline), None)
    compared = ""
    if base is not None and base is not best and base.numbers["quantile"] > 0.0:
        own, other = best.numbers["quantile"], base.numbers["quantile"]
        bounds = best.error_bound or 0.0, base.error_bound or 0.0
        bound = improvement_bound(own, other, *bounds, best.shared_errors, base.shared_errors)
        better = format_percent_size(percent_below(own, other), bound=bound)
        compared = f", {better} better than {base.layout} with its tolerances"
    elif base is best and len(known) > 1:
        compared = "; no other layout is better than this baseline"
    neglect = neglect_clause(study, best.method)
    model = f" ({neglect})" if neglect else ""
    share, name = (_shares(best) or [(0.0, "")])[0]
    due = f", mostly due to {name}" if share > 0.0 else ""
    order = f" Without tolerances {nominal.layout} is best." if nominal is not best else ""
    doubts = dict.fromkeys(one.message.rstrip(".") for one in known if not one.ok)
    certain = "".join(f"Not certain: {doubt}. " for doubt in doubts)
    return (
        f"{certain}With tolerances{model} {best.layout} is best for {title}: {format_share(SHARE)} of cases are below "
        f"{quantile}{compared}; standard deviation {deviation}{due}, worst {worst}.{order}"
    )


def _shares(one: ToleranceAnswer) -> list[tuple[float, str]]:
    """Pairs of total-order Sobol' index and name of the value, largest first."""
    known = [(total, name) for name, (_, total) in one.effects.items() if np.isfinite(total)]
    return sorted(known, reverse=True)


def _due(one: ToleranceAnswer) -> str:
    """Values that contribute to the variance, largest first, each with its total-order Sobol' index [%], as text."""
    return (
        ", ".join(f"{name} {format_decimals(100.0 * max(total, 0.0), 0)} %" for total, name in _shares(one)) or MISSING
    )
