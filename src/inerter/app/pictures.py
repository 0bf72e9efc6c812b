"""Pictures of designs, drawn as the command line draws them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from inerter.app.designs import Design, designs_of
from inerter.app.documents import study_from
from inerter.app.fixed import fixed
from inerter.errors import StudyError
from inerter.figures.networks import draw_networks
from inerter.figures.study import draw_study
from inerter.files.study.cases import cases, run_case
from inerter.files.study.results import dataset
from inerter.files.study.study import Study
from inerter.networks.elements import Network

FORMATS = ("svg", "png")
NETWORKS = "networks"


def picture(body: Mapping[str, Any]) -> bytes:
    """The picture that is asked for: of the networks, or a figure of the results of these designs.

    Raises `StudyError` for a kind or a format that there is not.
    """
    kind, form = body["kind"], body["format"]
    if form not in FORMATS:
        raise StudyError(f"A picture is one of {', '.join(FORMATS)}, got {form!r}.")
    study = study_from(body["study"])
    designs = designs_of(study, body)
    with TemporaryDirectory() as folder:
        if kind == NETWORKS:
            draw_networks(_networks(designs), Path(folder), NETWORKS)
        else:
            draw_study(dataset_of(body["study"], study, designs), Path(folder))
        drawn = {path.stem: path for path in sorted(Path(folder).glob(f"*.{form}"))}
        if kind not in drawn:
            known = ", ".join((NETWORKS, *(name for name in drawn if name != NETWORKS)))
            raise StudyError(f"There are pictures of {known}, got {kind!r}.")
        return drawn[kind].read_bytes()


def _networks(designs: Sequence[Design]) -> dict[str, Network]:
    drawn: dict[str, Network] = {}
    for design in designs:
        struts = design.mechanism.struts
        drawn |= {f"{design.name} {s.name}" if len(struts) > 1 else design.name: s.network for s in struts}
    return drawn


def dataset_of(document: Mapping[str, Any], study: Study, designs: Sequence[Design]) -> Any:
    """The results of a study of these very designs."""
    asked = study_from(fixed(document, study, designs))
    return dataset(asked, {case: run_case(asked, case) for case in cases(asked)})
