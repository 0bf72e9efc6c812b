"""Style of figures: sizes, fonts, colours, lines, legends, and reproducible files."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, count
from math import ceil, floor, log10
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, ScalarFormatter
from numpy.typing import ArrayLike

from inerter.atomic_io import atomic_write
from inerter.formatting import format_number, typeset

WIDE = 7.0  # two columns of a journal [inch]
_LEAST_RATIO = 6.0  # a log axis shows at least this ratio of values, so that two of its labels 1, 2, 5 are on it
_LOG_RATIO = 20.0  # values within this ratio are on a linear axis
_LABELLED_RATIO = 300.0  # up to which ratio a log axis labels 2 and 5 too
_LEAST_POWERS = 3  # powers of ten that suffice as labels of a longer one

# Okabe and Ito (2008), distinct for all kinds of colour vision; without yellow, which is faint on white.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_LINES: tuple[Any, ...] = ("-", "-.", (0, (1, 1.2)), (0, (7, 1.5, 1, 1.5, 1, 1.5)), (0, (10, 2)))
_METHOD_LINES: tuple[Any, ...] = ("-", "--", (0, (1, 1.2)), "-.")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_HATCHES = ("", "/////", ".....", "xxxxx")

_SETTINGS: Any = {  # matplotlib's own type for this lists every key
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that figures are the same everywhere
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 3.2,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.5,
    "svg.fonttype": "path",  # text as text depends on the fonts of the reader
    "svg.hashsalt": "inerter",
    "pdf.fonttype": 42,  # TrueType, which publishers ask for
}


_DPI = 300
UNDATED: dict[str, Any] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}


@dataclass(frozen=True)
class LayoutStyle:
    """Style of one layout in all figures of a study."""

    colour: str
    line: Any
    marker: str
    hatch: str = ""
    label: str = ""
    zorder: float = 2.0

    def curve(self) -> dict[str, Any]:
        """Keywords for a curve."""
        return {"color": self.colour, "linestyle": self.line, "label": self.label, "zorder": self.zorder}


def layout_styles(names: Iterable[str], baseline: str) -> dict[str, LayoutStyle]:
    """A style for each layout: the baseline black and dashed, the others by colour, line and marker."""
    styles = {baseline: LayoutStyle("black", "--", "", label=f"{baseline} (baseline)", zorder=3.0)} if baseline else {}
    for i, name in enumerate(name for name in names if name != baseline):
        styles[name] = LayoutStyle(
            colour=_COLOURS[i % len(_COLOURS)],
            line=_LINES[i % len(_LINES)],
            marker=_MARKERS[i % len(_MARKERS)],
            hatch=_HATCHES[i // len(_COLOURS) % len(_HATCHES)],
            label=name,
        )
    return styles


def method_line(number: int) -> Any:
    """The line of a method by its place among several, where colours and markers tell layouts."""
    return _METHOD_LINES[number % len(_METHOD_LINES)]


def marker(number: int) -> str:
    """The marker of a method by its place among several."""
    return _MARKERS[number % len(_MARKERS)]


def colour(number: int) -> str:
    """The colour of a curve by its place among others."""
    return _COLOURS[number % len(_COLOURS)]


@contextmanager
def style_context() -> Iterator[None]:
    """Context that applies the style of the package to figures created and drawn inside, and restores the settings."""
    with matplotlib.rc_context(_SETTINGS):
        yield


def new_figure(panels: int = 1, columns: int = 1, *, height: float, width: float = WIDE) -> tuple[Figure, list[Axes]]:
    """A figure of the style with some panels, row by row; its width and the height of a row in inches."""
    rows = ceil(panels / columns)
    figure = Figure(figsize=(width, rows * height), layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    for ax in axes[panels:]:
        ax.remove()
    for ax in axes[:panels]:
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(_PlainTicks())
    return figure, axes[:panels]


class _PlainTicks(ScalarFormatter):
    """Numbers as plain text: set as formulas, they took half of the time of a drawing."""

    def __init__(self) -> None:
        super().__init__(useMathText=False)

    def get_offset(self) -> str:
        """The power of ten that labels leave out."""
        offset = typeset(super().get_offset().replace("\N{MINUS SIGN}", "-"))
        return f"× {offset}" if offset.startswith("10") else offset


def add_legend(figure: Figure, axes: Iterable[Axes], most: int | None = None) -> Legend:
    """Add a legend of all axes below them, with as many columns as fit, at most `most`."""
    entries: dict[str, Artist] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    available = figure.get_figwidth() * figure.dpi
    for columns in range(min(max(len(entries), 1), most or len(entries)), 0, -1):
        legend = figure.legend(
            list(entries.values()), list(entries), loc="outside lower center", ncols=columns, columnspacing=1.5
        )
        if columns == 1 or legend.get_window_extent().width <= 0.98 * available:
            break
        legend.remove()
    return legend


def suits_log_axis(values: ArrayLike) -> bool:
    """Whether a logarithmic axis spreads some values more evenly than a linear one."""
    low, middle, high = np.quantile(np.asarray(values, dtype=float), (0.0, 0.5, 1.0))
    return bool(low > 0.0 and high > _LOG_RATIO * low and middle**2 < (low + high) / 2.0 * np.sqrt(low * high))


def log_axis(ax: Axes, which: str, *, least_ratio: float = _LEAST_RATIO) -> None:
    """Make the "x" or "y" axis logarithmic, with labels that can be read off; call it when the data are drawn."""
    axis = ax.xaxis if which == "x" else ax.yaxis
    ax.set(**{f"{which}scale": "log"})
    low, high = axis.get_view_interval()
    if high < least_ratio * low:
        middle, half = (low * high) ** 0.5, least_ratio**0.5
        low, high = middle / half, middle * half
        ax.set(**{f"{which}lim": (low, high)})
    powers = floor(log10(high)) - ceil(log10(low)) + 1
    few = high < _LABELLED_RATIO * low or powers < _LEAST_POWERS
    plain = FuncFormatter(lambda value, _: typeset(format_number(value)))
    axis.set_major_formatter(plain)
    axis.set_minor_locator(LogLocator(subs=(2.0, 5.0) if few else tuple(range(2, 10))))
    axis.set_minor_formatter(plain if few else NullFormatter())
    axis.set_tick_params(which="minor", labelsize=7.0, width=0.4)


def file_stems(names: Iterable[str]) -> dict[str, str]:
    """A file name without suffix for each name: itself, or numbered if it differs from one before by case alone.

    To some systems `S1.svg` and `s1.svg` are one file.

    >>> file_stems(["S1", "S3", "s1"])
    {'S1': 'S1', 'S3': 'S3', 's1': 's1-2'}
    """
    stems: dict[str, str] = {}
    for name in names:
        taken = {stem.lower() for stem in stems.values()}
        choices = chain([name], (f"{name}-{number}" for number in count(2)))
        stems[name] = next(stem for stem in choices if stem.lower() not in taken)
    return stems


def save(figure: Figure, folder: Path, name: str, *, pdf: bool = False, png: bool = True) -> list[Path]:
    """Write the figure as SVG and PNG, on request as PDF too, into `folder`; the same figure gives the same bytes.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in save(new_figure(height=2.0)[0], Path(folder), "empty")]
    ['empty.svg', 'empty.png']
    """
    folder.mkdir(parents=True, exist_ok=True)
    wanted = {"svg": True, "pdf": pdf, "png": png}
    files = [folder / f"{name}.{kind}" for kind, asked in wanted.items() if asked]
    with style_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "constrained_layout not applied")  # no room between labels of 300 digits
        if engine := figure.get_layout_engine():
            engine.execute(figure)  # once for all files
            figure.set_layout_engine(None)  # "none" would have each file drawn twice
        for file in files:
            with atomic_write(file) as draft:
                figure.savefig(draft, dpi=_DPI, metadata=UNDATED[file.suffix])
    return files
