"""Figures of the networks of a study, one per layout."""

from __future__ import annotations

from pathlib import Path

from inerter.errors import NetworkError
from inerter.figures.networks import draw_networks, networks_by_title
from inerter.figures.style import file_stems
from inerter.files.study.study import Study
from inerter.networks.parser import network


def layout_figures(study: Study) -> dict[str, str]:
    """File name, without suffix, of the figure of each layout."""
    stems = file_stems(f"layout-{layout}" for layout in study.layouts)
    return dict(zip(study.layouts, stems.values(), strict=True))


def draw_layouts(study: Study, folder: Path) -> list[Path]:
    """Write the networks of each layout into `folder`, as SVG, for the page; returns the files.

    Mounts with the same network share one drawing.
    """
    files, stems = [], layout_figures(study)
    for name, layout in study.layouts.items():
        try:
            networks = {mount: network(text, **study.elements) for mount, text in layout.struts.items()}
        except NetworkError:  # a distribution's element that cannot be mounted by itself
            continue
        files += draw_networks(networks_by_title(networks), folder, stems[name], alone=True)
    return files
