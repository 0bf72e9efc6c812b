"""Lines of the symbols of elements, in points (1/72 inch) around their middle."""

from __future__ import annotations

from math import cos, pi, sin

Point = tuple[float, float]
SymbolLine = tuple[Point, ...]

HALF_WIDTH, HALF_HEIGHT = 8.0, 20.0  # of a symbol with its leads


def circle(x: float, y: float, radius: float, corners: int = 60) -> SymbolLine:
    """A circle as a line."""
    angles = [2.0 * pi * i / corners for i in range(corners + 1)]
    return tuple((x + radius * cos(angle), y + radius * sin(angle)) for angle in angles)


def zigzag(turns: int = 7, half_height: float = 12.0, half_width: float = 6.5) -> SymbolLine:
    """A coil seen from the side, with its leads."""
    pitch = 2.0 * half_height / turns
    peaks = [(half_width * (-1) ** i, half_height - (i + 0.5) * pitch) for i in range(turns)]
    return ((0.0, HALF_HEIGHT), (0.0, half_height), *peaks, (0.0, -half_height), (0.0, -HALF_HEIGHT))


BOX: tuple[SymbolLine, ...] = (  # for elements without a symbol
    ((-8.0, 9.0), (-8.0, -9.0), (8.0, -9.0), (8.0, 9.0), (-8.0, 9.0)),
    ((0.0, 20.0), (0.0, 9.0)),
    ((0.0, -9.0), (0.0, -20.0)),
)
