"""Problems of names in index settings that the vehicle lacks, and of units that depend on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from inerter.errors import InerterError, with_article
from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.study.excitations import NameReference, SizeReference
from inerter.files.study.study import Study
from inerter.indices.definition import IndexDefinition
from inerter.systems.graph import full_graph
from inerter.systems.outputs import check_bounded, input_names, input_unit, main_outputs, outputs, velocity_of
from inerter.units import are_compatible, quote_value
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Mechanism


def name_problems(study: Study) -> Iterator[Problem]:
    """Problems of names that no layout has, and of units that differ from that of their input."""
    for name, own in study.own_indices.items():
        formed = own.typed_settings
        named = [((key, *one.keys), one) for key, form, value in formed for one in form.named(value)]
        sized = [((key, *one.keys), one) for key, form, value in formed for one in form.sized(value)]
        asked = _definitions_by_layout(study, name) if named or sized else []
        if not asked:
            continue
        for keys, one in named:
            problems = [_of_name(("indices", name, *keys), one, *case) for case in asked]
            if None not in problems:
                yield from filter(None, problems[:1])
        for keys, size in sized:
            yield from _of_size(("indices", name, *keys), size, *asked[0])


def _definitions_by_layout(study: Study, name: str) -> list[tuple[Mechanism, IndexDefinition]]:
    """Mechanism and index definition for each layout; empty if one cannot be built, which is reported elsewhere."""
    try:
        mechanisms = [study.design(layout).mechanism() for layout in study.layouts]
        return [(mechanism, study.index(name).definition(mechanism)) for mechanism in mechanisms]
    except InerterError:
        return []


def _of_name(
    place: Sequence[str], named: NameReference, mechanism: Mechanism, definition: IndexDefinition
) -> Problem | None:
    """Problem of a name that the mechanism lacks or whose response is unbounded; None if it is valid."""
    driven = definition.drive.excited_mechanism(mechanism)
    forces = [force.name for force in mechanism.forces if force.name != GROUND_ACCELERATION]
    told: Sequence[str]
    if named.what == "output":
        known = told = list(outputs(driven, full_graph(driven)))
        told = main_outputs(driven)
    else:
        moved = [velocity_of(road.name) for road in mechanism.roads]
        known = told = forces if named.what == "force" else [*input_names(mechanism), *moved]
    if named.name in known:
        return None
    try:
        check_bounded(mechanism, driven, named.name)
    except InerterError as error:
        return at(place, str(error))
    close = nearest(named.name, known)
    fault = f"{with_article(named.what)} that this vehicle does not have"
    others = "" if close else f"one of {some(told)}" if told else "another excitation, as it has none"
    return at(place, got=quote_value(named.name), fault=fault, expected=others, hint=close)


def _of_size(
    place: Sequence[str], size: SizeReference, mechanism: Mechanism, definition: IndexDefinition
) -> Iterator[Problem]:
    """Problem of a size whose unit does not match that of its input."""
    (path, *_) = _inputs(mechanism, definition) or ("",)
    unit = input_unit(mechanism, path)
    if unit and not are_compatible(size.unit, size.expected(unit)):
        fault = f"{path} is in {unit}"
        yield at(place, got=f"a size in {size.unit}", fault=fault, expected=f"one in {size.expected(unit)}")


def _inputs(mechanism: Mechanism, definition: IndexDefinition) -> list[str]:
    """Sources of the input paths of the index; empty if an input is unknown, which is reported elsewhere."""
    try:
        return [path.source for path in definition.input_paths(mechanism)]
    except InerterError:  # no such input, which is told with its name
        return []
