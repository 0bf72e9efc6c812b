"""The public names, as documented, and what the documents promise."""

from __future__ import annotations

import inspect
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import inerter as it
from inerter import _OLD, errors
from inerter.cli.main import app
from inerter.deprecation import renamed_keywords

ROOT = Path(__file__).parents[1]


def test_every_public_name_is_there() -> None:
    for name in it.__all__:
        assert getattr(it, name) is not None
    assert len(it.__all__) > 70
    assert dir(it) == it.__all__
    with pytest.raises(AttributeError, match="no attribute"):
        _ = it.nothing_of_that_name  # type: ignore[attr-defined]


def test_readme_has_the_two_commands() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"^ *(python3 -m venv .*)$", text, re.MULTILINE)
    assert commands == [
        "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/inerter run examples/quarter-car.toml",
        'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/pytest',
    ]


def test_links_of_documents_lead_somewhere() -> None:
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]:
        for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", path.read_text(encoding="utf-8")):
            assert link.startswith("https://") or (path.parent / link).exists(), f"{path.name}: {link}"


def test_readme_leads_to_what_newcomers_need() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "(CONTRIBUTING.md)" in text
    assert "(docs/architecture.md)" in text


def test_documents_name_every_command() -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in [ROOT / "README.md", *ROOT.glob("docs/*.md")])
    commands = [name for name in app if not name.startswith("-")]
    assert len(commands) >= 6
    for command in commands:
        assert f"inerter {command} " in text
        for argument in app[command].assemble_argument_collection(parse_docstring=False):
            options = [name for name in argument.names if name.startswith("-")]
            told = [re.search(rf"(?<![\w-]){option}(?![\w-])", text) for option in options]
            assert any(told) or not options, f"inerter {command} {options}"


def test_documents_name_what_is_public() -> None:
    named: dict[str, str] = {}
    for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]:
        for name in re.findall(r"\bit\.([A-Za-z]\w*)", path.read_text(encoding="utf-8")):
            named[name] = path.name
    assert len(named) > 80
    assert {name: file for name, file in named.items() if name not in it.__all__} == {}


def test_names_of_the_first_release() -> None:
    k, c, b = it.Spring(120e3), it.Damper(it.free(100, 100e3, name="c")), it.Inerter(it.free(1, 2000, name="b"))
    car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=k | c - b)
    road = it.Road(roughness=5e-7, speed=25)
    best = it.optimise(car, it.RideComfort(road), it.Norm(), seed=0)
    assert best.value == pytest.approx(2.4281, abs=5e-5)  # Wang and Su (2008), Table 1, J1 case 7
    assert best.parameters["c"] == pytest.approx(7544.2, abs=0.05)
    assert best.parameters["b"] == pytest.approx(366.52, abs=0.005)
    indices = [it.RideComfort(road), it.TyreLoad(road)]
    values = it.evaluate_many(car, indices, {"c": [7544.2, 6666.4], "b": [366.52, 363.55]}, it.Norm())
    assert values.shape == (2, 2)
    assert values[0, 0] == pytest.approx(2.4281, abs=1e-4)
    assert values[1, 1] == pytest.approx(501.20, abs=1e-2)
    assert it.evaluate(best.design, it.TyreLoad(road), it.Norm()).value > 501.20
    assert it.evaluate(best.design, it.LoadCarrying(), it.Norm()).value > 2.5946e-5
    system = it.state_space(best.design)
    assert (system.A.shape[0], system.B.shape[1], system.C.shape[0]) == tuple(
        map(len, (system.states, system.inputs, system.outputs))
    )
    compliance = system.subsystem("sprung_force", "strut_travel")
    assert it.hinf_norm(compliance).value == it.hinf_norm(compliance).peaks[0].gain
    assert it.h2_norm(system.subsystem("road", "sprung_acceleration")) * road.velocity_intensity == best.value
    parts = {"k": it.Spring(120e3), "c": it.Damper(7544.2), "b": it.Inerter(366.52)}
    omega = np.array([1.0, 10.0])
    expected = 120e3 / (1j * omega) + 1.0 / (1.0 / 7544.2 + 1.0 / (366.52 * 1j * omega))
    assert it.network("k | c - b", **parts).admittance(1j * omega) == pytest.approx(expected, rel=1e-13)


def test_half_car_of_the_first_release() -> None:
    road = it.Road(roughness=5e-7, speed=25)
    half = it.HalfCar(
        sprung_mass=363.5,
        pitch_inertia=200,
        unsprung_mass_front=25,
        unsprung_mass_rear=20,
        tyre_stiffness_front=120e3,
        tyre_stiffness_rear=100e3,
        distance_front=0.775,
        distance_rear=1.265,
        front=it.Spring(120e3) | it.Damper(3710.2),
        rear=it.Spring(120e3) | it.Damper(4385.6),
    )
    value = it.evaluate(half, it.RideComfort(road), it.Norm(conventions="paper2008")).value
    assert value == pytest.approx(6.1101, abs=1e-4)  # Wang and Su (2008), Table 2, J1 case 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("IndicatorError", "PerformanceIndexError"),
        ("RowError", "RegistryError"),
        ("UnknownRowError", "UnknownEntryError"),
    ],
)
def test_an_old_name_works_and_warns_with_the_new_one(old: str, new: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"`{new}`"):
        assert getattr(errors, old) is getattr(errors, new)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'NoError'"):
        _ = errors.NoError


def test_a_class_has_its_name_alone() -> None:
    homes: dict[str, list[str]] = {}
    for path in (ROOT / "src").rglob("*.py"):
        for name in re.findall(r"^class (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE):
            homes.setdefault(name, []).append(path.stem)
    assert len(homes) > 400
    assert {name: several for name, several in homes.items() if len(several) > 1} == {}


def test_every_old_name_is_that_of_a_new_one() -> None:
    assert not set(_OLD) & set(it.__all__)
    for old, new in _OLD.items():
        with pytest.warns(DeprecationWarning, match=f"`{old}` is now `{new}`"):
            assert getattr(it, old) is getattr(it, new)


def test_an_old_keyword_works_and_tells_the_new_one() -> None:
    @renamed_keywords(every="output_every")
    def sampled(count: int, output_every: int = 1) -> list[int]:
        return list(range(count))[::output_every]

    with pytest.warns(DeprecationWarning, match="`every` is now `output_every`") as warned:
        assert sampled(5, every=2) == [0, 2, 4]  # type: ignore[call-arg]
    assert warned[0].filename == __file__
    with pytest.raises(TypeError, match="both 'output_every' and its old name 'every'"):
        sampled(5, every=2, output_every=2)  # type: ignore[call-arg]


def test_old_names_are_no_attributes_of_a_class() -> None:
    """Tools that list the members of a result warn of nothing."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        members = dict(inspect.getmembers(it.Optimum))
    assert members["agreed"].new == "n_converged"


@pytest.mark.parametrize("make", [it.Norm, it.ExpectedValue, it.StatisticalLinearisation, it.ApproximateLinear])
def test_attributes_of_methods_have_their_old_names(make: type) -> None:
    names = {"sees": "nonlinearity_support", "words": "description", "searches": "supports_optimisation"}
    for old, new in names.items():
        with pytest.warns(DeprecationWarning, match=f"`{old}` is now `{new}`"):
            assert getattr(make(), old) == getattr(make(), new)


def test_a_method_written_with_the_old_names_is_one() -> None:
    class Halved:
        """A method of another distribution, written for 0.1."""

        name, sees, words, searches = "halved", it.Norm.nonlinearity_support, "half of the norm", False
        needs_amplitude = False
        estimate_many = objective = it.Norm.objective

        def estimate(self, vehicle: it.Vehicle, index: object) -> it.Estimate:
            return it.Estimate(0.5 * it.Norm().estimate(vehicle, index).value, "m/s^2")

    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | it.Damper(2e3))
    index = it.RideComfort(it.Road(5e-7, 25.0))
    with pytest.warns(DeprecationWarning, match="is now") as warned:
        found = it.evaluate(car, index, Halved())
    assert len(warned) == 3
    assert found.value == 0.5 * it.evaluate(car, index, it.Norm()).value
