"""Values of a best design at other speeds than its own: axles that follow each other tune it to their delay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inerter.errors import InerterError
from inerter.files.study.place import place_of
from inerter.files.study.places import with_numbers
from inerter.formatting import format_quantity
from inerter.methods.composite_index import IndexLike
from inerter.methods.equivalent import has_friction
from inerter.methods.equivalent_linear import has_play
from inerter.methods.method import Estimate, MethodWithExactFallback, constituents_of, evaluate
from inerter.methods.registry import averages, is_blind, without_roads
from inerter.systems.piecewise import piecewise
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from inerter.files.study.study import Study

SPEED = "road.speed"
AT_SPEEDS = "at_speeds."  # begins the names of what results have at those speeds
BESIDE = (0.8, 1.0, 1.2)  # of the speed of the study


def is_at_one_speed(study: Study) -> bool:
    """Whether the study has a road at one speed, which no sweep or condition changes, and no quantile."""
    return study.road is not None and SPEED not in study.varied_labels and study.quantile is None


def at_other_speeds(
    study: Study, vehicle: Vehicle, layout: str, index: str
) -> tuple[dict[str, list[dict[str, Any]]], str]:
    """Values of a design at `BESIDE` times the speed of the study with their errors, by method.

    There is also a message on doubtful ones.

    Both are empty where there is no need.

    The study is one that `is_at_one_speed`. At another speed the road is rougher or smoother, and no more, unless
    several axles meet it or the design has friction. A method that averages random roads is replaced by the quickest
    that sees as much friction. A value that cannot be computed, or takes more digits than double precision has, is
    nan, and the message says why.
    """
    if not study.needs_road(index):
        return {}, ""
    asked, method = study.resolve_index(index, layout), quick_method(study, vehicle)
    if not (_is_late(vehicle, asked) or (not is_blind(method) and has_friction(vehicle.mechanism()))):
        return {}, ""
    told = [estimate_at_speed(study, vehicle, (layout, index, method), factor) for factor in BESIDE]
    found = [
        {"value": np.nan, "error_bound": np.nan, "shared_errors": {}}
        if one is None
        else {name: getattr(one, name) for name in ("value", "error_bound", "shared_errors")}
        for one, _ in told
    ]
    return {method: found}, "; ".join(dict.fromkeys(message for _, message in told if message))


def estimate_at_speed(
    study: Study, vehicle: Vehicle, asked: tuple[str, str, str], factor: float
) -> tuple[Estimate | None, str]:
    """Estimate at `factor` times the speed of the study, None if it is not finite; a message if it is doubtful or none.

    `asked` are the layout, the index and the method.
    """
    layout, index, method = asked
    assert study.road is not None
    speed = factor * study.road.speed
    there = with_numbers(study, [(place_of(SPEED), speed)])
    asked_index, by = there.resolve_index(index, layout), there.method(method)
    try:
        if isinstance(by, MethodWithExactFallback) and any(
            by.share_unsure(*one, {}) for one in constituents_of(vehicle, asked_index)
        ):
            return None, "it takes more digits than double precision has"
        found = evaluate(vehicle, asked_index, by)
    except (InerterError, np.linalg.LinAlgError, ArithmeticError) as error:
        return None, f"at {format_quantity(3.6 * speed, 'km/h')} there is no value ({str(error).rstrip('.')})"
    if not np.isfinite(found.value):
        reason = str(found.status) if not found.status.ok else "it is without bounds"
        return None, f"at {format_quantity(3.6 * speed, 'km/h')} there is no finite value ({reason.rstrip('.')})"
    return found, found.status.doubt


def quick_method(study: Study, vehicle: Vehicle) -> str:
    """Method for values at other speeds: the first of `evaluate`, or one that does not average random roads."""
    first = study.evaluate[0]
    return without_roads(first, has_play=averages(first) and has_play(piecewise(vehicle)))


def _is_late(vehicle: Vehicle, asked: IndexLike) -> bool:
    """Whether random inputs act with different delays, or through a filter that depends on the speed."""
    for one, index in constituents_of(vehicle, asked):
        mechanism = one.mechanism()
        definition = index.definition(mechanism)
        paths = (
            definition.input_paths(definition.drive.excited_mechanism(mechanism)) if definition.drive.is_random else ()
        )
        coherence = getattr(getattr(definition.drive, "road", None), "coherence", None)
        if len({path.delay for path in paths}) > 1 or (paths and coherence is not None):
            return True
    return False
