"""Drawings of the networks of a design: SVG, PDF, and TikZ for LaTeX."""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING

from inerter.exports.kind import ExportKind
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Element, Free, Tied

if TYPE_CHECKING:
    from inerter.figures.networks import Schematic


def _figure(request: ExportSpec, suffix: str) -> bytes:
    from inerter.figures.networks import network_figure, networks_by_title  # noqa: PLC0415 - heavy
    from inerter.figures.style import UNDATED, style_context  # noqa: PLC0415 - heavy

    content = io.BytesIO()
    with style_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "constrained_layout not applied")
        figure = network_figure(networks_by_title(request.networks), values=True)
        figure.savefig(content, format=suffix.removeprefix("."), metadata=UNDATED[suffix])
    return content.getvalue()


def _tikz(request: ExportSpec, suffix: str) -> str:
    from inerter.figures.networks import networks_by_title, schematic  # noqa: PLC0415 - heavy

    lines = ["% written by inerter; needs \\usepackage{tikz}, one unit is one point"]
    for title, network in networks_by_title(request.networks).items():
        lines += [f"% {title}"] if title else []
        lines += tikz_lines(schematic(network, values=True))
    return "\n".join([*lines, ""])


def tikz_lines(drawing: Schematic) -> list[str]:
    """A `tikzpicture` of a schematic."""
    from inerter.figures.symbols import HALF_WIDTH, TO_LABEL, translate_line  # noqa: PLC0415 - heavy

    strokes = [*drawing.lines]
    for one in drawing.placed:
        strokes += [translate_line(line, one.x, one.y) for line in one.element.drawing]
    found = ["\\begin{tikzpicture}[x=1pt, y=1pt, line width=0.9pt, line cap=round, line join=round]"]
    found += [f"  \\draw {' -- '.join(f'({_short(x)}, {_short(y)})' for x, y in line)};" for line in strokes]
    found += [f"  \\draw (0, {_short(y)}) circle [radius=1.6];" for y in (1.6, -drawing.height - 1.6)]
    for one in drawing.placed:
        label = _label(one.element)
        found.append(
            f"  \\node[anchor=west, inner sep=0pt, align=left, font=\\footnotesize] at "
            f"({_short(one.x + HALF_WIDTH + TO_LABEL)}, {_short(one.y)}) {{{label}}};"
        )
    return [*found, "\\end{tikzpicture}"]


def _label(element: Element) -> str:
    from inerter.figures.symbols import symbol  # noqa: PLC0415 - heavy
    from inerter.formatting import format_quantity  # noqa: PLC0415 - heavy

    name = symbol(element.label)
    if isinstance(element.value, Free | Tied):
        return name
    return f"{name}\\\\{format_quantity(element.value, element.unit).replace('%', chr(92) + '%').replace(' ', '~')}"


def _short(number: float) -> str:
    return repr(round(number, 4))


SVG = ExportKind("svg", "drawing of the networks", (".svg",), _figure, takes=("part",))
PDF = ExportKind("pdf", "drawing of the networks", (".pdf",), _figure, takes=("part",))
LATEX = ExportKind("latex", "drawing of the networks in TikZ", (".tex",), _tikz, takes=("part",), synonyms=("tikz",))
