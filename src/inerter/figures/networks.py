"""Schematics of networks: upper end at the top, parallel parts side by side between bars, series parts in a column.

A bridge has its arms in three columns: a above b, then e, then c above d; e runs down from the left to the right node.
`schematic` only says where things are, in points; what draws only draws it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from inerter.errors import NetworkError
from inerter.figures.style import WIDE, save, style_context
from inerter.figures.symbols import (
    HALF_HEIGHT,
    HALF_WIDTH,
    LEADING,
    TO_LABEL,
    Point,
    SymbolLine,
    blank_figure,
    circle,
    stroke,
    symbol,
    text_width,
    translate_line,
    write,
)
from inerter.formatting import typeset_quantity
from inerter.networks.elements import (
    Bridge,
    CombinedNetwork,
    Element,
    Free,
    Network,
    Parallel,
    Tied,
    check_network,
)

_STUB = 7.0  # lead between a bar and the end of what it joins
_OVERHANG = 4.0  # of a bar over its outermost parts
_BETWEEN = 9.0  # space between parts side by side
_TERMINAL = 1.6  # radius of the open circle at an end
_MARGIN, _TITLE, _COLUMN, _ROW = 6.0, 4.0, 24.0, 22.0  # around a figure, below a title, between networks and rows


@dataclass(frozen=True)
class PlacedElement:
    """An element with the middle of its symbol, and the label to the right of it."""

    element: Element
    label: str
    x: float
    y: float

    @property
    def right(self) -> float:
        """Right end of the label [pt]."""
        return self.x + HALF_WIDTH + TO_LABEL + text_width(self.label)


@dataclass(frozen=True)
class Schematic:
    """A drawing whose upper end is at (0, 0) and whose lower end is at (0, -height)."""

    left: float  # how far it reaches to either side of its ends
    right: float
    height: float
    placed: tuple[PlacedElement, ...]
    lines: tuple[SymbolLine, ...] = ()

    def translate(self, x: float, y: float) -> tuple[tuple[PlacedElement, ...], tuple[SymbolLine, ...]]:
        """Elements and lines with the upper end at (x, y)."""
        placed = tuple(PlacedElement(p.element, p.label, p.x + x, p.y + y) for p in self.placed)
        return placed, tuple(translate_line(line, x, y) for line in self.lines)


def networks_by_title(networks: Mapping[str, Network]) -> dict[str, Network]:
    """Networks by their titles; mounts with the same network share one, and one alone has none."""
    together: dict[Network, list[str]] = {}
    for name, network in networks.items():
        together.setdefault(network, []).append(name.replace("_", " "))
    return {"" if len(together) == 1 else ", ".join(names): network for network, names in together.items()}


def draw_networks(
    networks: Mapping[str, Network], folder: Path, name: str, *, values: bool = False, alone: bool = False
) -> list[Path]:
    """Write the figure of some networks by their titles into `folder`, as SVG `alone` if wished; returns the files."""
    with style_context():
        return save(network_figure(networks, values=values), folder, name, pdf=not alone, png=not alone)


def network_figure(networks: Mapping[str, Network], *, values: bool = False) -> Figure:
    """Networks below their titles, in rows of up to the width of a page; wider only where one network alone is.

    Raises `NetworkError` if there are none.
    """
    if not networks:
        raise NetworkError("A figure of networks needs at least one, got none.")
    plain = {title.replace("$", r"\$"): network for title, network in networks.items()}  # a dollar begins no formula
    cells = [_Cell(title, schematic(network, values=values)) for title, network in plain.items()]
    rows = list(_rows(cells, 72.0 * WIDE - 2.0 * _MARGIN))
    widths, heights = [_row_width(row) for row in rows], [max(cell.height for cell in row) for row in rows]
    y = _MARGIN + sum(heights) + _ROW * (len(rows) - 1)
    figure, axes = blank_figure(max(widths) + 2.0 * _MARGIN, y + _MARGIN)
    for row, row_width, height in zip(rows, widths, heights, strict=True):
        x = _MARGIN + (max(widths) - row_width) / 2.0
        for cell in row:
            write(axes, cell.title, x + cell.left, y - cell.title_height / 2.0)
            draw_schematic(cell.drawing, axes, (x + cell.left, y - cell.title_height - _TITLE - 2.0 * _TERMINAL))
            x += cell.left + cell.right + _COLUMN
        y -= height + _ROW
    return figure


def schematic(network: Network, *, values: bool = False) -> Schematic:
    """Positions of all parts in the drawing of a network; with `values`, numbers stand below the names.

    Raises `NetworkError` if `network` is none.
    """
    network = check_network(network)
    if isinstance(network, CombinedNetwork):
        parts = [schematic(part, values=values) for part in network.parts]
        if not parts:
            raise NetworkError("A network without elements cannot be drawn. Give it at least one.")
        match network:
            case Parallel():
                return _side_by_side(parts)
            case Bridge():
                return _in_a_bridge(*parts)
        return _in_a_column(parts)
    (element,) = network.elements()
    middle = PlacedElement(element, element_label(element, values=values), 0.0, -HALF_HEIGHT)
    return Schematic(HALF_WIDTH, middle.right, 2.0 * HALF_HEIGHT, (middle,))


def element_label(element: Element, *, values: bool = False) -> str:
    """Label of an element in a drawing; with `values`, its fixed value in a second line."""
    name, value = symbol(element.label), element.value
    return name if isinstance(value, Free | Tied) or not values else f"{name}\n{typeset_quantity(value, element.unit)}"


def _side_by_side(parts: Sequence[Schematic]) -> Schematic:
    """Parts between two bars; the ends of the whole are at the middle part, or between the two in the middle."""
    xs = [0.0, *accumulate(one.right + _BETWEEN + other.left for one, other in pairwise(parts))]
    middle = (xs[(len(xs) - 1) // 2] + xs[len(xs) // 2]) / 2.0
    xs = [x - middle for x in xs]
    inside = max(part.height for part in parts)
    lines = _bars(xs, inside)
    at: list[Point] = []
    for x, part in zip(xs, parts, strict=True):
        at.append(_between(part, x, 0.0, inside, lines))
    size = (parts[0].left - xs[0], parts[-1].right + xs[-1], inside + 2.0 * _STUB)
    return _join_schematics(parts, at, size, lines)


def _in_a_bridge(a: Schematic, b: Schematic, c: Schematic, d: Schematic, e: Schematic) -> Schematic:
    """Arms a and b, e, c and d in three columns between two bars; the ends of the whole are at the middle one."""
    columns = [_in_a_column([a, b]), e, _in_a_column([c, d])]
    xs = [-(columns[0].right + _BETWEEN + e.left), 0.0, e.right + _BETWEEN + columns[2].left]
    left = max(a.height, c.height - e.height)  # depths of the nodes below the upper bar
    right = max(left + e.height, c.height)
    inside = max(left + b.height, right + d.height)
    wires = ((xs[0], 0.0, -_STUB - left), (0.0, xs[2], -_STUB - right))
    lines = [*_bars(xs, inside), *(((x, y), (x2, y)) for x, x2, y in wires)]
    spans = ((a, 0, 0.0, left), (b, 0, left, inside), (c, 2, 0.0, right), (d, 2, right, inside), (e, 1, left, right))
    at = [_between(arm, xs[i], upper, lower, lines) for arm, i, upper, lower in spans]
    size = (columns[0].left - xs[0], columns[2].right + xs[2], inside + 2.0 * _STUB)
    return _join_schematics((a, b, c, d, e), at, size, lines)


def _bars(xs: Sequence[float], inside: float) -> list[SymbolLine]:
    """Bars over columns, this far apart, with the leads to the ends of the whole."""
    top, bottom = -_STUB, -_STUB - inside
    lines: list[SymbolLine] = [((0.0, y), (0.0, y - _STUB)) for y in (0.0, bottom)]
    return lines + [((xs[0] - _OVERHANG, y), (xs[-1] + _OVERHANG, y)) for y in (top, bottom)]


def _between(part: Schematic, x: float, upper: float, lower: float, lines: list[SymbolLine]) -> Point:
    """Upper end of a part in the middle between two depths below the upper bar, with its leads added to `lines`."""
    lead = (lower - upper - part.height) / 2.0
    if lead:
        lines += [((x, -_STUB - y), (x, -_STUB - y - lead)) for y in (upper, lower - lead)]
    return x, -_STUB - upper - lead


def _in_a_column(parts: Sequence[Schematic]) -> Schematic:
    heights = [part.height for part in parts]
    at = [(0.0, -y) for y in accumulate(heights[:-1], initial=0.0)]
    left, right = max(part.left for part in parts), max(part.right for part in parts)
    return _join_schematics(parts, at, (left, right, sum(heights)))


def _join_schematics(
    parts: Sequence[Schematic], at: Sequence[Point], size: tuple[float, float, float], lines: Iterable[SymbolLine] = ()
) -> Schematic:
    there = [part.translate(*point) for part, point in zip(parts, at, strict=True)]
    placed = tuple(one for elements, _ in there for one in elements)
    return Schematic(*size, placed, (*lines, *(line for _, wires in there for line in wires)))


@dataclass(frozen=True)
class _Cell:
    """A network and its title above its upper end, in a figure."""

    title: str
    drawing: Schematic

    @property
    def left(self) -> float:
        return max(self.drawing.left, text_width(self.title) / 2.0)

    @property
    def right(self) -> float:
        return max(self.drawing.right, text_width(self.title) / 2.0)

    @property
    def title_height(self) -> float:
        return LEADING * len(self.title.splitlines())

    @property
    def height(self) -> float:
        return self.title_height + _TITLE + self.drawing.height + 4.0 * _TERMINAL


def _rows(cells: Iterable[_Cell], width: float) -> Iterator[list[_Cell]]:
    row: list[_Cell] = []
    for cell in cells:
        if row and _row_width([*row, cell]) > width:
            yield row
            row = []
        row.append(cell)
    yield row


def _row_width(row: Sequence[_Cell]) -> float:
    return sum(cell.left + cell.right for cell in row) + (len(row) - 1) * _COLUMN


def draw_schematic(drawing: Schematic, axes: Axes, at: Point) -> Axes:
    """Draw with the upper end `at` a point of axes whose unit is the point, such as of `blank_figure`."""
    placed, lines = drawing.translate(*at)
    x, y = at
    strokes = [*lines, circle(x, y + _TERMINAL, _TERMINAL), circle(x, y - drawing.height - _TERMINAL, _TERMINAL)]
    for one in placed:
        strokes += [translate_line(line, one.x, one.y) for line in one.element.drawing]
        write(axes, one.label, one.x + HALF_WIDTH + TO_LABEL, one.y, ha="left")
    return stroke(strokes, axes)
