"""Valid files of every kind with quantities over all magnitudes that `inerter check` accepts, as random texts.

A base is a small file that is solved in a second. Each of its quantities, or some of them, is multiplied by a power of
ten; those in the same group (times and frequencies of a motion, the bounds of a free value) keep what makes the file
valid: whole numbers of steps, bounds in order.
"""

from __future__ import annotations

import random
import re
from dataclasses import dataclass

from study_text import HALF_CAR

_CAR = """
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
"""
_HALF = f"\n[vehicle]\n{HALF_CAR}\n"
_FULL = """
[vehicle]
model = "full-car"
sprung_mass = "1200 kg"
pitch_inertia = "1500 kg m^2"
roll_inertia = "450 kg m^2"
unsprung_mass_front = "40 kg"
unsprung_mass_rear = "35 kg"
tyre_stiffness_front = "180 kN/m"
tyre_stiffness_rear = "180 kN/m"
distance_front = "1.2 m"
distance_rear = "1.4 m"
track_front = "1.5 m"
track_rear = "1.5 m"
"""
_ABSORBER = """
[vehicle]
model = "absorber"
primary_mass = "1000 kg"
primary_stiffness = "40 kN/m"
primary_damping = "100 N s/m"
mass = "50 kg"
"""
_ROAD = '[road]\nspeed = "25 m/s"\nroughness = "5e-7 m^3/cycle"\n'
_FREE = """
[elements]
k = "60 kN/m"
c = { from = "100 N s/m", to = "100000 N s/m" }
b = { from = "1 kg", to = "2000 kg" }
[layouts]
S1 = "k | c"
S3 = "k | c - b"
"""
_FIXED = """
[elements]
k = "60 kN/m"
c = "3 kN s/m"
b = "100 kg"
f = "30 N"
[layouts]
S1 = "k | c"
S2 = "k | c | (b | f)"
"""
_DEVICE = """
[elements]
ks = "1000 kN/m"
cs = "3200 N s/m"
b = "113 kg"
f = "10 N"
g = "0.1 mm"
[layouts]
"""
_TIMED = '[signal]\nkind = "cosine"\namplitude = "1 mm"\nfrequency = "5 Hz"\n'

BASES: dict[str, tuple[str, str]] = {  # the command, and the text
    "best designs": ("run", f'{_CAR}{_ROAD}{_FREE}[study]\nindices = ["J1", "J5"]\noptimise = "norm"\n'),
    "half car": ("run", f'{_HALF}{_ROAD}{_FIXED}[study]\nindices = ["J1", "J3"]\n'),
    "full car": ("run", f'{_FULL}{_ROAD}coherence = {{ track = "1.5 m" }}\n{_FIXED}[study]\nindices = ["J1"]\n'),
    "absorber": ("run", f'{_ABSORBER}{_FREE}[study]\nindices = ["J5"]\noptimise = "norm"\n'),
    "statistical": (
        "run",
        f'{_CAR}{_ROAD}{_FIXED}[study]\nindices = ["J1", "J5"]\nevaluate = ["norm", "statistical-linearisation"]\n'
        'force = "1 kN"\n',
    ),
    "sweep": (
        "run",
        f'{_CAR}{_ROAD}{_FIXED}[study]\nindices = ["J1", "J3"]\nhigh_pass = "1 Hz"\n'
        'sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 5 } }\n',
    ),
    "map": (
        "run",
        f'{_CAR}{_ROAD}{_FIXED}[study]\nindices = ["J3"]\n[study.sweep]\nroad.speed = ["40 km/h", "80 km/h"]\n'
        'k = ["30 kN/m", "90 kN/m"]\n',
    ),
    "limits": (
        "run",
        f'{_CAR}{_ROAD}{_FREE}[study]\nindices = ["J1"]\noptimise = "norm"\n'
        '[study.subject_to]\nsuspension-travel = { at_most = "8 mm" }\n',
    ),
    "conditions": (
        "run",
        f'{_CAR}{_ROAD}{_FIXED}[study]\nindices = ["J1"]\nconditions = "mean"\n[[conditions]]\nname = "empty"\n'
        'share = 0.3\n[[conditions]]\nname = "loaded"\nroad.speed = "30 m/s"\nvehicle.sprung_mass = "320 kg"\n'
        "share = 0.7\n",
    ),
    "tolerances": (
        "run",
        f'{_CAR}{_ROAD}{_FIXED}[study]\nindices = ["J1"]\ntolerance = {{ k = "5 %", c = "15 %", b = "5 %" }}\n',
    ),
    "responses": (
        "run",
        f"{_ABSORBER}{_FIXED}"
        '[indices.sway]\nkind = "random-response"\noutputs = { primary_relative_displacement = 1.0 }\n'
        'excitation = { ground_acceleration = "0.02 (m/s^2)^2/Hz" }\n'
        '[indices.stroke]\nkind = "element-stroke"\nelement = "k"\n'
        'excitation = { force = "primary_force", intensity = "1 N^2/Hz" }\n'
        '[study]\nindices = ["sway", "stroke", "J5"]\n',
    ),
    "stick and slip": (
        "simulate",
        f'{_CAR}{_FIXED.replace("S1", "S0")}{_TIMED}[simulation]\nlayout = "S2"\nduration = "1 s"\nstep = "1 ms"\n'
        "energy = true\n",
    ),
    "rattle": (
        "simulate",
        f'[vehicle]\nmodel = "rig"\n{_DEVICE}screw = "(ks | cs) - g - (b | f)"\n{_TIMED}[simulation]\n'
        'duration = "1 s"\nstep = "0.5 ms"\n',
    ),
    "stepping": (
        "simulate",
        f'{_CAR}{_FIXED}{_TIMED}[simulation]\nlayout = "S2"\nintegrator = "time-stepping"\nduration = "0.5 s"\n'
        'step = "0.1 ms"\n',
    ),
    "periodic": (
        "simulate",
        f'{_HALF}[road]\nspeed = "25 m/s"\n{_FIXED}{_TIMED}[simulation]\nlayout = "S2"\ninitial = "periodic"\n'
        'step = "1 ms"\n',
    ),
    "random road": (
        "simulate",
        f'{_CAR}{_ROAD}{_FIXED}[signal]\nkind = "multisine"\nlowest = "1 Hz"\nhighest = "100 Hz"\n[simulation]\n'
        'layout = "S2"\nduration = "1 s"\nstep = "1 ms"\n',
    ),
    "rig": (
        "rig",
        f'{_DEVICE}screw = "(ks | cs) - (b | f)"\n{_TIMED}[rig]\nduration = "1 s"\nsampling = "1 kHz"\n'
        'encoder_resolution = "1 um"\nforce_range = "981 N"\nforce_noise = "0.1 N"\n',
    ),
}
_TIMES = ("duration", "step", "frequency", "sampling", "lowest", "highest")  # that move together in a motion
_QUANTITY = re.compile(r'(?P<key>[\w.]+) = "(?P<number>[\d.e+-]+) (?P<unit>[^"%]+)"')
_RANGE = re.compile(r'from = "(?P<low>[\d.e+-]+) (?P<unit>[^"]+)", to = "(?P<high>[\d.e+-]+) (?P=unit)"')
_REACHES = {  # decades to either side: a motion is refused where double precision cannot compute it
    "run": (1.0, 3.0, 10.0, 25.0, 44.0),
    "simulate": (0.5, 1.0, 3.0, 6.0, 9.0),
    "rig": (0.5, 1.0, 3.0, 6.0, 9.0),
}
_WIDEST = 22.0  # decades between bounds


@dataclass(frozen=True)
class Extreme:
    """A file, and the command that takes it."""

    seed: int
    base: str
    command: str
    text: str


def extreme(seed: int) -> Extreme:
    """The file of that seed: every base in turn, with all or some quantities changed by up to 44 decades."""
    draw = random.Random(seed)
    base = list(BASES)[seed % len(BASES)]
    command, text = BASES[base]
    reach, share = draw.choice(_REACHES[command]), draw.choice([0.2, 0.5, 1.0])
    time = 10.0 ** draw.uniform(-reach, reach) if draw.random() < share else 1.0

    def factor() -> float:
        return 10.0 ** draw.uniform(-reach, reach) if draw.random() < share else 1.0

    def bounds(found: re.Match[str]) -> str:
        low = float(found["low"]) * factor()
        high = low * 10.0 ** draw.uniform(0.05, min(_WIDEST, 2.0 * reach))
        return f'from = "{low:.6g} {found["unit"]}", to = "{high:.6g} {found["unit"]}"'

    def quantity(found: re.Match[str]) -> str:
        value = float(found["number"])
        if command != "run" and found["key"] in _TIMES:
            value = value * time if found["key"] in ("duration", "step") else value / time
            return f'{found["key"]} = "{value!r} {found["unit"]}"'
        if found["key"] in ("from", "to"):
            return found[0]
        return f'{found["key"]} = "{value * factor():.6g} {found["unit"]}"'

    return Extreme(seed, base, command, _QUANTITY.sub(quantity, _RANGE.sub(bounds, text)))


def what_is_wrong(code: int, out: str, err: str, seconds: float, limit: float) -> list[str]:
    """Faults of an answer to a file that `check` accepts: it ends in time, in a result or in one sentence."""
    faults = []
    if seconds > limit:
        faults.append(f"took {seconds:.0f} s")
    if "Traceback" in err or "Warning:" in err.replace("inerter: Warning:", ""):
        faults.append(f"no sentence: {err.strip().splitlines()[-1][:200]}")
    if code == 2:
        faults.append(f"check accepts what is refused: {err.strip()[:300]}")
    if code not in (0, 1, 2):
        faults.append(f"exit code {code}")
    if code == 1 and not err.strip():
        faults.append("no reason for a failure")
    faults += [f"a line of {len(line)} characters" for line in out.splitlines() if len(line) > 160][:1]
    faults += [f"an absurd number {number}" for number in re.findall(r"\d{17,}", out)][:1]
    values = re.findall(r"(?<![\w-])(?:nan|inf)\b", out)
    if values and not err.strip() and "Note" not in out and not re.search(r"infinite|no value|unstable|undamped", out):
        faults.append(f"{values[0]} without a reason")
    return faults
