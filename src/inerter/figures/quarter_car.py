"""The schematic of a quarter car, with its strut as a box."""

from __future__ import annotations

from matplotlib.axes import Axes

from inerter.figures.symbols import HALF_WIDTH, TO_LABEL, Line, Point, moved, stroke, write
from inerter.networks.elements import Spring

_STRUT, _WHEEL, _BODY = 16.0, 28.0, 38.0  # half their widths in the drawing of a quarter car
_SCALE = 48.0  # where its displacements are shown
_MASSES = (("u", 40.0, 60.0, _WHEEL), ("s", 110.0, 138.0, _BODY))  # name, lower and upper edge, half the width
_ROAD: tuple[Line, ...] = (
    ((-_WHEEL, 0.0), (_WHEEL, 0.0)),
    *(((x - 4.0, -4.0), (x, 0.0)) for x in (-21.0, -14.0, -7.0, 0.0, 7.0, 14.0, 21.0, 28.0)),
)


def draw_quarter_car(axes: Axes, at: Point = (0.0, 0.0)) -> Axes:
    """Draw the body over the wheel over the road, whose middle is `at`, on axes as for `draw_network`."""
    lines: list[Line] = [*_ROAD, *(moved(line, 0.0, 20.0) for line in Spring.drawing)]
    lines += [_rectangle(_STRUT, 70.0, 100.0), ((0.0, 60.0), (0.0, 70.0)), ((0.0, 100.0), (0.0, 110.0))]
    x, y = at
    write(axes, r"$k_\mathrm{t}$", x + HALF_WIDTH + TO_LABEL, y + 20.0, "left")
    write(axes, "strut", x, y + 85.0)
    for name, low, high, half_width in _MASSES:
        lines.append(_rectangle(half_width, low, high))
        write(axes, rf"$m_\mathrm{{{name}}}$", x, y + (low + high) / 2.0)
    for name, low, high, half_width in (("r", 0.0, 0.0, _WHEEL), *_MASSES):
        lines += _displacement(half_width, (low + high) / 2.0)
        write(axes, rf"$z_\mathrm{{{name}}}$", x + _SCALE + 2.0 * TO_LABEL, y + (low + high) / 2.0 + 9.0, "left")
    return stroke([moved(line, *at) for line in lines], axes)


def _rectangle(half_width: float, low: float, high: float) -> Line:
    return (-half_width, low), (half_width, low), (half_width, high), (-half_width, high), (-half_width, low)


def _displacement(start: float, y: float) -> list[Line]:
    """An arrow upwards from the height `y` of a mass that reaches to `start`."""
    head = ((_SCALE - 2.0, y + 11.0), (_SCALE, y + 15.0), (_SCALE + 2.0, y + 11.0))
    return [((start, y), (_SCALE + 4.0, y)), ((_SCALE, y), (_SCALE, y + 15.0)), head]
