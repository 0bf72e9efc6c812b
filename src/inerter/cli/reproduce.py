"""The command `inerter reproduce`: loaded when it is used, because its words are made of the papers that there are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from inerter.cli.options import DEFAULT_WORK, LongWork
from inerter.errors import StudyError
from inerter.papers.registry import PAPERS
from inerter.statements import Statement

_EXAMPLES = [f"inerter reproduce {p.name} {options}" for p in PAPERS.values() for options in ("-o paper", *p.examples)]

app = App(
    name="reproduce",
    help_format="plaintext",
    help_epilogue="\n  ".join(["Examples:", "inerter reproduce    lists the papers", *_EXAMPLES]),
)

if TYPE_CHECKING:
    Name = str
    Part = str
else:
    Name = Literal[tuple(PAPERS)]
    Part = Literal[tuple(dict.fromkeys(part for paper in PAPERS.values() for part in paper.parts))]


@app.default
def reproduce(
    paper: Name | None = None,
    /,
    *,
    only: Annotated[
        tuple[Part, ...],
        Parameter(negative="", show_default=False, help="Part to reproduce; repeatable; default: all parts."),
    ] = (),
    options: LongWork = DEFAULT_WORK,
) -> tuple[Statement, ...]:
    """Recompute a published paper and compare it with the printed numbers, designs, figures and claims.

    Parameters
    ----------
    paper
        Name of the paper; default: list all papers.
    """
    from inerter.cli.papers import papers
    from inerter.cli.papers import reproduce as command

    if paper is None:
        if only or options != DEFAULT_WORK:
            raise StudyError(f"Got options without a paper; expected the name of one: {', '.join(PAPERS)}.")
        papers()
        return ()
    return command(paper, only, options)
