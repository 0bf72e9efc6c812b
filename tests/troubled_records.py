"""Random rigs with random troubles, and what an identification should say of each."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from troubled_rig import Device, Sensors, Tones, measured

import inerter as it

LAYOUTS = ("rigid", "elastic", "backlash")
_SHAFT = it.Spring(it.free(1e4, 1e8, name="ks")) | it.Damper(it.free(10.0, 2e5, name="cs"))
_GAP = it.Gap(it.free(0.0, 2e-3, name="gap"))
_B, _F = it.Inerter(it.free(0.5, 5000.0, name="b")), it.Friction(it.free(0.0, 500.0, name="f"))
_C = it.Damper(it.free(1.0, 2e4, name="c"))


@dataclass(frozen=True)
class Case:
    """A device on a rig, how it is moved and read, and what is wrong with it."""

    device: Device
    motion: Tones
    sensors: Sensors
    layout: str  # of the model that is fitted
    fault: str = "none"
    duration: float = 5.0

    @property
    def truth(self) -> dict[str, float]:
        """Of every parameter that a model may have; a rigid device has a shaft of no softness."""
        d = self.device
        return {"b": d.b, "f": d.f, "ks": d.ks or math.inf, "cs": d.cs or math.inf, "gap": d.gap, "c": d.c}


def clean(number: int, stream: int = 11) -> tuple[Case, np.random.Generator]:
    """A rig without a fault, and the random numbers that go on from it."""
    random = np.random.default_rng([stream, number])
    layout = LAYOUTS[int(random.choice(3, p=(0.25, 0.55, 0.2)))]
    b, f = _between(random, 15.0, 250.0), random.uniform(5.0, 40.0)
    ks, cs = _between(random, 2e5, 3e6), _between(random, 4e2, 8e3)
    gap = random.uniform(2e-5, 2e-4) if layout == "backlash" else 0.0
    c = random.uniform(10.0, 80.0) if layout == "rigid" and random.random() < 0.5 else 0.0
    device = Device(b, f, 0.0 if layout == "rigid" else ks, 0.0 if layout == "rigid" else cs, gap, c)
    return Case(device, _motion(random, b, f), Sensors(), layout), random


def troubled(number: int, stream: int = 12) -> Case:
    """A rig with one fault; they take turns."""
    case, random = clean(number, stream)
    names = list(FAULTS)
    name = names[number % len(names)]
    return replace(FAULTS[name](case, random), fault=name)


def sticking(number: int, stream: int = 13) -> Case:
    """A rig without a fault, on which the friction holds the inertance all the time."""
    random = np.random.default_rng([stream, number])
    b, ks, cs = _between(random, 15.0, 250.0), _between(random, 1e4, 1e6), _between(random, 50.0, 2e3)
    frequencies = np.sort(np.exp(random.uniform(np.log(0.5), np.log(12.0), size=random.integers(1, 6))))
    amplitudes = np.minimum(
        random.uniform(0.3, 1.0, frequencies.size) * 20.0 / np.abs(ks + 2j * np.pi * frequencies * cs), 0.02
    )
    motion = Tones(tuple(amplitudes.tolist()), tuple(frequencies.tolist()), tuple((0.0 * frequencies).tolist()))
    moved, speed, _ = motion.at(np.arange(0.0, 5.0, 1e-3))
    held = float(np.abs(ks * moved + cs * speed).max())
    return Case(Device(b, held * random.uniform(1.01, 2.5), ks, cs), motion, Sensors(), "elastic")


def _between(random: np.random.Generator, lower: float, upper: float) -> float:
    return math.exp(random.uniform(math.log(lower), math.log(upper)))


def _motion(random: np.random.Generator, b: float, f: float) -> Tones:
    """One cosine, a few or many: with accelerations whose force is that of the friction twice, or more."""
    kind = random.choice(["cosine", "tones", "multisine"])
    force = max(random.uniform(60.0, 300.0), 2.0 * f)
    if kind == "cosine":
        frequencies = np.array([random.uniform(1.0, 5.0)])
    elif kind == "tones":
        frequencies = np.sort(np.exp(random.uniform(np.log(0.5), np.log(12.0), size=random.integers(3, 7))))
    else:
        frequencies = 0.2 * np.arange(2, 2 + 5 * random.integers(4, 9), 2) * random.uniform(0.8, 1.2)
    omega = 2.0 * np.pi * frequencies
    share = random.uniform(0.3, 1.0, frequencies.size)
    share *= force / math.sqrt(float(np.sum(share**2)))
    amplitudes = np.minimum(share / (b * omega**2), 0.04)
    phases = random.uniform(0.0, 2.0 * np.pi, frequencies.size)
    return Tones(tuple(amplitudes.tolist()), tuple(frequencies.tolist()), tuple(phases.tolist()))


Fault = Callable[[Case, np.random.Generator], Case]


def _of_device(**ranges: Callable[[Case, np.random.Generator], float]) -> Fault:
    return lambda case, random: replace(
        case, device=replace(case.device, **{name: draw(case, random) for name, draw in ranges.items()})
    )


def _of_sensors(**ranges: Callable[[Case, np.random.Generator], object]) -> Fault:
    return lambda case, random: replace(
        case, sensors=replace(case.sensors, **{name: draw(case, random) for name, draw in ranges.items()})
    )


def _fastest(case: Case) -> float:
    return float(np.abs(case.motion.at(np.arange(0.0, case.duration, 1e-3))[1]).max())


def _stroke(case: Case) -> float:
    return float(np.abs(case.motion.at(np.arange(0.0, case.duration, 1e-3))[0]).max())


def _sign(random: np.random.Generator) -> float:
    return float(random.choice([-1.0, 1.0]))


def _losses(case: Case, random: np.random.Generator) -> tuple[tuple[float, int], ...]:
    places = np.sort(random.uniform(0.15, 0.95, random.integers(1, 4)))
    return tuple((float(place), int(random.integers(2, 9))) for place in places)


def _rigid(case: Case, random: np.random.Generator) -> Case:
    """A device in which nothing gives way, taken for one with a shaft."""
    device = replace(case.device, ks=0.0, cs=0.0, gap=0.0)
    return replace(case, device=device, layout="elastic" if case.layout == "rigid" else case.layout)


FAULTS: dict[str, Fault] = {
    "stribeck": _of_device(
        static=lambda case, random: random.uniform(1.4, 2.5),
        stribeck_speed=lambda case, random: _fastest(case) * _between(random, 0.05, 0.4),
    ),
    "viscous": _of_device(
        c=lambda case, random: case.device.f * random.uniform(0.15, 1.0) / _fastest(case),
    ),
    "asymmetric": _of_device(bias=lambda case, random: _sign(random) * random.uniform(0.1, 0.4)),
    "position": _of_device(
        slope=lambda case, random: _sign(random) * random.uniform(0.2, 0.6) / _stroke(case),
    ),
    "filtered displacement": _of_sensors(
        displacement_filter=lambda case, random: _between(random, 40.0, 100.0),
        filter_order=lambda case, random: int(random.integers(1, 3)),
    ),
    "late displacement": _of_sensors(displacement_late=lambda case, random: random.uniform(5e-4, 4e-3)),
    "late force": _of_sensors(force_late=lambda case, random: random.uniform(5e-4, 4e-3)),
    "filtered force": _of_sensors(amplifier=lambda case, random: _between(random, 30.0, 90.0)),
    "lost samples": _of_sensors(lost=_losses),
    "drift": _of_sensors(
        drift=lambda case, random: _sign(random) * random.uniform(5.0, 25.0),
        drift_shape=lambda case, random: str(random.choice(["line", "warming", "slow"])),
    ),
    "fixture": _of_sensors(fixture=lambda case, random: case.device.b * random.uniform(0.02, 0.1)),
    "rigid": _rigid,
}

NAMES = {
    "stribeck": "Stribeck friction",
    "viscous": "viscous friction",
    "asymmetric": "asymmetric friction",
    "position": "friction by position",
    "filtered displacement": "filtered displacement",
    "late displacement": "displacement is delayed",
    "late force": "force is delayed",
    "filtered force": "filtered force",
    "lost samples": "lost samples",
    "drift": "drift",
    "rigid": "rigid device",
}


def fits_fault(fault: str, explanations: list[tuple[str, str]], notes: list[str]) -> bool:
    """Whether a fault is among these explanations (name, sentence), or told in the notes."""
    said = [text for pair in explanations for text in pair] + notes
    return any(NAMES.get(fault, "?") in text for text in said)


def model_of(case: Case) -> it.Network:
    """What one would fit who knows the layout of the device, and nothing of its trouble."""
    beside = _B | _F | _C if case.device.c and case.fault != "viscous" else _B | _F
    if case.layout == "rigid":
        return beside
    return _SHAFT - beside if case.layout == "elastic" else _SHAFT - _GAP - beside


def record_of(case: Case, seed: int) -> it.Record:
    """The record of a case; a mass that moves with the table is known."""
    time, displacement, force = measured(case.device, case.motion, case.sensors, case.duration, seed)
    return it.Record(
        time,
        displacement,
        force,
        source=f"{case.layout}, {case.fault}",
        force_bandwidth=case.sensors.cell,
        force_range=5e3,
        fixture_mass=case.sensors.fixture or None,
    )
