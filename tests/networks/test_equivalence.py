"""Classes of equal networks: transformed values give the same admittance, and no others do."""

from __future__ import annotations

from itertools import combinations, pairwise, permutations

import numpy as np
import pytest
from campaigns import sampled

import inerter as it
from inerter.networks.enumeration import Topology
from inerter.networks.equivalence import equivalence_classes, transform_values

POWERS = {"k": -1, "c": 0, "b": 1}  # of s in the admittance
POINTS = np.logspace(-1.5, 1.5, 14)  # real s, at which nothing cancels


def up_to(size, **options):
    return [topology for n in range(1, size + 1) for topology in it.enumerate_networks(n, **options)]


def log_admittance(tree, logs):
    """Logarithm of the admittance for rows of logarithms of values, and its derivatives, by the rules of sums."""
    rest = iter(range(logs.shape[-1]))

    def each(tree):
        if isinstance(tree, str):
            Y = np.exp(logs[..., next(rest), None]) * POINTS ** POWERS[tree]
            return Y, [np.ones_like(Y)]
        parts = [each(part) for part in tree[1:]]
        sign = 1 if tree[0] == "|" else -1
        total = sum(Y**sign for Y, _ in parts)
        return total**sign, [w * (Y**sign / total) for Y, weights in parts for w in weights]

    Y, weights = each(tree)
    return np.log(Y), np.stack(weights, -1)


def bridge_admittance(a, b, c, d, e):
    """Sum over the spanning trees over the sum over those of the bridge with its ends joined (Kirchhoff)."""
    trees = a * b * (c + d) + c * d * (a + b) + e * (a + c) * (b + d)
    return trees / ((a + b) * (c + d) + e * (a + b + c + d))


def admittance(topology, values):
    if topology.tree[0] == "bridge":
        return bridge_admittance(*[v * POINTS ** POWERS[k] for v, k in zip(values, topology.kinds, strict=True)])
    return np.exp(log_admittance(topology.tree, np.log(np.array(values, float)))[0])


def assert_equal_admittances(one, other, rng):
    values = 10.0 ** rng.uniform(-3, 3, one.size)
    found = transform_values(one, values, other)
    assert len(found) == other.size
    assert min(found) > 0.0
    np.testing.assert_allclose(admittance(other, found), admittance(one, values), rtol=1e-12)


@pytest.mark.campaign
def test_transformed_values_have_the_same_admittance():
    rng = np.random.default_rng(3)
    for members in equivalence_classes(up_to(4)):
        for one, other in permutations(members, 2):
            assert_equal_admittances(one, other, rng)
    for members in equivalence_classes(up_to(5)):
        for one, other in [*pairwise(members), *pairwise(members[::-1])]:
            assert_equal_admittances(one, other, rng)


def test_transformed_values_of_bridges():
    rng = np.random.default_rng(4)
    pairs = 0
    for members in equivalence_classes(up_to(5, bridges=True)):
        for bridge in [member for member in members if member.tree[0] == "bridge"]:
            for other in {members[0], members[-1]} - {bridge}:
                assert_equal_admittances(bridge, other, rng)
                assert_equal_admittances(other, bridge, rng)
                pairs += 1
    assert pairs >= 29  # of 81 bridges, 29 have like arms that make them series-parallel networks


def test_like_neighbours_and_other_kinds_are_transformed():
    rng = np.random.default_rng(5)
    one, other = Topology(("|", "k", "k", ("-", "b", "b", "c"))), Topology(("|", "k", ("-", "c", "b")))
    assert_equal_admittances(one, other, rng)
    assert_equal_admittances(other, one, rng)
    assert transform_values(other, [3.0, 2.0, 5.0], other) == (3.0, 2.0, 5.0)
    friction = [Topology(("|", "f", ("-", "f", "k"))), Topology(("-", "f", ("|", "f", "k")))]
    assert equivalence_classes(friction) == [(each,) for each in sorted(friction)]


def test_admittance_at_complex_frequencies():
    rng = np.random.default_rng(6)
    kinds = {"k": it.Spring, "c": it.Damper, "b": it.Inerter}
    s = 1j * np.logspace(-1, 1, 9)
    for members in equivalence_classes(up_to(4)):
        for one, other in pairwise(members):
            values = 10.0 ** rng.uniform(-1, 1, one.size)
            Y, Z = (
                topology.network([kinds[k](v) for k, v in zip(topology.kinds, numbers, strict=True)]).admittance(s)
                for topology, numbers in ((one, values), (other, transform_values(one, values, other)))
            )
            np.testing.assert_allclose(Z, Y, rtol=1e-10)


def test_classes_partition_and_the_simplest_comes_first():
    networks = up_to(5)
    classes = equivalence_classes(reversed(networks))
    assert sorted(topology for members in classes for topology in members) == sorted(networks)
    for members in classes:
        assert list(members) == sorted(members)
    assert classes == equivalence_classes(networks)
    assert [members[0] for members in classes] == sorted(members[0] for members in classes)


def test_further_networks_join_no_classes():
    """Networks with like neighbours are no missing links between others."""
    networks = set(up_to(4))
    more = equivalence_classes(up_to(4, like_neighbours=True))
    kept = [tuple(topology for topology in members if topology in networks) for members in more]
    assert [members for members in kept if members] == equivalence_classes(networks)


def best_fit(tree, size, target, rng, starts=24, steps=80):
    """Least root of squares that many starts of Levenberg and Marquardt leave of the logarithm of an admittance."""
    logs, damping = rng.uniform(-3, 3, (starts, size)), np.full(starts, 1e-2)
    values, J = log_admittance(tree, logs)
    r = values - target
    for _ in range(steps):
        H = np.einsum("spi,spj->sij", J, J)
        H += (damping[:, None] * np.einsum("sii->si", H) + 1e-18)[:, :, None] * np.eye(size)
        step = np.linalg.solve(H, np.einsum("spi,sp->si", J, r)[..., None])[..., 0]
        new = np.clip(logs - np.clip(step, -3, 3), -30, 30)
        new_values, new_J = log_admittance(tree, new)
        better = ((new_values - target) ** 2).sum(-1) < (r**2).sum(-1)
        logs[better], r[better], J[better] = new[better], new_values[better] - target, new_J[better]
        damping = np.clip(np.where(better, damping / 5, damping * 4), 1e-15, 1e8)
        if np.abs(r).max(-1).min() < 1e-12:
            break
    return np.sqrt((r**2).sum(-1).min())


def end_powers(tree):
    """Powers of s to which the admittance is proportional for small and for large s."""
    if isinstance(tree, str):
        return POWERS[tree], POWERS[tree]
    low, high = zip(*map(end_powers, tree[1:]), strict=True)
    return (min(low), max(high)) if tree[0] == "|" else (max(low), min(high))


def check_that_classes_differ(size):
    """No two classes are the same functions of the same number of degrees of freedom.

    The first member of each has as many degrees of freedom as elements. Of two with the same powers of s at both ends,
    at least one has random members that no values of the other fit.
    """
    rng = np.random.default_rng(7)
    first = [members[0] for members in equivalence_classes(up_to(size))]
    for topology in first:
        singular = np.linalg.svd(log_admittance(topology.tree, rng.uniform(-1, 1, topology.size))[1], compute_uv=False)
        assert singular[..., -1].min() > 1e-9 * singular.max(), topology

    def fits(one, other):
        targets = (log_admittance(one.tree, rng.uniform(-2, 2, one.size))[0] for _ in range(5))
        return all(best_fit(other.tree, other.size, target, rng) < 1e-8 for target in targets)

    for one, other in combinations(first, 2):
        if one.size == other.size and end_powers(one.tree) == end_powers(other.tree):
            assert not (fits(one, other) and fits(other, one)), (one, other)


@pytest.mark.parametrize("size", sampled([3, 4, 5], [3], seldom=[4, 5]))
def test_classes_differ_as_functions(size):
    check_that_classes_differ(size)


def test_fits_find_equal_networks():
    rng = np.random.default_rng(8)
    for members in equivalence_classes(up_to(3)):
        for one, other in permutations(members, 2):
            target, _ = log_admittance(one.tree, rng.uniform(-2, 2, one.size))
            assert best_fit(other.tree, other.size, target, rng) < 1e-8


def test_refusals():
    one, other = Topology(("|", ("-", "k", "c"), ("-", "k", "c"))), Topology(("-", "k", ("|", "c", ("-", "k", "c"))))
    with pytest.raises(it.InerterError, match="requires 4 positive values"):
        transform_values(one, [1.0, 2.0, 3.0], other)
    with pytest.raises(it.InerterError, match="requires 4 positive values"):
        transform_values(one, [1.0, 2.0, 3.0, -1.0], other)
    with pytest.raises(it.InerterError, match="Change a value slightly"):
        transform_values(one, [1.0, 2.0, 2.0, 4.0], other)
    with pytest.raises(it.InerterError, match="No transformation"):
        transform_values(one, [1.0, 2.0, 3.0, 4.0], Topology(("|", "k", "c")))
