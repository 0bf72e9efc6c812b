"""Results in notebooks: their numbers, their status first, and nothing that a page could take for markup."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from wang_su import ROAD
from wang_su import paper_quarter_car as car

import inerter as it
from inerter.errors import Status, StatusKind

COMFORT = it.RideComfort(ROAD)


FREE = it.Spring(120e3) | it.Damper(it.free(1e3, 1e4, name="c"))
PLAIN = car(it.Spring(120e3) | it.Damper(4981.0))
OPTIMUM = it.optimise(car(FREE), COMFORT, it.Norm(), seed=0)
SHOWN = {
    "estimate": (OPTIMUM.estimate, ["2.988 m/s²"]),
    "optimum": (OPTIMUM, ["2.988 m/s²", "4.981 kN s/m", f"{OPTIMUM.n_converged} of {OPTIMUM.n_starts}"]),
    "comparison": (it.compare(OPTIMUM.design, PLAIN, COMFORT, it.Norm()), ["first", "second"]),
    "front": (
        it.pareto_front(car(FREE), [COMFORT, it.LoadCarrying()], it.Norm(), points=3, seed=0),
        ["Ride comfort J1"],
    ),
    "tolerance": (it.tolerance_analysis(OPTIMUM.design, COMFORT, it.Norm(), spread={"c": 0.1}, seed=0), ["nominal"]),
    "motion": (it.simulate(PLAIN, road=it.cosine(1e-3, 1.0), duration=0.5), ["tyre load", "0 events"]),
}


@pytest.mark.parametrize("name", SHOWN)
def test_results_are_tables(name: str) -> None:
    result, texts = SHOWN[name]
    html = result._repr_html_()
    root = ElementTree.fromstring(html.replace("<br>", "<br/>"))
    text = "".join(root.itertext()).replace("\N{NO-BREAK SPACE}", " ")
    assert len(root.findall(".//tr")) >= 2
    assert [one for one in texts if one not in text] == []


def test_quantities_of_vehicle_and_seat_have_their_units() -> None:
    seat = it.Seat(PLAIN, mass=it.free(70.0, 80.0), network=it.Spring(1e4) | it.Damper(500.0))
    free = replace(
        seat, vehicle=replace(PLAIN, tyre_stiffness=it.free(100e3, 120e3), sprung_mass=it.free(180.0, 190.0))
    )
    best = it.optimise(free, COMFORT, it.Norm(), seed=0)
    printed, html = str(best), best._repr_html_().replace("&#160;", " ").replace("\N{NO-BREAK SPACE}", " ")
    for name, unit in {"tyre_stiffness": "kN/m", "sprung_mass": "kg", "mass": "kg"}.items():
        assert re.search(rf"\b{name} = [\d.]+ {unit}\b", printed)
        assert re.search(rf"\b{name}\b[^\d]*[\d.]+ {unit}<", html)


def test_ends_of_a_narrow_interval_differ() -> None:
    html = it.Estimate(250.0, "kg", standard_error=0.013, interval=(249.974, 250.026))._repr_html_()
    assert "249.974 to 250.026" in html


def test_a_doubt_is_said_first_and_markup_is_text() -> None:
    doubtful = replace(OPTIMUM.estimate, status=Status(StatusKind.INACCURATE, "<b>not</b> converged"))
    html = doubtful._repr_html_()
    assert html.index("&lt;b&gt;not") < html.index("<table>")
    assert "<b>" not in html


def test_values_with_tolerances_have_the_digits_that_their_errors_allow() -> None:
    known = it.tolerance_analysis(OPTIMUM.design, COMFORT, it.Norm(), spread={"c": 0.1}, samples=16, seed=0)
    nominal = replace(known.nominal, value=2.9876, error_sources=(it.ErrorSource("one damper", 0.03),))
    rough = replace(known, nominal=nominal, mean=2.9954, values=np.full(16, 3.1234), worst=3.4321)
    html = rough._repr_html_()
    values = re.findall(r"<td>([\d.]+)[^<]*m/s", html)
    assert values == ["3.0", "3.0", "3.1", "3.4"]


def test_a_mean_and_a_quantile_of_a_small_sample_have_the_digits_of_their_standard_errors() -> None:
    """16 evenly spaced values from 1.5 to 3.5: the mean of 2.5 has a standard error of 0.15, a quantile more."""
    values = np.linspace(1.5, 3.5, 16)
    known = it.tolerance_analysis(OPTIMUM.design, COMFORT, it.Norm(), spread={"c": 0.1}, samples=16, seed=0)
    nominal = it.Estimate(2.4813, "m/s^2")
    scatter = float(values.std(ddof=1))
    few = replace(known, nominal=nominal, values=values, mean=2.5001, standard_deviation=scatter, worst=3.5004)
    found = re.findall(r"<td>([\d.]+)[^<]*m/s", few._repr_html_())
    assert found == ["2.481", "2.5", "3.4", "3.500"]


def test_a_network_is_a_drawing() -> None:
    root = ElementTree.fromstring(FREE._repr_svg_())
    assert root.tag.endswith("svg")
    assert FREE._repr_svg_() == FREE._repr_svg_()


@pytest.mark.parametrize(
    ("design", "drawn"),
    [
        (PLAIN, {"120 kN/m", "4.981 kN s/m"}),
        (it.Seat(PLAIN, 80.0, it.Spring(2e4)), {"strut", "seat", "20 kN/m"}),
        (it.HalfCar(400.0, 200.0, 25.0, 20.0, 1.2e5, 1e5, 0.8, 1.2, it.Spring(2e4), it.Spring(3e4)), {"front", "rear"}),
        (PLAIN.mechanism(), {"120 kN/m"}),
    ],
)
def test_a_design_is_a_drawing_of_its_struts(design: it.Vehicle, drawn: set[str]) -> None:
    svg = design._repr_svg_()  # type: ignore[attr-defined]
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    written = {text.replace("\N{NO-BREAK SPACE}", " ") for text in re.findall(r"<!-- (.*?) -->", svg)}
    assert drawn <= written | set(" ".join(written).split()), written


def test_a_design_without_struts_has_no_drawing() -> None:
    wheel, tyre = it.Coordinate("wheel", 30.0), it.Tyre("tyre", it.Spring(1e5), {"wheel": 1.0}, "road")
    assert it.Mechanism((wheel,), (), (tyre,), (it.RoadInput("road"),))._repr_svg_() is None
