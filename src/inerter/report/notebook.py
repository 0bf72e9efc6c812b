"""Results in notebooks: a table of each, its status first where that is not ok."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, nan

from inerter.errors import OK, Status
from inerter.formatting import capital, format_number, format_quantity, format_with_interval
from inerter.identification.fit import Fit
from inerter.methods.compare import Comparison
from inerter.methods.method import Estimate
from inerter.network_search.results import SearchResult
from inerter.optimisation.budget import BreakEven
from inerter.optimisation.optimise import Optimum
from inerter.pareto_fronts.front import ParetoFront
from inerter.report.page import environment
from inerter.simulation.trajectory import Trajectory
from inerter.systems.outputs import main_outputs
from inerter.table import Quantity, Row, Table, cells, columns
from inerter.uncertainty.tolerance import Tolerance
from inerter.vehicle.vehicle import Vehicle, value_units

_MOST = 20  # rows of a ranking or a front

Fact = tuple[str, object]


def estimate_html(found: Estimate) -> str:
    """Value with its errors, and what the method left out."""
    facts: list[Fact] = [("value", found.quantity)]
    if found.interval is not None:
        facts.append(("95 % interval", _interval(found.value, found.interval, found.unit)))
    if found.error_sources:
        facts.append(("largest relative error", format_number(found.error_bound, 2)))
    return _html(_facts("Estimate", facts), found.status, found.notes)


def comparison_html(found: Comparison) -> str:
    """Both values, and the difference in words."""
    facts = [
        ("first", found.first.quantity),
        ("second", found.second.quantity),
        ("difference", str(found)),
    ]
    return _html(_facts("Comparison", facts), found.status)


def optimum_html(found: Optimum) -> str:
    """Best value, its parameters with active bounds, active limits, and how many starts agree."""
    facts: list[Fact] = [("value", found.estimate.quantity), *_parameters(found.parameters, found.design)]
    facts += [(f"{bound} bound", name) for name, bound in found.active_bounds.items()]
    facts += [("limit", label) for label in found.active_limits]
    facts.append(("starts that agree", f"{found.n_converged} of {found.n_starts}"))
    return _html(_facts("Optimum", facts), found.status, found.estimate.notes)


def break_even_html(found: BreakEven) -> str:
    """Break-even value with its interval."""
    error, bound = found.standard_error, found.error_bound
    facts: list[Fact] = [(found.parameter, Quantity(found.value, found.unit, error=error, bound=bound))]
    facts.append(("95 % interval", _interval(found.value, found.interval, found.unit)))
    if isfinite(bound):
        facts.append(("largest relative error", format_number(bound, 2)))
    return _html(_facts("Break-even value", facts), found.status)


def tolerance_html(found: Tolerance) -> str:
    """Distribution of an index, and the part of each value in its variance."""
    nominal = found.nominal.quantity
    quantile = found.quantile_estimate(0.95)
    facts: list[Fact] = [("nominal", nominal)]
    facts.append(("mean", nominal.beside(found.mean, found.standard_errors["mean"])))
    facts.append(("95 % quantile", nominal.beside(quantile.value, quantile.standard_error or nan)))
    facts.append(("worst", nominal.beside(found.worst)))
    facts += [(f"first order of {name}", format_number(share, 3)) for name, share in found.first_order.items()]
    return _html(_facts("Tolerance analysis", facts), found.status)


def front_html(found: ParetoFront) -> str:
    """Points of a front with their parameters; the knee is strong."""
    names = list(found.parameters[0]) if found.parameters else []
    heads = [f"{capital(index.title)} {index.symbol}" for index in found.indices]
    units = value_units(found.designs[0]) if found.designs else {}
    rows = [
        Row(
            cells(
                str(number + 1),
                *(one.quantity for one in estimates),
                *(Quantity(parameters[name], units.get(name, "")) for name in names),
            ),
            strong=number == found.knee,
            status=status.doubt,
        )
        for number, (estimates, parameters, status) in enumerate(
            zip(found.estimates, found.parameters, found.statuses, strict=True)
        )
    ]
    return _html(Table("Pareto front", columns("point", *heads, *names), rows), found.status)


def search_html(found: SearchResult) -> str:
    """The best networks of a search."""
    rows = [
        Row(
            cells(str(rank + 1), one.layout, str(one.n_elements), Quantity(one.value, one.unit)),
            status=one.status.doubt,
        )
        for rank, one in enumerate(found.ranking[:_MOST])
    ]
    more = [f"{found.n_networks - len(rows)} further networks."] if found.n_networks > len(rows) else []
    return _html(Table("Networks", columns("rank", "network", "elements", found.symbol), rows), OK, more)


def fit_html(found: Fit) -> str:
    """Identified values with their intervals; one that is not known is a word."""
    rows = [
        Row(
            cells(
                each.name,
                Quantity(each.value, each.unit, error=each.standard_error) if each.value == each.value else "not known",
                _interval(each.value, each.interval, each.unit),
            )
        )
        for each in found.parameters.values()
    ]
    first = [] if found.reliability_warning is None else [found.reliability_warning.sentence]
    return _html(Table("Device", columns("parameter", "value", "95 % interval"), rows), found.status, first)


def trajectory_html(run: Trajectory) -> str:
    """R.m.s. and peak values of the main outputs of a motion."""
    names = list(run.outputs) if run.mechanism is None else main_outputs(run.mechanism)
    rows = [
        Row(
            cells(
                run.outputs[name].title,
                Quantity(run.rms(name), run.outputs[name].unit),
                Quantity(run.peak(name).value, run.outputs[name].unit),
            )
        )
        for name in names
    ]
    caption = f"Motion from {format_quantity(run.time[0], 's')} to {format_quantity(run.time[-1], 's')}"
    said = [f"{len(run.events)} events.", *run.notes]
    return _html(Table(caption, columns("output", "r.m.s.", "peak"), rows), run.status, said)


def _facts(caption: str, facts: Sequence[Fact]) -> Table:
    return Table(caption, columns("what", "value"), [Row(cells(name, content)) for name, content in facts])  # type: ignore[arg-type]


def _interval(value: float, ends: tuple[float, float], unit: str) -> str:
    return format_with_interval(value, *ends, unit)[1]


def _parameters(values: Mapping[str, float], design: Vehicle) -> list[Fact]:
    units = value_units(design)
    return [(name, Quantity(value, units.get(name, ""))) for name, value in values.items()]


def _html(table: Table, status: Status, said: Sequence[str] = ()) -> str:
    template = environment().get_template("notebook.html")
    return template.render(table=table, status=status.doubt, said=said)
