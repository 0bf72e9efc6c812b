"""Figures 8 to 10 and the identified parameters, from a virtual rig: the paper's own records are not published."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.networks.elements import Damper, Friction, Inerter, Network, Spring
from inerter.records.result import Response
from inerter.signals.harmonics import cosine, flat_multisine
from inerter.validation import number_or_none

Matrix = NDArray[np.float64]
NAME = "staged"
PRINTED = {"f": 10.0, "ks": 1e6, "cs": 3200.0, "gap": 0.0, "b": 113.0}  # section 4
SHAFT = 5.0  # [kg] inertance without flywheel
SIMULATED = (
    "The paper's records are not published. The records here are those of a virtual rig with the printed parameters, "
    "the paper's load cell and encoder, and assumed noise and bandwidths. They show whether the protocol identifies "
    "such parameters from such records, not whether the paper's records contain them."
)
_STARTS = 8
_EVERY = 4  # samples of the slow test of which one is kept for the figure
_RESPONSES = ("measured", "model", "linear", "ideal")
_ARRAYS = ("omega", "gain", "phase", "coherence", "band", "phase_band", "averages")


@dataclass(frozen=True)
class IdentifiedParameter:
    """Identified parameter, with the printed value."""

    name: str
    unit: str
    printed: float
    value: float  # nan where it is not identifiable
    interval: tuple[float, float]
    sentence: str

    @property
    def difference(self) -> float:
        """Relative difference from the printed value; nan if that is zero."""
        return self.value / self.printed - 1.0 if self.printed else float("nan")


@dataclass(frozen=True, eq=False)
class RigTest:
    """Records and results of the three tests of the staged protocol."""

    parameters: tuple[IdentifiedParameter, ...]
    friction: dict[str, Matrix]  # time [s], displacement [m], force [N], model [N]
    fit: dict[str, Matrix]
    responses: dict[str, Response]  # measured, model, linear, ideal
    bands: tuple[str, ...]
    notes: tuple[str, ...]
    status: str


def device(inertance: float) -> Network:
    """The printed device with this inertance [kg]; its backlash is none."""
    shaft = Spring(PRINTED["ks"], "ks") | Damper(PRINTED["cs"], "cs")
    return shaft - (Inerter(inertance, "b") | Friction(PRINTED["f"], "f"))


def compute(name: str) -> dict[str, Any]:
    """Numbers of the three tests, for JSON."""
    from inerter.identification.staged_protocol import identify_staged  # noqa: PLC0415 - heavy
    from inerter.identification.virtual_rig import VirtualRig  # noqa: PLC0415 - heavy

    assert name == NAME
    whole, bare = device(PRINTED["b"]), device(SHAFT)
    slow = VirtualRig(bare, seed=0).run(cosine(1e-3, 0.1), duration=20.0)
    fast = VirtualRig(whole, seed=1).run(cosine(1e-3, 3.0), duration=5.0)
    wide = VirtualRig(whole, seed=2).run(flat_multisine(0, 1e-4, 0.5, 20.0), duration=16.0)
    found = identify_staged(slow, fast, wide, shaft_inertance=SHAFT, starts=_STARTS)
    assert found.response is not None
    part = found.fit.comparisons[0]
    return {
        "parameters": {
            n: {
                "unit": p.unit,
                "value": number_or_none(p.value),
                "interval": p.interval,
                "said": found.identifiable[n].sentence,
            }
            for n, p in found.parameters.items()
        },
        "friction": _motion_to_json(slow.time, slow.displacement, slow.force, found.friction.model, _EVERY),
        "fit": _motion_to_json(fast.time, fast.displacement, part.record.force, part.model, 1),
        "responses": {key: _response_to_json(getattr(found.response, key)) for key in _RESPONSES},
        "bands": [band.verdict for band in found.response.bands],
        "notes": list(found.notes),
        "status": str(found.status),
    }


def rig_test_from_json(numbers: Mapping[str, Any]) -> RigTest:
    """Tests from their numbers in JSON."""
    return RigTest(
        parameters=tuple(
            IdentifiedParameter(
                n,
                p["unit"],
                PRINTED[n],
                float("nan") if p["value"] is None else p["value"],
                tuple(p["interval"]),
                p["said"],
            )
            for n, p in ((n, numbers["parameters"][n]) for n in PRINTED)
        ),
        friction={key: np.array(values) for key, values in numbers["friction"].items()},
        fit={key: np.array(values) for key, values in numbers["fit"].items()},
        responses={key: _response_from_json(flat) for key, flat in numbers["responses"].items()},
        bands=tuple(numbers["bands"]),
        notes=tuple(numbers["notes"]),
        status=numbers["status"],
    )


def _motion_to_json(
    time: Matrix, displacement: Matrix, force: Matrix, model: Matrix, every: int
) -> dict[str, list[float]]:
    columns = {"time": time, "displacement": displacement, "force": force, "model": model}
    return {name: [float(f"{x:.7g}") for x in values[::every].tolist()] for name, values in columns.items()}


def _response_to_json(response: Response) -> dict[str, Any]:
    numbers: dict[str, Any] = {name: getattr(response, name).tolist() for name in _ARRAYS}
    numbers["averages"] = None if np.isinf(response.averages).any() else numbers["averages"]
    about = {name: getattr(response, name) for name in ("amplitude", "estimator", "source")}
    return numbers | about | {"notes": list(response.notes)}


def _response_from_json(flat: Mapping[str, Any]) -> Response:
    fields: dict[str, Any] = {name: np.array(flat[name], dtype=float) for name in _ARRAYS if flat[name] is not None}
    fields.setdefault("averages", np.full(fields["omega"].shape, np.inf))
    fields |= {name: flat[name] for name in ("amplitude", "estimator", "source")}
    return Response(**fields, notes=tuple(flat["notes"]))
