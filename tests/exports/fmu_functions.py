"""Functions that the standard asks of an FMU for co-simulation."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy


def declared(kind: str) -> set[str]:
    """Functions of the standard's own headers, which FMPy has; of FMI 2.0 without those of model exchange alone."""
    folder, number = Path(fmpy.__file__).parent / "c-code", {"fmu": 2, "fmu3": 3}[kind]
    text = (folder / f"fmi{number}FunctionTypes.h").read_text(encoding="utf-8")
    if kind == "fmu":
        begin, end = text.index("Model Exchange\n"), text.index("Co-Simulation\n")
        text = text[:begin] + text[end:]
    return set(re.findall(rf"\b(fmi{number}\w+)TYPE\b", text))
