"""Words and numbers for people: they mean what the results say."""

from synthetic import designs, sweep

from inerter.figures.labels import axis_label, compared_layouts, flat_range, layouts, swept_element


def test_the_baseline_comes_first_and_is_not_compared_with_itself():
    data = designs(["S2", "S1", "S3"])
    assert layouts(data) == ["S1", "S2", "S3"]
    assert compared_layouts(data) == ["S2", "S3"]
    assert compared_layouts(designs(["S1"], baseline="")) == []


def test_the_swept_element_is_the_dimension_that_only_a_sweep_has():
    assert swept_element(designs()) is None
    assert swept_element(sweep()) == "k"


def test_long_labels_take_two_lines_and_keep_units_whole():
    label = axis_label("Damping coefficient of the front axle", "kN s/m")
    assert label.count("\n") == 1
    assert "kN s/m".replace(" ", "\N{NO-BREAK SPACE}") in label.splitlines()[1]


def test_flat_optima_show_their_range() -> None:
    data = designs()
    entry = data.sel(layout="S2", index="J1", parameter="c")
    assert flat_range(entry) == ""
    wide = entry.assign(parameter_low=3000.0, parameter_high=40e3)
    assert flat_range(wide) == "3 kN s/m to 40 kN s/m"
