"""Random questions to random vehicles, and the truth beside what methods say of their own errors.

A member is a vehicle, an index and a method, all drawn from one number. What its estimate is compared with shares no
code with it where there is such a thing (rational arithmetic), and else is the same simulation with steps, roads and
periods that are finer than the bound of what is judged.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from unittest.mock import patch

import numpy as np
from random_mechanisms import FAMILIES, at_zero, drawn, logarithmic
from strategies import random_half_car, random_network, random_quarter_car

import inerter as it
from inerter.indices.definition import Index
from inerter.methods import excitation, harmonic_response, out_of_band, realisations
from inerter.methods.steady_squares import steady_squares
from inerter.networks.elements import Friction, Network
from inerter.networks.transform import map_elements
from inerter.simulation import periodic_steady_state
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle

VEHICLES = ("quarter car", "half car", "full car", "full car on two tracks", "seat", "absorber", *FAMILIES)
SEEN = ("quarter car", "half car", "full car", "seat", "absorber", "chain")  # with friction, to be simulated


@dataclass(frozen=True)
class Member:
    """A question to a vehicle, and what it is called."""

    name: str
    vehicle: Vehicle | Mechanism
    index: Index


def road(rng: np.random.Generator, coherence: it.Coherence | None = None) -> it.Road:
    return it.Road(logarithmic(rng, 1e-8, 1e-5), float(rng.uniform(5.0, 40.0)), coherence=coherence)


# -- linear members --


def linear_member(number: int) -> Member:
    """Of each vehicle in turn, with an index that it has."""
    rng = np.random.default_rng([41, number])
    name = VEHICLES[number % len(VEHICLES)]
    vehicle = _linear_vehicle(rng, name)
    index = _linear_index(rng, name, vehicle.mechanism())
    return Member(f"{name}, {index.symbol}", vehicle, index)


def _strut(rng: np.random.Generator, most: int = 5) -> Network:
    network = at_zero(rng) if rng.random() < 0.15 else random_network(rng, 3, int(rng.integers(1, most + 1)))
    return drawn(rng, network, 1e2 if rng.random() < 0.3 else 1.0)


def _linear_vehicle(rng: np.random.Generator, name: str) -> Vehicle | Mechanism:
    if name in FAMILIES and name not in ("quarter car", "half car"):
        return FAMILIES[name](rng, 1.0)
    if name == "quarter car":
        return random_quarter_car(rng, _strut(rng, 8))
    if name == "half car":
        return random_half_car(rng, _strut(rng), _strut(rng))
    if name.startswith("full car"):
        return full_car(rng, _strut(rng, 3), _strut(rng, 3))
    if name == "seat":
        return it.Seat(random_quarter_car(rng, _strut(rng, 3)), logarithmic(rng, 40.0, 100.0), _strut(rng, 3))
    ground = _strut(rng, 2) if rng.random() < 0.5 else None
    return it.Absorber(logarithmic(rng, 100, 1e4), logarithmic(rng, 1e4, 1e6), logarithmic(rng, 5, 500),
                       _strut(rng, 4), ground, logarithmic(rng, 1.0, 1e4))  # fmt: skip


def full_car(rng: np.random.Generator, front: Network, rear: Network) -> it.FullCar:
    between = [drawn(rng, random_network(rng, 1, 2), 1.0) if rng.random() < 0.4 else None for _ in range(2)]
    return it.FullCar(
        sprung_mass=logarithmic(rng, 500, 2500),
        pitch_inertia=logarithmic(rng, 600, 4000),
        roll_inertia=logarithmic(rng, 200, 1000),
        unsprung_mass_front=logarithmic(rng, 20, 80),
        unsprung_mass_rear=logarithmic(rng, 20, 80),
        tyre_stiffness_front=logarithmic(rng, 1e5, 4e5),
        tyre_stiffness_rear=logarithmic(rng, 1e5, 4e5),
        distance_front=float(rng.uniform(0.8, 2.0)),
        distance_rear=float(rng.uniform(0.8, 2.0)),
        track_front=float(rng.uniform(1.2, 1.8)),
        track_rear=float(rng.uniform(1.2, 1.8)),
        front=front,
        rear=rear,
        anti_roll_front=between[0],
        anti_roll_rear=between[1],
    )


def _linear_index(rng: np.random.Generator, name: str, mechanism: Mechanism) -> Index:
    coherence = None
    if name.endswith("two tracks"):
        coherence = it.Coherence.first_order(float(rng.uniform(0.5, 5.0)), float(rng.uniform(0.2, 1.0)))
    on = road(rng, coherence)
    inner = [mount.name for mount in mechanism.struts or mechanism.tyres]
    force = mechanism.forces[0].name
    masses = [c.name for c in mechanism.coordinates if not c.angle]
    mass = masses[int(rng.integers(len(masses)))]
    white = it.WhiteForce(force, logarithmic(rng, 0.1, 10.0))
    moved = {f"{mass}_{'velocity' if rng.random() < 0.5 else 'acceleration'}": 1.0}
    without_road: list[Callable[[], Index]] = [
        lambda: it.RandomResponse(moved, it.FilteredExcitation(white, it.Filter([30.0], [1.0, 30.0]))),
        lambda: it.RandomResponse({f"{inner[0]}_force": 1.0}, it.GroundAcceleration(logarithmic(rng, 0.1, 10.0))),
        it.LoadCarrying,
        lambda: it.PeakResponse(force, f"{mass}_velocity"),
    ]
    with_road: list[Callable[[], Index]] = [
        lambda: it.RideComfort(on),
        lambda: it.RideComfort(on, weighting="Wk"),
        lambda: it.TyreLoad(on),
        lambda: it.SuspensionTravel(on),
        lambda: it.RandomResponse({f"{inner[-1]}_force": 1.0, f"{mass}_acceleration": 100.0}, on),
        lambda: it.PeakResponse(mechanism.roads[0].name, f"{mass}_acceleration", it.Filter([1.0], [1e-3, 1.0])),
    ]
    if name not in FAMILIES:
        with_road += [lambda: it.DynamicLoadCoefficient(on)]
    choices = [*without_road, *(with_road if mechanism.roads else ())]
    return choices[int(rng.integers(len(choices)))]()


# -- members with friction --


def member_with_friction(number: int) -> Member:
    """Frictions from hardly any to the main damper, in each vehicle in turn."""
    rng = np.random.default_rng([43, number])
    name = SEEN[number % len(SEEN)]
    vehicle = _vehicle_with_friction(rng, name)
    mechanism = vehicle.mechanism()
    if name == "absorber":
        index: Index = it.RandomResponse({"primary_acceleration": 1.0},
                                  it.FilteredExcitation(it.WhiteForce("primary_force", logarithmic(rng, 10, 1e4)),
                                            it.Filter([60.0], [1.0, 60.0])))  # fmt: skip
        return Member(f"{name}, {index.symbol}", vehicle, index)
    on = road(rng)
    choices = [it.RideComfort(on), it.TyreLoad(on), it.SuspensionTravel(on), it.RideComfort(on, weighting="Wk")]
    index = choices[int(rng.integers(len(choices)))]
    if not mechanism.measures.comfort and index.symbol == "J1":
        index = choices[1]
    return Member(f"{name}, {index.symbol}", vehicle, index)


def member_under_a_sine(number: int) -> Member:
    """The same vehicles, asked what they carry."""
    member = member_with_friction(number)
    rng = np.random.default_rng([47, number])
    return replace(member, index=it.LoadCarrying(amplitude=logarithmic(rng, 30.0, 3e3)))


def member_with_a_damped_stop(number: int) -> Member:
    """A quarter car that meets a stop with a damper, whose force jumps at contact."""
    rng = np.random.default_rng([53, number])
    mass, tyre, k = logarithmic(rng, 150, 600), logarithmic(rng, 1e5, 3e5), logarithmic(rng, 1e4, 6e4)
    critical = 2.0 * float(np.sqrt(k * mass))
    behind = it.Spring(k * logarithmic(rng, 0.3, 10)) | it.Damper(critical * logarithmic(rng, 0.02, 1.0))
    strut = it.Spring(k) | it.Damper(critical * logarithmic(rng, 0.05, 0.3))
    stop = it.Gap(logarithmic(rng, 5e-4, 5e-3)) - behind
    on = it.Road(logarithmic(rng, 2e-7, 5e-6), float(rng.uniform(10.0, 40.0)))
    index: Index = it.RideComfort(on, weighting=(None, "Wk")[number % 2])
    car = it.QuarterCar(mass, logarithmic(rng, 20, 60), tyre, strut | stop)
    return Member(f"damped stop, {index.symbol}", car, index)


def _rubbing(rng: np.random.Generator, mass: float, stiffness: float) -> Network:
    k = stiffness * logarithmic(rng, 0.08, 0.8)
    critical = 2.0 * float(np.sqrt(k * mass))
    c = it.Damper(critical * logarithmic(rng, 0.05, 0.6))
    f = it.Friction(mass * logarithmic(rng, 0.003, 3.0))
    b = it.Inerter(mass * logarithmic(rng, 0.03, 1.0))
    inner = it.Damper(critical * logarithmic(rng, 0.1, 1.0))
    kinds = [c | f, c | b | f, c | inner - (b | f), c | (it.Spring(3.0 * k) | f) - b | f]
    return it.Spring(k) | kinds[int(rng.integers(len(kinds)))]


def _vehicle_with_friction(rng: np.random.Generator, name: str) -> Vehicle | Mechanism:
    mass, tyre = logarithmic(rng, 120, 600), logarithmic(rng, 8e4, 3e5)
    quarter = it.QuarterCar(mass, mass * float(rng.uniform(0.08, 0.25)), tyre, _rubbing(rng, mass, tyre))
    if name == "quarter car":
        return quarter
    if name == "seat":
        occupant = logarithmic(rng, 40, 90)
        return it.Seat(quarter, occupant, _rubbing(rng, occupant, 2e4))
    if name == "absorber":
        return it.Absorber(1000.0, 4e4, 60.0, _rubbing(rng, 60.0, 4e3), None, logarithmic(rng, 100, 1000))
    if name == "chain":
        names = ["m0", "m1", "m2"]
        masses = [0.1 * mass, mass, 0.4 * mass]
        struts = tuple(
            it.Strut(f"s{i}", _rubbing(rng, masses[i], tyre if i == 1 else 0.3 * tyre), {names[i]: 1.0},
                     {names[i - 1]: 1.0}) for i in (1, 2)
        )  # fmt: skip
        return it.Mechanism(
            coordinates=tuple(it.Coordinate(n, m) for n, m in zip(names, masses, strict=True)),
            struts=struts,
            tyres=(it.Tyre("tyre", it.Spring(tyre), {"m0": 1.0}, "road"),),
            roads=(it.RoadInput("road"),),
            forces=(it.Force("load", {"m2": 1.0}),),
            measures=it.PerformanceOutputs(
                comfort=(it.OutputWeight("m2_acceleration"),),
                tyre_load=(it.OutputWeight("tyre_load"),),
                load_input="load",
                load_output="m2_displacement",
            ),
        )
    front, rear = _rubbing(rng, mass, tyre), _rubbing(rng, mass, tyre)
    if name == "half car":
        return replace(random_half_car(rng, front, rear), sprung_mass=2.0 * mass, pitch_inertia=1.5 * mass,
                       tyre_stiffness_front=tyre, tyre_stiffness_rear=tyre)  # fmt: skip
    car = full_car(rng, front, rear)
    inertias = {"sprung_mass": 4.0 * mass, "pitch_inertia": 5.0 * mass, "roll_inertia": 1.5 * mass}
    tyres = {"tyre_stiffness_front": tyre, "tyre_stiffness_rear": tyre}
    return replace(car, **inertias, **tyres, anti_roll_front=None, anti_roll_rear=None)


# -- the truth --


@dataclass(frozen=True)
class Judged:
    """How far an estimate is from the truth, beside what it says; `beside` is what the truth may lack."""

    error: float
    bound: float
    beside: float = 0.0

    @property
    def exceeded(self) -> bool:
        """Whether the bound is too small."""
        return not self.error <= self.bound + self.beside


def against_exact(member: Member) -> Judged | None:
    """A norm beside rational arithmetic; None where there is no such number, or the method says so itself."""
    rational = importlib.import_module("rational_norms")  # needs python-flint
    found = it.evaluate(member.vehicle, member.index, it.Norm())
    try:
        exact = rational.index_value(member.vehicle.mechanism(), member.index)
    except ArithmeticError:  # more digits than it is given
        return None
    if exact is None or math.isnan(found.value):
        return None
    if exact is rational.INFINITE or exact == 0.0:
        return Judged(0.0 if found.value == (math.inf if exact else 0.0) else math.inf, found.error_bound)
    return Judged(abs(found.value / exact - 1.0), found.error_bound)


def of_hardly_any_friction(member: Member, method: it.Method) -> Judged | None:
    """A simulation with so little friction that its value is the norm."""
    nearly = _with_friction(member.vehicle, 1e-9)
    found, norm = (it.evaluate(nearly, member.index, m) for m in (method, it.Norm()))
    if not math.isfinite(found.value) or not math.isfinite(norm.value):
        return None
    return Judged(abs(found.value / norm.value - 1.0), found.error_bound, 1e-8)


def of_finer_steps(member: Member, method: it.ExpectedValue | it.ApproximateLinear) -> Judged | None:
    """A simulation beside one of the same inputs in shorter steps that goes on for longer."""
    found = it.evaluate(member.vehicle, member.index, method)
    if not math.isfinite(found.value):
        return None
    bound = sum(s.bound for s in found.error_sources if s.name in ("time step", "periodic steady state"))
    if isinstance(method, it.ExpectedValue) and found.period is not None:
        method = replace(method, period=found.period)
    with finer():
        truth = it.evaluate(member.vehicle, member.index, method)
    return Judged(abs(found.value / truth.value - 1.0), bound, truth.error_bound if found.peaks else 0.0)


def of_linearisation(member: Member, roads: int) -> Judged | None:
    """Statistical linearisation beside simulations and four of their standard errors; None of an infinite bound."""
    found = it.evaluate(member.vehicle, member.index, it.StatisticalLinearisation())
    if not math.isfinite(found.value) or not math.isfinite(found.error_bound):
        return None
    truth = it.evaluate(member.vehicle, member.index, it.ExpectedValue(realisations=roads, jobs=1))
    if not truth.status.ok:
        return None
    scatter = 4.0 * (truth.standard_error or 0.0) / truth.value
    error = abs(found.value / truth.value - 1.0)
    return Judged(error, found.error_bound, scatter + truth.error_bound)


def intervals(member: Member, make: Callable[[int], it.Method], seeds: int) -> tuple[int, int] | None:
    """How many of the intervals of 95 % of some seeds hold the mean of all the others, and how many there are.

    Each is widened by the standard error of that mean, as an interval for a difference is.
    """
    found = [it.evaluate(member.vehicle, member.index, make(seed)) for seed in range(seeds)]
    if not all(math.isfinite(one.value) and one.standard_error for one in found):
        return None
    values = np.array([one.value for one in found])
    held = 0
    for i, one in enumerate(found):
        rest = np.delete(values, i)
        other = float(rest.std(ddof=1)) / math.sqrt(rest.size)
        assert one.interval is not None
        assert one.standard_error
        reach = 0.5 * (one.interval[1] - one.interval[0]) * math.hypot(1.0, other / one.standard_error)
        held += abs(one.value - float(rest.mean())) <= reach + one.error_bound * one.value
    return held, seeds


def _with_friction(vehicle: Vehicle | Mechanism, force: float) -> Mechanism:
    """The mechanism with all frictions of this force."""
    mechanism = vehicle.mechanism()

    def changed(network: Network) -> Network:
        return map_elements(network, lambda e: Friction(force, e.label) if isinstance(e, Friction) else e)

    return replace(mechanism, struts=tuple(replace(s, network=changed(s.network)) for s in mechanism.struts))


@contextmanager
def finer(steps: int = 4) -> Iterator[None]:
    """Simulations with shorter steps, so many for each, that go on until the motion repeats to 1e-10."""
    kept = realisations._kept_table, excitation._kept
    longer = partial(steady_squares, repeats=1e-10)
    with (
        patch.object(realisations, "STEP", realisations.STEP / steps),
        patch.object(out_of_band, "STEP", out_of_band.STEP / steps),
        patch.object(realisations, "steady_squares", longer),
        patch.object(excitation, "_COARSEST", excitation._COARSEST / steps),
        patch.object(harmonic_response, "_POINTS", harmonic_response._POINTS * steps),
        patch.object(harmonic_response, "_LONGEST", harmonic_response._LONGEST / steps),
        patch.object(harmonic_response, "_REPEATS", 1e-9),
        patch.object(harmonic_response, "_NEAR", 1e-6),
        patch.object(periodic_steady_state, "_ENOUGH", 1e-10),
    ):
        for one in kept:
            one.cache_clear()
        try:
            yield
        finally:
            for one in kept:
                one.cache_clear()
