"""Lines and letters of schematics: the names of elements as formulas, axes that measure in points.

All lengths are in points (1/72 inch), so that symbols, letters and lines keep one scale.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from inerter.networks.elements.drawing import HALF_HEIGHT, HALF_WIDTH, Point, SymbolLine, circle

__all__ = [
    "HALF_HEIGHT",
    "HALF_WIDTH",
    "LEADING",
    "TO_LABEL",
    "Point",
    "SymbolLine",
    "blank_figure",
    "circle",
    "stroke",
    "symbol",
    "text_width",
    "translate_line",
    "write",
]

TO_LABEL = 3.0
_LINE_WIDTH = 0.9
_LETTERS, LEADING = 8.0, 9.6  # size of all text; from line to line
_GREEK = {"eps": r"\varepsilon", "epsilon": r"\varepsilon", "delta": r"\delta"}
_SHORT_NAME = re.compile(r"([A-Za-z])([A-Za-z]?\d*)|([A-Za-z]+)(\d*)")


def blank_figure(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure of this size in points, and axes without frame that cover it and measure in points."""
    figure = Figure(figsize=(width / 72.0, height / 72.0))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, width), ylim=(0.0, height))
    axes.set_axis_off()
    return figure, axes


def symbol(name: str) -> str:
    r"""A name as a formula, with a subscript after an underscore, in short names also without.

    >>> [symbol(name) for name in ("k", "ks", "k_s", "c2", "gap", "k_rear_2")]
    ['$k$', '$k_\\mathrm{s}$', '$k_\\mathrm{s}$', '$c_\\mathrm{2}$', '$\\mathrm{gap}$', '$k_\\mathrm{rear,2}$']
    """
    first, *rest = (word for word in name.split("_") if word)
    match = _SHORT_NAME.fullmatch(first)
    head, subscript = (match[1] or match[3], match[2] or match[4]) if match else (first, "")
    below = ",".join(word for word in (subscript, *rest) if word)
    formula = _GREEK.get(head, head if len(head) == 1 else rf"\mathrm{{{head}}}")
    return f"${formula}_\\mathrm{{{below}}}$" if below else f"${formula}$"


@cache
def text_width(text: str) -> float:
    """Width of drawn text, the widest of its lines."""
    lines = [line for line in text.splitlines() if line.strip()]
    return max((float(TextPath((0.0, 0.0), line, prop=_font()).get_extents().x1) for line in lines), default=0.0)


def stroke(lines: Sequence[SymbolLine], axes: Axes) -> Axes:
    """Draw lines, all of one width."""
    drawn = LineCollection(lines, colors="black", linewidths=_LINE_WIDTH, capstyle="round", joinstyle="round")
    drawn.set_snap(False)  # moves some lines by up to a pixel, and not others
    axes.add_collection(drawn, autolim=False)
    return axes


def write(axes: Axes, text: str, x: float, y: float, ha: Literal["left", "center"] = "center") -> None:
    """Text with its middle at the height `y`, whatever its letters are."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        baseline = y + (0.5 * (len(lines) - 1) - i) * LEADING - 0.34 * _LETTERS
        axes.text(x, baseline, line, fontproperties=_font(), color="black", ha=ha, va="baseline")


def _font() -> FontProperties:
    return FontProperties(family="DejaVu Sans", size=_LETTERS, math_fontfamily="dejavusans")


def translate_line(line: SymbolLine, x: float, y: float) -> SymbolLine:
    """The line with its origin at (x, y)."""
    return tuple((px + x, py + y) for px, py in line)
