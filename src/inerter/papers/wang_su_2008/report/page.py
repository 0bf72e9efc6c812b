"""The reproduction of a paper as files, figures and a page."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial
from operator import call
from pathlib import Path

from inerter.atomic_io import write_text
from inerter.figures.networks import draw_networks
from inerter.files.common.folder import FIGURES, REPORT
from inerter.networks.elements import Damper, Element, Friction, Gap, Inerter, Network, Spring
from inerter.networks.parser import network
from inerter.papers.wang_su_2008.judging import RULE, ClaimVerdict
from inerter.papers.wang_su_2008.origins import origins
from inerter.papers.wang_su_2008.paper import NETWORKS, PAPER
from inerter.papers.wang_su_2008.report import figures as drawn
from inerter.papers.wang_su_2008.report.data import data_csv, method_points, tables
from inerter.papers.wang_su_2008.report.tables import (
    budgets_table,
    design_tables,
    linear_tables,
    optima_table,
    rig_table,
    rig_value,
    simulated_tables,
)
from inerter.papers.wang_su_2008.report.text import agreement_of
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rig import SIMULATED
from inerter.papers.wang_su_2008.rows import VERDICTS
from inerter.papers.wang_su_2008.source import study
from inerter.report.page import environment, page_figures
from inerter.work.pool import Pool, worker_pool

Drawing = Callable[[], list[Path]]
_DRAWN = {
    "S1": "k | c",
    "S2": "k | c | b",
    "S3": "k | c - b",
    "Ball screw": "(k_s | c_s) - eps - (b | f)",
    "S3 with a ball screw": "k | c - (k_s | c_s) - eps - (b | f)",
}
_KINDS: dict[str, Callable[[float, str], Element]] = {
    "k": Spring,
    "c": Damper,
    "b": Inerter,
    "k_s": Spring,
    "c_s": Damper,
    "f": Friction,
    "eps": Gap,
}
_METHOD_TITLES = {
    "statistical-linearisation": "Statistical linearisation",
    "expected-value": "Expected value (Method 2)",
    "approximate-linear": "Approximated linear model (Method 1)",
}


def write_reproduction(found: Reproduction, folder: Path, executor: Executor | Pool | None = None) -> None:
    """Write the tables as CSV, the figures, and a page that shows all of it, into `folder`."""
    for name, rows in tables(found).items():
        if rows:
            write_text(folder / f"{name}.csv", data_csv(rows))
    with worker_pool(executor=executor) as pool, pool.of_this_machine() as near:  # drawings are files here
        list(near.spread(call, _figures(found, folder / FIGURES)))
    write_text(folder / REPORT, _page(found, folder))


def _figures(found: Reproduction, folder: Path) -> list[Drawing]:
    """Drawing functions of the figures with results, the slowest first."""
    figures: list[Drawing] = []
    if found.rig is not None:
        figures.append(partial(drawn.draw_rig, found.rig, folder))
    if found.methods:
        figures.append(partial(drawn.draw_methods, method_points(found), _METHOD_TITLES, folder))
    if found.figure11 is not None:
        figures.append(partial(drawn.draw_figure_11, found.figure11, folder))
    if found.curves is not None and "figure13" in found.parts:
        figures.append(partial(drawn.draw_figure_13, found.curves, folder))
    if found.curves is not None and "figure14" in found.parts:
        figures.append(partial(drawn.draw_figure_14, found.curves, folder))
    if "figure12" in found.parts:
        road = study("table1").road
        assert road is not None
        figures.append(partial(drawn.draw_figure_12, road, folder))
    return [*figures, partial(draw_networks, _networks(), folder, NETWORKS)]


def _networks() -> dict[str, Network]:
    elements = {name: kind(1.0, name) for name, kind in _KINDS.items()}
    return {title: network(text, **elements) for title, text in _DRAWN.items()}


def _page(found: Reproduction, folder: Path) -> str:
    captions = PAPER.figures.items()
    figures = {name: one for name, caption in captions for one in page_figures(folder / FIGURES, name, caption)}
    return (
        environment(__package__)
        .get_template("reproduction.html")
        .render(
            title=PAPER.title,
            headlines=_summary(found),
            linear=linear_tables(found),
            simulated=simulated_tables(found),
            designs=design_tables(found),
            origins=origins(found),
            claims=found.claims,
            rule=RULE,
            optima=optima_table(found),
            budgets=budgets_table(found),
            rig=rig_table(found),
            rig_notes=[SIMULATED, *found.rig.notes, *found.rig.bands] if found.rig else [],
            figures=figures,
        )
    )


def _summary(found: Reproduction) -> list[str]:
    """Summary of the reproduction in a few sentences."""
    lines = [agreement_of(found.linear.compared)] if found.linear else []
    rows = list(found.rows.values())
    if rows:
        counts = {verdict: sum(row.verdict == verdict for row in rows) for verdict in VERDICTS}
        said = ", ".join(f"{verdict} {count}" for verdict, count in counts.items() if count)
        lines.append(f"Simulated rows of the tables by verdict: {said}; {len(rows)} in all.")
    if found.claims:
        claims = {verdict: [str(c.number) for c in found.claims if c.verdict is verdict] for verdict in ClaimVerdict}
        said = "; ".join(f"{verdict}: {', '.join(some)}" for verdict, some in claims.items() if some)
        lines.append(f"Claims by number, {said}.")
    if found.optima:
        name, numbers = min(found.optima.items(), key=lambda item: float(item[1]["percent"]))
        lines.append(
            f"A design that knows its friction gains up to {-numbers['percent']:.1f} % on the best linear one ({name})."
        )
    if found.rig is not None:
        values = ", ".join(f"{p.name} {rig_value(p)[0]}" for p in found.rig.parameters)
        lines.append(f"Identified from the records of a virtual rig: {values}.")
    return lines
