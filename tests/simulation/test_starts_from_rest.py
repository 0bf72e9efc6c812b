"""Starts from rest with limits of exactly zero: no member of the family may stop, and both integrators agree."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import log_uniform
from uneven import OneSidedStop, OneWay, Push, UnevenFriction, valved_damper

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, Spring
from inerter.networks.elements import Element, Network


@dataclass(frozen=True)
class Strap(OneWay):
    """A clutch the other way round: it holds any compression, and gives way in tension against its drag."""

    key = "strap"
    symbol = "h"

    @property
    def limits(self) -> tuple[float, float]:
        return -math.inf, self.coefficient


@dataclass(frozen=True)
class Brake(UnevenFriction):
    """Uneven friction that may be none in one direction."""

    key = "brake"
    symbol = "r"
    more = ()
    may_vanish = True


def uneven(rng: np.random.Generator, kinds: int = 5) -> Element:
    """One of the first so many uneven laws, with drags and forces of exactly zero more often than not."""
    drag = 0.0 if rng.random() < 0.7 else log_uniform(rng, 0.01, 100.0)
    return [
        OneWay(drag),
        Strap(drag),
        Brake(log_uniform(rng, 0.1, 100.0), compression=drag),
        Brake(drag, compression=log_uniform(rng, 0.1, 100.0)),
        OneSidedStop(log_uniform(rng, 1e-5, 1e-2)),
    ][int(rng.integers(kinds))]


def branch(rng: np.random.Generator) -> Network:
    """An uneven law in series with a damper, an elastic shaft, a friction or an inerter, alone or beside one."""
    law, c = uneven(rng), Damper(log_uniform(rng, 100.0, 1e4))
    beside = uneven(rng, kinds=4)  # a stop beside an inerter would strike
    shaft = Spring(log_uniform(rng, 1e4, 1e6)) | Damper(log_uniform(rng, 100.0, 5e3))
    return [
        c - law,
        shaft - law,
        (c | Inerter(log_uniform(rng, 1.0, 300.0))) - beside,
        c - law | Inerter(log_uniform(rng, 1.0, 300.0)),
        c - (law | Friction(log_uniform(rng, 0.1, 50.0))),
        c - law - Friction(log_uniform(rng, 0.1, 50.0)),
        c - law | Damper(log_uniform(rng, 100.0, 1e4)) - Strap(0.0),
        shaft - Gap(log_uniform(rng, 1e-6, 1e-3)) - (beside | Inerter(log_uniform(rng, 1.0, 300.0))),
    ][int(rng.integers(8))]


def member(seed: int) -> tuple[it.QuarterCar, it.Signal, float, bool]:
    """A car, its road, a step, and whether the energy is accounted for."""
    rng = np.random.default_rng([seed, 2606])
    parts = [Spring(log_uniform(rng, 5e3, 8e4)), Damper(log_uniform(rng, 50.0, 3e3)), branch(rng)]
    if rng.random() < 0.3:
        parts.append(branch(rng))
    strut = parts[0]
    for part in parts[1:]:
        strut = strut | part
    car = it.QuarterCar(log_uniform(rng, 100.0, 600.0), log_uniform(rng, 15.0, 80.0), log_uniform(rng, 8e4, 4e5), strut)
    road = it.Road(log_uniform(rng, 1e-7, 1e-5), log_uniform(rng, 5.0, 40.0))
    steps = (1e-4, 2e-4, 4e-4, 5e-4)
    return car, it.multisine(road, seed=seed), steps[int(rng.integers(4))], bool(rng.random() < 0.3)


def off(seed: int) -> float:
    """By how much the two integrators differ in the body's displacement, relative to its size."""
    car, road, step, energy = member(seed)
    run = it.simulate(car, road=road, duration=0.4, step=step, energy=energy)
    assert run.integration_status.ok, (seed, run.integration_status)
    if energy:
        assert run.energy is not None
        assert abs(run.energy.relative_residual) < 1e-7, seed
    fine = it.simulate(car, road=road, duration=0.4, step=step / 8.0, integrator="time-stepping")
    assert fine.integration_status.ok, (seed, fine.integration_status)
    found, other = run["sprung_displacement"], fine["sprung_displacement"][::8]
    return float(np.max(np.abs(found - other)) / np.max(np.abs(other)))


@pytest.mark.parametrize("chunk", sampled(range(200), [0], often=[1, 2, 3, 4], kept=0))
def test_every_member_starts_and_both_integrators_agree(chunk: int) -> None:
    """Ten members a chunk, 2000 in all; time stepping is of first order where contacts are met."""
    found = np.array([off(seed) for seed in range(10 * chunk, 10 * (chunk + 1))])
    assert np.all(found < 1e-3)
    assert np.median(found) < 1e-5


@pytest.mark.parametrize("step", [2e-4, 4e-4])
@pytest.mark.parametrize("seed", [19, 32])
def test_a_valved_damper_starts_on_every_road(seed: int, step: float) -> None:
    """Roads on which a force of zero, met in a slip, was rounding in a stick."""
    car = it.QuarterCar(250, 35, 150e3, Spring(22e3) | valved_damper(400.0, 2400.0))
    run = it.simulate(car, road=it.multisine(it.Road(2e-6, 20), seed=seed), duration=0.2, step=step)
    assert run.integration_status.ok


def test_a_velocity_met_between_inertances_is_no_blow() -> None:
    """A clutch without drag closes where its velocity is zero down to the rounding of a motion that has just begun."""
    assert off(1056) < 1e-3


def test_a_contact_that_is_too_stiff_for_the_step_names_its_elements() -> None:
    shaft = Spring(1e6, "k_shaft") | Damper(1e-2, "c_shaft")
    strut = Spring(2e4) | shaft - Gap(1e-4) - (Inerter(50.0) | Friction(1.0))
    road = it.multisine(it.Road(2e-6, 20), seed=1)
    run = it.simulate(it.QuarterCar(250, 35, 150e3, strut), road=road, duration=1.0, step=5e-4)
    assert "k_shaft and c_shaft relax in 0.01 us" in run.integration_status.message


@pytest.mark.parametrize("seed", sampled(range(20), kept=5))
def test_expected_values_of_valved_dampers_are_numbers(seed: int) -> None:
    car = it.QuarterCar(250, 35, 150e3, Spring(22e3) | valved_damper(400.0, 2400.0))
    found = it.evaluate(car, it.RideComfort(it.Road(2e-6, 20)), it.ExpectedValue(realisations=16, seed=seed))
    assert found.status.ok
    assert math.isfinite(found.value)


def test_a_preload_starts_beside_a_valve() -> None:
    strut = Spring(22e3) | Push(50.0) | valved_damper(400.0, 2400.0)
    run = it.simulate(it.QuarterCar(250, 35, 150e3, strut), road=it.multisine(it.Road(2e-6, 20), seed=1), duration=0.2)
    assert run.integration_status.ok
