"""The reproduction of a paper as plain text of 80 columns, and how its numbers are written."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from inerter.errors import StatusKind
from inerter.formatting import format_quantity, format_with_interval, typeset_quantity
from inerter.papers.wang_su_2008.judging import RULE, Claim
from inerter.papers.wang_su_2008.linear import ComparedRow, FoundDesign
from inerter.papers.wang_su_2008.paper import PAPER
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rig import SIMULATED, IdentifiedParameter
from inerter.papers.wang_su_2008.rows import VERDICTS, SimulatedRow
from inerter.report.text import WIDTH

_SIGNS = dict(zip(VERDICTS, "=~<?^!", strict=True))


def reproduction_text(found: Reproduction) -> str:
    """Reproduction as plain text of at most 80 columns."""
    lines = [*wrap(PAPER.title, WIDTH), ""]
    if found.rig is not None:
        lines += [*wrap(SIMULATED, WIDTH), "", *(_rig_line(p) for p in found.rig.parameters), ""]
        lines += [line for note in (*found.rig.notes, *found.rig.bands) for line in wrap(note, WIDTH)] + [""]
    if found.linear is not None:
        lines += [*_linear_text(found.linear.compared), *_designs_text(found.linear.found)]
    for table in (1, 2, 3):
        rows = [row for row in found.rows.values() if row.row.table == table]
        lines += _simulated_text(table, rows) if rows else []
    if found.optima:
        lines += ["Designs that are best with friction; lower: than the best linear design with it.", ""]
        lines += [_optimum_line(name, numbers) for name, numbers in found.optima.items()] + [""]
    if found.budgets:
        lines += [
            "Break-even values: largest friction or backlash, or smallest shaft stiffness,",
            "for which a printed design of Table 1 is better than S1.",
            "",
        ]
        for name, numbers in found.budgets.items():
            lines += wrap(f"{name}: {budget_value(numbers)}", WIDTH, subsequent_indent="    ")
        lines.append("")
    if found.claims:
        lines += ["Claims", "", *wrap(RULE, WIDTH), ""]
        lines += [line for claim in found.claims for line in _claim_lines(claim)]
    return "\n".join(lines).rstrip()


def rig_value(p: IdentifiedParameter) -> tuple[str, str]:
    """Identified value of a parameter and its confidence interval, as texts."""
    low, high = p.interval
    if p.value == p.value:
        return format_with_interval(p.value, low, high, p.unit)
    ends = f"{format_quantity(low, p.unit, 3)} to" if low > 0.0 else "below"
    return "not identifiable", f"{ends} {format_quantity(high, p.unit, 3)}"


def _rig_line(p: IdentifiedParameter) -> str:
    value, interval = rig_value(p)
    known = f"identified {value}" if p.value == p.value else value
    return f"{p.name:5}printed {format_quantity(p.printed, p.unit):11}{known:25}{interval}"


def agreement_of(compared: list[ComparedRow]) -> str:
    parts = []
    for table in (1, 2, 3):
        rows = [c for c in compared if c.row.table == table]
        parts.append(f"Table {table}: {sum(c.agrees for c in rows)} of {len(rows)}")
    note = "Table 3 repeats values of Table 2, some with a zero for a digit that was not known."
    return f"Equal to the printed value within one unit of its last digit: {', '.join(parts)}. {note}"


def _linear_text(compared: list[ComparedRow]) -> list[str]:
    return [
        "Linear designs as printed, recomputed under both conventions; off:",
        "paper2008 less printed, in units of the last printed digit; differs: exact",
        "against printed.",
        "",
        f"{'table':6}{'index':6}{'case':>4}  {'layout':9}{'printed':>12}{'paper2008':>13}{'off':>6}{'exact':>13}"
        f"{'differs':>9}",
        *(_compared_line(c) for c in compared),
        "",
        *wrap(agreement_of(compared), WIDTH),
        "",
    ]


def _compared_line(c: ComparedRow) -> str:
    row = c.row
    return (
        f"{row.table:<6}{row.index:6}{row.case:>4}  {row.layout:9}{row.printed:>12}{digits(c.paper2008):>13}"
        f"{format_signed(c.off_by, 1):>6}{digits(c.exact):>13}{format_signed(share(c)):>7} %"
    )


def _designs_text(found: list[FoundDesign]) -> list[str]:
    return [
        "Designs found from scratch under paper2008, with the printed ones in brackets;",
        "lower: how far the value lies below the printed one; starts: how many agreed.",
        "",
        f"{'table':6}{'index':6}{'layout':9}{'printed':>12}{'found':>13}{'lower':>9}{'starts':>9}",
        *(line for f in found for line in _found_lines(f)),
        "",
    ]


def _found_lines(f: FoundDesign) -> Iterator[str]:
    yield (
        f"{f.row.table:<6}{f.row.index:6}{f.row.layout:9}{f.row.printed:>12}{digits(f.value):>13}"
        f"{format_signed(f.gain_percent):>7} %{f.agreed:>5}/{f.starts}"
    )
    pairs = [f"{name} {value:.6g} ({f.row.parameters[name]:g})" for name, value in f.parameters.items()]
    for i in range(0, len(pairs), 2):
        yield " " * 12 + ", ".join(pairs[i : i + 2])


def _simulated_text(table: int, rows: list[SimulatedRow]) -> list[str]:
    how = "the approximated linear model (Method 1)" if table == 2 else "expected values (Method 2)"
    return [
        *wrap(
            f"Table {table} by {how}; = equal to the printed digits, ~ within the scatter of four runs, < as from a "
            "start at rest, ? the same at either of several peaks, ^ another peak than the highest was printed, ! "
            "differs (the report says why). Standard errors are in simulated-rows.csv.",
            WIDTH,
        ),
        "",
        f"{'index':6}{'design':33}{'printed':>10}{'paper2008':>12}{'':>9}{'exact':>10}",
        *(
            f"{r.row.index:4}{_SIGNS[r.verdict]:2}{r.row.title:33}{r.row.printed:>10}{r.paper2008:>12.5g}"
            f"{100.0 * r.difference:>+7.2f} %{r.exact:>10.4g}"
            for r in rows
        ),
        "",
    ]


def _optimum_line(name: str, numbers: dict[str, Any]) -> str:
    parameters = ", ".join(f"{key} {value:.5g}" for key, value in numbers["parameters"].items())
    gain = f"{-numbers['percent']:.2f} % ± {numbers['percent_error']:.2f} %"
    return f"{name:16}{numbers['value']:>11.5g}  lower by {gain:17}  {parameters}"


def budget_value(numbers: dict[str, Any]) -> str:
    if numbers["value"] != numbers["value"]:
        return str(numbers["message"] if numbers["kind"] == StatusKind.UNBOUNDED else numbers["status"])
    error = numbers["error"]
    about = f" ± {format_quantity(error, numbers['unit'], digits=2)}" if error else ""
    return f"{typeset_quantity(numbers['value'], numbers['unit'])}{about}".replace("\N{NO-BREAK SPACE}", " ")


def _claim_lines(claim: Claim) -> Iterator[str]:
    yield from wrap(f"{claim.number}. {claim.statement}", WIDTH, subsequent_indent="   ")
    yield from wrap(f"{claim.headline.upper()}. {claim.evidence}", WIDTH, initial_indent="   ", subsequent_indent="   ")


def share(c: ComparedRow) -> float:
    return 100.0 * (c.exact / c.row.value - 1.0)


def format_signed(value: float, decimals: int = 2) -> str:
    text = f"{value:+.{decimals}f}"
    return text[1:] if float(text) == 0.0 else text


def digits(value: float) -> str:
    return f"{value:.6g}"


def with_error(value: float, error: float, digits: int = 6) -> str:
    """A value with its standard error, both to the second digit of the error."""
    if not error > 0.0:
        return f"{value:.{digits}g}"
    power = 0
    while error * 10.0**power < 9.95 and power < 12:
        power += 1
    if abs(value) < 1e-3:
        exponent = int(f"{value:e}".partition("e")[2])
        return f"({with_error(value * 10.0**-exponent, error * 10.0**-exponent)}) 1e{exponent}"
    return f"{value:.{power}f} ± {error:.{power}f}"
