"""What linear analysis leaves of a network, what it says about that, and how free values get their names."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import networks

from inerter import Damper, Friction, Gap, HalfCar, Inerter, QuarterCar, Spring, free
from inerter.errors import DesignError
from inerter.networks.elements import Parallel, Series
from inerter.networks.transform import linearise, map_elements, notes_of

k, c, b, f, gap = Spring(1e5, "k"), Damper(2e3, "c"), Inerter(30.0, "b"), Friction(5.0, "f"), Gap(1e-3, "gap")


@given(networks())
def test_a_linear_network_stays_as_it_is(network):
    left = linearise(network)
    assert left.network == network
    assert (left.frictions, left.gaps, left.idle) == ((), (), ())


@pytest.mark.parametrize(
    ("network", "left", "idle"),
    [
        (k | f, k, ()),
        (k - gap, k, ()),
        (k | c - f, k, ("c",)),
        (c - (k | gap), c, ("k",)),
        ((k | c) - gap - (b | f), (k | c) - b, ()),
        (k | (c - (b | gap)), k | c, ("b",)),
        (k | c - (f - gap) - b, k, ("c", "b")),
    ],
)
def test_friction_is_left_out_and_gaps_are_closed(network, left, idle):
    result = linearise(network)
    assert result.network == left
    assert result.idle == idle
    assert result.frictions == (("f",) if f in network.elements() else ())
    assert result.gaps == (("gap",) if gap in network.elements() else ())


@pytest.mark.parametrize(
    ("network", "rigid"),
    [
        (f, False),
        (gap, True),
        (k - f, False),
        (k | gap, True),
        (f - gap, False),
        (f | gap, True),
        ((k | gap) - f, False),
    ],
)
def test_nothing_may_be_left(network, rigid):
    result = linearise(network)
    assert result.network is None
    assert result.rigid is rigid


@st.composite
def networks_with_losses(draw):
    def lose(element):
        kind = draw(st.sampled_from([None, None, Friction, Gap]))
        return element if kind is None else kind(1.0)

    return map_elements(draw(networks()), lose)


@given(networks_with_losses(), st.floats(0.1, 100.0), st.floats(-100.0, 100.0))
def test_what_is_left_has_the_admittance_of_the_whole(network, real, imaginary):
    s, left = complex(real, imaginary), linearise(network)
    if left.network is None:
        assert network.admittance(s) == (float("inf") if left.rigid else 0.0)
    else:
        assert network.admittance(s) == pytest.approx(left.network.admittance(s), rel=1e-12)


def test_an_element_that_stands_in_two_places_may_be_idle_in_one():
    assert linearise(c | c - f).idle == ("c",)


def names(*networks):
    if len(networks) == 1:
        return list(QuarterCar(1.0, 1.0, 1.0, *networks).free_values())
    return list(HalfCar(1, 1, 1, 1, 1, 1, 1, 1, *networks).free_values())


def test_a_free_value_is_named_by_itself_then_by_its_element_then_by_its_symbol():
    assert names(Damper(free(1, 2, "own"), "element") | Spring(free(1, 2), "main") | Inerter(free(1, 2))) == [
        "own",
        "main",
        "b",
    ]


def test_unnamed_free_values_are_all_different():
    assert names(Damper(free(1, 2)) | Damper(free(1, 2)) - Damper(free(1, 3))) == ["c", "c2", "c3"]
    strut = Spring(1.0) | Damper(free(1, 2))
    assert names(strut, strut) == ["c", "c2"]


def test_an_automatic_name_avoids_a_given_one():
    assert names(Damper(free(1, 2)) | Damper(free(1, 2), "c")) == ["c2", "c"]
    assert names(Damper(free(1, 2)) | Spring(free(1, 2), "c2") | Damper(free(1, 2))) == ["c", "c2", "c3"]


def test_free_values_of_one_name_are_one_variable():
    strut = Spring(1.0) | Damper(free(1, 2), "c")
    car = HalfCar(1, 1, 1, 1, 1, 1, 1, 1, strut, strut)
    assert list(car.free_values()) == ["c"]
    fixed = car.with_values({"c": 1.5})
    assert fixed.front == fixed.rear == Spring(1.0) | Damper(1.5, "c")


@pytest.mark.parametrize("other", [Damper(free(1, 3), "c"), Spring(free(1, 2), "c"), Inerter(free(1, 2, "c"))])
def test_one_name_has_one_range_and_one_unit(other):
    with pytest.raises(DesignError, match="'c' has two ranges"):
        names(Damper(free(1, 2), "c") | other)


def test_the_kinds_of_joints_stay():
    left = linearise((k | c | f) - (b | f) - gap).network
    assert isinstance(left, Series)
    assert isinstance(left.parts[0], Parallel)


def test_notes_name_all_places_of_a_kind_at_once():
    """Four wheels with the same device are two notes, not eight."""
    wheels = {
        "front": linearise(k | f | c - gap),
        "rear": linearise(k | f),
        "boot": linearise(c | k - Friction(5.0, "g")),
    }
    assert notes_of(wheels) == [
        "friction 'f' in 'front', 'f' in 'rear' and 'g' in 'boot' left out",
        "gap 'gap' in 'front' taken as closed",
        "'k' in 'boot' without force then",
    ]
    assert notes_of({"strut": linearise(k | c)}) == []
