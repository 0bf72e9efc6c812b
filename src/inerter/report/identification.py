"""The report of an identification: numbers, residuals, figures and one HTML page that needs no other file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from inerter.report.identification_data import identification_data, write_residuals
from inerter.study.identification_run import FIT, RESIDUALS, Identified
from inerter.study.run import FIGURES, REPORT, write_text

RESPONSE = "response.json"
OWN = (FIT, RESIDUALS, RESPONSE, FIGURES, REPORT)


def write_fit(found: Identified, folder: Path) -> None:
    """Write the numbers and the residuals, which is what took time to find, into `folder`."""
    write_text(folder / FIT, json.dumps(identification_data(found), indent=2) + "\n")
    write_residuals(found, folder / RESIDUALS)


def write_identification(found: Identified, folder: Path, progress: Callable[[float], None]) -> None:
    """Write the figures, and the page that shows all of it, into `folder`."""
