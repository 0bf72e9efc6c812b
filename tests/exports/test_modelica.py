"""Modelica source, read back by pymoca, has the equations of the vehicle."""

from __future__ import annotations

import re

import numpy as np
import pytest
from campaigns import sampled
from designs import ALWAYS, COUNT, design, deviation, frequencies
from nodal import Nodal
from scipy.integrate import solve_ivp

import inerter as it

pytest.importorskip("pymoca", reason='pymoca reads Modelica back: pip install "inerter[test]".')
from flat_modelica import LIBRARY, FlatModel

K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)


@pytest.mark.parametrize("number", sampled(range(COUNT), ALWAYS[::2], often=ALWAYS[1::2], kept=2))
def test_its_equations_are_those_of_the_vehicle(number: int) -> None:
    """Against M s^2 + C s + K in extended precision: motions, forces and travels from every road and force."""
    vehicle, omega = design(number), frequencies()
    model = FlatModel(it.export(vehicle, "modelica", title="design"), "design.Vehicle")
    nodal = Nodal(vehicle.mechanism(), omega)
    sources = [name if name in nodal.inputs else name.removesuffix("_velocity") for name in model.inputs]
    assert sorted(sources) == sorted(nodal.inputs)
    expected = [[nodal.response(out, source) for source in sources] for out in model.outputs]
    assert len(model.outputs) == 3 * len(nodal.coordinates) + 2 * len(nodal.carriers)
    assert deviation(model.response(omega), np.moveaxis(np.array(expected, complex), 2, 0)) < 1e-9


@pytest.mark.parametrize("number", sampled(range(COUNT), often=[0, 36], kept=0))
def test_a_compiler_simulates_it(number: int) -> None:
    """That of rumoca, with its own reduction of index and integrator, against the state space and SciPy's."""
    rumoca = pytest.importorskip("rumoca", reason='A compiler of Modelica: pip install "inerter[modelica]".')
    vehicle = design(number)
    system = it.state_space(vehicle, outputs=None)
    lines = {name: (1e4 * 10.0 ** (i % 3), 3.0 + 2.5 * i) for i, name in enumerate(system.inputs)}
    roads = {road.name for road in vehicle.mechanism().roads}
    given = [
        f"  car.{name}{'_velocity' if name in roads else ''} = {size!r}*sin({rate!r}*time);"
        for name, (size, rate) in lines.items()
    ]
    source = it.export(vehicle, "modelica", title="design")
    whole = "\n".join([LIBRARY, source, "model Test", "  design.Vehicle car;", "equation", *given, "end Test;"])
    model = rumoca.Session().loads(whole, model="Test")
    made = model.simulate(1.0, dt=1e-2, config=rumoca.SimConfig(rtol=1e-10, atol=1e-12))
    time, found = np.array(made.time), dict(zip(made.names, made.to_numpy(), strict=True))

    def inputs(at: np.ndarray) -> np.ndarray:
        return np.array([size * np.sin(rate * at) for size, rate in lines.values()])

    def rates(at: float, x: np.ndarray) -> np.ndarray:
        return system.A @ x + system.B @ inputs(np.asarray(at))

    states = solve_ivp(rates, (0.0, time[-1]), np.zeros(len(system.A)), "Radau", time, rtol=1e-10, atol=1e-13).y
    for name, row in zip(system.outputs, system.C @ states + system.D @ inputs(time), strict=True):
        assert np.allclose(found[f"car.{name}"], row, rtol=0.0, atol=1e-5 * np.abs(row).max()), name


def test_bridges_nodes_without_mass_and_levers() -> None:
    bridge = it.Bridge(it.Damper(3e3), it.Spring(4e4), it.Inerter(20.0), it.Damper(1e3), it.Spring(1e5))
    car = it.Mechanism(
        coordinates=(it.Coordinate("body", 300.0), it.Coordinate("time", 0.0), it.Coordinate("end_flange", 30.0)),
        struts=(
            it.Strut("upper", it.Spring(5e5) | it.Damper(500.0), {"body": 1.0}, {"time": 1.0}),
            it.Strut("lower", bridge | it.Spring(2e4), {"time": 1.0}, {"end_flange": 1.0}),
            it.Strut("rocker", it.Damper(100.0), {"body": 0.5, "end_flange": -1.25}, it.GROUND),
        ),
        tyres=(it.Tyre("tyre", it.Spring(1.5e5) | it.Damper(50.0), {"end_flange": 1.0}, "road"),),
        roads=(it.RoadInput("road"),),
        forces=(it.Force("load", {"body": 1.0, "end_flange": 0.5}),),
    )
    omega = frequencies()
    model = FlatModel(it.export(car, "modelica"), "vehicle.Vehicle")
    nodal = Nodal(car, omega)
    named = {out: out.replace("time_2", "time") for out in model.outputs}
    expected = [[nodal.response(named[out], source) for source in ("road", "load")] for out in model.outputs]
    assert model.inputs == ["road_velocity", "load"]
    assert deviation(model.response(omega), np.moveaxis(np.array(expected, complex), 2, 0)) < 1e-9


def test_names_and_units() -> None:
    half = design(1)
    model = FlatModel(it.export(half, "modelica", title="half car 3"), "half_car_3.Vehicle")
    assert model.inputs == ["road_front_velocity", "road_rear_velocity", "sprung_force", "pitch_moment"]
    assert model.units["road_front_velocity"] == "m/s"
    assert model.units["pitch_moment"] == "N.m"
    assert model.units["pitch_acceleration"] == "rad/s2"
    assert model.units["front_force"] == "N"


def test_names_that_modelica_keeps_for_itself() -> None:
    strut = it.Spring(1e4, "end") | it.Damper(1e3, "time") - it.Inerter(5.0, "Inerter") | it.Spring(1e3, "sprung")
    model = FlatModel(it.export(it.QuarterCar(250.0, 35.0, 1.5e5, strut), "modelica", title="model"), "model_.Vehicle")
    assert {"end_2.f", "time_2.f", "Inerter_2.f", "sprung_2.f"} <= {*model.variables}


def test_a_title_becomes_the_name_of_the_package() -> None:
    title = 'A "car": 100 % of it, ' + 90 * "x"
    text = it.export(it.QuarterCar(250.0, 35.0, 1.5e5, K | C), "modelica", title=title)
    assert text.startswith(f"package A_car_100_of_it_{44 * 'x'} ")
    assert FlatModel(text, f"A_car_100_of_it_{44 * 'x'}.Vehicle").outputs


def test_values_have_every_bit() -> None:
    value = 120e3 / 7.0
    text = it.export(it.QuarterCar(181.75, 25.0, value, K | C - B), "modelica")
    assert float(re.search(r"Spring k_2\(c=(\S+)\);", text)[1]) == value  # type: ignore[index]


def test_moving_ground_is_refused() -> None:
    absorber = design(3).mechanism().on_moving_ground()
    with pytest.raises(it.InerterError, match="The ground of this mechanism moves"):
        it.export(absorber, "modelica")
    assert "ground_acceleration [m/s^2]" in [one.label for one in it.named_system(absorber).inputs]
