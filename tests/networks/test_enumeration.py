"""Enumeration of networks: counts, and the same networks by joining pairs and removing duplicates."""

from __future__ import annotations

import pickle
from collections import Counter
from itertools import product

import pytest
from campaigns import sampled

import inerter as it
from inerter.networks.enumeration import Topology, canonical_tree
from inerter.networks.parser import format_expression

KINDS = {"k": it.Spring, "c": it.Damper, "b": it.Inerter}
ARRANGEMENTS = ((0, 1, 2, 3, 4), (2, 3, 0, 1, 4), (1, 0, 3, 2, 4), (3, 2, 1, 0, 4))  # of the arms of one bridge


def join(operator, one, other):
    """Connection of two networks as (operator, frozen multiset of parts): the same in any order, flat."""
    parts = Counter()
    for part in (one, other):
        parts += Counter(dict(part[1])) if part[0] == operator else Counter([part])
    return operator, frozenset(parts.items())


def networks_from_pairs(symbols, size):
    """Every network of up to `size` elements by number of elements, joined pair by pair."""
    found = {1: {(symbol, frozenset()) for symbol in symbols}}
    for total in range(2, size + 1):
        found[total] = {
            join(operator, one, other)
            for first in range(1, total)
            for one, other in product(found[first], found[total - first])
            for operator in "|-"
        }
    return found


def has_like_neighbours(network):
    return any((count > 1 and not part[1]) or has_like_neighbours(part) for part, count in network[1])


def unordered(tree):
    if isinstance(tree, str):
        return tree, frozenset()
    return tree[0], frozenset(Counter(map(unordered, tree[1:])).items())


@pytest.mark.parametrize("like_neighbours", [False, True])
@pytest.mark.parametrize("symbols", ["k", "kc", "kcb"])
def test_each_network_once_as_by_joining_pairs(symbols, like_neighbours):
    for size, expected in networks_from_pairs(symbols, 5).items():
        kinds = [KINDS[symbol] for symbol in symbols]
        found = [
            unordered(topology.tree)
            for topology in it.enumerate_networks(size, kinds=kinds, like_neighbours=like_neighbours)
        ]
        assert len(found) == len(set(found))
        assert set(found) == {each for each in expected if like_neighbours or not has_like_neighbours(each)}


@pytest.mark.parametrize("most", sampled([5, 6], [5]))
def test_counts(most):
    """One kind with like neighbours: series-parallel networks of unlabelled elements, OEIS A000084."""

    def counts(most, **options):
        return [sum(1 for _ in it.enumerate_networks(size, **options)) for size in range(1, most + 1)]

    assert counts(most) == [3, 6, 20, 90, 432, 2202][:most]
    assert counts(most, like_neighbours=True) == [3, 12, 56, 312, 1896, 12412][:most]
    assert counts(8, kinds=[it.Spring], like_neighbours=True) == [1, 2, 4, 10, 24, 66, 180, 522]


def test_bridges_by_counting_fixed_arrangements():
    """Orbits of the four arrangements by Burnside's lemma: 81 of five elements; with an arm of two elements as well."""

    def orbits(arm_sizes):
        arms = {size: [topology.tree for topology in it.enumerate_networks(size)] for size in (1, 2)}
        fillings = [filling for sizes in arm_sizes for filling in product(*[arms[size] for size in sizes])]
        fixed = [sum(tuple(f[i] for i in order) == f for f in fillings) for order in ARRANGEMENTS]
        return sum(fixed) / len(ARRANGEMENTS)

    trees = {size: [one.tree for one in it.enumerate_networks(size, bridges=True)] for size in (4, 5, 6)}
    bridges = {size: sum(tree[0] == "bridge" for tree in found) for size, found in trees.items()}
    assert bridges[4] == 0
    assert bridges[5] == orbits([(1,) * 5]) == 81
    assert bridges[6] == orbits([tuple(1 + (i == j) for i in range(5)) for j in range(5)])
    # a bridge of five in parallel or in series with one of three elements
    assert sum("bridge" in str(tree) for tree in trees[6]) - bridges[6] == 2 * 3 * 81


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_order_names_and_text(size):
    found = list(it.enumerate_networks(size, bridges=True))
    assert found == sorted(found)
    assert [t.expression for t in found] == sorted(t.expression for t in found)
    assert found == list(it.enumerate_networks(size, kinds=(it.Inerter, it.Damper, it.Spring), bridges=True))
    for topology in found:
        assert topology.size == len(topology.kinds) == len(topology.names()) == size
        assert topology.counts == Counter(name[0] for name in topology.names())
        assert len(set(topology.names())) == size
        taken = frozenset(topology.names()[:1])
        assert not taken & set(topology.names(taken))
        assert topology.format_expression(topology.names()) == topology.expression


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_networks_are_those_of_the_expression(size):
    for topology in it.enumerate_networks(size, like_neighbours=True, bridges=True):
        elements = [
            KINDS[symbol](1.0 + i, name)
            for i, (symbol, name) in enumerate(zip(topology.kinds, topology.names(), strict=True))
        ]
        network = topology.network(elements)
        assert list(network.elements()) == elements
        assert network == it.network(topology.expression, **dict(zip(topology.names(), elements, strict=True)))
        assert format_expression(network, topology.names()) == topology.expression


def test_equal_trees_are_one_topology():
    assert Topology(("|", "b", ("|", "k", ("-", "c", "b")))) == Topology(("|", "k", "b", ("-", "b", "c")))
    arms = ("k", "c", "b", ("|", "c", "k"), "c")
    assert len({Topology(("bridge", *[arms[i] for i in order])) for order in ARRANGEMENTS}) == 1
    assert len({Topology(("bridge", *[arms[i] for i in order])) for order in ((0, 1, 2, 3, 4), (1, 0, 2, 3, 4))}) == 2
    topology = Topology(("|", "k", "c"))
    assert pickle.loads(pickle.dumps(topology)) == topology


@pytest.mark.parametrize("tree", [("|",), ("|", "k"), (), ("+", "k", "c"), ("bridge", "k", "c"), 3, ("-", "k", 2)])
def test_refuse_what_is_not_a_tree(tree):
    with pytest.raises(it.InerterError, match="A tree must be"):
        canonical_tree(tree)


@pytest.mark.parametrize("elements", [0, -1, 2.5, "3", None])
def test_refuse_numbers_of_elements(elements):
    with pytest.raises(it.InerterError, match="positive integer"):
        it.enumerate_networks(elements)


@pytest.mark.parametrize("kinds", [(), ("k",), (it.Spring, it.Spring), (it.Spring(1.0),)])
def test_refuse_kinds(kinds):
    with pytest.raises(it.InerterError, match="kinds must"):
        it.enumerate_networks(2, kinds=kinds)


def test_refuse_another_number_of_elements():
    with pytest.raises(it.InerterError, match="requires 2 elements"):
        Topology(("|", "k", "c")).network([it.Spring(1.0)])
