"""Lines and letters of schematics: the symbols of the elements, their names as formulas, axes that measure in points.

All lengths are in points (1/72 inch), so that symbols, letters and lines keep one scale.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from math import cos, pi, sin
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from inerter.networks.elements import Damper, Element, Friction, Gap, Inerter, Spring

Point = tuple[float, float]
Line = tuple[Point, ...]

HALF_WIDTH, HALF_HEIGHT = 8.0, 20.0  # of a symbol with its leads
TO_LABEL = 3.0
_LINE_WIDTH = 0.9
_LETTERS, LEADING = 8.0, 9.6  # size of all text; from line to line
_GREEK = {"eps": r"\varepsilon", "epsilon": r"\varepsilon", "delta": r"\delta"}
_SHORT_NAME = re.compile(r"([A-Za-z])([A-Za-z]?\d*)|([A-Za-z]+)(\d*)")


def circle(x: float, y: float, radius: float, corners: int = 60) -> Line:
    """A circle as a line."""
    angles = [2.0 * pi * i / corners for i in range(corners + 1)]
    return tuple((x + radius * cos(angle), y + radius * sin(angle)) for angle in angles)


def _zigzag(turns: int = 7, half_height: float = 12.0, half_width: float = 6.5) -> Line:
    pitch = 2.0 * half_height / turns
    peaks = [(half_width * (-1) ** i, half_height - (i + 0.5) * pitch) for i in range(turns)]
    return ((0.0, HALF_HEIGHT), (0.0, half_height), *peaks, (0.0, -half_height), (0.0, -HALF_HEIGHT))


SYMBOLS: dict[type[Element], tuple[Line, ...]] = {
    Spring: (_zigzag(),),
    Damper: (  # a piston in a cup
        ((0.0, 20.0), (0.0, 1.0)),
        ((-5.5, 1.0), (5.5, 1.0)),
        ((-8.0, 8.0), (-8.0, -8.0), (8.0, -8.0), (8.0, 8.0)),
        ((0.0, -8.0), (0.0, -20.0)),
    ),
    Inerter: (  # a rod that turns a flywheel in a box
        ((-8.0, 9.0), (-8.0, -9.0), (8.0, -9.0), (8.0, 9.0), (-8.0, 9.0)),
        circle(0.0, 0.0, 5.0),
        circle(0.0, 0.0, 0.4),
        ((0.0, 20.0), (0.0, 5.0)),
        ((0.0, -9.0), (0.0, -20.0)),
    ),
    Friction: (  # a block that slides along a hatched wall
        ((0.0, 20.0), (0.0, 7.0)),
        ((-4.0, 7.0), (-4.0, -7.0), (4.0, -7.0), (4.0, 7.0), (-4.0, 7.0)),
        ((4.0, 13.0), (4.0, -13.0), (0.0, -13.0), (0.0, -20.0)),
        *(((4.0, y), (8.0, y + 4.0)) for y in (-13.0, -9.0, -5.0, -1.0, 3.0, 7.0)),
    ),
    Gap: (  # a pin between two jaws
        ((0.0, 20.0), (0.0, 9.0)),
        ((4.0, 9.0), (-8.0, 9.0), (-8.0, -7.0), (4.0, -7.0)),
        ((-4.0, 1.0), (8.0, 1.0), (8.0, -12.0), (0.0, -12.0), (0.0, -20.0)),
    ),
}


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


def stroke(lines: Sequence[Line], axes: Axes) -> Axes:
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


def moved(line: Line, x: float, y: float) -> Line:
    """The line with its origin at (x, y)."""
    return tuple((px + x, py + y) for px, py in line)
