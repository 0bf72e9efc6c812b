"""Tables hold what the figures show, to the last bit; drawings hold every element."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
import scipy.special
import xarray as xr
from campaigns import sampled
from designs import ALWAYS, design, deviation
from test_decades_of_values import design as decades_apart
from wang_su import paper_quarter_car

import inerter as it
from inerter.exports.kinds.tables import responses_of
from inerter.exports.request import ExportSpec
from inerter.files.study.cases import cases
from inerter.files.study.loading import load_study
from inerter.files.study.responses import responses
from inerter.norms.response import resonant_range

pytest.importorskip("flint", reason='Exact responses: pip install "inerter[test]".')
from exact_responses import at, of_mechanism

K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
CAR = paper_quarter_car(K | C - B)


def table(text: str) -> pd.DataFrame:
    return pd.read_csv(io.StringIO(text), comment="#", dtype=str).astype(float)  # to the last bit by any pandas


@pytest.mark.parametrize("number", ALWAYS)
def test_csv_and_netcdf_are_the_frequency_responses(number: int) -> None:
    vehicle, hertz = design(number), [0.5, 1.0, 1.5, 7.0, 30.0]
    named, omega = it.named_system(vehicle, form="descriptor"), 2.0 * np.pi * np.array(hertz)
    expected = named.response(omega)
    assert deviation(expected, it.frequency_response(it.state_space(vehicle), omega)) < 1e-10
    found = table(it.export(vehicle, "csv", frequencies=hertz))
    data = xr.open_dataset(io.BytesIO(it.export(vehicle, "netcdf", frequencies=hertz)), engine="h5netcdf")
    assert np.array_equal(found["frequency [Hz]"], hertz)
    assert np.array_equal(data["real"].values + 1j * data["imaginary"].values, expected)
    for i, out in enumerate(named.outputs):
        for j, inp in enumerate(named.inputs):
            unit = str(data["gain_unit"].values[i, j])
            gain = found[f"gain of {out.name} from {inp.name} [{unit}]"].to_numpy()
            phase = found[f"phase of {out.name} from {inp.name} [deg]"].to_numpy()
            assert np.array_equal(gain, np.abs(expected[:, i, j]))
            assert np.allclose(gain * np.exp(1j * np.radians(phase)), expected[:, i, j], rtol=1e-12, atol=0.0)
            assert np.array_equal(data["gain"].sel(output=out.name, input=inp.name), gain)
    assert list(data["output_unit"].values) == [one.unit for one in named.outputs]


@pytest.mark.parametrize(("decades", "seed"), sampled([(d, n) for d in (0, 2, 4) for n in range(24)], [(2, 3)], kept=3))
def test_small_gains_of_a_table_have_their_digits_too(decades: int, seed: int) -> None:
    """Gains of any size at low frequencies, against nodal equations in 700 bits; elimination lost up to 0.3 %."""
    mechanism = decades_apart(decades, seed)
    system = it.state_space(mechanism)
    omega = resonant_range([system.A])[[7, 67, 127, 247, 487]] * [1e-2, 1.0, 1.0, 1.0, 1.0]
    request = ExportSpec(mechanism, "csv", frequencies=omega / (2.0 * np.pi))
    found = responses_of(request).values
    exact = of_mechanism(mechanism, at(omega), list(system.outputs), list(system.inputs))
    expected = np.array([[[complex(z.real.mid(), z.imag.mid()) for z in row] for row in M.table()] for M in exact])
    whole = np.abs(expected).max(axis=(0, 2))[None, :, None]
    assert np.allclose(found, expected, rtol=3e-5, atol=1e-13 * whole)


@pytest.mark.parametrize(("spring", "mass"), [(1e4, 250.0), (2e4, 30.0)])
def test_a_table_without_frequencies_leaves_out_an_undamped_pole(spring: float, mass: float) -> None:
    """Of one mass on a spring, whose only resonance was the middle of the frequencies: k / (k - m w^2)."""
    mounted = it.Mechanism(
        coordinates=(it.Coordinate("body", mass),),
        struts=(),
        tyres=(it.Tyre("mount", it.Spring(spring), {"body": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
    )
    found = table(it.export(mounted, "csv", outputs=["body_velocity"]))
    hertz, gain = found["frequency [Hz]"].to_numpy(), found["gain of body_velocity from road_velocity [(m/s)/(m/s)]"]
    assert len(hertz) == 600
    ratio = mass * (2.0 * np.pi * hertz) ** 2 / spring
    assert np.allclose(gain, 1.0 / np.abs(1.0 - ratio), rtol=1e-12)


def test_units_of_gains() -> None:
    heads = it.export(CAR, "csv", frequencies=[1.0], outputs=["sprung_acceleration", "strut_travel"]).splitlines()[0]
    assert [re.search(r"\[(.*)\]", head)[1] for head in heads.split(",")] == [  # type: ignore[index]
        *("Hz", "(m/s^2)/(m/s)", "deg", "(m/s^2)/N", "deg", "m/(m/s)", "deg", "m/N", "deg")
    ]


@pytest.mark.campaign
def test_curves_on_two_tracks_have_the_coherence_of_an_isotropic_surface(examples: str, tmp_path: Path) -> None:
    """x K1(x), which no filter has, both in tables and in the figure of a study."""
    text = Path(examples, "full-car-two-tracks.toml").read_text(encoding="utf-8")
    file = tmp_path / "study.toml"
    file.write_text(re.sub("coherence = {.*?}", 'coherence = { track = "1.5 m" }', text), encoding="utf-8")
    study = load_study(file)
    layout = next(iter(study.layouts))
    values = {name: (one.lower * one.upper) ** 0.5 for name, one in study.design(layout).free_values().items()}
    case = next(case for case in cases(study) if (case.layout, case.index) == (layout, "J1"))
    car, index = study.design(layout).with_values(values), study.index("J1")
    omega = responses(study, {case: values})["omega"].values
    request = ExportSpec(car, "csv", frequencies=omega / (2.0 * np.pi), indices={"J1": index})
    outputs, gains = responses_of(request).of_indices["J1"]
    roads, speed = car.mechanism().roads, index.road.speed
    x = omega * 1.5 / speed
    coherence = x * scipy.special.k1(x)
    weights = [each.weight for each in index.definition(car.mechanism()).outputs]
    for output, weight, gain in zip(outputs, weights, gains, strict=True):
        system = it.state_space(car, [road.name for road in roads], [output])
        late = np.exp(-1j * np.outer(omega, [road.distance / speed for road in roads]))
        arriving = it.frequency_response(system, omega)[:, 0] * late
        left, right = (arriving[:, [r.side == side for r in roads]].sum(axis=1) for side in ("left", "right"))
        both, apart = np.abs(left + right) ** 2, np.abs(left - right) ** 2
        expected = abs(weight) * np.sqrt((both * (1.0 + coherence) + apart * (1.0 - coherence)) / 2.0)
        assert np.allclose(gain, expected, rtol=0.0, atol=1e-7 * expected.max())
    shown = responses(study, {case: values})["gain_J1"].isel(layout=0).transpose("output_J1", "omega")
    assert np.allclose(shown, gains, rtol=1e-12)


@pytest.mark.parametrize("conventions", ["exact", "paper2008"])
def test_curves_of_an_index_are_those_of_the_figure(conventions: str, examples: str) -> None:
    """With the delay of the road between both axles, as the figure of a study has them."""
    study = replace(load_study(f"{examples}/half-car.toml"), conventions=conventions)
    layout = next(iter(study.layouts))
    values = {name: (one.lower * one.upper) ** 0.5 for name, one in study.design(layout).free_values().items()}
    case = next(case for case in cases(study) if (case.layout, case.index) == (layout, "J1"))
    shown = responses(study, {case: values})["gain_J1"].isel(layout=0).transpose("output_J1", "omega")
    hertz = shown["omega"].values / (2.0 * np.pi)
    request = ExportSpec(
        study.design(layout).with_values(values),
        "csv",
        frequencies=hertz,
        indices={"J1": study.index("J1")},
        conventions=conventions,
    )
    found = responses_of(request)
    outputs, gains = found.of_indices["J1"]
    assert outputs == ("sprung_acceleration", "pitch_acceleration")
    assert np.allclose(gains, shown.values, rtol=1e-12)
    heads = it.EXPORTS["csv"].make(request, ".csv").splitlines()[1].split(",")
    assert heads[-2:] == ["gain of sprung_acceleration in J1", "gain of pitch_acceleration in J1"]


def test_a_trajectory_is_written_to_the_last_bit() -> None:
    run = it.simulate(CAR, road=it.sine(0.01, 2.0), duration=0.3)
    found = table(it.export(run, "csv", outputs=["sprung_acceleration", "strut_force"]))
    assert list(found.columns) == ["time [s]", "sprung_acceleration [m/s^2]", "strut_force [N]"]
    assert np.array_equal(found["strut_force [N]"], run["strut_force"])
    data = xr.open_dataset(io.BytesIO(it.export(run, "netcdf")), engine="h5netcdf")
    assert np.array_equal(data["sprung_acceleration"].values, run["sprung_acceleration"])
    with pytest.raises(it.InerterError, match="requires a vehicle or a LinearSystem, got Trajectory"):
        it.export(run, "control")


def test_a_record_is_written_to_the_last_bit(tmp_path: Path) -> None:
    time = 0.01 * np.arange(50)
    record = it.Record(time, 1e-3 * np.sin(time), np.cos(time) / 3.0, source="bench", notes=("Trimmed.",))
    found = table(it.export(record, "csv"))
    assert list(found.columns) == ["time [s]", "displacement [m]", "force [N]"]
    assert np.array_equal(found["force [N]"], record.force)
    data = xr.open_dataset(io.BytesIO(it.export(record, "netcdf")), engine="h5netcdf")
    assert np.array_equal(data["force"].values, record.force)
    assert np.array_equal(data["time"].values, time)
    assert (data["force"].units, data.title, data.notes) == ("N", "bench", "Trimmed.")
    for kind, suffix in (("csv", ".csv"), ("matlab", ".mat")):
        again = it.read_record(it.export(record, kind, tmp_path / f"bench{suffix}"))
        assert np.array_equal(again.force, record.force)
    with pytest.raises(it.InerterError, match="a script holds a linear model"):
        it.export(record, "matlab", tmp_path / "bench.m")
    with pytest.raises(it.InerterError, match="requires a vehicle or a LinearSystem, got Record"):
        it.export(record, "control")


def test_a_pole_at_a_frequency_is_refused() -> None:
    car = it.Absorber(1000.0, 4e4, 50.0, it.Spring(1e4))
    system = it.state_space(car)
    pole = float(np.abs(np.linalg.eigvals(system.A)).max() / (2.0 * np.pi))
    assert it.export(car, "csv", frequencies=[1.01 * pole])
    for bad in ([0.0], [-1.0], [], [np.nan], "1 Hz"):
        with pytest.raises(it.InerterError, match="Frequencies must be positive numbers of Hz"):
            it.export(car, "csv", frequencies=bad)


@pytest.mark.parametrize("strut", [K | C - B, it.Bridge(K, C, B, C, K) | it.Friction(10.0), K - it.Gap(1e-3)])
def test_drawings_hold_every_element(strut: it.Network) -> None:
    """Nonlinear ones too, which nothing is left out of."""
    count = len(list(strut.elements()))
    svg = it.export(strut, "svg")
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert svg == it.export(strut, "svg")
    assert it.export(strut, "pdf").startswith(b"%PDF")
    tikz = it.export(strut, "latex")
    assert tikz.count("\\node[") == count
    assert tikz.count("{") == tikz.count("}")
    assert tikz.count("\\begin{tikzpicture}") == tikz.count("\\end{tikzpicture}") == 1
    for line in re.findall(r"\\draw .*;", tikz):
        assert re.fullmatch(r"\\draw \(.*\)( -- \(.*\))+;|\\draw \(.*\) circle \[radius=1\.6\];", line)


def test_mounts_of_one_network_share_a_drawing() -> None:
    tikz = it.export(design(2), "latex")
    assert re.findall(r"^% (front.*|rear.*)$", tikz, re.MULTILINE) == [
        "front left, front right",
        "rear left, rear right",
    ]


def test_free_values_are_drawn_and_nothing_else() -> None:
    free = it.Spring(1e5) | it.Damper(it.free(100, 1e5, name="c"))
    car = paper_quarter_car(free)
    assert b"svg" in it.export(car, "svg")
    for kind in (key for key in it.EXPORTS if key not in ("svg", "pdf", "latex")):
        with pytest.raises(it.InerterError, match="free"):
            it.export(car, kind)
