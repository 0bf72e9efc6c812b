"""Schematics: what is drawn is the network, and nothing runs over anything else."""

import xml.etree.ElementTree as ET
from functools import reduce
from itertools import combinations, pairwise
from operator import or_, sub

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from inerter import Damper, Friction, Gap, Inerter, Spring, free
from inerter.errors import NetworkError
from inerter.figures.networks import draw_networks, draw_schematic, element_label, network_figure, schematic
from inerter.figures.style import style_context
from inerter.figures.symbols import HALF_HEIGHT, HALF_WIDTH, LEADING, TO_LABEL, blank_figure, symbol
from inerter.networks.catalogue import LAYOUTS
from inerter.networks.elements import ELEMENT_TYPES, Bridge, Parallel, Series
from inerter.networks.parser import names, network

KINDS = {"k": Spring(120e3), "c": Damper(3.2e3), "b": Inerter(328.72), "f": Friction(10.0), "g": Gap(1e-3)}
NAMES = ["k", "c_s", "inertance", "k_rear_left_of_the_middle_axle", "f2", "eps"]


def written(expression):
    return network(expression, **{name: KINDS[name[0].lower()] for name in names(expression)})


def nest(levels):
    """One that goes down on the right, parallel and series in turn."""
    return reduce(lambda inner, i: written(f"k{i} | c{i}") - (KINDS["b"] | inner), range(levels), KINDS["f"])


@st.composite
def networks(draw, kinds=ELEMENT_TYPES, depth=4):
    """Of named and nameless elements, by the operators and by nesting as it comes, down to a part alone."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        value = draw(st.floats(0.1, 10.0) if kinds is not ELEMENT_TYPES else st.just(1.0) | st.just(free(1.0, 2.0)))
        return draw(st.sampled_from(kinds))(value, draw(st.none() | st.sampled_from(NAMES)))
    parts = draw(st.lists(networks(kinds, depth - 1), min_size=1, max_size=4))
    join = draw(
        st.sampled_from(
            [
                lambda p: reduce(or_, p),
                lambda p: reduce(sub, p),
                lambda p: Parallel(tuple(p)),
                lambda p: Series(tuple(p)),
                lambda p: Bridge(*(p * 5)[:5]),
            ]
        )
    )
    return join(parts)


def box(placed):
    """Left, right, lower and upper edge of a symbol with its label."""
    return placed.x - HALF_WIDTH, placed.right, placed.y - HALF_HEIGHT, placed.y + HALF_HEIGHT


def meet(one, other):
    """Whether the insides of two boxes do; edges may touch."""
    (a, b, c, d), (e, f, g, h) = one, other
    return min(b, f) - max(a, e) > 1e-6 and min(d, h) - max(c, g) > 1e-6


def segments(lines):
    return [np.array(ends) for line in lines for ends in pairwise(line)]


def touches(segment, point):
    low, high = segment.min(axis=0) - 1e-6, segment.max(axis=0) + 1e-6
    return bool(np.all((low <= point) & (point <= high)))


def conductance(drawing, s):
    """Admittance between the ends of the drawing at a real `s`: what touches is one node, then Kirchhoff's laws."""
    wires = segments(drawing.lines)
    ends = [np.array((p.x, p.y + side * HALF_HEIGHT)) for p in drawing.placed for side in (1, -1)]
    points = [np.zeros(2), np.array((0.0, -drawing.height)), *ends]
    node = list(range(len(points) + len(wires)))

    def join(i, j):
        node[:] = [node[i] if n == node[j] else n for n in node]

    for i, wire in enumerate(wires, len(points)):
        for j, point in enumerate(points):
            if touches(wire, point):
                join(i, j)
        for j, other in enumerate(wires, len(points)):
            if any(touches(wire, end) for end in other):
                join(i, j)
    for (i, one), (j, other) in combinations(enumerate(points), 2):
        if np.allclose(one, other):
            join(i, j)
    matrix = np.zeros((len(node), len(node)))
    for k, placed in enumerate(drawing.placed):
        e = np.zeros(len(node))
        e[node[2 + 2 * k]] += 1.0
        e[node[3 + 2 * k]] -= 1.0
        matrix += placed.element.admittance(s).real * np.outer(e, e)
    drive = np.zeros(len(node))
    drive[node[0]], drive[node[1]] = 1.0, -1.0
    return 1.0 / (drive @ np.linalg.lstsq(matrix, drive, rcond=1e-12)[0])


def check_places(drawing):
    boxes = [box(placed) for placed in drawing.placed]
    for left, right, low, high in boxes:
        assert -drawing.left - 1e-6 <= left < right <= drawing.right + 1e-6
        assert -drawing.height - 1e-6 <= low < high <= 1e-6
    assert not any(meet(one, other) for one, other in combinations(boxes, 2))
    for wire in segments(drawing.lines):
        (left, low), (right, high) = wire.min(axis=0), wire.max(axis=0)
        assert left == right or low == high
        assert -drawing.left <= left <= right <= drawing.right
        for a, b, c, d in boxes:
            assert right <= a or left >= b or high <= c + 1e-6 or low >= d - 1e-6


@given(networks())
def test_every_element_is_placed_once_in_order_and_boxes_do_not_meet(network):
    drawing = schematic(network)
    elements = list(network.elements())
    assert len(drawing.placed) == len(elements)
    assert all(placed.element is element for placed, element in zip(drawing.placed, elements, strict=True))
    check_places(drawing)


@pytest.mark.campaign
@settings(max_examples=25)
@given(networks((Spring, Damper, Inerter), depth=3), st.floats(0.5, 2.0))
def test_what_touches_in_the_drawing_is_the_network(network, s):
    assert conductance(schematic(network), s) == pytest.approx(network.admittance(s).real, rel=1e-6)


@pytest.mark.campaign
def test_a_hundred_levels():
    check_places(schematic(nest(100)))


def test_parts_in_parallel_keep_their_order_and_hang_between_the_same_bars():
    drawing = schematic(written("k | c - b | f"))
    spring, damper, inerter, friction = drawing.placed
    assert spring.x < damper.x == inerter.x == 0.0 < friction.x
    assert spring.y == friction.y == pytest.approx((damper.y + inerter.y) / 2.0)
    assert damper.y - HALF_HEIGHT == pytest.approx(inerter.y + HALF_HEIGHT)


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
def test_symbols_join_their_ends_and_stay_in_their_box(kind):
    points = np.array([point for line in kind.drawing for point in line])
    assert {(0.0, HALF_HEIGHT), (0.0, -HALF_HEIGHT)} <= {point for line in kind.drawing for point in line}
    assert (np.abs(points) <= (HALF_WIDTH, HALF_HEIGHT)).all()


@pytest.mark.parametrize(
    ("name", "formula"),
    [
        ("k", "$k$"),
        ("kb", r"$k_\mathrm{b}$"),
        ("k_b", r"$k_\mathrm{b}$"),
        ("k_", "$k$"),
        ("k12", r"$k_\mathrm{12}$"),
        ("ks2_rear", r"$k_\mathrm{s2,rear}$"),
        ("gap", r"$\mathrm{gap}$"),
        ("gap2", r"$\mathrm{gap}_\mathrm{2}$"),
        ("eps_1", r"$\varepsilon_\mathrm{1}$"),
        ("a1b2", r"$\mathrm{a1b2}$"),
    ],
)
def test_names_are_formulas(name, formula):
    assert symbol(name) == formula


def test_labels_say_the_value_where_there_is_one():
    assert element_label(Spring(120e3, "k_s"), values=True) == "$k_\\mathrm{s}$\n120\N{NO-BREAK SPACE}kN/m"
    assert element_label(Spring(120e3, "k_s")) == "$k_\\mathrm{s}$"
    assert element_label(Damper(free(1.0, 2.0, "c2")), values=True) == "$c_\\mathrm{2}$"


FIGURES = {
    "catalogue": {name: written(layout.expression) for name, layout in LAYOUTS.items()},
    "real inerter": {"S3": written("k | c - (ks | cs) - (b | f)")},
    "ten in parallel": {"ten": written(" | ".join(f"k_wheel{i}" for i in range(10)))},
    "nested": {"5": nest(5), "2": nest(2)},
    "titles": {"": KINDS["k"], "costs $x$ or\ntwo $": KINDS["f"], "a title that is wider than all of it": KINDS["g"]},
    "bars in bars": {"one": Parallel((Parallel((KINDS["k"],)), Series((KINDS["c"],))))},
    "long names": {"a": written("k_of_the_spring_on_the_left_side | c_rear - b"), "b": written("f_c - gap | k | b")},
}


@pytest.mark.parametrize("values", [False, True])
@pytest.mark.parametrize("drawn", FIGURES.values(), ids=FIGURES)
def test_no_text_runs_over_the_edge_over_other_text_or_over_lines(drawn, values):
    with style_context():
        figure = network_figure(drawn, values=values)
        figure.draw_without_rendering()
    (axes,) = figure.axes
    back = axes.transData.inverted()
    texts = [text.get_window_extent().padded(-0.5).transformed(back) for text in axes.texts if text.get_text()]
    paths = [path for lines in axes.collections for path in lines.get_paths()]
    page = figure.bbox.transformed(back)
    assert all(page.count_contains([text.min, text.max]) == 2 for text in texts)
    assert all(page.count_contains(path.vertices) == len(path.vertices) for path in paths)
    assert not any(one.overlaps(other) for one, other in combinations(texts, 2))
    assert not any(path.intersects_bbox(text, filled=False) for path in paths for text in texts)


@pytest.mark.parametrize("values", [False, True])
def test_a_label_stands_at_its_element(values):
    placed = written("k | c - (ks | cs) - (b | f)")
    figure, axes = blank_figure(400.0, 300.0)
    figure.set_dpi(300.0)  # letters are moved and widened to whole pixels
    assert draw_schematic(schematic(placed, values=values), axes, (150.0, 280.0)) is axes
    figure.draw_without_rendering()
    texts = iter(axes.texts)
    for one in schematic(placed, values=values).placed:
        for line in one.label.splitlines():
            text = next(texts)
            assert text.get_text() == line
            box = text.get_window_extent().transformed(axes.transData.inverted())
            assert box.x0 - 150.0 - one.x == pytest.approx(HALF_WIDTH + TO_LABEL, abs=1.5)
            assert box.x1 <= 150.0 + one.right + 1.0
            assert abs(box.y0 + box.y1 - 2.0 * (280.0 + one.y)) < 2.0 * (LEADING if values else 2.0)
    assert next(texts, None) is None


def test_networks_wider_than_a_page_make_it_wider_and_others_share_rows():
    one = network_figure({"a": KINDS["k"]}).get_size_inches()
    two = network_figure({"a": KINDS["k"], "b": KINDS["c"]}).get_size_inches()
    many = network_figure({str(i): KINDS["k"] for i in range(40)}).get_size_inches()
    wide = network_figure({"wide": reduce(or_, [KINDS["k"]] * 30), "b": KINDS["k"]}).get_size_inches()
    assert one[0] < two[0] < many[0] <= 7.0 < wide[0]
    assert one[1] == pytest.approx(two[1])
    assert 2.0 * one[1] < many[1]
    assert 1.5 * one[1] < wide[1]


@pytest.mark.campaign
def test_files_are_written_and_the_same_every_time(tmp_path):
    drawn = FIGURES["catalogue"]
    first, second = (draw_networks(drawn, tmp_path / run, "layouts") for run in "12")
    assert [path.name for path in first] == ["layouts.svg", "layouts.pdf", "layouts.png"]
    assert ET.parse(first[0]).getroot().tag.endswith("svg")
    assert first[1].read_bytes().startswith(b"%PDF")
    assert first[2].read_bytes().startswith(b"\x89PNG")
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


@pytest.mark.parametrize("nothing", [Parallel(()), Series(()), KINDS["k"] | Series(()), "k | c"])
def test_what_is_no_network_is_refused(nothing):
    with pytest.raises(NetworkError):
        schematic(nothing)


def test_a_figure_needs_a_network():
    with pytest.raises(NetworkError, match="at least one"):
        network_figure({})
