"""Any response as an index of a study file: numbers by two ways, everything that follows from a row, and bad ones."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES
from nodal import Nodal
from quadrature import h2_by_quadrature
from random_mechanisms import FAMILIES, mechanisms
from study_text import assert_survives, load_text
from synthetic import terminal_text

import inerter as it
from inerter.cli.main import call
from inerter.errors import StudyError
from inerter.files.study.checking import check_study
from inerter.files.study.loading import load_study
from inerter.files.study.running import run_study
from inerter.files.study.static import at_static_limit
from inerter.files.study.study import Study
from inerter.networks.elements import Network, Parallel, Series
from inerter.report.page import report
from inerter.report.study_contents import StudyContents

UNITS = {it.Spring: "N/m", it.Damper: "N s/m", it.Inerter: "kg"}
SPEED = 20.0
Load = Callable[[str], Study]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    def load_file(text: str) -> Study:
        return load_text(tmp_path, text)

    return load_file


# --- numbers of random mechanisms, by two ways ---


def in_a_file(mechanism: it.Mechanism, index: str) -> str:
    """The mechanism as a study file has it, with one index."""
    elements: list[str] = []

    def written(network: Network) -> str:
        if isinstance(network, Parallel | Series):
            return f"({(' | ' if isinstance(network, Parallel) else ' - ').join(map(written, network.parts))})"
        elements.append(f'e{len(elements)} = "{network.value!r} {UNITS[type(network)]}"')
        return f"e{len(elements) - 1}"

    angles = {c.name for c in mechanism.coordinates if c.angle}

    def port(levers: dict[str, float]) -> str:
        inside = (f'{n} = "{v!r} m"' if n in angles else f"{n} = {v!r}" for n, v in levers.items())
        return f"{{ {', '.join(inside)} }}"

    lines = ["[vehicle]", 'model = "mechanism"', "[vehicle.coordinates]"]
    lines += [f'{c.name} = "{c.inertia!r} {"kg m^2" if c.angle else "kg"}"' for c in mechanism.coordinates]
    lines += ["[vehicle.struts]"]
    lines += [
        f"{s.name} = {{ upper = {port(s.upper)}{f', lower = {port(s.lower)}' if s.lower else ''} }}"
        for s in mechanism.struts
    ]
    lines += [
        "[vehicle.tyres]",
        *(f'{t.name} = {{ port = {port(t.port)}, road = "{t.road}" }}' for t in mechanism.tyres),
    ]
    lines += ["[vehicle.roads]", *(f'{r.name} = {{ distance = "{r.distance!r} m" }}' for r in mechanism.roads)]
    lines += ["[vehicle.forces]", *(f"{f.name} = {port(f.port)}" for f in mechanism.forces)]
    mounted = ", ".join(f'{mount.name} = "{written(mount.network)}"' for mount in mechanism.mounts())
    lines += ["[elements]", *elements, "[layouts]", f"only = {{ {mounted} }}"]
    lines += ["[road]", f'speed = "{SPEED} m/s"', 'roughness = "5e-7 m^3/cycle"']
    return "\n".join([*lines, "[indices.asked]", index, "[study]", 'indices = ["asked"]']) + "\n"


def is_damped(mechanism: it.Mechanism) -> bool:
    """Enough for a quadrature with panels that grow with frequency."""
    poles = np.linalg.eigvals(it.state_space(mechanism).A)
    sizes = np.abs(poles)
    return bool(sizes.size) and bool(np.all(-poles.real > 0.01 * sizes) and 0.1 < sizes.min() < sizes.max() < 3e3)


def polynomials(top: list[float], bottom: list[float]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda omega: np.polyval(top, 1j * omega) / np.polyval(bottom, 1j * omega)


def shaken(mechanism: it.Mechanism) -> it.Mechanism:
    """The mechanism seen from the ground, where every mass feels the ground's acceleration as a force."""
    masses = {c.name: -c.inertia for c in mechanism.coordinates if not c.angle}
    return it.Mechanism(
        mechanism.coordinates,
        mechanism.struts,
        mechanism.tyres,
        mechanism.roads,
        (*mechanism.forces, it.Force("shake", masses)),
    )


def asked(rng: np.random.Generator, mechanism: it.Mechanism) -> tuple[str, float]:
    """A random response in a file, and its value by quadrature."""
    kind = str(rng.choice(["ground", "force", "road"]))
    rate = float(np.exp(rng.uniform(0.0, 5.0)))
    shape, passed = ([rate**2], [1.0, 1.2 * rate, rate**2]), ([1.0, 0.0], [1.0, float(rng.uniform(0.1, 5.0))])
    intensity = float(rng.uniform(0.01, 100.0))
    mass = next(c.name for c in mechanism.coordinates if not c.angle)
    on_ground = f"{mass}_relative_displacement"
    mount = mechanism.struts[0].name if mechanism.struts else None
    names = [on_ground, f"{mass}_acceleration", *([f"{mount}_force", f"{mount}_travel"] if mount else [])]
    chosen = {str(name): float(rng.uniform(0.5, 2.0)) for name in rng.choice(names, size=2, replace=False)}
    nodal_of = {"ground": shaken(mechanism)}.get(kind, mechanism)
    force = mechanism.forces[0].name
    sources = {"ground": ["shake"], "force": [force]}.get(kind, [r.name for r in mechanism.roads])
    delays = [r.distance / SPEED for r in mechanism.roads] if kind == "road" else [0.0]
    size = math.sqrt((2 * math.pi) ** 2 * SPEED * 5e-7 if kind == "road" else intensity)
    before, behind = polynomials(*shape), polynomials(*passed)

    def response(name: str) -> Callable[[np.ndarray], np.ndarray]:
        def of(omega: np.ndarray) -> np.ndarray:
            nodal = Nodal(nodal_of, omega)
            plain = name.replace("_relative", "")
            found = np.array([nodal.response(plain, source) for source in sources], complex).T
            if kind == "ground" and name.endswith("_acceleration"):
                found = found + 1.0  # and that of the ground itself
            return found * (before(omega) * behind(omega))[:, None]

        return of

    value = sum(w * h2_by_quadrature(response(name), delays, edge=4000.0) for name, w in chosen.items())
    excitation = {
        "ground": f'ground_acceleration = "{intensity!r} (m/s^2)^2/Hz", ',
        "force": f'force = "{force}", intensity = "{intensity!r} N^2/Hz", ',
        "road": "",
    }[kind]
    index = f"""kind = "random-response"
outputs = {json.dumps(chosen).replace(":", " =")}
excitation = {{ {excitation}shaping = {{ numerator = {shape[0]}, denominator = {shape[1]} }} }}
filter = {{ numerator = {passed[0]}, denominator = {passed[1]} }}"""
    return index, size * value


@pytest.mark.parametrize("seed", sampled(range(60), [0], kept=1))
def test_a_random_response_in_a_file_is_a_quadrature_along_the_frequencies(seed: int, load: Load) -> None:
    rng, checked = np.random.default_rng([seed, 77]), 0
    for family in FAMILIES:
        for mechanism in filter(is_damped, mechanisms(family, seed, 8, 1.0)):
            text, expected = asked(rng, mechanism)
            study = load(in_a_file(mechanism, text))
            found = it.evaluate(study.design("only"), study.index("asked"), study.method("norm"))
            assert found.value == pytest.approx(expected, rel=1e-6), family
            checked += 1
            break
    assert checked >= 1


@pytest.mark.parametrize("seed", sampled(range(20), [0], kept=2))
def test_a_peak_response_in_a_file_is_the_largest_gain(seed: int, load: Load) -> None:
    rng, checked = np.random.default_rng([seed, 78]), 0
    for family in FAMILIES:
        for mechanism in filter(is_damped, mechanisms(family, seed, 8, 1.0)):
            mass, corner = mechanism.coordinates[0].name, float(rng.uniform(1.0, 50.0))
            source = mechanism.forces[0].name if rng.random() < 0.5 else mechanism.roads[0].name
            given = source if source == mechanism.forces[0].name else f"{source}_velocity"
            text = f"""kind = "peak-response"
input = "{given}"
output = "{mass}_velocity"
filter = {{ numerator = [{corner!r}], denominator = [1.0, {corner!r}] }}"""
            study = load(in_a_file(mechanism, text))
            found = it.evaluate(study.design("only"), study.index("asked"), study.method("norm"))
            omega = np.geomspace(1e-5, 5e3, 4001)
            for _ in range(2):  # the whole, then what is about the largest
                gains = np.abs(
                    Nodal(mechanism, omega).response(f"{mass}_velocity", source) * corner / (1j * omega + corner)
                )
                near = int(np.argmax(gains))
                omega = np.linspace(omega[max(near - 2, 0)], omega[min(near + 2, omega.size - 1)], 2001)
            assert found.value == pytest.approx(float(gains.max()), rel=1e-6)
            assert study.unit("asked") == ("" if given != source else "(m/s)/N")
            checked += 1
            break
    assert checked >= 1


# --- what follows from a row ---

SWAY, PEAK = 'kind = "random-response"\n', 'kind = "peak-response"\n'

BUILDING = """
[vehicle]
model = "absorber"
primary_mass = "1 kg"
primary_stiffness = "1 N/m"
mass = "0.1 kg"
[elements]
k = { from = "0.001 N/m", to = "1 N/m" }
c = { from = "0.0001 N s/m", to = "1 N s/m" }
b = "0.05 kg"
[layouts]
TMD = "k | c"
TMDI = { mount = "k | c", ground = "b" }
[indices.sway]
kind = "random-response"
outputs = { primary_relative_displacement = 1.0 }
excitation = { ground_acceleration = "1 (m/s^2)^2/Hz" }
[indices.felt]
kind = "random-response"
outputs = { primary_acceleration = 1.0 }
excitation = { ground_acceleration = "1 (m/s^2)^2/Hz", shaping = { numerator = [3.0], denominator = [1.0, 3.0] } }
[indices.receptance]
kind = "peak-response"
input = "primary_force"
output = "primary_displacement"
[indices.stroke]
kind = "element-stroke"
element = "c"
excitation = { force = "primary_force", intensity = "2 N^2/Hz" }
[study]
indices = ["sway", "felt", "receptance", "stroke"]
"""
OPTIMISED = BUILDING + 'optimise = "norm"\n'


def test_a_building_is_that_of_python_digit_by_digit(load: Load) -> None:
    study, ground = load(OPTIMISED), it.GroundAcceleration(1.0)
    shaped = it.FilteredExcitation(ground, it.Filter([3.0], [1.0, 3.0]))
    assert study.index("sway") == it.RandomResponse({"primary_relative_displacement": 1.0}, ground)
    assert study.index("felt") == it.RandomResponse({"primary_acceleration": 1.0}, shaped)
    assert study.index("receptance") == it.PeakResponse("primary_force", "primary_displacement")
    assert study.index("stroke") == it.ElementStroke(it.WhiteForce("primary_force", 2.0), "c")
    mount = it.Spring(it.free(1e-3, 1.0, "k")) | it.Damper(it.free(1e-4, 1.0, "c"))
    by_hand = it.Absorber(1.0, 1.0, 0.1, mount, it.Inerter(0.05))
    mine, its = (it.optimise(v, study.index("sway"), it.Norm(), seed=0) for v in (by_hand, study.design("TMDI")))
    assert (mine.value, mine.parameters) == (its.value, its.parameters)


def test_the_best_damper_is_that_of_the_literature(load: Load, tmp_path: Path) -> None:
    """Marian and Giaralis (2014), and Warburton (1982) without an inerter: white acceleration of the ground."""
    data = run_study(load(OPTIMISED), tmp_path / "out").data
    for layout, beta in (("TMD", 0.0), ("TMDI", 0.05)):
        mu, m = 0.1, 0.1 + beta
        wide = beta * (1.0 - mu) + (2.0 - mu) * (1.0 + mu)
        nu = math.sqrt(wide / (2.0 * (1.0 + mu))) / (1.0 + m)
        zeta = math.sqrt(m * (beta * (3.0 - mu) + (4.0 - mu) * (1.0 + mu)) / (8.0 * (1.0 + m) * wide))
        best = data.sel(layout=layout, index="sway").squeeze()["parameter_value"]
        assert best.sel(parameter="k").item() == pytest.approx(m * nu**2, rel=1e-5)
        assert best.sel(parameter="c").item() == pytest.approx(2.0 * zeta * m * nu, rel=1e-5)
    units = dict(zip(data["index"].values.tolist(), data.index_unit.values.tolist(), strict=True))
    assert units == {"sway": "m", "felt": "m/s^2", "receptance": "m/N", "stroke": "m"}
    assert data.gain_sway.attrs == {"units": "m/(m/s^2)", "long_name": "gain from ground acceleration"}
    assert data.gain_stroke.attrs == {"units": "m/N", "long_name": "gain from primary force"}


def test_it_survives_being_written_and_is_told(load: Load, tmp_path: Path) -> None:
    study = load(OPTIMISED)
    assert_survives(study, tmp_path)
    page = report(StudyContents(run_study(study, tmp_path / "out").data, study), tmp_path)
    for told in (
        "random response (sway)",
        "Shaping filter of felt",
        "3 / (s + 3)",
        "Input of receptance",
        "primary force",
    ):
        assert told in page


@pytest.mark.marathon
def test_everything_asks_for_it_by_its_name(load: Load, tmp_path: Path) -> None:
    more = """subject_to = { receptance = { at_most = "6 m/N" }, stroke = { at_most = "30 m" } }
trade_off = ["sway", "felt"]
points = 3
tolerance = { c = "10 %" }
conditions = "worst"
[[conditions]]
"vehicle.primary_mass" = "1.1 kg"
[[conditions]]
"""
    alone = OPTIMISED.replace('TMD = "k | c"\n', "").replace('"sway", "felt", "receptance", "stroke"]', '"sway"]')
    study = load(alone + more)
    check_study(study)
    data = run_study(study, tmp_path / "out").data
    for layout in study.layouts:
        design = data.sel(layout=layout, index="sway").squeeze()
        values = dict(zip(data["parameter"].values.tolist(), design["parameter_value"].values.tolist(), strict=True))
        fixed = study.design(layout).with_values(values)
        heavy = study.design(layout).with_values(values)
        heavy = it.Absorber(1.1, 1.0, 0.1, heavy.mount, heavy.ground)  # type: ignore[attr-defined]
        worst = max(it.evaluate(v, study.index("sway"), it.Norm()).value for v in (fixed, heavy))
        assert design["value"].item() == pytest.approx(worst, rel=1e-9)
        for limited, most in (("receptance", 6.0), ("stroke", 30.0)):
            for vehicle in (fixed, heavy):
                assert it.evaluate(vehicle, study.index(limited), it.Norm()).value <= most * (1.0 + 1e-6)


def test_what_excites_is_swept(load: Load, tmp_path: Path) -> None:
    fixed = BUILDING.replace('{ from = "0.001 N/m", to = "1 N/m" }', '"0.08 N/m"').replace(
        '{ from = "0.0001 N s/m", to = "1 N s/m" }', '"0.03 N s/m"'
    )
    place = "indices.stroke.excitation.intensity"
    study = load(fixed + f'sweep = {{ "{place}" = ["1 N^2/Hz", "4 N^2/Hz"] }}\n')
    values = run_study(study, tmp_path / "out").data["value"].sel(index="stroke", layout="TMD").values.ravel()
    assert values[1] == pytest.approx(2.0 * values[0], rel=1e-12)
    assert study.sweeps[0].words == "intensity of primary force for stroke"


def test_an_expected_value_is_the_norm_where_nothing_is_nonlinear(load: Load, tmp_path: Path) -> None:
    fixed = BUILDING.replace('{ from = "0.001 N/m", to = "1 N/m" }', '"0.08 N/m"').replace(
        '{ from = "0.0001 N s/m", to = "1 N s/m" }', '"0.03 N s/m"'
    )
    methods = 'evaluate = ["norm", "expected-value", "statistical-linearisation"]\nrealisations = 4\n'
    head, _, rest = fixed.partition("[indices.receptance]")
    study = load(head + rest[rest.index("[study]") :].replace(', "receptance", "stroke"', "") + methods)
    data = run_study(study, tmp_path / "out").data
    norm = data["value"].sel({"method": "norm"}).values
    for method, bound in (("expected-value", 0.05), ("statistical-linearisation", 1e-9)):
        np.testing.assert_allclose(data["value"].sel({"method": method}).values, norm, rtol=bound)


def test_a_peak_response_of_friction_needs_its_amplitude(load: Load) -> None:
    rubs = BUILDING.replace('b = "0.05 kg"', 'b = "0.05 kg"\nf = "0.1 N"').replace('"k | c"\n', '"k | (c - f)"\n')
    rubs = rubs.replace('{ from = "0.001 N/m", to = "1 N/m" }', '"0.08 N/m"')
    rubs = rubs.replace('{ from = "0.0001 N s/m", to = "1 N s/m" }', '"0.03 N s/m"') + 'evaluate = ["expected-value"]\n'
    with pytest.raises(StudyError, match=r'indices\.receptance\.amplitude: missing.*amplitude = "1 kN"'):
        load(rubs)
    output = 'output = "primary_displacement"\n'
    assert load(rubs.replace(output, f'{output}amplitude = "2 N"\n')).index("receptance").amplitude == 2.0
    with pytest.raises(
        StudyError, match=r"indices\.receptance\.amplitude: got a size in m; primary_force is in N|in m:"
    ):
        load(rubs.replace(output, f'{output}amplitude = "2 m"\n'))


CAR = """
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
[elements]
k = "20 kN/m"
c = "1 kN s/m"
[layouts]
S1 = "k | c"
[indices.shaken]
kind = "ride-comfort"
INDEX
[study]
indices = ["shaken"]
"""


def test_a_transmissibility_is_a_ratio_and_no_static_limit(load: Load, tmp_path: Path) -> None:
    """How a car follows its road has no unit, and is 1 at frequency zero, where the body drifts with the road."""
    peak = PEAK + 'input = "road"\noutput = "sprung_displacement"'
    study = load(CAR.replace('kind = "ride-comfort"\nINDEX', peak))
    data = run_study(study, tmp_path / "out").data
    k, c, kt, body, wheel = 20e3, 1e3, 150e3, 250.0, 35.0
    s = 2j * math.pi * np.linspace(0.5, 5.0, 200_001)
    strut = k + c * s
    gains = np.abs(strut * kt / ((body * s**2 + strut) * (wheel * s**2 + strut + kt) - strut**2))
    assert data["value"].item() == pytest.approx(gains.max(), rel=1e-8)
    assert at_static_limit(study, data) == frozenset()
    assert terminal_text(data).splitlines()[2].split() == ["S1", f"{gains.max():.4g}"]
    (value, unit) = next(csv.reader((tmp_path / "out" / "summary.csv").read_text().splitlines()[1:]))[3:5]
    assert (float(value), unit) == (data["value"].item(), "")


def test_a_car_under_a_force_alone_needs_no_road(load: Load) -> None:
    study = load(CAR.replace("INDEX", 'excitation = { force = "sprung_force", intensity = "1 N^2/Hz", shaping = { '
                                      "numerator = [9.0], denominator = [1.0, 9.0] } }"))  # fmt: skip
    assert study.road is None
    drive = it.FilteredExcitation(it.WhiteForce("sprung_force", 1.0), it.Filter([9.0], [1.0, 9.0]))
    assert study.index("shaken") == it.RideComfort(drive)
    check_study(study)
    with pytest.raises(StudyError, match="road: missing, but shaken needs it"):
        load(CAR.replace("INDEX", ""))
    with pytest.raises(StudyError, match="road: missing, but shaken needs it"):
        load(CAR.replace("INDEX", "excitation = { shaping = { numerator = [1.0], denominator = [1.0, 1.0] } }"))


OUTPUTS = "outputs = { primary_relative_displacement = 1.0 }\n"
GROUND = 'excitation = { ground_acceleration = "1 (m/s^2)^2/Hz" }\n'
BAD = {
    "no outputs": (SWAY + GROUND, "asked.outputs", ["missing", "outputs = { tyre_load = 1 }"]),
    "empty outputs": (SWAY + GROUND + "outputs = {}", "asked.outputs", ["none given"]),
    "outputs as a list": (SWAY + GROUND + 'outputs = ["x"]', "asked.outputs", ["a list", "not a table"]),
    "a weight of zero": (
        SWAY + GROUND + "outputs = { mount_travel = 0 }",
        "asked.outputs.mount_travel",
        ["other than 0"],
    ),
    "a weight in quotes": (
        SWAY + GROUND + 'outputs = { mount_travel = "1" }',
        "asked.outputs.mount_travel",
        ["quotes"],
    ),
    "an unknown output": (
        SWAY + GROUND + "outputs = { mount_travle = 1.0 }",
        "asked.outputs.mount_travle",
        ["does not have", 'Did you mean "mount_travel"?'],
    ),
    "an output without bounds": (
        SWAY + GROUND + "outputs = { primary_displacement = 1.0 }",
        "asked.outputs.primary_displacement",
        ["unbounded", "primary_relative_displacement"],
    ),
    "an intensity per radian or per Hz": (
        SWAY + OUTPUTS + 'excitation = { ground_acceleration = "1 m^2/s^3" }',
        "asked.excitation.ground_acceleration",
        ["ambiguous density, per Hz or per rad/s"],
    ),
    "an intensity of another kind": (
        SWAY + OUTPUTS + 'excitation = { force = "primary_force", intensity = "1 N" }',
        "asked.excitation.intensity",
        ["of any white force", "N^2/Hz (force)"],
    ),
    "a moment on a mass": (
        SWAY + OUTPUTS + 'excitation = { force = "primary_force", intensity = "1 (N m)^2/Hz" }',
        "asked.excitation.intensity",
        ["primary_force is in N", "one in N^2/Hz"],
    ),
    "a negative intensity": (
        SWAY + OUTPUTS + 'excitation = { ground_acceleration = "-1 (m/s^2)^2/Hz" }',
        "asked.excitation.ground_acceleration",
        ["not positive"],
    ),
    "an empty excitation": (SWAY + OUTPUTS + "excitation = {}", "asked.excitation", ["an empty table"]),
    "two excitations": (
        SWAY + OUTPUTS + 'excitation = { ground_acceleration = "1 (m/s^2)^2/Hz", force = "primary_force" }',
        "asked.excitation",
        ["both ground_acceleration and force", "one of the two"],
    ),
    "a force without intensity": (
        SWAY + OUTPUTS + 'excitation = { force = "primary_force" }',
        "asked.excitation",
        ["a force alone", "its intensity"],
    ),
    "an unknown force": (
        SWAY + OUTPUTS + 'excitation = { force = "primry_force", intensity = "1 N^2/Hz" }',
        "asked.excitation.force",
        ["a force that this vehicle does not have", 'Did you mean "primary_force"?'],
    ),
    "an unknown key of an excitation": (
        SWAY + OUTPUTS + 'excitation = { ground = "1 (m/s^2)^2/Hz" }',
        "asked.excitation.ground",
        ["unknown key", "ground_acceleration"],
    ),
    "an unstable filter": (
        SWAY + OUTPUTS + GROUND + "filter = { numerator = [1.0], denominator = [1.0, -1.0] }",
        "asked.filter",
        ["left half plane"],
    ),
    "a filter that differentiates": (
        SWAY + OUTPUTS + GROUND + "filter = { numerator = [1.0, 0.0, 0.0], denominator = [1.0, 1.0] }",
        "asked.filter",
        ["differentiated"],
    ),
    "half a filter": (
        SWAY + OUTPUTS + GROUND + "filter = { numerator = [1.0] }",
        "asked.filter.denominator",
        ["missing", "denominator = [1.0, 0.5]"],
    ),
    "words in a filter": (
        SWAY + OUTPUTS + GROUND + 'filter = { numerator = ["s"], denominator = [1.0] }',
        "asked.filter.numerator",
        ["the highest power of s first"],
    ),
    "no input": (PEAK + 'output = "primary_displacement"', "asked.input", ["missing", 'input = "sprung_force"']),
    "an unknown input": (
        PEAK + 'input = "road"\noutput = "primary_displacement"',
        "asked.input",
        ["an input that this vehicle does not have", "primary_force"],
    ),
    "an amplitude of another kind": (
        PEAK + 'input = "primary_force"\noutput = "primary_displacement"\namplitude = "1 m"',
        "asked.amplitude",
        ["got a size in m", "primary_force is in N"],
    ),
    "an excitation of a peak": (
        PEAK + 'input = "primary_force"\noutput = "primary_displacement"\n' + GROUND,
        "asked.excitation",
        ["unknown key"],
    ),
}


@pytest.mark.parametrize(("index", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_response_is_one_sentence_at_its_place(
    index: str, place: str, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    head, _, _ = BUILDING.partition("[indices.sway]")
    path = tmp_path / "study.toml"
    text = head.replace('{ from = "0.001 N/m", to = "1 N/m" }', '"0.08 N/m"')
    text = text.replace('{ from = "0.0001 N s/m", to = "1 N s/m" }', '"0.03 N s/m"')
    path.write_text(f'{text}[indices.asked]\n{index}\n[study]\nindices = ["asked"]\n', encoding="utf-8")
    assert call(["check", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"inerter: study.toml: indices.{place}: "), line
    assert [word for word in words if word not in line] == [], line


@pytest.mark.parametrize("kind", ["random-response", "peak-response", "element-force"])
def test_a_kind_that_cannot_do_without_settings_says_them(kind: str, load: Load) -> None:
    text = BUILDING.partition("[indices.sway]")[0] + f'[study]\nindices = ["{kind}"]\noptimise = "norm"\n'
    with pytest.raises(StudyError, match=rf'study\.indices: got "{kind}": it needs its .*\[indices\.NAME\]'):
        load(text)


# --- the example ---

EXAMPLE = EXAMPLES / "building_quake.toml"


def test_the_example_is_that_of_python_and_keeps_its_limit(tmp_path: Path) -> None:
    study = load_study(EXAMPLE)
    kanai_tajimi = it.Filter([18.72, 243.36], [1.0, 18.72, 243.36])  # 2 x 0.6 x 15.6 and 15.6^2
    ground = it.FilteredExcitation(it.GroundAcceleration(0.02), kanai_tajimi)
    sway, stroke = it.RandomResponse({"primary_relative_displacement": 1.0}, ground), it.ElementStroke(ground, "k")
    assert study.index("stroke") == stroke
    data = run_study(study, tmp_path / "out").data
    for layout, inerter in (("TMD", None), ("TMDI", it.Inerter(8e3, "b"))):
        design = data.sel(layout=layout, index="sway").squeeze()
        k, c = (design["parameter_value"].sel(parameter=name).item() for name in "kc")
        best = it.Absorber(100e3, 4e6, 2e3, it.Spring(k, "k") | it.Damper(c, "c"), inerter, 25e3)
        assert it.evaluate(best, sway, it.Norm()).value == pytest.approx(design["value"].item(), rel=1e-12)
        assert it.evaluate(best, stroke, it.Norm()).value <= 0.09 * (1.0 + 1e-6)
    assert float(data["improvement"].sel(layout="TMDI", index="sway").squeeze()) > 20.0


def test_a_moment_has_its_own_unit(load: Load, tmp_path: Path) -> None:
    """In the excitation, in the answer and in its frequency response, which is that of a peak response too."""
    text = (EXAMPLE.parent / "half-car.toml").read_text(encoding="utf-8")
    head, _, _ = text.partition("[study]")
    head = head.replace('{ from = "100 N s/m", to = "100 kN s/m" }', '"3 kN s/m"')
    head = head.replace('{ from = "1 kg", to = "2000 kg" }', '"50 kg"')
    moment = 'excitation = { force = "pitch_moment", intensity = "2 (N m)^2/Hz" }\n'
    asked = f'[indices.turn]\nkind = "random-response"\noutputs = {{ pitch_displacement = 1.0 }}\n{moment}'
    peak = f'[indices.turned]\n{PEAK}input = "pitch_moment"\noutput = "pitch_displacement"\n'
    study = load(f'{head}{asked}{peak}[study]\nindices = ["turn", "turned"]\n')
    data = run_study(study, tmp_path / "out").data
    assert data.index_unit.values.tolist() == ["rad", "rad/(N m)"]
    assert data.gain_turn.attrs["units"] == data.gain_turned.attrs["units"] == "rad/(N m)"
    np.testing.assert_allclose(data.gain_turn.values, data.gain_turned.values, rtol=1e-9)
    with pytest.raises(StudyError, match=r"pitch_moment is in N m; expected one in \(N m\)\^2/Hz"):
        load(f'{head}{asked.replace("2 (N m)^2/Hz", "2 N^2/Hz")}[study]\nindices = ["turn"]\n')


# --- words of messages ---


@pytest.mark.parametrize("method", ["norm", "statistical-linearisation"])
def test_a_message_calls_methods_as_the_file_does(method: str, load: Load) -> None:
    friction = CAR.replace('c = "1 kN s/m"', 'c = "1 kN s/m"\nf = "20 N"').replace('"k | c"', '"k | c | f"')
    force = 'kind = "random-response"\noutputs = { f_force = 1.0 }\nexcitation = { force = "sprung_force", '
    text = friction.replace('kind = "ride-comfort"\nINDEX', force + 'intensity = "1 N^2/Hz" }')
    study = load(text + f'evaluate = ["{method}"]\n')
    with pytest.raises(it.InerterError, match=r"(by|Use) expected-value") as caught:
        it.evaluate(study.design("S1"), study.index("shaken"), study.method(method))
    assert "()" not in str(caught.value)
