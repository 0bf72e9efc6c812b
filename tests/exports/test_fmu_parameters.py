"""Values that a host sets give the FMU of the design that has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from designs import design
from scipy.integrate import solve_ivp
from wang_su import paper_quarter_car

import inerter as it
from inerter.networks.transform import map_elements

pytest.importorskip("fmpy", reason='FMPy steps FMUs: pip install "inerter[test]".')
from fmu_master import Master
from fmu_roads import driven, error, needs_compiler, road

pytestmark = [needs_compiler, pytest.mark.usefixtures("unoptimised")]
K, C, B = it.Spring(120e3), it.Damper(7544.2), it.Inerter(366.52)
REAL = K | C - it.Gap(5e-4) - (it.Spring(1e6, "ks") | it.Damper(3200.0, "cs")) - (B | it.Friction(20.0))
LOOSE = K | C | it.Spring(1e5, "k2") - (it.Spring(5e4, "k3") | it.Friction(80.0))
STRUTS = {"linear": K | C - B, "real": REAL, "at a node between springs": LOOSE}
KINDS = ("fmu", "fmu3")
CAR = paper_quarter_car(K | C - B)


@pytest.fixture
def masters() -> Iterator[list[Master]]:
    opened: list[Master] = []
    yield opened
    for one in opened:
        one.close()


def opened(masters: list[Master], data: object, folder: Path, kind: str = "fmu", **parameters: float) -> Master:
    masters.append(Master(it.export(data, kind, folder / f"{len(masters)}.fmu"), parameters))
    return masters[-1]


def mounts_of(vehicle: it.Vehicle) -> tuple[str, ...]:
    return tuple(f"{m.name}_{'force' if isinstance(m, it.Strut) else 'load'}" for m in vehicle.mechanism().mounts())


def of_other_values(vehicle: it.Vehicle, seed: int) -> it.Mechanism:
    """The same structure with values between half and twice those of the vehicle."""
    rng = np.random.default_rng(seed)
    mechanism = vehicle.mechanism()

    def change(element: it.Element) -> it.Network:
        return element.with_value(element.value * 2.0 ** rng.uniform(-1, 1))

    return replace(
        mechanism,
        coordinates=tuple(replace(c, inertia=c.inertia * 2.0 ** rng.uniform(-1, 1)) for c in mechanism.coordinates),
        struts=tuple(replace(s, network=map_elements(s.network, change)) for s in mechanism.struts),
        tyres=tuple(replace(t, network=map_elements(t.network, change)) for t in mechanism.tyres),
    )


def starts(master: Master) -> dict[str, float]:
    return {v.name: float(v.start) for v in master.description.modelVariables if v.causality == "parameter"}


@pytest.mark.parametrize(
    ("kind", "name"), sampled([(kind, name) for kind in KINDS for name in STRUTS], [("fmu", "real")], kept=1)
)
def test_values_before_a_run(name: str, kind: str, masters: list[Master], tmp_path: Path) -> None:
    strut = STRUTS[name]
    vehicle = paper_quarter_car(strut)
    other = of_other_values(vehicle, 3)
    expected = opened(masters, other, tmp_path, kind)
    assert len(starts(expected)) == len(list(strut.elements())) + 3
    found = opened(masters, vehicle, tmp_path, kind, **starts(expected))
    _, height, slope = road(0.3, 1e-3)
    shown = mounts_of(vehicle)
    assert error(*(driven(one, height, slope, 1e-3, shown) for one in (found, expected))) < 1e-9


@pytest.mark.parametrize("number", sampled([n for n in range(50) if n % 5 != 3], kept=1))
def test_random_vehicles_with_other_values(number: int, masters: list[Master], tmp_path: Path) -> None:
    vehicle = design(number)
    expected = opened(masters, of_other_values(vehicle, number), tmp_path)
    found = opened(masters, vehicle, tmp_path, **starts(expected))
    _, height, slope = road(0.3, 1e-3, number)
    shown = mounts_of(vehicle)
    one, other = (driven(master, height, slope, 1e-3, shown) for master in (found, expected))
    seen = np.sqrt(np.mean(other**2, axis=0)) > 1e-9 * np.sqrt(np.mean(other**2))
    assert error(one[:, seen], other[:, seen]) < 1e-9


@pytest.mark.campaign
def test_a_strut_alone_has_the_values_of_its_elements(masters: list[Master], tmp_path: Path) -> None:
    strut = K | C - B | it.Inerter(5.0, "own")
    found = opened(masters, strut, tmp_path, c=5000.0, own=12.0, k=1e5)
    expected = opened(masters, it.Spring(1e5) | it.Damper(5000.0) - B | it.Inerter(12.0), tmp_path)
    for master in (found, expected):
        master.set("upper_acceleration", 1.0, 20.0)
        master.step(0.05)
    assert found.get("strut_force", "inertance") == pytest.approx(expected.get("strut_force", "inertance"), rel=1e-12)


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu"]))
def test_a_damper_is_another_from_a_communication_point_on(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """Against the equations of a quarter car without inerter, by another integrator."""
    m, mu, k, kt, force = 300.0, 40.0, 2e4, 2e5, 500.0
    master = opened(masters, it.QuarterCar(m, mu, kt, it.Spring(k) | it.Damper(2e3)), tmp_path, kind)
    master.set("sprung_force", force)

    def rates(c: float, x: np.ndarray) -> list[float]:
        pull = k * (x[0] - x[1]) + c * (x[2] - x[3])
        return [x[2], x[3], (force - pull) / m, (pull - kt * x[1]) / mu]

    state = np.zeros(4)
    for c in (2e3, 4e2, 3e3):
        master.set("c", c)
        for _ in range(40):
            master.step(5e-3)
        state = solve_ivp(lambda t, x, c=c: rates(c, x), (0.0, 0.2), state, rtol=1e-11, atol=1e-14).y[:, -1]
        shown = master.get("sprung_displacement", "unsprung_displacement", "sprung_velocity", "unsprung_velocity")
        assert shown == pytest.approx(state, rel=1e-7, abs=1e-10)


@pytest.mark.campaign
def test_friction_that_changes_during_a_run_holds_what_it_can(masters: list[Master], tmp_path: Path) -> None:
    """A mass on a spring with friction: it stays at rest until the friction falls below its load."""
    car = it.QuarterCar(300.0, 40.0, 2e5, it.Spring(2e4) | it.Damper(2e3) | it.Friction(200.0))
    master = opened(masters, car, tmp_path)
    master.set("sprung_force", 80.0)
    for _ in range(1000):
        master.step(1e-3)
    assert abs(master.get("strut_travel")[0]) < 1e-9
    master.set("f", 20.0)
    for _ in range(3000):
        master.step(1e-3)
    assert 80.0 - 20.0 <= 2e4 * master.get("strut_travel")[0] <= 80.0 + 20.0


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu3"]))
def test_what_cannot_be_set(kind: str, masters: list[Master], tmp_path: Path) -> None:
    master = opened(masters, paper_quarter_car(REAL), tmp_path, kind)
    of = {v.name: v.variability for v in master.description.modelVariables if v.causality == "parameter"}
    assert {name for name, variability in of.items() if variability == "tunable"} == {"c", "cs", "f"}
    with pytest.raises(Exception, match="failed with status"):
        master.set("b", 100.0)
    with pytest.raises(Exception, match="failed with status"):
        master.set("c", -1.0)
    assert master.messages == [
        "a fixed parameter cannot change after initialisation",
        "parameters are positive numbers that double precision supports, 1e-12 to 1e15",
    ]
    master.set("f", 0.0)


@pytest.mark.parametrize("kind", sampled(KINDS, seldom=["fmu"]))
def test_a_state_brings_its_values(kind: str, masters: list[Master], tmp_path: Path) -> None:
    car = paper_quarter_car(REAL)
    one, other = opened(masters, car, tmp_path, kind, b=100.0), opened(masters, car, tmp_path, kind)
    _, height, slope = road(0.2, 1e-3)
    shown = mounts_of(car)
    driven(one, height[:101], slope[:101], 1e-3, shown)
    one.set("c", 5e3)
    saved = one.save()
    later = driven(one, height[100:], slope[100:], 1e-3, shown)
    other.restore(saved, 0.1)
    assert np.array_equal(driven(other, height[100:], slope[100:], 1e-3, shown), later)


@pytest.mark.parametrize("kind", KINDS)
def test_values_are_finite_numbers(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"{kind}.fmu"
    path.write_bytes(it.export(paper_quarter_car(REAL), kind))
    master = Master(path)
    for name in ("c", "f", "road_velocity"):
        for value in (np.inf, np.nan):
            with pytest.raises(Exception, match="failed with status"):
                master.set(name, value)
    with pytest.raises(Exception, match="failed with status"):
        master.step(np.inf)
    master.time = 0.0
    master.step(1e-3)
    assert np.all(np.isfinite(master.get("sprung_acceleration", "strut_force")))
    assert "values are finite numbers" in master.messages
    master.close()


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu"]))
def test_a_value_that_double_precision_does_not_support_is_refused(
    kind: str, masters: list[Master], tmp_path: Path
) -> None:
    """As in Python, where such an element or mass is refused."""
    path = it.export(CAR, kind, tmp_path / "car.fmu")
    for name, value in (("sprung_mass", 5e-324), ("sprung_mass", 1e-13), ("tyre.k", 1e16), ("c", 1e300)):
        with pytest.raises(Exception, match="failed with status"):
            Master(path, {name: value})
    masters.append(master := Master(path))
    master.set("sprung_force", 1e308)
    with pytest.raises(Exception, match="failed with status"):
        master.step(1e30)
    assert master.messages == ["no finite motion follows from these values"]


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu3"]))
def test_a_step_of_days_with_friction_is_refused(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """It would be so many small steps that their number has no place, and nothing moved."""
    master = opened(masters, paper_quarter_car(REAL), tmp_path, kind)
    master.set("sprung_force", 100.0)
    with pytest.raises(Exception, match="failed with status"):
        master.step(1e5)
    assert master.messages == ["a step with friction or gaps is at most 20000 s long"]


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu"]))
def test_a_step_of_a_rounding_error_hardly_moves_anything(kind: str, masters: list[Master], tmp_path: Path) -> None:
    """As of a host that adds up its steps, and ends where it was asked to."""
    shown = ("sprung_displacement", "sprung_velocity", "strut_force")
    for step in (1e-13, 1e-14, 1e-17, 1e-150):
        master = opened(masters, paper_quarter_car(REAL), tmp_path, kind)
        master.set("sprung_force", 100.0)
        master.step(0.1)
        before, master.time = master.get(*shown), 0.0
        master.step(step)
        assert master.get(*shown) == pytest.approx(before, rel=1e-9)


def exact_compliance(mass: float, unsprung: float, inertance: float) -> float:
    """Acceleration of a body for each N on it, with an inerter between it and an unsprung mass, in rationals."""
    m, mu, b = Fraction(mass), Fraction(unsprung), Fraction(inertance)
    return float((mu + b) / (m * mu + b * (m + mu)))


@pytest.mark.parametrize(
    ("mass", "kind"),
    sampled(product([3e-3, 3e-6, 3e-9], KINDS), [(mass, "fmu") for mass in (3e-3, 3e-6, 3e-9)], kept=1),
)
def test_a_body_of_grams_on_an_inerter_of_tons(mass: float, kind: str, masters: list[Master], tmp_path: Path) -> None:
    """Both masses move as one, and what they weigh cancels against the inertance."""
    unsprung, inertance = 1.7 * mass, 3.7e9
    car = it.QuarterCar(300.0, 40.0, 2e5, it.Spring(2e4) | it.Damper(2e3) | B)
    master = opened(masters, car, tmp_path, kind, sprung_mass=mass, unsprung_mass=unsprung, b=inertance)
    master.set("sprung_force", 1.0)
    expected = exact_compliance(mass, unsprung, inertance)
    assert master.get("sprung_acceleration")[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("kind", sampled(KINDS, ["fmu"]))
def test_masses_that_no_digit_of_an_inertance_shows_are_refused(
    kind: str, masters: list[Master], tmp_path: Path
) -> None:
    car = it.QuarterCar(300.0, 40.0, 2e5, it.Spring(2e4) | it.Damper(2e3) | B)
    master = opened(masters, car, tmp_path, kind)
    master.fmu.reset()
    with pytest.raises(Exception, match="failed with status"):
        master.start({"sprung_mass": 1e-12, "unsprung_mass": 1e-12, "b": 1e15})
    (message,) = master.messages
    assert message.endswith(": the equations are singular, or nearly so in twice the digits of a double")
