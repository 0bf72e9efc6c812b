"""Notebooks run from top to bottom, and give the figures in their comments."""

from __future__ import annotations

from pathlib import Path

import pytest
from folders import ROOT
from matplotlib import pyplot as plt
from pages import notebook, run, text_of

NOTEBOOKS = sorted(ROOT.glob("docs/notebooks/*.ipynb"))


@pytest.mark.campaign
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_gives_the_figures_beside_it(path: Path) -> None:
    namespace: dict[str, object] = {"__name__": "__main__"}
    for number, cell in enumerate(notebook(path), 1):
        run(cell, f"{path.name}, cell {number}", namespace)
    assert plt.get_fignums()
    plt.close("all")


def test_notebooks_are_on_the_site() -> None:
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        assert f"\nnotebooks/{path.stem}\n" in text_of("index.md")
        assert any("assert" in cell.code or "#" in cell.code for cell in notebook(path))
