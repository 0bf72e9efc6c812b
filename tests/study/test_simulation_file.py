"""Simulation files: what a good one means, that it survives being written out, and what is said about a bad one."""

from dataclasses import replace

import numpy as np
import pytest
from folders import EXAMPLES, ROOT
from scipy.signal import lsim
from study_text import HALF_CAR, PAPER_CAR, with_changes
from wang_su import ROAD, paper_quarter_car

from inerter.errors import StudyError
from inerter.files.common.codec import REQUIRED, keys_in
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.signal_kinds import SIGNALS, UNITS
from inerter.files.common.signals import SignalRequest
from inerter.files.simulation.loading import load_simulation
from inerter.files.simulation.request import SimulationRequest, write_simulation
from inerter.files.simulation.sections import INITIAL, SimulationSettings
from inerter.networks.elements import Damper, Friction, Gap, Inerter, Spring
from inerter.signals.harmonics import multisine
from inerter.signals.records import read_signal
from inerter.simulation.simulate import simulate
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.rig import Rig

MOTIONS = sorted(path for path in EXAMPLES.glob("*.toml") if "[simulation]" in path.read_text("utf-8"))

CAR = """
[vehicle]
model = "quarter-car"
sprung_mass = "181.75 kg"
unsprung_mass = "25 kg"
tyre_stiffness = "120 kN/m"
[road]
speed = "90 km/h"
roughness = "5e-7 m^3/cycle"
[elements]
k = "60 kN/m"
c = "3 kN s/m"
b = "300 kg"
f = "10 N"
[layouts]
S1 = "k | c"
S2 = "k | c | (b | f)"
[signal]
kind = "multisine"
seed = 3
[simulation]
layout = "S2"
duration = "0.5 s"
"""

HALF = CAR.replace(f'model = "quarter-car"\n{PAPER_CAR}', HALF_CAR)

FULL = HALF.replace(
    'model = "half-car"\nsprung_mass = "363.5 kg"',
    """model = "full-car"
sprung_mass = "727 kg"
roll_inertia = "150 kg m^2"
track_front = "1.4 m"
track_rear = "1.38 m\"""",
)

ABSORBER = """
[vehicle]
model = "absorber"
primary_mass = "1000 kg"
primary_stiffness = "40 kN/m"
mass = "50 kg"
[elements]
k = "1.8 kN/m"
c = "70 N s/m"
b = "20 kg"
[layouts]
TMDI = { mount = "k | c", ground = "b" }
[signal]
kind = "sine"
amplitude = "100 N"
frequency = "1 Hz"
[simulation]
duration = "0.5 s"
"""

RIG = """
[vehicle]
model = "rig"
[elements]
ks = "1000 kN/m"
cs = "3200 N s/m"
g = "0.1 mm"
b = "113 kg"
[layouts]
screw = "(ks | cs) - g - b"
[signal]
kind = "cosine"
amplitude = "1 mm"
frequency = "3 Hz"
[simulation]
duration = "0.2 s"
"""


@pytest.fixture
def load(tmp_path):
    """Loads a file from text, with parts of the text replaced first; each part must be there."""

    def load_changed(text, *changes):
        path = tmp_path / "motion.toml"
        path.write_text(with_changes(text, *changes), encoding="utf-8")
        return load_simulation(path)

    return load_changed


# --- what a good file means ---


def test_every_value_arrives_in_si_units_and_every_default_is_filled_in(load, tmp_path):
    assert load(CAR) == SimulationRequest(
        title="motion",
        path=tmp_path / "motion.toml",
        vehicle={"model": "quarter-car", "sprung_mass": 181.75, "unsprung_mass": 25.0, "tyre_stiffness": 120e3},
        road={"speed": 25.0, "roughness": 5e-7, "coherence": None},
        elements={"k": Spring(60e3, "k"), "c": Damper(3e3, "c"), "b": Inerter(300.0, "b"), "f": Friction(10.0, "f")},
        layouts={"S1": StrutLayout({"strut": "k | c"}), "S2": StrutLayout({"strut": "k | c | (b | f)"})},
        signal=SignalRequest("multisine", "road", {"seed": 3, "lowest": 0.1, "highest": 1000.0}),
        layout="S2",
        duration=0.5,
        step=2e-4,
        integrator="event-driven",
        initial="rest",
        energy=False,
        every=1,
    )


def test_the_vehicle_and_the_signal_are_those_of_the_library(load):
    request = load(CAR)
    strut = Spring(60e3, "k") | Damper(3e3, "c") | (Inerter(300.0, "b") | Friction(10.0, "f"))
    assert request.design() == paper_quarter_car(strut)
    time = np.linspace(0.0, 1.0, 7)
    assert np.array_equal(request.make_signal()(time), multisine(ROAD, seed=3)(time))


def test_a_rig_has_one_device_and_needs_no_road(load):
    request = load(RIG)
    device = (Spring(1e6, "ks") | Damper(3200.0, "cs")) - Gap(1e-4, "g") - Inerter(113.0, "b")
    assert (request.design(), request.layout, request.signal.input) == (Rig(device), "screw", "displacement")


def test_frequencies_count_cycles_and_phases_radians(load):
    request = load(RIG, ('"3 Hz"', '"3 Hz"\nphase = "90 deg"'))
    assert request.signal.values == {"amplitude": 1e-3, "frequency": 3.0, "phase": pytest.approx(np.pi / 2)}


@pytest.mark.parametrize("model", VEHICLES)
def test_the_inputs_of_a_model_are_those_of_its_mechanism(load, model):
    mechanism = (
        load({"quarter-car": CAR, "half-car": HALF, "full-car": FULL, "absorber": ABSORBER, "rig": RIG}[model])
        .design()
        .mechanism()
    )
    angles = {coordinate.name for coordinate in mechanism.coordinates if coordinate.angle}
    units = {force.name: "N m" if angles & set(force.port) else "N" for force in mechanism.forces}
    assert units == dict(VEHICLES[model].forces)
    assert all(road.name.startswith(VEHICLES[model].moved) for road in mechanism.roads)


KIND_KEYS = {
    "sampled": 'file = "given.csv"',
    "profile": 'file = "road.csv"',
}


@pytest.mark.parametrize(
    ("kind", "unit"), [(k, u) for k in SIGNALS for u in UNITS if u == "m" or not SIGNALS[k].of_roads]
)
def test_every_kind_of_signal_is_made_of_its_own_examples(load, tmp_path, kind, unit):
    (tmp_path / "given.csv").write_text(f"time [s],value [{unit}]\n0,1\n1,2\n2,1\n")
    (tmp_path / "road.csv").write_text("distance [m],height [mm]\n0,0\n10,5\n100,0\n")
    keys = {name: key.of(unit) for name, key in SIGNALS[kind].keys.items()}
    lines = KIND_KEYS.get(kind) or "\n".join(key.example for key in keys.values() if key.default is REQUIRED)
    moved = {"m": "road", "N": "sprung_force", "N m": "pitch_moment", "m/s^2": "ground_acceleration"}[unit]
    old = 'kind = "multisine"\nseed = 3'
    request = load(HALF, (old, f'kind = "{kind}"\ninput = "{moved}"\n{lines}'), ('"0.5 s"', '"2 ms"'))
    assert request.signal.unit == unit
    assert np.isfinite(request.make_signal()([0.0, 0.1])).all()
    assert_survives(request, tmp_path / "elsewhere")
    if kind != "step":  # its jump may not reach a damper's end, which is another test's business
        assert request.run().status.ok


# --- there and back ---


def assert_survives(request, folder):
    folder.mkdir(exist_ok=True)
    copy = folder / "copy.toml"
    copy.write_text(write_simulation(request), encoding="utf-8")
    assert load_simulation(copy) == request


@pytest.mark.parametrize("path", MOTIONS, ids=lambda path: path.stem)
def test_examples_survive_being_written(path, tmp_path):
    assert_survives(load_simulation(path), tmp_path)


@pytest.mark.parametrize("path", MOTIONS, ids=lambda path: path.stem)
def test_examples_run(path):
    request = load_simulation(path)
    run = replace(request, duration=0.5).run()
    assert run.status.ok
    assert run.energy.relative_residual < 1e-8


def test_there_are_examples():
    assert {path.stem for path in MOTIONS} >= {"stick_slip", "backlash_rattle", "half_car_friction"}


def test_every_setting_survives_being_written(load, tmp_path):
    settings = """[simulation]
step = "0.25 ms"
integrator = "time-stepping"
initial = "preload"
energy = true
every = 4
"""
    request = load(CAR, ("[simulation]\n", settings), ("[vehicle]", 'title = "A \\"bump\\""\n[vehicle]'))
    assert (request.step, request.every, request.energy, request.title) == (0.25e-3, 4, True, 'A "bump"')
    assert_survives(request, tmp_path)


BUILDING = """
[vehicle]
model = "mechanism"
[vehicle.coordinates]
floor_1 = "40 t"
floor_2 = "30 t"
[vehicle.struts]
storey_1 = { upper = { floor_1 = 1 } }
storey_2 = { upper = { floor_2 = 1 }, lower = { floor_1 = 1 }, network = "k | c" }
[vehicle.forces]
push = { floor_1 = 1 }
[elements]
k = "30 MN/m"
c = "300 kN s/m"
[layouts]
plain = "k | c"
[signal]
kind = "sampled"
file = "quake.csv"
input = "ground_acceleration"
hold = "linear"
[simulation]
duration = "4 s"
step = "20 ms"
"""


def test_an_earthquake_record_shakes_the_ground(load, tmp_path):
    time = np.arange(201) * 0.02
    ground = np.random.default_rng(0).normal(size=time.size)  # m/s^2
    table = "\n".join(f"{t:.2f}, {100.0 * a!r}" for t, a in zip(time.tolist(), ground.tolist(), strict=True))
    (tmp_path / "quake.csv").write_text(f"time [s], value [cm/s^2]\n{table}\n", encoding="utf-8")
    request = load(BUILDING)
    run = request.run()
    coupling = np.array([[2.0, -1.0], [-1.0, 1.0]]) / np.array([[40e3], [30e3]])
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-30e6 * coupling, -300e3 * coupling]])
    b, above_ground = np.array([[0.0], [0.0], [-1.0], [-1.0]]), np.eye(2, 4)
    outputs = np.vstack(
        [above_ground, a[2:]]
    )  # over the ground, and accelerations, which are those over it and its own
    _, expected, _ = lsim((a, b, outputs, np.zeros((4, 1))), ground, time)
    names = [f"floor_{floor}_{what}" for what in ("relative_displacement", "acceleration") for floor in (1, 2)]
    for name, values in zip(names, expected.T, strict=True):
        np.testing.assert_allclose(run[name], values, atol=1e-10 * np.abs(values).max())
    assert_survives(request, tmp_path / "elsewhere")
    record = read_signal(tmp_path / "quake.csv", "m/s^2", "linear")
    plain = load(
        BUILDING,
        (
            'kind = "sampled"\nfile = "quake.csv"\ninput = "ground_acceleration"\nhold = "linear"',
            'kind = "step"\nheight = "1 N"',
        ),
    ).design()
    again = simulate(plain, forces={"ground_acceleration": record}, duration=4.0, step=0.02)
    np.testing.assert_array_equal(again["floor_2_acceleration"], run["floor_2_acceleration"])


@pytest.mark.parametrize(("mark", "point"), [(";", ","), (";", "."), ("\t", ","), (",", ".")])
def test_a_record_has_the_delimiter_and_the_decimal_mark_of_its_program(load, tmp_path, mark, point):
    rows = "\r\n".join(
        mark.join(cells).replace(".", point) for cells in [("0.0", "0.0"), ("0.5", "1.5"), ("2.0", "0.25")]
    )
    (tmp_path / "road.csv").write_bytes(f"\ufefftime [s]{mark}value [mm]\r\n{rows}\r\n".encode())
    signal = load(CAR, (SEED, 'kind = "sampled"\nfile = "road.csv"')).make_signal()
    np.testing.assert_allclose(signal([0.0, 0.5, 2.0]), [0.0, 1.5e-3, 0.25e-3], atol=1e-15)


def test_a_car_on_shaken_ground_has_its_road_on_it(load, tmp_path):
    """Over ground with a constant acceleration a car sinks as under so much more weight."""
    moved = 'kind = "step"\ninput = "ground_acceleration"\nheight = "2 m/s^2"'
    run = load(CAR, (SEED, moved), ('layout = "S2"', 'layout = "S1"'), ('"0.5 s"', '"20 s"\nstep = "1 ms"')).run()
    tyre = 2.0 * (181.75 + 25.0) / 120e3
    assert run["unsprung_relative_displacement"][-1] == pytest.approx(-tyre, rel=1e-6)
    assert run["sprung_relative_displacement"][-1] == pytest.approx(-tyre - 2.0 * 181.75 / 60e3, rel=1e-6)
    assert run["sprung_acceleration"][-1] == pytest.approx(2.0, rel=1e-6)


def test_the_steady_state_is_one_period(load):
    request = load(RIG, ('duration = "0.2 s"', 'initial = "periodic"\nstep = "1 ms"'), ('"3 Hz"', '"5 Hz"'))
    assert (request.duration, request.length) == (None, 0.2)
    assert request.run().time[-1] == pytest.approx(0.2)


def test_every_key_is_in_the_documentation():
    text = (ROOT / "docs" / "simulation.md").read_text(encoding="utf-8")
    words = {
        *SIGNALS,
        *(key for kind in SIGNALS.values() for key in kind.keys),
        *(one.name for one in keys_in(SimulationSettings)),
        *INITIAL,
    }
    assert [word for word in words if f"`{word}`" not in text and f'"{word}"' not in text] == []


# --- what is said about a bad one: the file, the place, and the words that help ---

SEED = 'kind = "multisine"\nseed = 3'
BAD = {
    "range": (
        CAR,
        [('"3 kN s/m"', '{ from = "1 N s/m", to = "2 N s/m" }')],
        "elements.c",
        ["range", "one value", "--to simulation"],
    ),
    "no unit": (CAR, [('"300 kg"', '"300"')], "elements.b", ["unit missing"]),
    "negative": (CAR, [('"300 kg"', '"-300 kg"')], "elements.b", ["not positive"]),
    "model": (CAR, [('"quarter-car"', '"quarter_car"')], "vehicle.model", ['"rig"', 'Did you mean "quarter-car"?']),
    "rig's mass": (RIG, [('"rig"', '"rig"\nsprung_mass = "1 kg"')], "vehicle.sprung_mass", ['model = "quarter-car"']),
    "axles of a rig": (RIG, [('"(ks | cs) - g - b"', '{ front = "b", rear = "b" }')], "layouts.screw", ["one device"]),
    "undefined": (CAR, [('"k | c"', '"k | q"')], "layouts.S1", ['"q"', "not in [elements]"]),
    "impact": (RIG, [("(ks | cs) - g - b", "g - b")], "layouts.screw", ["gap"]),
    "study": (CAR, [("[signal]", "[study]\n[signal]")], "study", ["unknown key", "inerter run"]),
    "section": (CAR, [("[signal]", "[signl]")], "signl", ["unknown key", 'Did you mean "signal"?']),
    "no simulation": (CAR, [("[simulation]", "[other]")], "simulation", ["missing", 'duration = "10 s"']),
    "no layout": (CAR, [('layout = "S2"\n', "")], "simulation.layout", ["missing", "S1, S2"]),
    "other layout": (CAR, [('layout = "S2"', 'layout = "S3"')], "simulation.layout", ['"S3"', "S1, S2"]),
    "kind": (CAR, [('"multisine"', '"multisin"')], "signal.kind", ['Did you mean "multisine"?', "held-noise"]),
    "no kind": (CAR, [('kind = "multisine"', "")], "signal.kind", ["missing", 'kind = "multisine"']),
    "kind's key": (CAR, [("seed = 3", 'amplitude = "1 mm"')], "signal.amplitude", ["unknown key", 'kind = "sine"']),
    "key": (CAR, [("seed = 3", "sed = 3")], "signal.sed", ["unknown key", 'Did you mean "seed"?']),
    "missing key": (RIG, [('frequency = "3 Hz"\n', "")], "signal.frequency", ["missing", 'frequency = "3 Hz"']),
    "amplitude in N": (RIG, [('"1 mm"', '"1 N"')], "signal.amplitude", ["incompatible unit", '"1 m"']),
    "number": (RIG, [('"1 mm"', "1")], "signal.amplitude", ["unit missing"]),
    "frequency": (RIG, [('"3 Hz"', '"3 s"')], "signal.frequency", ["incompatible unit", "Hz"]),
    "force in mm": (
        CAR,
        [(SEED, 'kind = "sine"\ninput = "sprung_force"\namplitude = "1 mm"\nfrequency = "1 Hz"')],
        "signal.amplitude",
        ["incompatible unit", '"1 N"'],
    ),
    "seed": (CAR, [("seed = 3", "seed = -3")], "signal.seed", ["whole number"]),
    "band": (CAR, [("seed = 3", 'lowest = "3 kHz"')], "signal", ["must not exceed", "3000 Hz and 1000 Hz"]),
    "road as force": (CAR, [("seed = 3", 'input = "sprung_force"')], "signal.kind", ["shape of a road"]),
    "input": (CAR, [("seed = 3", 'input = "rod"')], "signal.input", ['"rod"', 'Did you mean "road"?']),
    "shaken rig": (
        RIG,
        [
            (
                'kind = "cosine"\namplitude = "1 mm"',
                'kind = "cosine"\ninput = "ground_acceleration"\namplitude = "1 m/s^2"',
            )
        ],
        "signal.input",
        ["displacement"],
    ),
    "shaken in mm": (
        CAR,
        [(SEED, 'kind = "sine"\ninput = "ground_acceleration"\namplitude = "1 mm"\nfrequency = "1 Hz"')],
        "signal.amplitude",
        ["incompatible unit", '"1 m/s^2"'],
    ),
    "rig's input": (RIG, [('"3 Hz"', '"3 Hz"\ninput = "road"')], "signal.input", ["displacement"]),
    "no file": (CAR, [(SEED, 'kind = "profile"\nfile = "none.csv"')], "signal", ["file not found", "none.csv"]),
    "no roughness": (CAR, [('roughness = "5e-7 m^3/cycle"\n', "")], "road.roughness", ["multisine", "m^3/cycle"]),
    "no delay": (
        HALF,
        [
            ('[road]\nspeed = "90 km/h"\nroughness = "5e-7 m^3/cycle"\n', ""),
            (SEED, 'kind = "step"\nheight = "1 mm"'),
        ],
        "road.speed",
        ["rear axle", '"25 m/s"'],
    ),
    "duration": (CAR, [('duration = "0.5 s"', "")], "simulation.duration", ["missing", '"10 s"']),
    "steps": (CAR, [('"0.5 s"', '"0.50001 s"')], "simulation.step", ["whole number of steps"]),
    "zero step": (CAR, [('"0.5 s"', '"0.5 s"\nstep = "0 s"')], "simulation.step", ["not positive"]),
    "integrator": (CAR, [('"0.5 s"', '"1 s"\nintegrator = "euler"')], "simulation.integrator", ["time-stepping"]),
    "initial": (CAR, [('"0.5 s"', '"1 s"\ninitial = "rset"')], "simulation.initial", ['Did you mean "rest"?']),
    "energy": (CAR, [('"0.5 s"', '"1 s"\nenergy = "yes"')], "simulation.energy", ["true or false"]),
    "every": (CAR, [('"0.5 s"', '"1 s"\nevery = 0')], "simulation.every", ["whole number"]),
    "misplaced": (CAR, [("seed = 3", 'duration = "1 s"')], "signal.duration", ["unknown key"]),
}


@pytest.mark.parametrize(("text", "changes", "place", "words"), BAD.values(), ids=BAD)
def test_one_sentence_names_the_place_and_what_to_do(load, text, changes, place, words):
    with pytest.raises(StudyError) as caught:
        load(text, *changes)
    message = str(caught.value)
    line = next(line for line in message.splitlines() if line.startswith(f"motion.toml: {place}: "))
    for word in words:
        assert word in line, line
    assert "pydantic" not in message


def test_files_that_are_none(tmp_path):
    with pytest.raises(StudyError, match=r"file not found; expected a simulation file"):
        load_simulation(tmp_path / "none.toml")
    with pytest.raises(StudyError, match="this is a folder"):
        load_simulation(tmp_path)
