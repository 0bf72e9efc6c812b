"""Kinds of element that the package does not know, defined here alone, through everything that elements go through."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from study_text import PAPER_CAR, study_text
from wang_su import ROAD
from wang_su import paper_quarter_car as car

import inerter as it
from inerter.cli.main import call
from inerter.errors import DesignError, NetworkError, PerformanceIndexError, RegistryError, StudyError
from inerter.field_metadata import Field
from inerter.figures.networks import draw_networks, schematic
from inerter.files.simulation.loading import load_simulation
from inerter.files.study.loading import load_study
from inerter.files.study.quantity_texts import write_resolved
from inerter.networks.elements import Element, Network, Value
from inerter.networks.elements.drawing import BOX, circle
from inerter.networks.elements.registry import ELEMENTS, kinds_by_unit
from inerter.networks.elements.roles import GuardRole, LinearRole, StatisticalRole, SwitchRole
from inerter.networks.parser import network
from inerter.systems.graph import full_graph, linear_graph
from inerter.systems.outputs import outputs

COMFORT = it.RideComfort(ROAD)


@dataclass(frozen=True)
class Flywheel(Element):
    """A flywheel on a screw: linear, with a law of its own unit and a transmission."""

    moment: Value
    lead: float
    name: str | None = None
    key = "flywheel on a screw"
    symbol = "J"
    quantity = "moment"
    unit = "kg m^2"
    sentence = "Moment of inertia of the flywheel."
    example = "0.001 kg m^2"
    more = (Field("lead", "m", "Travel of the screw in one turn."),)
    linear = LinearRole.MASS
    drawing = (((0.0, 20.0), (0.0, 6.0)), circle(0.0, 0.0, 6.0), ((0.0, -6.0), (0.0, -20.0)))

    @property
    def gain(self) -> float:
        return (2.0 * math.pi / self.lead) ** 2


@dataclass(frozen=True)
class TwoSlopes(Element):
    """A damper with less damping beyond a speed: a network of others to simulation, a damper to linear analysis."""

    damping: Value
    beyond: float
    knee: float
    name: str | None = None
    key = "digressive damper"
    symbol = "d"
    quantity = "damping"
    unit = "N s/m"
    sentence = "Force over speed below the knee."
    example = "3000 N s/m"
    more = (
        Field("beyond", "N s/m", "Slope of the force beyond the knee."),
        Field("knee", "m/s", "Speed at which the slope changes."),
    )
    linear = LinearRole.DAMPING

    def as_linear(self) -> Network:
        return it.Damper(self.damping)

    def as_piecewise(self) -> Network:
        lost = self.coefficient - self.beyond
        if lost <= 0.0:
            raise NetworkError(f"The slope of {self.label!r} beyond its knee must be less than below it.")
        return it.Damper(self.beyond) | it.Damper(lost, "d_lost") - it.Friction(lost * self.knee)


@dataclass(frozen=True)
class Clutch(Element):
    """Something that holds up to a force, with words of its own."""

    torque: Value
    name: str | None = None
    key = "clutch"
    symbol = "q"
    quantity = "torque"
    unit = "N"
    sentence = "Force at which it slips."
    example = "10 N"
    linear = LinearRole.OPEN
    switch = SwitchRole(GuardRole.FORCE, "pushed on", "engaged", "pulled on")
    statistical = StatisticalRole.DAMPER
    may_vanish = True
    tried = (0.1, 1e3)


@dataclass(frozen=True)
class Play(it.Gap):
    """A gap, with words of its own."""

    key = "play"
    switch = SwitchRole(GuardRole.ELONGATION, "pressed", "adrift", "stretched")


OWN = (Flywheel, TwoSlopes, Clutch)


@pytest.fixture
def known():
    for kind in OWN:
        ELEMENTS.add(kind)
    yield
    for kind in OWN:
        ELEMENTS.remove(kind)


k, c = it.Spring(120e3, "k"), it.Damper(7353.0, "c")
LEAD = 0.01
WHEEL = Flywheel(8e-4, LEAD, "J")
INERTANCE = 8e-4 * (2.0 * math.pi / LEAD) ** 2  # 316 kg


@pytest.mark.parametrize("index", [COMFORT, it.TyreLoad(ROAD), it.LoadCarrying()])
def test_a_flywheel_on_a_screw_is_an_inerter_to_every_norm(index):
    own, known = (it.evaluate(car(k | c - b), index, it.Norm()) for b in (WHEEL, it.Inerter(INERTANCE)))
    assert own.value == pytest.approx(known.value, rel=1e-11)
    assert own.status.ok


@pytest.mark.parametrize("omega", [0.5, 30.0])
def test_its_admittance_is_that_of_its_role(omega):
    assert WHEEL.admittance(1j * omega) == pytest.approx(1j * omega * INERTANCE, rel=1e-14)
    assert (k - WHEEL).admittance(1j * omega) == pytest.approx(
        1.0 / (1j * omega / 120e3 + 1 / (1j * omega * INERTANCE))
    )


def test_exact_transfer_functions_know_its_transmission():
    systems = [it.state_space(car(k | c - b)) for b in (WHEEL, it.Inerter(INERTANCE))]
    own, known = (s.origin.functions(s.inputs, s.outputs[:1]) for s in systems)
    for s in (0.3, 2.0, 50.0):
        values = [
            sum(a * s**i for i, a in enumerate(f.numerators[0][0])) / sum(a * s**i for i, a in enumerate(f.denominator))
            for f in (own, known)
        ]
        assert values[0] == pytest.approx(values[1], rel=1e-12)


def test_its_free_value_is_chosen_in_its_own_unit():
    gain = WHEEL.gain
    own = it.optimise(car(k | c - Flywheel(it.free(1 / gain, 2000 / gain, "J"), LEAD)), COMFORT, it.Norm(), seed=0)
    known = it.optimise(car(k | c - it.Inerter(it.free(1.0, 2000.0, "b"))), COMFORT, it.Norm(), seed=0)
    assert own.value == pytest.approx(known.value, rel=1e-9)
    assert gain * own.parameters["J"] == pytest.approx(known.parameters["b"], rel=1e-4)


@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
def test_it_moves_as_an_inerter_does(integrator):
    runs = [
        it.simulate(
            car(k | c - (b | it.Friction(30.0, "f"))),
            road=it.multisine(ROAD, seed=0),
            duration=1.0,
            step=5e-4,
            integrator=integrator,
        )
        for b in (WHEEL, it.Inerter(INERTANCE, "J"))
    ]
    for name in ("sprung_acceleration", "tyre_load", "J_force"):
        assert runs[0][name] == pytest.approx(runs[1][name], abs=1e-9 * np.abs(runs[1][name]).max())


def slopes(beyond: float = 800.0, knee: float = 0.05) -> TwoSlopes:
    return TwoSlopes(3000.0, beyond, knee, "d")


@pytest.mark.parametrize("amplitude", [2e-3, 2e-2])
@pytest.mark.parametrize("integrator", ["event-driven", "time-stepping"])
def test_a_damper_with_two_slopes_has_the_force_of_its_law(amplitude, integrator):
    omega, step = 10.0, 1e-4
    moved = it.cosine(amplitude=amplitude, frequency=omega / (2.0 * math.pi))
    device = slopes()
    run = it.simulate(it.Rig(device), displacement=moved, duration=1.0, step=step, integrator=integrator)
    v = -amplitude * omega * np.sin(omega * run.time)
    law = np.where(np.abs(v) < 0.05, 3000.0 * v, 800.0 * v + 2200.0 * 0.05 * np.sign(v))
    error = np.abs(run["device_force"] - law)[2:-2]
    assert error.max() < (1e-9 if integrator == "event-driven" else 0.02) * np.abs(law).max()
    slips = [event for event in run.events if event.element == "d_f"]
    assert bool(slips) == (integrator == "event-driven" and amplitude * omega > 0.05)


def test_its_energy_adds_up():
    run = it.simulate(car(k | slopes()), road=it.multisine(ROAD, seed=1), duration=2.0, step=2e-4, energy=True)
    assert run.energy.relative_residual < 1e-8
    assert run.energy.dampers.keys() == {"d_c", "d_lost"}
    assert run.energy.friction["d_f"] > 0.0


def test_linear_analysis_takes_its_slope_at_rest():
    own, known = (it.evaluate(car(k | d), COMFORT, it.Norm()).value for d in (slopes(), it.Damper(3000.0)))
    assert own == known


@pytest.mark.parametrize("knee", [1e-3, 10.0])
def test_methods_that_see_it_agree_where_one_slope_rules(knee):
    damping = 3000.0 if knee == 10.0 else 800.0
    linear = it.evaluate(car(k | it.Damper(damping)), COMFORT, it.Norm()).value
    for method in (it.StatisticalLinearisation(), it.ExpectedValue(realisations=2, seed=0)):
        assert it.evaluate(car(k | slopes(knee=knee)), COMFORT, method).value == pytest.approx(linear, rel=0.02)


@pytest.mark.parametrize("knee", [0.01, 0.03, 0.08, 0.3])
def test_statistical_linearisation_of_it_is_close_to_simulation_or_says_that_it_may_not_be(knee):
    own = car(k | slopes(knee=knee))
    simulated = it.evaluate(own, COMFORT, it.ExpectedValue(realisations=8, seed=0))
    closed = it.evaluate(own, COMFORT, it.StatisticalLinearisation())
    assert closed.status.ok == (knee in {0.01, 0.3})  # one slope rules
    assert closed.status.ok or "'d_f' in 'strut' sticks" in closed.status.message
    scatter = 3.0 * simulated.standard_error
    assert abs(closed.value - simulated.value) < closed.error_bound * closed.value + scatter


def test_what_depends_on_a_free_value_is_refused_and_what_does_not_is_optimised():
    open_design = car(k | TwoSlopes(it.free(1000.0, 1e5, "d"), 800.0, 0.05))
    best = it.optimise(open_design, COMFORT, it.Norm(), seed=0)
    known = it.optimise(car(k | it.Damper(it.free(1000.0, 1e5, "c"))), COMFORT, it.Norm(), seed=0)
    assert best.value == pytest.approx(known.value, rel=1e-9)
    with pytest.raises(DesignError, match="still has free values"):
        it.simulate(open_design, road=it.multisine(ROAD, seed=0), duration=1.0)
    with pytest.raises(DesignError, match="'d' is free"):
        it.optimise(open_design, COMFORT, it.StatisticalLinearisation(), seed=0)
    with pytest.raises(NetworkError, match="less than below"):
        it.simulate(car(k | TwoSlopes(500.0, 800.0, 0.05)), road=it.multisine(ROAD, seed=0), duration=1.0)


def test_its_parts_are_named_after_it():
    mechanism = car(k | slopes()).mechanism()
    assert [b.label for b in full_graph(mechanism).branches][:4] == ["k", "d_c", "d_lost", "d_f"]
    assert [b.label for b in linear_graph(mechanism).branches][:2] == ["k", "d"]


def in_others_words(monkeypatch, words):
    """The damper with two slopes, written otherwise: parts named as it is itself, or two parts to linear analysis."""

    def parts(device, label=None):
        lost = device.coefficient - device.beyond
        return it.Damper(device.beyond, label) | it.Damper(lost, label) - it.Friction(lost * device.knee)

    if words == "its own label":
        monkeypatch.setattr(TwoSlopes, "as_piecewise", lambda device: parts(device, device.label))
    if words == "two linear parts":

        def at_rest(device):
            return it.Damper(0.25 * device.coefficient) | it.Damper(0.75 * device.coefficient)

        monkeypatch.setattr(TwoSlopes, "as_linear", at_rest)


@pytest.mark.parametrize("words", ["as written", "its own label", "two linear parts"])
@pytest.mark.parametrize("name", ["d", "c", None])
def test_the_force_of_a_composite_is_that_of_the_whole_to_all(monkeypatch, name, words):
    """While nothing slips, what linear analysis and simulation have by one name is one thing; all names are known."""
    in_others_words(monkeypatch, words)
    label, design = name or "d", car(k | TwoSlopes(3000.0, 800.0, 10.0, name))
    mechanism = design.mechanism()
    linear, full = (outputs(mechanism, graph(mechanism)) for graph in (linear_graph, full_graph))
    assert {f"{label}_force", f"{label}_velocity"} <= linear.keys() <= full.keys()
    run = it.simulate(design, road=it.multisine(ROAD, seed=0), duration=0.5, step=5e-4)
    known = it.simulate(car(k | it.Damper(3000.0, "x")), road=it.multisine(ROAD, seed=0), duration=0.5, step=5e-4)
    system = it.state_space(design, outputs=[f"{label}_force", f"{label}_velocity"])
    expected = it.state_space(car(k | it.Damper(3000.0, "x")), outputs=["x_force", "x_velocity"])
    omega = np.array([1.0, 30.0])
    assert it.frequency_response(system, omega) == pytest.approx(it.frequency_response(expected, omega), rel=1e-9)
    for what in ("force", "velocity"):
        size = np.abs(known[f"x_{what}"]).max()
        assert run[f"{label}_{what}"] == pytest.approx(known[f"x_{what}"], abs=1e-9 * size)
    for output in linear.keys() & {o for o in full if o.endswith("_force")}:  # the parts that both have are the same
        branch = output.removesuffix("_force")
        found = [{b.label: b.element for b in graph(mechanism).branches} for graph in (linear_graph, full_graph)]
        assert branch == label or all(branch not in one for one in found) or found[0][branch] == found[1][branch]


@pytest.mark.parametrize("amplitude", [2e-3, 2e-2])
def test_the_force_of_a_composite_is_that_of_its_law(amplitude):
    moved = it.cosine(amplitude=amplitude, frequency=10.0 / (2.0 * math.pi))
    run = it.simulate(it.Rig(slopes() - it.Spring(1e5, "shaft")), displacement=moved, duration=1.0, step=1e-4)
    v = run["d_velocity"]
    law = np.where(np.abs(v) < 0.05, 3000.0 * v, 800.0 * v + 2200.0 * 0.05 * np.sign(v))
    assert np.abs(run["d_force"] - law).max() < 1e-6 * np.abs(law).max()
    assert run["d_force"] == pytest.approx(run["shaft_force"], abs=1e-9 * np.abs(law).max())


def test_a_clutch_is_a_friction_with_words_of_its_own():
    runs = [
        it.simulate(car(k | c - (it.Inerter(300.0) | f)), road=it.multisine(ROAD, seed=0), duration=1.0, step=5e-4)
        for f in (Clutch(200.0, "f"), it.Friction(200.0, "f"))
    ]
    assert np.array_equal(*(run["sprung_acceleration"] for run in runs))
    assert [e.time for e in runs[0].events] == [e.time for e in runs[1].events]
    assert {e.after for e in runs[0].events} == {"engaged", "pulled on", "pushed on"}
    closed = [
        it.evaluate(car(k | c - (it.Inerter(300.0) | f)), COMFORT, it.StatisticalLinearisation()).value
        for f in (Clutch(20.0), it.Friction(20.0))
    ]
    assert closed[0] == closed[1]
    noted = it.evaluate(car(k | c | Clutch(20.0, "f")), COMFORT, it.Norm()).notes
    plain = it.evaluate(car(k | c | it.Friction(20.0, "f")), COMFORT, it.Norm()).notes
    assert noted == tuple(note.replace("friction", "clutch") for note in plain) != plain


def test_a_clutch_has_a_budget():
    own, plain = car(k | c - (it.Inerter(328.7) | Clutch(0.0))), car(k | it.Damper(4981.0))
    same = car(k | c - (it.Inerter(328.7) | it.Friction(0.0)))
    method = it.StatisticalLinearisation()
    found = it.break_even(own, plain, COMFORT, parameter="clutch", method=method, bounds=(1.0, 1e4))
    assert (
        found.value == it.break_even(same, plain, COMFORT, parameter="friction", method=method, bounds=(1.0, 1e4)).value
    )
    assert it.break_even(own, plain, COMFORT, parameter="clutch", method=method).bounds == Clutch.tried


@pytest.mark.marathon
def test_an_identified_play_comes_loose_as_often_as_a_gap():
    """In a motion that breaks contact at every turn, whatever it calls that."""
    shaft, b = it.Spring(1e6) | it.Damper(3200.0), it.free(50.0, 200.0, "b")
    rattling, open_gap, open_play = (
        shaft - gap - (it.Inerter(value) | it.Friction(10.0))
        for value, gap in ((113.0, it.Gap(1e-4)), (b, it.Gap(1e-4, "g")), (b, Play(1e-4, "g")))
    )
    record = it.VirtualRig(rattling, seed=0).run(it.cosine(1e-3, 6.0), 1.0)
    fits = [it.identify(record, model, starts=8) for model in (open_gap, open_play)]
    counts = [fit.comparisons[0].openings["g"] for fit in fits]
    assert counts[0] == counts[1] >= 10


@pytest.mark.parametrize(("element", "lines"), [(WHEEL, Flywheel.drawing), (slopes(), BOX)])
def test_they_are_drawn(element, lines, tmp_path):
    drawing = schematic(k | element, values=True)
    assert [p.element for p in drawing.placed] == [k, element]
    assert type(element).drawing == lines
    for path in draw_networks({"own": k | element}, tmp_path, "own", values=True):
        assert path.stat().st_size > 1000


def test_an_expression_holds_them():
    parsed = network("k | J - d", k=k, J=Flywheel(8e-4, LEAD), d=slopes())
    assert [(type(e), e.label) for e in parsed.elements()] == [(it.Spring, "k"), (Flywheel, "J"), (TwoSlopes, "d")]


STUDY = study_text(
    'indices = ["J1"]\nevaluate = ["norm", "expected-value"]',
    vehicle=PAPER_CAR,
    elements='k = "120 kN/m"\nc = "3 kN s/m"\nd = {D}\nJ = {J}',
    layouts='S1 = "k | d"\nS2 = "k | c - J"',
)
DAMPER = '{ kind = "digressive damper", damping = "3 kN s/m", beyond = "800 N s/m", knee = "50 mm/s" }'
SCREW = '{ kind = "flywheel on a screw", moment = "8 kg cm^2", lead = "10 mm" }'
RANGE = SCREW.replace('"8 kg cm^2"', '{ from = "1 kg cm^2", to = "90 kg cm^2" }')


def written(folder: Path, damper: str = DAMPER, screw: str = SCREW, text: str = STUDY) -> Path:
    path = folder / "own.toml"
    path.write_text(text.replace("{D}", damper).replace("{J}", screw), encoding="utf-8")
    return path


@pytest.mark.parametrize("screw", [SCREW, RANGE])
def test_files_name_their_kinds(screw, known, tmp_path):
    text = STUDY + 'optimise = "norm"\n' if screw is RANGE else STUDY
    study = load_study(written(tmp_path, screw=screw, text=text))
    assert study.elements["d"] == slopes()
    value = study.elements["J"].value
    if screw is RANGE:
        assert value == it.free(1e-4, 9e-3, "J")
    else:
        assert value == pytest.approx(8e-4, rel=1e-14)
        assert study.elements["J"] == Flywheel(value, 0.01, "J")
    again = tmp_path / "again.toml"
    again.write_text(write_resolved(study), encoding="utf-8")
    assert load_study(again).elements == study.elements


def test_a_simulation_file_names_them_too(known, tmp_path):
    head, _, _ = STUDY.partition("[study]")
    text = head + '[signal]\nkind = "multisine"\n[simulation]\nlayout = "S1"\nduration = "1 s"\n'
    request = load_simulation(written(tmp_path, text=text))
    assert request.elements["d"] == slopes()
    with pytest.raises(StudyError, match=r"elements\.J\.moment: got a table: not a quantity"):
        load_simulation(written(tmp_path, screw=RANGE, text=text))


def test_the_whole_command_has_words_for_a_switch_of_its_own(known, tmp_path, capsys):
    head = STUDY.partition("[study]")[0].replace("d = {D}", 'q = { kind = "clutch", torque = "50 N" }')
    text = head.replace('S1 = "k | d"', 'S1 = "k | c | q"') + '[signal]\nkind = "sine"\namplitude = "10 mm"\n'
    text += 'frequency = "1.3 Hz"\n[simulation]\nlayout = "S1"\nduration = "2 s"\n'
    assert call(["simulate", str(written(tmp_path, text=text)), "-o", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert re.search(r"clutch +q +\d+ +engaged \d.* %, pushed on", shown)
    (drawing,) = (tmp_path / "out" / "figures").glob("*.svg")
    assert "q is engaged" in drawing.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (
            '{ kind = "spark plug" }',
            '.kind: got "spark plug": not a kind of element; available in this version: "spring"',
        ),
        ("{ kind = 3 }", ".kind: got 3: not a kind of element"),
        (DAMPER.replace("}", ', elbow = "1 m" }'), ".elbow: unknown key; expected one of kind, damping, beyond, knee."),
        (DAMPER.replace(', knee = "50 mm/s"', ""), '.knee: missing; expected knee = "1 m/s".'),
        (DAMPER.replace("50 mm/s", "50 mm"), '.knee: got "50 mm": incompatible unit "mm" (millimeter)'),
        (DAMPER.replace("50 mm/s", "-50 mm/s"), '.knee: got "-50 mm/s": not positive'),
        (DAMPER.replace('"3 kN s/m"', '{ from = "1 N s/m" }'), '.damping.to: missing; expected to = "2 N s/m".'),
        (DAMPER.replace('"3 kN s/m"', '{ from = "2 N s/m", to = "1 N s/m" }'), ".damping: got reversed ends"),
    ],
)
def test_what_is_wrong_with_their_entries_is_told(entry, said, known, tmp_path):
    with pytest.raises(StudyError) as caught:
        load_study(written(tmp_path, damper=entry))
    (line,) = str(caught.value).splitlines()
    assert line.startswith(f"own.toml: elements.d{said}")


def test_a_study_knows_that_a_norm_does_not_see_all_of_them(known, tmp_path):
    text = STUDY.replace('["J1"]', '["J5"]')
    with pytest.raises(StudyError, match=r"study\.force: missing, but expected-value takes J5 of S1"):
        load_study(written(tmp_path, text=text))


def test_kinds_are_registered_once_and_units_tell_the_first_that_is_a_value_alone(known):
    assert ELEMENTS.add(Flywheel) is Flywheel
    assert ELEMENTS["clutch"] is Clutch
    assert kinds_by_unit()["N"] is it.Friction
    assert "kg m^2" not in kinds_by_unit()
    with pytest.raises(RegistryError, match="another kind of element with the key 'clutch'"):
        ELEMENTS.add(type("Other", (Clutch,), {}))


@pytest.mark.parametrize("lead", [0.0, -1.0, math.nan, "1 mm", True])
def test_other_numbers_are_checked_as_values_are(lead):
    with pytest.raises(NetworkError, match="Lead must be a positive number of m"):
        Flywheel(1e-3, lead)


def test_statistical_linearisation_refuses_what_says_so():
    class Refused(Clutch):
        key = "ratchet"
        statistical = StatisticalRole.ITSELF

    with pytest.raises(PerformanceIndexError, match="'f' in 'strut' is a ratchet"):
        it.evaluate(car(k | c | Refused(5.0, "f")), COMFORT, it.StatisticalLinearisation())
