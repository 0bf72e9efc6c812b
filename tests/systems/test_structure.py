"""One structure for all designs of a layout: descriptors with the values put in equal those made for each design."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from random_mechanisms import FAMILIES, mechanisms, opened
from wang_su import J1, paper_quarter_car

import inerter as it
from inerter.methods.linear import CONVENTIONS, linear_problem, linear_problem_of_design
from inerter.networks.transform import map_elements
from inerter.systems.descriptor import _describe, close, describe
from inerter.systems.graph import linear_graph
from inerter.systems.outputs import input_names
from inerter.systems.structure import once_per_structure, structure_of

STACKS = ("S", "R", "F", "X_eta", "X_x", "X_u", "Y_eta", "Y_x", "Y_u")
NAMES = ("states", "inputs", "outputs", "free", "notes", "mechanism", "precision_warning")


def directly(mechanism, inputs=None, outputs=None):
    return _describe(mechanism, linear_graph(mechanism), inputs, outputs)


def assert_equal_descriptors(found, expected):
    assert all(getattr(found, name) == getattr(expected, name) for name in NAMES)
    assert list(found.free) == list(expected.free)
    for name in STACKS:
        ours, theirs = getattr(found, name), getattr(expected, name)
        assert ours.dtype == theirs.dtype
        scale = np.abs(theirs).max(initial=0.0)
        np.testing.assert_allclose(ours, theirs, rtol=1e-17, atol=float(scale) * 1e-17)
    for ours, theirs in zip(found.sizes, expected.sizes, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-14)


@pytest.mark.parametrize("family", sampled(FAMILIES, [*FAMILIES][::2], kept=1))
def test_descriptors_equal_those_made_directly(family):
    for mechanism in mechanisms(family, seed=11, count=25, extremes=30.0):
        assert_equal_descriptors(describe(mechanism), directly(mechanism))
        free, values = opened(mechanism)
        assert_equal_descriptors(describe(free), directly(free))
        one, other = close(describe(free), values).fine, close(directly(free), values).fine
        assert np.all(np.abs(one.values - other.values) <= np.maximum(one.errors, other.errors))


ROAD = it.Road(roughness=5e-7, speed=25.0)
LOW_PASS = it.FilteredExcitation(ROAD, it.Filter((1.0,), (0.05, 1.0)))
TWO_TRACKS = it.Road(roughness=5e-7, speed=25.0, coherence=it.Coherence.isotropic(track=1.5))


@pytest.mark.parametrize(
    "index",
    [J1, it.RideComfort(ROAD, "Wk"), it.TyreLoad(LOW_PASS), it.TyreLoad(TWO_TRACKS), it.LoadCarrying()],
    ids=["white", "weighted", "filtered", "two tracks", "peak"],
)
def test_designs_share_one_problem_and_have_the_values_of_their_own(index):
    rng = np.random.default_rng(15)
    struts = [
        it.Spring(k) | it.Damper(c) - it.Inerter(b) for k, c, b in rng.uniform(0.5, 2.0, (4, 3)) * (1e5, 5e3, 100)
    ]
    body = (730.0, 1200.0, 400.0, 25.0, 20.0, 120e3, 100e3, 0.9, 1.2, 1.4, 1.5)
    found = []
    for front, rear in (struts[:2], struts[2:]):
        car = it.FullCar(*body, front=front, rear=rear).mechanism()
        definition = index.definition(car)
        problem, values = linear_problem_of_design(definition.excite(car), CONVENTIONS["exact"])
        found.append(problem.descriptor)
        ours = problem.estimate(values)
        theirs = linear_problem(car, definition, CONVENTIONS["exact"]).estimate({})
        assert ours.value == pytest.approx(theirs.value, rel=1e-13)
        assert (ours.status, ours.notes, ours.unit) == (theirs.status, theirs.notes, theirs.unit)
        assert ours.error_bound == pytest.approx(theirs.error_bound, rel=1e-3)
    assert found[0] is found[1]


def with_other_values(mechanism, rng):
    def change(network):
        return map_elements(network, lambda e: e.with_value(e.value * rng.uniform(0.5, 2.0)))

    return replace(
        mechanism,
        coordinates=tuple(replace(c, inertia=c.inertia * rng.uniform(0.5, 2.0)) for c in mechanism.coordinates),
        struts=tuple(replace(s, network=change(s.network)) for s in mechanism.struts),
        tyres=tuple(replace(t, network=change(t.network)) for t in mechanism.tyres),
    )


@pytest.mark.parametrize("family", FAMILIES)
def test_other_values_have_the_same_structure_and_their_own_descriptor(family):
    rng = np.random.default_rng(12)
    for mechanism in mechanisms(family, seed=13, count=10, extremes=1.0):
        other = with_other_values(mechanism, rng)
        assert structure_of(mechanism) == structure_of(other)
        assert hash(structure_of(mechanism)) == hash(structure_of(other))
        first = describe(mechanism)
        assert_equal_descriptors(describe(other), directly(other))
        assert_equal_descriptors(first, directly(mechanism))


K, C, B = it.Spring(1e5), it.Damper(2e3), it.Inerter(30.0)


def car(strut, **changes):
    given = {"sprung_mass": 250.0, "unsprung_mass": 30.0, "tyre_stiffness": 2e5} | changes
    return it.QuarterCar(**given, strut=strut).mechanism()


DIFFERENT = [
    car(K | C - B),
    car(K | B - C),
    car(K | C | B),
    car(it.Spring(1e5, "ks") | C - B),
    car(it.Spring(it.free(1e4, 1e6)) | C - B),
    car(it.Spring(it.free(1e4, 1e6, "stiffness")) | C - B),
    car(K | C - B | it.Friction(10.0)),
    car(K | C - B | it.Friction(10.0, "f")),
    car(K | it.Damper(it.free(100.0, 1e4)) - B | it.Friction(it.free(1.0, 10.0))),
    car(K | C - B - it.Gap(1e-3)),
    car(K | C - B, sprung_mass=it.free(100.0, 300.0)),
    car(K | C - B).on_moving_ground(),
    car(K | C - B, sprung_mass=251.0).on_moving_ground(),
    car(K | C - B, sprung_mass=it.free(100.0, 300.0)).on_moving_ground(),
    car(it.Spring(it.free(1e4, 1e6, "x")) | it.Spring(it.free(1e4, 1e6, "x")) - C),
    car(K | C - B | K),
    car(it.Bridge(K, C, B, C, K)),
    it.Mechanism(
        (it.Coordinate("body", 250.0), it.Coordinate("node", 0.0)),
        (it.Strut("upper", C, {"body": 1.0}, {"node": 1.0}), it.Strut("lower", K, {"node": 1.0}, it.GROUND)),
        forces=(it.Force("load", {"body": 1.0}),),
    ),
    car(K | it.Bridge(K, C, B - it.Friction(5.0, "f") | C, C, K) - C),
]


@pytest.mark.parametrize("mechanism", DIFFERENT)
def test_descriptors_of_all_kinds_of_mechanisms(mechanism):
    assert_equal_descriptors(describe(mechanism), directly(mechanism))


@pytest.mark.parametrize("mechanism", DIFFERENT)
def test_exact_transfer_functions_of_all_kinds_of_mechanisms(mechanism):
    """They follow from the graph of the structure, with free values of elements without effect left out."""
    values = {name: 1.5 * free.lower for name, free in describe(mechanism).free.items()}
    names = input_names(mechanism)
    ours, theirs = (close(d, values).origin for d in (describe(mechanism, names), directly(mechanism, names)))
    found, expected = (origin.functions(origin.inputs, origin.outputs) for origin in (ours, theirs))
    assert found == expected


def test_structures_differ_where_the_descriptor_does():
    structures = [structure_of(mechanism) for mechanism in DIFFERENT]
    assert len(set(structures)) == len(DIFFERENT)


def test_tied_values_have_no_structure():
    x = it.free(1e4, 1e6, "x")
    assert structure_of(car(it.Spring(x) | it.Spring(it.tied("x", 2.0)) - C)) is None


def test_errors_name_the_mechanism_itself():
    rattling = car(K | it.Gap(1e-3, "joint"))
    with pytest.raises(it.InerterError, match="joint"):
        describe(rattling)
    with pytest.raises(it.InerterError, match="Unknown input 'wind'"):
        describe(car(K | C), ["wind"])


def test_threads_get_their_own_values():
    rng = np.random.default_rng(14)
    designs = [with_other_values(car(K | C - B), rng) for _ in range(200)]
    index = J1
    expected = [it.evaluate(design, index, it.Norm()) for design in designs]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda design: it.evaluate(design, index, it.Norm()), designs)) == expected


def test_an_answer_by_structure_is_computed_once_for_all_values():
    asked = []
    answer = once_per_structure(lambda mechanism: asked.append(mechanism) or len(asked))
    soft, stiff = (paper_quarter_car(it.Spring(k) | it.Damper(1e3)).mechanism() for k in (1e4, 1e5))
    damped = paper_quarter_car(it.Spring(1e4) | it.Inerter(1e3)).mechanism()
    assert [answer(soft), answer(stiff), answer(damped), answer(soft)] == [1, 1, 2, 1]
