"""The figures of the programs of the gallery: those that they hold in a variable, whoever made them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import matplotlib
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

matplotlib.use("agg")


def scrape(block: Any, variables: dict[str, Any], gallery: dict[str, Any], **settings: Any) -> str:
    """Save each new figure of a program; returns its place in the page."""
    import matplotlib.pyplot as plt  # noqa: PLC0415 -- after the backend is chosen

    saved: list[str] = []
    for figure in dict.fromkeys(_figures(variables["example_globals"].values())):
        path = str(next(variables["image_path_iterator"]))
        figure.savefig(path, dpi=130)
        saved.append(path)
    plt.close("all")
    return str(figure_rst(saved, gallery["src_dir"]))


def _figures(values: Any) -> Iterator[Figure]:
    for value in values:
        if isinstance(value, Figure):
            yield value
        elif isinstance(value, Artist) and isinstance(value.figure, Figure):
            yield value.figure
        elif isinstance(value, list | tuple):
            yield from _figures(value)
