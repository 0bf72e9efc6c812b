"""Honesty and speed of `identify`: coverage of its 95 % intervals over random virtual rigs, and seconds of a fit.

    python benchmarks/identification.py [RIGS]
    python benchmarks/identification.py explaining [SECONDS]

The second measures the whole answer to a long record (1 kHz, 20 s unless said) of a rig without a trouble and with a
force that is late and a load cell that drifts, which no cause explains alone.

Truths are drawn from wide ranges (logarithms of b, ks, cs; f and the half-gap evenly); the motion follows from the
truth: a slow cosine of 50 mm that moves the inerter against its friction, and five small cosines from 5 to 37 Hz.
Sensors: 1 um encoder with 0.2 um noise, a load cell of 5 kN with steps of 0.5 N, noise of 0.25 N and 300 Hz, 1 kHz.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import inerter as it

MODEL = (
    (it.Spring(it.free(1e4, 1e8, name="ks")) | it.Damper(it.free(10, 2e5, name="cs")))
    - it.Gap(it.free(0, 2e-3, name="gap"))
    - (it.Inerter(it.free(1, 5000, name="b")) | it.Friction(it.free(0, 400, name="f")))
)
NAMES = ("ks", "cs", "gap", "b", "f")
SENSORS = {"table_bandwidth": 60.0, "force_range": 5e3, "force_resolution": 0.5, "force_noise": 0.25}
AMPLITUDE = 0.05  # [m]
TONES = (5.2, 9.4, 15.8, 26.2, 37.4)  # [Hz]


def truth(random: np.random.Generator) -> dict[str, float]:
    def between(lower: float, upper: float) -> float:
        return math.exp(random.uniform(math.log(lower), math.log(upper)))

    return {
        "b": between(5.0, 500.0),
        "f": random.uniform(0.0, 100.0),
        "ks": between(1e5, 1e7),
        "cs": between(1e2, 2e4),
        "gap": random.uniform(0.0, 5e-4),
    }


def command(values: dict[str, float], random: np.random.Generator) -> it.Signal:
    """Accelerations whose force is 150 N, or one and a half times the friction; tones of a twelfth of that each."""
    omega = math.sqrt(max(150.0, 1.5 * values["f"]) / (values["b"] * AMPLITUDE))
    frequency = min(max(0.2 * round(omega / (2.0 * math.pi) / 0.2), 0.4), 3.0)
    force = values["b"] * (2.0 * math.pi * frequency) ** 2 * AMPLITUDE
    linear = it.Rig(MODEL).with_values({**values, "gap": 0.0, "f": 0.0}).device
    signal = it.cosine(amplitude=AMPLITUDE, frequency=frequency)
    for tone in TONES:
        omega = 2.0 * math.pi * tone
        stiffness = abs(linear.admittance(1j * omega)) * omega
        amplitude = 0.08 * max(force, values["f"]) / stiffness
        signal = signal + it.cosine(amplitude=amplitude, frequency=tone, phase=random.uniform(0.0, 2.0 * math.pi))
    return signal


def case(number: int) -> tuple[int, dict[str, float], dict[str, tuple[bool, bool, float]], str, float]:
    """For each parameter whether it was identified, whether its interval holds the truth, and its relative error."""
    random = np.random.default_rng([7, number])
    values = truth(random)
    rig = it.VirtualRig(it.Rig(MODEL).with_values(values).device, seed=number, **SENSORS)
    record = rig.run(command(values, random), duration=5.0)
    begun = time.perf_counter()
    fit = it.identify(record, MODEL, seed=0)
    seconds = time.perf_counter() - begun
    found = {
        name: (
            bool(fit.identifiable[name]),
            fit.parameters[name].interval[0] <= values[name] <= fit.parameters[name].interval[1],
            fit.parameters[name].best / values[name] - 1.0,
        )
        for name in NAMES
    }
    return number, values, found, fit.status.kind.value, seconds


def coverage(count: int) -> None:
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    held, identified, errors = Counter(), Counter(), {name: [] for name in NAMES}
    statuses, seconds = Counter(), []
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for number, values, found, status, took in pool.map(case, range(count)):
            statuses[status] += 1
            seconds.append(took)
            missed = [name for name in NAMES if found[name][0] and not found[name][1]]
            if missed:
                shown = ", ".join(f"{name} = {values[name]:.4g} ({100 * found[name][2]:+.3f} %)" for name in missed)
                print(f"  rig {number}: not in the interval: {shown}", flush=True)
            for name in NAMES:
                identified[name] += found[name][0]
                held[name] += found[name][0] and found[name][1]
                if found[name][0]:
                    errors[name].append(abs(found[name][2]))
    print(f"{count} rigs: {dict(statuses)}; median {np.median(seconds):.1f} s a fit on busy cores")
    for name in NAMES:
        share = held[name] / max(identified[name], 1)
        print(
            f"  {name:4s} identified {identified[name]:4d}, interval holds the truth in {100 * share:5.1f} %, ", end=""
        )
        print(f"median error {100 * np.median(errors[name]):.3f} %")


def speed() -> None:
    """The fit of a 5 s record at 1 kHz with five parameters, after a first call."""
    values = {"ks": 1e6, "cs": 3200.0, "gap": 0.0, "b": 113.0, "f": 10.0}
    record = it.VirtualRig(it.Rig(MODEL).with_values(values).device).run(it.cosine(1e-3, 3.0), duration=5.0)
    times = []
    for _ in range(4):
        begun = time.perf_counter()
        fit = it.identify(record, MODEL, seed=0)
        times.append(time.perf_counter() - begun)
    print(f"five parameters, 5 s at 1 kHz: {min(times[1:]):.1f} s, {fit.simulations} simulations")


def explaining(seconds: float) -> None:
    """Seconds of the processor for the answer to a sound record, and to one with two troubles."""
    values = {"ks": 1e6, "cs": 3200.0, "gap": 0.0, "b": 113.0, "f": 10.0}
    rig = it.VirtualRig(it.Rig(MODEL).with_values(values).device, sampling=1000.0)
    motion = it.cosine(3e-3, 1.3) + it.cosine(8e-4, 3.1) + it.cosine(2e-4, 7.9)
    late = it.VirtualRig(rig.device, force_delay=2e-3).run(motion, duration=seconds)
    troubled = late.with_notes(force=late.force + 20.0 * (late.time / seconds) ** 2)
    it.identify(rig.run(motion, duration=2.0), MODEL, seed=0, delay=False)  # compiles
    for name, record in (("sound", rig.run(motion, duration=seconds)), ("troubled", troubled)):
        begun = time.process_time()
        fit = it.identify(record, MODEL, seed=0, delay=False)
        took = time.process_time() - begun
        causes = ", ".join(f"{e.name} {100.0 * e.explained:.0f} %" for e in fit.explanations[:3])
        print(f"{name}, {record.time.size} samples: {took:.0f} s of the processor, {fit.simulations} simulations")
        print(f"  {fit.status.kind.value}; {causes or 'no causes'}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["explaining"]:
        explaining(float(sys.argv[2]) if len(sys.argv) > 2 else 20.0)
        sys.exit()
    speed()
    coverage(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
