"""The reproduction of a paper as plain text of 80 columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from textwrap import wrap

from inerter.papers.wang_su_2008.judging import RULE, Claim
from inerter.papers.wang_su_2008.linear import ComparedRow
from inerter.papers.wang_su_2008.paper import PAPER
from inerter.papers.wang_su_2008.report.tables import (
    budgets_table,
    design_tables,
    linear_tables,
    optima_table,
    rig_table,
    simulated_tables,
)
from inerter.papers.wang_su_2008.reproduce import Reproduction
from inerter.papers.wang_su_2008.rig import SIMULATED
from inerter.report.text import WIDTH, table_lines
from inerter.table import Table


def reproduction_text(found: Reproduction) -> str:
    """Reproduction as plain text of at most 80 columns."""
    blocks = [wrap(PAPER.title, WIDTH)]
    if found.rig is not None:
        notes = (*found.rig.notes, *found.rig.bands)
        blocks += [wrap(SIMULATED, WIDTH), *_tables([rig_table(found)])]
        blocks += [[line for note in notes for line in wrap(note, WIDTH)]]
    if found.linear is not None:
        blocks += [*_tables(linear_tables(found)), wrap(agreement_of(found.linear.compared), WIDTH)]
        blocks += _tables(design_tables(found))
    blocks += _tables([*simulated_tables(found), optima_table(found), budgets_table(found)])
    if found.claims:
        blocks += [["Claims"], wrap(RULE, WIDTH), [line for claim in found.claims for line in _claim_lines(claim)]]
    return "\n\n".join("\n".join(block) for block in blocks if block)


def _tables(tables: Iterable[Table | None]) -> list[list[str]]:
    return [list(table_lines(table)) for table in tables if table is not None]


def agreement_of(compared: list[ComparedRow]) -> str:
    parts = []
    for table in (1, 2, 3):
        rows = [c for c in compared if c.row.table == table]
        parts.append(f"Table {table}: {sum(c.agrees for c in rows)} of {len(rows)}")
    note = "Table 3 repeats values of Table 2, some with a zero for a digit that was not known."
    return f"Equal to the printed value within one unit of its last digit: {', '.join(parts)}. {note}"


def _claim_lines(claim: Claim) -> Iterator[str]:
    yield from wrap(f"{claim.number}. {claim.statement}", WIDTH, subsequent_indent="   ")
    yield from wrap(f"{claim.headline.upper()}. {claim.evidence}", WIDTH, initial_indent="   ", subsequent_indent="   ")
