"""Pictures of designs, drawn as the command line draws them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from inerter.app.designs import Design, designs_of
from inerter.app.documents import study_from
from inerter.app.fixed_designs import with_fixed_values
from inerter.app.histories import simulation_request
from inerter.errors import DesignError, StudyError
from inerter.figures.networks import draw_networks
from inerter.figures.simulation import NAME as SIMULATION
from inerter.figures.simulation import draw_simulation
from inerter.figures.study import draw_study
from inerter.files.simulation.running import SimulationResult
from inerter.files.study.cases import cases, run_case
from inerter.files.study.results import dataset
from inerter.files.study.study import Study
from inerter.networks.elements import Network

FORMATS = ("svg", "png")
NETWORKS, HISTORY = "networks", "history"
_KINDS = {SIMULATION: HISTORY}  # what the page calls figures that are called otherwise


def picture(body: Mapping[str, Any]) -> bytes:
    """Picture in the requested format: networks, a motion, or a figure of the results of the designs.

    Raises `StudyError` for a kind or a format that there is not.
    """
    kind, form = body["kind"], body["format"]
    if form not in FORMATS:
        raise StudyError(f"Unknown format {form!r}; available: {', '.join(FORMATS)}.")
    study = study_from(body["study"])
    designs = designs_of(study, body)
    with TemporaryDirectory() as name:
        folder = Path(name)
        if kind == NETWORKS:
            draw_networks(_networks(designs), folder, NETWORKS)
        elif kind == HISTORY:
            draw_simulation(_motion(study, designs, body), folder)
        else:
            draw_study(dataset_of(body["study"], study, designs), folder)
        drawn = {_KINDS.get(path.stem, path.stem): path for path in sorted(folder.glob(f"*.{form}"))}
        if kind not in drawn:
            known = ", ".join(dict.fromkeys((NETWORKS, HISTORY, *drawn)))
            raise StudyError(f"Unknown kind of picture {kind!r}; available: {known}.")
        return drawn[kind].read_bytes()


def _motion(study: Study, designs: Sequence[Design], body: Mapping[str, Any]) -> SimulationResult:
    """The motion of a single design on the road, as the page shows it."""
    if len(designs) != 1:
        raise DesignError(f"A picture of the motion requires a single design, got {len(designs)}.")
    asked = simulation_request(study, designs[0], body)
    return SimulationResult(asked, asked.run())


def _networks(designs: Sequence[Design]) -> dict[str, Network]:
    drawn: dict[str, Network] = {}
    for design in designs:
        struts = design.mechanism.struts
        drawn |= {f"{design.name} {s.name}" if len(struts) > 1 else design.name: s.network for s in struts}
    return drawn


def dataset_of(document: Mapping[str, Any], study: Study, designs: Sequence[Design]) -> Any:
    """The results of a study of these very designs."""
    asked = study_from(with_fixed_values(document, study, designs))
    return dataset(asked, {case: run_case(asked, case) for case in cases(asked)})
