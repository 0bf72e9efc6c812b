"""The answers of panels: each is a function from a study and the body of a request to data that JSON can hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from math import floor, log2
from pkgutil import resolve_name
from typing import Any

import numpy as np

from inerter.app.designs import baseline_of, designs_of, one_design, problem_digest
from inerter.app.documents import study_for
from inerter.app.histories import history
from inerter.app.kinds import Tell, report_nothing
from inerter.app.panels import PANELS
from inerter.app.warm import is_compiled
from inerter.app.wire import encode_json
from inerter.decision.of_study import decisive_method
from inerter.errors import DesignError, StudyError
from inerter.field_metadata import fields_of
from inerter.files.common.roads import ROAD_QUANTITIES
from inerter.files.study.cases import Case, Outcome, run_case
from inerter.files.study.responses import IndexResponse, index_responses
from inerter.files.study.results import dataset
from inerter.files.study.study import Study
from inerter.formatting import format_quantity, in_words, printed_text, typeset
from inerter.indices.registry import INDICES
from inerter.methods.registry import DEFAULT, averages, is_blind, methods_that, searches
from inerter.networks.elements import Damper, Element, Inerter, Spring
from inerter.networks.elements.algebra import CombinedNetwork, Network
from inerter.optimisation.budget import BreakEven
from inerter.report.speeds import SpeedSentences, speed_sentences
from inerter.systems.graph import full_graph
from inerter.systems.outputs import outputs
from inerter.tasks.budgets import element_break_even
from inerter.tasks.margins import SHARES
from inerter.uncertainty.tolerance import tolerance_analysis
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.registry import VEHICLES
from inerter.work.blas_threads import one_blas_thread

Body = Mapping[str, Any]
Answer = dict[str, Any]

_MOST_DESIGNS = 10_000  # that are judged for a scatter while one waits, and a quarter of them by a method that iterates
_SAMPLES = 64, 1024  # of a scatter: fewest and most
_MOST_COORDINATES = 4  # of a vehicle whose optima are found by norms while one waits


def first() -> None:
    """Answer the most frequent requests once, so that their modules are loaded and kernels compiled."""
    model, kind = next(iter(VEHICLES.items()))
    elements: dict[str, Any] = {element.symbol: element.example for element in (Spring, Damper, Inerter)}
    study: dict[str, dict[str, Any]] = {
        "vehicle": {"model": model, **{field.key: field.example for field in fields_of(kind)}},
        "road": {field.key: field.example for field in ROAD_QUANTITIES},
        "elements": elements,
        "layouts": {"first": f"{Spring.symbol} | {Damper.symbol}", "second": " | ".join(elements)},
        "study": {"indices": [next(iter(INDICES))]},
    }
    for key in ("decision", "response"):
        encode_json(answer_panel(key, {"study": study}))
    search = methods_that(searches)[0]
    if is_compiled(search):  # else it would wait here for the compiler
        elements[Damper.symbol] = {"from": "100 N s/m", "to": "10 kN s/m"}
        study["study"]["optimise"] = search
        encode_json(answer_panel("optimise", {"study": study}))


def answer_panel(key: str, body: Body) -> Answer:
    """The answer of a panel.

    Raises what the library raises of what was asked.
    """
    with one_blas_thread(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        answer: Callable[[Study, Body], Answer] = resolve_name(PANELS[key].home)
        study, asked = study_for(body)
        for index in asked.get("indices") or ():
            study.symbol(index)  # raises if it is unknown
        left_out = {key: asked[key] for key in ("left_out",) if key in asked}
        return {**answer(study, asked), **left_out}


def response(study: Study, body: Body) -> Answer:
    """The frequency responses of all designs over the same frequencies, made as those of a study's results are."""
    designs, indices = designs_of(study, body), tuple(body.get("indices") or study.indices)
    numbered = {str(number): design for number, design in enumerate(designs)}
    each = replace(study, indices=indices, layouts={n: study.layouts[design.layout] for n, design in numbered.items()})
    found = {Case(n, index): design.values for n, design in numbered.items() for index in indices}
    omega, every = index_responses(each, found)
    curves = [
        {
            "name": design.name,
            "layout": design.layout,
            "index": one.index,
            "title": title,
            "unit": one.unit,
            "label": label,
            "gain": gain,
            "phase": phase,
        }
        for one in every
        for design, several, angles in zip(designs, one.gains, one.phases, strict=True)
        for title, label, gain, phase in zip(_output_titles(one), one.outputs, several, angles, strict=True)
    ]
    return {"frequency": omega / (2.0 * np.pi), "curves": curves}


def _output_titles(one: IndexResponse) -> list[str]:
    """Titles of the outputs of an index: its response in words, of several outputs that of each."""
    if len(one.outputs) == 1:
        return [one.words]
    _, per, source = one.words.partition(" per ")
    names = [in_words(label) for label in one.outputs]
    return [f"{name} per {source}" if per else f"{name}: {one.words}" for name in names]


def mechanism(study: Study, body: Body) -> Answer:
    design = one_design(study, body)
    return {**design.describe_values(), **describe_mechanism(design.mechanism)}


def describe_mechanism(mechanism: Mechanism) -> Answer:
    """Coordinates, struts, tyres, roads, forces and outputs of a mechanism as data."""
    angles = {c.name for c in mechanism.coordinates if c.angle}
    rolling = {name for name, other in mechanism.mirror if name == other}

    def end(port: Mapping[str, float]) -> Answer:
        return {"port": dict(port), "x": sum(lever for name, lever in port.items() if name in angles - rolling)}

    known = outputs(mechanism, full_graph(mechanism))
    return {
        "coordinates": [
            {
                "name": c.name,
                "inertia": c.inertia,
                "text": _written(c.inertia, "kg m^2" if c.angle else "kg"),
                "angle": c.angle,
                "roll": c.name in rolling,
            }
            for c in mechanism.coordinates
        ],
        "struts": [
            {"name": s.name, "upper": end(s.upper), "lower": end(s.lower), "network": tree_of(s.network)}
            for s in mechanism.struts
        ],
        "tyres": [
            {"name": t.name, **end(t.port), "road": t.road, "network": tree_of(t.network)} for t in mechanism.tyres
        ],
        "roads": [{"name": r.name, "distance": r.distance, "side": r.side} for r in mechanism.roads],
        "forces": [{"name": f.name, **end(f.port)} for f in mechanism.forces],
        "outputs": [{"name": o.name, "unit": o.unit, "title": o.title} for o in known.values()],
    }


def _written(value: Any, unit: str) -> str:
    """Value of a design, which is a number, as text."""
    return typeset(format_quantity(value, unit))


def tree_of(network: Network) -> Answer:
    """Network as data: connections, and name, kind, unit and value of each element, which is written as `text`."""
    if isinstance(network, Element):
        return {
            "kind": "element",
            "name": network.label,
            "key": network.key,
            "unit": network.unit,
            "value": network.value,
            "text": _written(network.value, network.unit),
        }
    assert isinstance(network, CombinedNetwork)
    return {"kind": type(network).__name__.lower(), "parts": [tree_of(part) for part in network.parts]}


def optimum(study: Study, body: Body, tell: Tell = report_nothing) -> Answer:
    """Best design of each layout for each requested index, found and evaluated as in a study.

    With it, in the sentences of its report, what the best become at other speeds, first what makes them doubtful.
    `while_waiting` asks for nothing that takes longer than a person waits: `designs` is None of a large vehicle, and
    empty where no value is free.
    """
    layouts = tuple(body.get("layouts") or study.layouts)
    if body.get("while_waiting"):
        designs = [one_design(study, {"layout": layout}) for layout in layouts]
        if not any(design.free for design in designs):
            return {"designs": []}
        if len(designs[0].mechanism.coordinates) > _MOST_COORDINATES:
            return {"designs": None}
    wanted = tuple(body.get("indices") or study.indices)
    asked = replace(
        study,
        indices=tuple(dict.fromkeys([*study.indices, *wanted])),  # each design is judged by all
        optimise=body.get("method") or study.optimise or methods_that(searches)[0],
        evaluate=tuple(body.get("methods") or study.evaluate),
        sweeps=(),
    )
    for layout in layouts:
        study.design(layout)
    for name in asked.methods:
        asked.method(name)
    found: dict[Case, Outcome] = {}
    every = [Case(layout, index) for layout in layouts for index in wanted]
    for case in every:
        tell(len(found), len(every), f"{case.layout} {case.index}")
        found[case] = run_case(asked, case)
    tell(len(found), len(every), "")
    return {
        "designs": [_describe_outcome(study, outcome) for outcome in found.values()],
        "at_speeds": {key: [*map(printed_text, told)] for key, told in asdict(_at_speeds(asked, found)).items()},
    }


def _at_speeds(study: Study, found: Mapping[Case, Outcome]) -> SpeedSentences:
    """Sentences on the best of these designs at other speeds; empty where speed only scales the values."""
    if not any(outcome.speeds for outcome in found.values()):
        return SpeedSentences([], [])
    layouts = {case.layout: study.layouts[case.layout] for case in found}
    indices = tuple(dict.fromkeys(case.index for case in found))
    baseline = study.baseline if study.baseline in layouts else None
    there = replace(study, layouts=layouts, indices=indices, baseline=baseline, trade_off=(), budgets=())
    return speed_sentences(dataset(there, found))


def _describe_outcome(study: Study, outcome: Outcome) -> Answer:
    """Outcome of a design for an answer, with its values as texts that are read back exactly."""
    return {
        **outcome.to_json(),
        "notes": ["".join(map(str, note)) for note in outcome.notes],
        "texts": texts_of(study, outcome.parameters),
        "problem_digests": [problem_digest(study, outcome.layout, outcome.index)],
    }


def texts_of(study: Study, values: Mapping[str, float]) -> dict[str, str]:
    """Texts of element values that are read back exactly."""
    return {name: f"{value!r} {study.free_units[name]}" for name, value in values.items()}


def break_even(study: Study, body: Body) -> Answer:
    design = one_design(study, body)
    baseline = baseline_of(study, body, [])
    if baseline is None:
        raise DesignError("A break-even value needs a baseline: a second layout, or `baseline` in the request.")
    method = body.get("method") or decisive_method((*(body.get("methods") or ()), *study.evaluate))
    index, element = required_value(body, "index"), required_value(body, "parameter")
    found = element_break_even(
        design.vehicle, baseline.vehicle, study.over_conditions(index), element, study.method(method)
    )
    return {
        "parameter": found.parameter,
        "method": method,
        "unit": found.unit,
        "value": found.value,
        "standard_error": found.standard_error,
        "interval": found.interval,
        "error_bound": found.error_bound,
        "bounds": found.bounds,
        "crossings": [
            {"value": c.value, "standard_error": c.standard_error, "error_bound": c.error_bound, "better": c.better}
            for c in found.crossings
        ],
        "ranges": list(map(vars, found.ranges)),
        "sentence": printed_text(_break_even_sentence(found, design.name, baseline.name)),
        **found.status.to_json(),
    }


def _break_even_sentence(found: BreakEven, name: str, baseline: str) -> str:
    """Break-even value in words, or why there is none; of a doubtful one the doubt first."""
    if not np.isfinite(found.value):
        return found.status.message or "There is no break-even value."
    value = format_quantity(found.value, found.unit, error=found.standard_error, bound=found.error_bound)
    doubt = "" if found.status.ok else f"Unreliable: {str(found.status).rstrip('.')}. "
    return f"{doubt}At {found.parameter} = {value}, {name} is as good as {baseline}."


def scatter(study: Study, body: Body) -> Answer:
    """Tolerance analysis of a design: distribution of an index, and first- and total-order Sobol' indices.

    By the first of several methods that does not average over roads, and with as many samples as a wait allows.
    """
    design, name = one_design(study, body), required_value(body, "index")
    index, spread = study.over_conditions(name), required_value(body, "spread")
    quick = (method for method in body.get("methods") or () if not averages(method))
    method = body.get("method") or next(quick, DEFAULT)
    found = tolerance_analysis(
        design.vehicle,
        index,
        study.method(method),
        spread=spread,
        samples=body.get("samples") or _affordable_samples(method, len(spread)),
        seed=body.get("seed") or 0,
    )
    counts, edges = np.histogram(found.values[np.isfinite(found.values)], bins=40)
    return {
        **design.describe_values(),
        "index": name,
        "unit": study.unit(name),
        "method": method,
        "nominal": found.nominal.value,
        "mean": found.mean,
        "standard_deviation": found.standard_deviation,
        "quantiles": {str(share): found.quantile(share) for share in SHARES},
        "standard_errors": {
            **found.standard_errors,
            **{str(share): found.quantile_estimate(share).standard_error for share in SHARES},
        },
        "worst": found.worst,
        "worst_values": found.worst_values,
        "main": found.first_order,
        "total": found.total_order,
        "histogram": {"edges": edges, "counts": counts},
        **found.status.to_json(),
    }


def _affordable_samples(method: str, n_scattering: int) -> int:
    """Number of samples that a wait allows, a power of two: each has as many designs as values scatter, and two."""
    designs = _MOST_DESIGNS if is_blind(method) else _MOST_DESIGNS // 4
    fewest, most = _SAMPLES
    return int(min(max(2 ** floor(log2(designs / (2 + n_scattering))), fewest), most))


def required_value(body: Body, key: str) -> Any:
    """Value of a required key of a request; raises `StudyError` where it is left out."""
    if not body.get(key):
        raise StudyError(f"The request needs `{key}`.")
    return body[key]


def motion(study: Study, body: Body) -> Answer:
    return history(study, one_design(study, body), body)
