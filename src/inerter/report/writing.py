"""Figures and report of a study in its result folder, as the command line and the workbench write them."""

from __future__ import annotations

from pathlib import Path

from inerter.figures.layouts import draw_layouts
from inerter.figures.study import draw_study
from inerter.files.common.folder import FIGURES, REPORT
from inerter.files.study.running import StudyResult
from inerter.report.page import write_report
from inerter.report.study_contents import StudyContents
from inerter.work.progress import report


def write_figures_and_report(result: StudyResult, folder: Path) -> StudyContents:
    """Draw the results and the layouts, and write the report; returns its contents."""
    report("drawing the figures")
    draw_study(result.data, folder / FIGURES)
    draw_layouts(result.study, folder / FIGURES)
    report("writing the report")
    contents = StudyContents(result.data, result.study, result.answers)
    write_report(contents, folder / FIGURES, folder / REPORT)
    return contents
