"""The algebra of `|` and `-`: associative, flat, with the precedence of the drawing, the same in code and in text."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import elements, logarithmic, networks

from inerter import Damper, Friction, Gap, Inerter, InerterError, Spring, network
from inerter.networks.elements import Element, Parallel, Series
from inerter.networks.parser import replace_in_expression

PARTS = {
    "k": Spring(1e5, "k"),
    "c": Damper(2e3, "c"),
    "b": Inerter(30.0, "b"),
    "f": Friction(5.0, "f"),
    "g": Gap(1e-3, "g"),
}


@given(networks(), networks(), networks())
def test_joining_is_associative(one, two, three):
    assert (one | two) | three == one | (two | three)
    assert (one - two) - three == one - (two - three)


@given(networks())
def test_a_part_is_never_of_the_kind_of_its_whole(whole):
    pending = [whole]
    while pending:
        part = pending.pop()
        if isinstance(part, Parallel | Series):
            assert len(part.parts) >= 2
            assert not any(type(inner) is type(part) for inner in part.parts)
            pending += part.parts


@given(elements(), elements(), elements())
def test_series_binds_tighter_than_parallel(one, two, three):
    assert one | two - three == one | (two - three)
    assert one - two | three == (one - two) | three


@given(networks(), networks())
def test_joining_keeps_every_element_in_the_order_of_writing(one, two):
    assert list((one | two).elements()) == list((one - two).elements()) == [*one.elements(), *two.elements()]


expressions = st.recursive(
    st.sampled_from(list(PARTS)),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["|", "-", " | ", " -", "-  "]), inner).map("".join),
        inner.map(lambda text: f"({text})"),
        inner.map(lambda text: f" ( {text} )"),
    ),
    max_leaves=10,
)


@given(expressions)
def test_a_string_means_what_the_operators_mean(text):
    assert network(text, **PARTS) == eval(text.strip(), {"__builtins__": {}}, PARTS)


@given(expressions, expressions)
def test_a_network_in_place_of_a_name_is_that_network(outer, inner):
    text = replace_in_expression(outer, {"c": inner})
    assert network(text, **PARTS) == network(outer, **{**PARTS, "c": network(inner, **PARTS)})


@given(expressions)
def test_arms_of_bridges_take_networks_without_brackets(inner):
    text = replace_in_expression("k - bridge(b, c, f - g, k | b, c)", {"c": inner})
    chosen = network(inner, **PARTS)
    assert network(text, **PARTS) == network("k - bridge(b, c, f - g, k | b, c)", **{**PARTS, "c": chosen})
    assert text.startswith(f"k - bridge(b, {replace_in_expression(inner, {})}, f - g")


def drawn(part) -> str:
    if isinstance(part, Element):
        return part.label
    joint = " | " if isinstance(part, Parallel) else " - "
    return "(" + joint.join(map(drawn, part.parts)) + ")"


@given(expressions)
def test_what_is_drawn_is_read_back(text):
    read = network(text, **PARTS)
    assert network(drawn(read), **PARTS) == read


@given(st.text(alphabet="kcb|-() \t\nX1_.*é", max_size=12))
def test_any_text_is_a_network_or_a_refusal_with_a_reason(text):
    try:
        read = network(text, **PARTS)
    except InerterError:
        return
    assert network(drawn(read), **PARTS) == read


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("k |", 4, "element name or '(' expected"),
        ("| k", 1, "element name or '(' expected"),
        ("k | | c", 5, "element name or '(' expected"),
        ("k c", 3, "'|', '-' or the end expected"),
        ("(k | c", 7, "')' expected"),
        ("k | c)", 6, "'|', '-' or the end expected"),
        ("()", 2, "element name or '(' expected"),
        ("k | x", 5, "undefined element 'x'; defined: k, c, b, f, g"),
        ("k | c * b", 7, "'*' is not part of the syntax"),
        ("k | 2c", 5, "'2' is not part of the syntax"),
        ("  k +c", 5, "'+' is not part of the syntax"),
        ("k\n|\n$", 5, "'$' is not part of the syntax"),
    ],
)
def test_a_syntax_error_names_its_column(text, column, words):
    with pytest.raises(InerterError) as refusal:
        network(text, **PARTS)
    assert f"column {column}:" in str(refusal.value)
    assert words in str(refusal.value)


def test_an_unnamed_element_takes_its_name_in_the_expression():
    read = network("spring | d", spring=Spring(1.0), d=Damper(2.0, "own"))
    assert [element.label for element in read.elements()] == ["spring", "own"]


@given(logarithmic(1e-300, 1e300))
def test_elements_keep_their_number(value):
    assert [kind(value).value for kind in (Spring, Damper, Inerter, Friction, Gap)] == [value] * 5
