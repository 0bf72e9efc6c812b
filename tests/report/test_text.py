"""Tables for the terminal: plain, narrow, and with all the numbers."""

import math
import re

import pytest
import xarray as xr
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from synthetic import LONG, TITLES, designs, improved, judged, sweep, terminal_text, with_value

from inerter.formatting import format_quantity
from inerter.methods.registry import brief_words_of
from inerter.report.index_summary import crossings, sweep_headlines
from inerter.report.text import WIDTH, table_lines
from inerter.report.verdicts import best_layouts, verdict_sentences
from inerter.table import Row, Table, cells, columns

NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_+.-]{0,39}", fullmatch=True)
METHODS = ["norm", "statistical-linearisation", "expected-value", "approximate-linear"]
ANY_VALUE = st.one_of(st.floats(1e-12, 1e12), st.sampled_from([math.inf, math.nan]))


PRINTED = st.text(st.characters(exclude_categories=["C", "Z"]) | st.just(" "), max_size=200)


def fitting(results, quoted=""):
    """The text of results, all of whose lines fit a terminal; ASCII but for what the user wrote."""
    text = terminal_text(results)
    assert "".join(set(text) - set(quoted)).isascii()
    assert all(len(line) <= WIDTH and line == line.rstrip() for line in text.split("\n"))
    return text


@settings(max_examples=15)
@given(st.lists(NAMES, min_size=1, max_size=6, unique=True), ANY_VALUE, st.booleans(), PRINTED)
def test_tables_fit_a_terminal(names, value, swept, message):
    results = (sweep if swept else designs)(names, baseline=names[0])
    results = with_value(results, value, f"failed: {message}", layout=names[-1], index="J3")
    text = fitting(results, message)
    for name in names[1:] if len(names) > 1 else names:
        assert name in text


@pytest.mark.parametrize("width", [40, 50, 60, 70, WIDTH])
def test_every_part_of_a_table_has_the_labels_of_its_rows(width):
    heads = columns("Layout", "Index", "Method", "First", "Second", "Third", "Fourth")
    keys = [(layout, index, method) for layout in ("S1", "S2") for index in ("J1", "J3") for method in METHODS[:2]]
    rows = [Row(cells(*key, *(f"{i}{j}.000 kN s/m" for j in range(4)))) for i, key in enumerate(keys)]
    lines = list(table_lines(Table("", heads, rows, labels=3), width))
    for i, key in enumerate(keys):
        for number in range(4):
            at = next(n for n, line in enumerate(lines) if f"{i}{number}.000" in line)
            assert " ".join(key) in " ".join(" ".join(lines[max(at - 1, 0) : at + 1]).split())


def test_a_name_keeps_its_letters():
    text = fitting(designs(["weich", "härter", "härtér"], baseline="weich"), "äé")
    assert all(f"  {name} " in text for name in ("weich", "härter", "härtér"))


def test_methods_without_any_value_are_not_compared():
    results = judged(designs())
    results["value"].loc[{"index": "J3"}] = math.nan
    results["status"] = results["status"].astype(object)
    results["status"].loc[{"index": "J3"}] = "infeasible: no feasible design"
    text = terminal_text(results)
    assert "J1) by each method" in text
    assert "J3) by each method" not in text
    assert verdict_sentences(results)[list(results["index"].values).index("J3")] == (
        "No strut satisfies the constraints, so none is best in dynamic tyre load (J3)."
    )


def test_designs_with_their_numbers():
    lines = terminal_text(designs()).split("\n")
    assert lines[:6] == [
        "Best for ride comfort (J1)",
        "  Layout  J1           Improvement  Parameters",
        "  S1      2.575 m/s^2  baseline     c = 4.12 kN s/m",
        "  S2      2.420 m/s^2  +6.0 %       c = 3.873 kN s/m, b = 250 kg",
        "  S3      2.266 m/s^2  +12.0 %      c = 3.626 kN s/m,",
        "                                    b = 250 kg (at its upper bound)",
    ]


MANY = [10e3, 20e3, 30e3, 50e3, 100e3, 200e3, 300e3]  # stiffness [N/m]: more than a terminal shows


def test_a_short_sweep_is_shown_at_all_its_values():
    results = improved(sweep(["S1", "S2"], stiffness=MANY[::3]))
    results["improvement"].loc[{"layout": "S2", "index": "J1"}] = [3.0, -2.0, 7.0]
    values = [[float(v) for v in row] for row in results["value"].sel(index="J1").transpose("k", "layout", ...).values]
    lines = terminal_text(results).split("\n")
    assert lines[0] == "Best ride comfort (J1) in m/s^2, over k in kN/m"
    shown = [[float(number) for number in line.split()] for line in lines[2:8:2]]
    assert shown == [pytest.approx([k / 1e3, *row], rel=1e-3) for k, row in zip(MANY[::3], values, strict=True)]
    assert [line.split() for line in lines[3:9:2]] == [["+3.0", "%"], ["-2.0", "%"], ["+7.0", "%"]]


def test_an_index_without_a_unit_has_none_in_captions():
    results = sweep(stiffness=MANY[::3])
    results = results.assign_coords(index_unit=("index", ["" for _ in results["index"].values]))
    assert terminal_text(results).startswith("Best ride comfort (J1), over k in kN/m\n")


def test_a_sweep_by_its_best_and_its_worst():
    results = improved(sweep(stiffness=MANY))
    results["improvement"].loc[{"layout": "S2", "index": "J5"}] = [3.0, 1.0, 1.0, 1.0, -2.0, 1.0, 7.0]
    assert "  S2      +7.0 % at 300 kN/m  -2.0 % at 100 kN/m" in terminal_text(results).split("\n")


@pytest.mark.campaign
@settings(max_examples=10, phases=[Phase.explicit, Phase.generate])
@given(st.lists(NAMES, min_size=2, max_size=6, unique=True), ANY_VALUE, st.booleans(), st.integers(1, 4))
def test_tables_by_method_fit_a_terminal(names, value, swept, count):
    results = (sweep if swept else designs)(names, baseline=names[0])
    results = judged(with_value(results, value, layout=names[-1], index="J3"), METHODS[-count:])
    text = fitting(results)
    assert all(brief_words_of(method).split()[-1] in text for method in METHODS[-count:] if count > 1)


def test_methods_side_by_side_with_their_errors():
    lines = terminal_text(judged(designs())).split("\n")
    assert lines[0] == "Best for ride comfort (J1), by exact norms"
    start = lines.index("Ride comfort (J1) by each method, in m/s^2")
    assert lines[start + 1 : start + 7] == [
        "  Layout  By exact norms  By simulation",
        "  S1      2.575           2.601",
        "  S2      2.420           2.4447 +- 0.0098",
        "          +6.0 %          +6.00 +- 0.31 %",
        "  S3      2.266           2.2887 +- 0.0092",
        "          +12.0 %         +12.00 +- 0.31 %",
    ]


def test_one_method_with_errors_is_the_table_as_it_was_with_errors_in_it():
    lines = terminal_text(judged(designs(), ["expected-value"])).split("\n")
    assert lines[0] == "Best for ride comfort (J1)"
    assert lines[3] == "  S2      2.4205 +- 0.0097 m/s^2  +6.00 +- 0.31 %   c = 3.873 kN s/m, b = 250 kg"
    assert "by each method" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("value", "error", "unit", "text"),
    [
        (2.64912, 0.000584, "m/s^2", "2.64912 +- 0.00058 m/s^2"),
        (503.3436, 0.0865, "N", "503.344 +- 0.086 N"),
        (413.7, 99.6, "N", "410 +- 100 N"),
        (75947.0, 127.8, "N/m", "75.95 +- 0.13 kN/m"),
        (12.0, 345.0, "N", "10 +- 340 N"),
        (2.5, 0.0, "N", "2.5 N"),
        (2.5, math.nan, "N", "2.5 N"),
        (math.inf, 1.0, "N", "inf"),
    ],
)
def test_a_value_has_the_decimals_of_its_error(value, error, unit, text):
    assert format_quantity(value, unit, error=error) == text


def test_a_crossing_of_a_sweep_with_its_error():
    """Improvements on the parabola 6 - (k/50e3 - 3)^2 per cent, which are zero at 3 +- sqrt(6) times 50 kN/m."""
    stiffness = [50e3 * place for place in range(7)]
    results = sweep(["S1", "S2"], stiffness=[max(k, 1.0) for k in stiffness])
    results["improvement"].loc[{"layout": "S2", "index": "J1"}] = [6.0 - (k / 50e3 - 3.0) ** 2 for k in stiffness]
    for (at, error), side in zip(crossings(results, "J1", "S2"), (-1.0, 1.0), strict=True):
        assert at == pytest.approx(50e3 * (3.0 + side * math.sqrt(6.0)), abs=2.0 * error)
        assert error < 3e3
    scattered = results.assign(improvement_error=results["improvement"] * 0.0 + 0.5)
    for (_, exact), (_, wide) in zip(crossings(results, "J1", "S2"), crossings(scattered, "J1", "S2"), strict=True):
        assert wide > exact
    assert "S2 and S1 are equally good at k = " in terminal_text(results)


def test_curves_that_lie_on_each_other_do_not_cross():
    results = sweep(["S1", "S2"], stiffness=[10e3, 20e3, 30e3, 40e3, 50e3])
    for improvement in ([1e-9, -1e-9, 1e-9, 0.0, 1e-9], [5.0, 0.0, 0.0, 0.0, -5.0], [math.nan] * 5):
        results["improvement"].loc[{"layout": "S2", "index": "J1"}] = improvement
        assert crossings(results, "J1", "S2") == []


def test_a_status_that_is_not_ok_is_told():
    status = "unstable: the design has no finite norm"
    assert f"    ! {status}" in terminal_text(with_value(designs(), math.inf, status, layout="S2", index="J1"))
    one_point = with_value(sweep(stiffness=MANY), math.inf, status, layout="S2", index="J1", k=10e3)
    assert f"    ! {status} (1 of 7 values are not ok)" in terminal_text(one_point).split("\n")
    short = with_value(sweep(stiffness=MANY[:3]), math.inf, status, layout="S2", index="J1", k=10e3)
    assert f"S2 at k = 10 kN/m: {status}" in terminal_text(short)


def test_ten_layouts_in_one_block_each():
    lines = terminal_text(designs(LONG)).split("\n")
    assert [line for line in lines if line.startswith("Best for")] == [
        f"Best for {title} ({index})" for index, title in TITLES.items()
    ]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({}, "S3 is 12.0 % better than S1 in ride comfort (J1)."),
        (
            {"layout": "S1", "value": 2.0},
            "No strut is better than S1 in ride comfort (J1); S3, the next, is 13.3 % worse.",
        ),
        (
            {"layout": "S1", "value": 2.2661},
            "S3 is as good as S1 in ride comfort (J1), and no better (difference 0.0 %).",
        ),
        (
            {"layout": "S1", "value": math.inf},
            "S3 is best in ride comfort (J1), 2.266 m/s^2, 6.4 % better than S2; S1 has no finite value.",
        ),
        ({"layout": ["S1", "S2", "S3"], "value": math.inf}, "No strut has a finite value of ride comfort (J1)."),
    ],
)
def test_verdicts_of_designs(change, sentence):
    results = designs()
    if change:
        results = with_value(results, change["value"], layout=change["layout"], index="J1")
    assert verdict_sentences(results)[0].startswith(sentence)


@pytest.mark.parametrize(
    ("improvement", "sentence"),
    [
        (
            [3.0, -2.0, 7.0],
            "Best ride comfort compared with S1 of the same k: S2, 7.0 % better at k = 300 kN/m; "
            "its improvement over the sweep lies between -2.0 % and 7.0 %.",
        ),
        ([3.36, 3.36, 3.36], "Best ride comfort compared with S1 of the same k: S2, 3.4 % better at every k."),
        ([0.0, -2.0, -math.inf], "Best ride comfort: no layout is better than S1 at any k."),
    ],
)
def test_headlines_of_sweeps(improvement, sentence):
    results = sweep(["S1", "S2"], stiffness=[10e3, 100e3, 300e3])
    results["improvement"].loc[{"layout": "S2", "index": "J1"}] = improvement
    assert sweep_headlines(results)[0] == sentence


def test_the_best_layout_has_the_least_finite_value():
    results = designs()
    assert best_layouts(results, "J1")[0] == results["layout"][results["value"].sel(index="J1").argmin("layout")]
    assert best_layouts(with_value(results, math.nan, layout="S3", index="J1"), "J1")[0] == "S2"


@pytest.mark.campaign
@settings(max_examples=20)
@given(st.permutations([2, 3, 3, 9]), st.floats(-1e-15, 1e-15), st.sampled_from([1e-9, 8.333e-6, 1e5]))
def test_of_equally_good_layouts_the_simplest_is_named_and_the_others_are_told(counts, rounding, value):
    """Whatever rounding makes of equal values: the fewest elements first, then as in the file."""
    names = ["A", "B", "C", "D"]
    results = designs(names, baseline="D").assign_coords(elements=("layout", list(counts)))
    for i, name in enumerate(names):
        results = with_value(results, value * (1.0 + i * rounding), layout=name, index="J5")
    order = sorted(names, key=lambda name: counts[names.index(name)])
    assert best_layouts(results, "J5")[0] == order[0]
    sentence = next(line for line in verdict_sentences(results) if "load carrying (J5)" in line.split(". ")[0])
    others = [name for name in order if name != "D"]
    assert sentence.startswith(
        f"{others[0]}, {others[1]} and {others[2]} are as good as D in dynamic load carrying (J5)"
    )
    worse = with_value(results, value * 1.01, layout=order[0], index="J5")
    assert best_layouts(worse, "J5")[0] == order[1]


def test_a_wide_table_continues_below_and_tells_a_doubt_once():
    heads = [f"column-{i}-of-twelve" for i in range(12)]
    rows = [Row(cells(label, *(f"{label}{i}" for i in range(12))), status=f"{label} is doubtful") for label in "ab"]
    lines = list(table_lines(Table("Wide", columns("Row", *heads), rows)))
    assert max(map(len, lines)) <= WIDTH
    words = " ".join(lines).split()
    assert [word for word in words if word in heads] == heads
    for label in "ab":
        assert [word for word in words if word[:-1].startswith(label) and word[1:].isdigit()] == [
            f"{label}{i}" for i in range(12)
        ]
        assert sum(f"! {label} is doubtful" in line for line in lines) == 1


def test_a_table_of_labels_alone_keeps_its_rows_and_doubts():
    table = Table("Names", columns("Layout"), [Row(cells("S1")), Row(cells("S2"), status="bad")])
    assert list(table_lines(table)) == ["Names", "  Layout", "  S1", "  S2", "    ! bad"]


def test_a_sweep_whose_baseline_has_no_value_shows_those_of_the_others():
    results = sweep(["S1", "S2"], stiffness=MANY)
    results = with_value(results, math.nan, "infeasible: no feasible design", layout="S1", index="J1")
    results["improvement"].loc[{"index": "J1"}] = math.nan
    least = results["value"].sel(layout="S2", index="J1").min().item()
    shown = f"{format_quantity(least, 'm/s^2')} at "
    assert sweep_headlines(results)[0].startswith(f"Best ride comfort: S2, {shown}")
    assert sweep_headlines(results)[0].endswith("; no feasible S1.")
    assert shown in terminal_text(results)


@pytest.mark.parametrize(
    ("layouts", "value", "status", "sentence"),
    [
        (
            ["S2"],
            math.nan,
            "infeasible: no feasible design",
            "Best ride comfort: S1, 0.7361 m/s^2 at k = 10 kN/m; no feasible S2.",
        ),
        (["S2"], math.inf, "ok", "Best ride comfort: S1, 0.7361 m/s^2 at k = 10 kN/m; S2 has no finite value."),
        (
            ["S1", "S2"],
            math.nan,
            "infeasible: no feasible design",
            "Best ride comfort: no layout satisfies the constraints.",
        ),
        (["S1", "S2"], math.nan, "failed: singular", "Best ride comfort: no layout has a finite value."),
    ],
)
def test_a_sweep_in_which_layouts_have_no_value(layouts, value, status, sentence):
    results = sweep(["S1", "S2"], stiffness=[10e3, 100e3])
    results = with_value(results, value, status, layout=layouts, index="J1")
    missing = -math.inf if value == math.inf else math.nan
    results["improvement"].loc[{"layout": layouts, "index": "J1"}] = missing
    assert sweep_headlines(results)[0] == sentence


def test_only_a_doubt_is_marked():
    rows = [Row(cells("S2", 1.0), status="bad"), Row(cells("S3", 2.0), remark="better for every f")]
    lines = list(table_lines(Table("Names", columns("Layout", "Value"), rows)))
    assert [line for line in lines if "!" in line] == ["    ! bad"]
    assert lines[-1].strip() == "better for every f"


def test_rows_that_share_a_label_are_told_apart_in_every_part_of_a_table():
    limits, effects = (
        ["travel of each strut at most 4 mm", "load of each tyre at most 1 kN"],
        ["not reached", "reached"],
    )
    rows = [Row(cells("S1", *each, "some more words")) for each in zip(limits, effects, strict=True)]
    lines = list(table_lines(Table("Limits", columns("Layout", "Limit", "Effect", "More"), rows), 60))
    for limit, effect in zip(limits, effects, strict=True):
        assert [line.split() for line in lines if limit in line] == [
            ["S1", *limit.split(), *words.split()] for words in (effect, "some more words")
        ]


def test_a_terminal_has_the_values_of_a_sweep_where_improvements_are_largest_and_smallest() -> None:
    """Below each improvement the value of the index at that place, of the layout that has it."""
    results = sweep(stiffness=[10e3, 60e3, 120e3, 200e3, 250e3, 280e3, 300e3])
    better = results["improvement"] * xr.DataArray([0.5, 1.0, 0.2, 0.8, 0.7, 0.7, 0.7], dims="k")
    text = terminal_text(results.assign(improvement=better.transpose(*results["improvement"].dims)))
    lines = text.splitlines()
    for index, unit in (("J1", "m/s^2"), ("J3", "N")):
        for name in ("S2", "S3"):
            values = results["value"].sel(layout=name, index=index).values.ravel()
            expected = pytest.approx([values[1], values[2]], rel=1e-3)  # at 60 and 120 kN/m
            shown = [[float(number) for number in re.findall(rf"(\S+) {re.escape(unit)}", line)] for line in lines]
            assert any(numbers == expected for numbers in shown), (shown, expected)
    assert re.search(r"S2 +\+6\.0 % at 60 kN/m +\+1\.2 % at 120 kN/m", text)


def test_a_doubt_of_several_rows_is_said_once_below_them():
    """Alike but for its numbers, of which the range is told; another doubt stays below its own row."""
    said = ["inaccurate: off by up to 5.4 %", "", "failed: no value", "inaccurate: off by up to 8 %"]
    rows = [Row(cells(f"S{i}", 2.0), status=status) for i, status in enumerate(said)]
    lines = list(table_lines(Table("Designs", columns("Layout", "J1"), rows)))
    assert [line for line in lines if "!" in line] == [
        "    ! inaccurate: see below",
        "    ! failed: no value",
        "    ! inaccurate: see below",
        "    ! S0; S3: inaccurate: off by up to 5.4 to 8 %",
    ]
    several = [Row(cells("S1", method, 2.0), status=said[0]) for method in ("norm", "simulation")]
    *_, last = table_lines(Table("Values", columns("Layout", "Method", "J1"), several, labels=2))
    assert last == f"    ! S1 norm; S1 simulation: {said[0]}"
