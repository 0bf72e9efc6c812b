"""Matrices of designs whose values lie decades apart: right digits, a stated bound, or a refusal, but no silence."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scipy
from campaigns import sampled
from random_mechanisms import FAMILIES

import inerter as it
from inerter.networks.transform import map_elements
from inerter.norms.response import resonant_range

pytest.importorskip("flint", reason='Exact responses: pip install "inerter[test]".')
from exact_responses import at, deviation, of_matrices, of_mechanism
from flint import acb, acb_mat

FORMS = ("state-space", "descriptor")
MEMBERS = list(product((4, 8, 12), range(100)))
LOST = [(12, seed) for seed in (9, 11, 38, 47, 57, 58)]  # matrices were off by 2e-8 to 3e-3 without a word


def design(decades: int, seed: int) -> it.Mechanism:
    """A random mechanism with each value moved by up to half of so many decades, masses by half of that."""
    rng = np.random.default_rng([7, seed, decades])
    mechanism = list(FAMILIES.values())[seed % len(FAMILIES)](rng, 1.0).mechanism()

    def moved(value: float, share: float) -> float:
        return float(value * 10.0 ** rng.uniform(-share * decades, share * decades))

    def spread(mount: it.Strut | it.Tyre) -> it.Network:
        return map_elements(mount.network, lambda element: element.with_value(moved(element.value, 0.5)))

    return replace(
        mechanism,
        coordinates=tuple(replace(c, inertia=moved(c.inertia, 0.25)) for c in mechanism.coordinates),
        struts=tuple(replace(strut, network=spread(strut)) for strut in mechanism.struts),
        tyres=tuple(replace(tyre, network=spread(tyre)) for tyre in mechanism.tyres),
    )


@pytest.mark.parametrize(("decades", "seed"), sampled(MEMBERS, LOST, kept=4))
def test_matrices_are_right_or_say_what_they_lose(decades: int, seed: int) -> None:
    """Against nodal equations in 700 bits, into which the doubles of the matrices go as they are."""
    mechanism = design(decades, seed)
    for form in FORMS:
        try:
            system = it.named_system(mechanism, form=form)
        except it.InerterError as error:
            assert "decades apart" in str(error) or "so far apart" in str(error)  # noqa: PT017
            continue
        roads = {f"{road.name}_velocity": road.name for road in mechanism.roads}
        inputs = [roads.get(one.name, one.name) for one in system.inputs]
        omega = resonant_range([it.state_space(mechanism).A])[::60]
        for growth in (0.0, 1e-3):
            s = at(omega, growth)
            expected = of_mechanism(mechanism, s, [one.name for one in system.outputs], inputs)
            assert deviation(of_matrices(system, s), expected) <= max(1e-9, 1.1 * system.rounding)
        assert (system.rounding > 1e-9) == any("Rounding of these matrices" in note for note in system.notes)


@pytest.mark.parametrize(("decades", "seed"), sampled(MEMBERS, LOST, kept=4))
def test_frequency_responses_have_their_digits(decades: int, seed: int) -> None:
    """Against nodal equations in 700 bits, at resonances, between them and beyond."""
    mechanism = design(decades, seed)
    try:
        system = it.state_space(mechanism)
    except it.InerterError as error:
        assert "so far apart" in str(error) or "decades apart" in str(error)  # noqa: PT017
        return
    omega = resonant_range([system.A])[7::60]
    expected = of_mechanism(mechanism, at(omega), list(system.outputs), list(system.inputs))
    found = [acb_mat(*M.shape, [acb(z.real, z.imag) for z in M.ravel()]) for M in it.frequency_response(system, omega)]
    assert deviation(found, expected) <= 2e-9


@pytest.mark.parametrize(("decades", "seed"), [(0, 16), (4, 10), (4, 11), (8, 16)])  # without massless nodes
def test_files_for_matlab_lose_no_small_response_at_low_frequencies(decades: int, seed: int, tmp_path: Path) -> None:
    """As solved in doubles, at a thousandth of the first resonance, over the response itself."""
    mechanism = design(decades, seed)
    it.export(mechanism, "matlab", tmp_path / "car.mat")
    data = scipy.io.loadmat(tmp_path / "car.mat")
    A, B, C, D, E = (data[name] if name in data else np.eye(len(data["A"])) for name in "ABCDE")
    omega = 1e-3 * resonant_range([it.state_space(mechanism).A])[:1]
    roads = {f"{road.name}_velocity": road.name for road in mechanism.roads}
    inputs, outputs = ([str(cell[0]) for cell in data[f"{what}_names"].ravel()] for what in ("input", "output"))
    (exact,) = of_mechanism(mechanism, at(omega, 0.0), outputs, [roads.get(name, name) for name in inputs])
    found = C @ np.linalg.solve(1j * omega[0] * E - A, B.astype(complex)) + D
    for i, row in enumerate(found):
        for j, value in enumerate(row):
            assert abs(acb(value.real, value.imag) - exact[i, j]) <= 1e-8 * abs(exact[i, j])


def test_a_design_beyond_doubles_is_refused_with_the_way_out() -> None:
    mechanism = design(12, 58)
    with pytest.raises(it.InerterError, match=r"decades apart that its matrices.*Try the other form"):
        it.export(mechanism, "matlab", form="state-space")
    with pytest.raises(it.InerterError, match="decades apart"):
        it.export(it.state_space(mechanism), "scipy")


@pytest.mark.parametrize("seed", range(5))
def test_usual_values_lose_nothing_that_is_told(seed: int) -> None:
    for form in FORMS:
        assert it.named_system(design(0, seed), form=form).rounding < 1e-9
