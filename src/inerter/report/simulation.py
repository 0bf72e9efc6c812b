"""Simulation result as text for a terminal of 80 columns and as data for JSON."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from inerter.figures.simulation import Window
from inerter.files.simulation.running import SimulationResult
from inerter.formatting import format_decimals, format_number, format_quantity, format_range, in_words
from inerter.report.json_data import json_data
from inerter.report.text import WIDTH, table_lines
from inerter.simulation.peaks import LiftOff, Peak
from inerter.table import Column, Quantity, Row, Table, cells, columns
from inerter.units import quote_value


def simulation_text(result: SimulationResult, window: Window | None) -> str:
    """The request, r.m.s. values, events, energy, what the figure shows, and the status: at most 80 columns.

    A status that is not ok stands before the values.
    """
    status = wrap(f"Status: {result.run.status}", WIDTH, subsequent_indent="  ")
    blocks = [_request(result), _values(result), _elements(result), _energy(result), _remarks(result, window)]
    blocks.insert(len(blocks) if result.run.status.ok else 1, iter(status))
    return "\n\n".join("\n".join(block) for block in map(list, blocks) if block)


def simulation_data(result: SimulationResult) -> dict[str, Any]:
    """Request, r.m.s. values, peaks, tyre loads, events, energy and status in SI units, for JSON."""
    run, request = result.run, result.request
    energy, repetition = run.energy, run.repetition
    data = {
        **request.to_tables(),
        "time": [float(run.time[0]), float(run.time[-1])],
        "status": str(run.status),
        "rms": {name: {"value": result.rms(name), "unit": run.unit(name)} for name in result.main_outputs},
        "peaks": {name: {**vars(run.peak(name)), "unit": run.unit(name)} for name in result.main_outputs},
        "tyres": {
            name: {"static_load": load, "least": vars(run.least_tyre_loads[name])}
            for name, load in run.static_loads.items()
        },
        "lift_offs": [vars(one) for one in run.lift_offs],
        "notes": [*result.notes],
        "nonlinear": {
            n.name: {"kind": n.kind, "strut": n.strut, "events": n.events, "shares": n.shares} for n in result.nonlinear
        },
        "energy": None if energy is None else {**vars(energy), "residual": energy.residual},
        "repetition": None if repetition is None else vars(repetition),
    }
    plain: dict[str, Any] = json_data(data)
    return plain


def _request(result: SimulationResult) -> Iterator[str]:
    request, run = result.request, result.run
    signal, units = request.signal, request.signal.units
    given = {key: value for key, value in signal.values.items() if value not in (None, "")}
    keys = [f"{k} {format_quantity(v, units[k]) if units[k] else _word(v)}" for k, v in given.items()]
    yield from wrap(request.title, WIDTH)
    network = "; ".join(dict.fromkeys(request.layouts[request.layout].struts.values()))
    yield from wrap(f"{request.model}, {request.layout} = {network}", WIDTH, subsequent_indent="  ")
    yield from wrap(f"{signal.input}: {signal.kind}, {', '.join(keys)}", WIDTH, subsequent_indent="  ")
    start = "steady state" if request.initial == "periodic" else f"from {request.initial}"
    steps = f"{format_number(run.time[-1] - run.time[0])} s in steps of {format_number(1e3 * request.step)} ms"
    yield from wrap(f"{steps}, {request.integrator}, {start}", WIDTH)


def _word(value: object) -> str:
    return value.rpartition("/")[2] if isinstance(value, str) else quote_value(value)


def _values(result: SimulationResult) -> Iterator[str]:
    run = result.run
    rows = [
        Row(
            cells(
                in_words(name),
                Quantity(result.rms(name), run.unit(name)),
                _when(run.peak(name), run.unit(name)),
            )
        )
        for name in result.main_outputs
    ]
    yield from table_lines(Table("Outputs", columns("Output", "r.m.s.", "Largest"), rows))
    rows = [
        Row(cells(in_words(tyre), _when(least, "N"), Quantity(run.static_loads[tyre], "N")))
        for tyre, least in run.least_tyre_loads.items()
    ]
    if rows:
        yield ""
        yield from table_lines(Table("Loads of the tyres on the road", columns("Tyre", "Least", "At rest"), rows))


def _when(peak: Peak, unit: str) -> str:
    return f"{format_quantity(peak.value, unit)} at {format_quantity(peak.time, 's')}"


def _elements(result: SimulationResult) -> Iterator[str]:
    rows = []
    for n in result.nonlinear:
        shares = ", ".join(
            f"{n.switch.time_in(state)} {format_decimals(100 * share, 1)} %" for state, share in n.shares.items()
        )
        rows.append(Row(cells(f"{n.kind} {n.name}", n.events, shares)))
    if rows:
        heads = [*columns("Element", "Events"), Column("Share of the time", prose=True)]
        yield from table_lines(Table("Nonlinear elements", heads, rows))
    if result.unrecorded_elements:
        names = ", ".join(result.unrecorded_elements)
        yield from wrap(f"Note: this integrator keeps no events of {names}; the event-driven one does.", WIDTH)


def _energy(result: SimulationResult) -> Iterator[str]:
    energy = result.run.energy
    if energy is None:
        return
    kinds = {n.name: n.kind for n in result.nonlinear}
    work = {
        **{f"put in by {name}": work for name, work in energy.inputs.items() if name in result.inputs},
        "gained by masses, inerters and springs": energy.stored,
        **{f"dissipated in damper {name}": work for name, work in energy.dampers.items()},
        **{f"dissipated in {kinds.get(name, 'friction')} {name}": work for name, work in energy.friction.items()},
        "unaccounted for": energy.residual,
    }
    rows = [Row(cells(name, Quantity(value, "J"))) for name, value in work.items()]
    yield from table_lines(Table("Energy", columns("Part", "Work"), rows))


def _remarks(result: SimulationResult, window: Window | None) -> Iterator[str]:
    run, begin, end = result.run, float(result.run.time[0]), float(result.run.time[-1])
    if run.repetition is not None:
        r = run.repetition
        mismatch = format_number(r.mismatch, 2)
        yield f"Steady state: after {r.periods} periods the state repeats to {mismatch} of its size."
    if window is not None and window != (begin, end):
        shown = format_range(*window, "s", 6)
        yield f"The figure shows {shown}; another part with --window FROM:TO."
    if window is not None and run.lift_offs:
        yield from _elsewhere(run.lift_offs, window, (begin, end))
    for note in result.notes:
        yield from wrap(f"Note: {note}", WIDTH)


def _elsewhere(found: tuple[LiftOff, ...], window: Window, whole: Window) -> Iterator[str]:
    """Sentence on the window of the first lift-off, if none lies in the window of the figure."""
    if not any(one.end > window[0] and one.begin < window[1] for one in found):
        half, at = 0.5 * (window[1] - window[0]), found[0].begin
        around = f"{format_number(max(whole[0], at - half), 4)}:{format_number(min(whole[1], at + half), 4)}"
        yield f"No tyre lifts off in that part; the first one does within --window {around}."
