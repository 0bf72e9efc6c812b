"""The text of a study file: a quarter car and what a test asks of it, as lines of its sections."""

from __future__ import annotations

VEHICLE = 'sprung_mass = "250 kg"\nunsprung_mass = "35 kg"\ntyre_stiffness = "150 kN/m"'
PAPER_CAR = 'sprung_mass = "181.75 kg"\nunsprung_mass = "25 kg"\ntyre_stiffness = "120 kN/m"'  # of Wang and Su (2008)
ELEMENTS = 'k = "20 kN/m"\nc = "1 kN s/m"\nb = "30 kg"'
LAYOUTS = 'S1 = "k | c"\nS2 = "k | c | b"'


def study_text(
    settings: str, *, vehicle: str = VEHICLE, elements: str = ELEMENTS, layouts: str = LAYOUTS, title: str = ""
) -> str:
    """A whole file; `title` is the line before the first section."""
    return f"""{title}
[vehicle]
model = "quarter-car"
{vehicle}
[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
{elements}
[layouts]
{layouts}
[study]
{settings}
"""
