"""Options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

Output = Annotated[Path | None, Parameter(name=["--output", "-o"], help="Folder for the results.")]
Jobs = Annotated[int | None, Parameter(name=["--jobs", "-j"], help="Processes to use; all cores if left out.")]
Resume = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Continue an interrupted run: what its journal holds is not computed again.",
    ),
]
Force = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Replace the results in the folder when the new ones are whole. "
        "What inerter did not write there, or somebody changed since, stays.",
    ),
]
Json = Annotated[
    bool, Parameter(name="--json", negative="", show_default=False, help="Print the results as JSON instead of text.")
]
