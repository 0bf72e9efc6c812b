"""Random members of the families that the campaigns go through: what is simulated, and by which signals."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from mechanisms import log_uniform, random_network
from wang_su import paper_half_car

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, Mechanism, QuarterCar, Rig, Road, Signal, Spring
from inerter.networks.elements import Network
from inerter.vehicle.vehicle import Vehicle

SPEED = 25.0
DURATION = 1.0


@dataclass(frozen=True)
class Member:
    """What to simulate: the vehicle, the keywords that move it, and in words what both are."""

    vehicle: Vehicle
    inputs: dict[str, object]
    kind: str

    @property
    def gaps(self) -> bool:
        mounts = self.vehicle.mechanism().mounts()
        return any(isinstance(e, Gap) for mount in mounts for e in mount.network.elements())


def base(rng: np.random.Generator) -> Network:
    return Spring(log_uniform(rng, 2e4, 2e5)) | Damper(log_uniform(rng, 300.0, 6e3))


def friction(rng: np.random.Generator) -> Friction:
    return Friction(log_uniform(rng, 2.0, 600.0))


def shaft(rng: np.random.Generator) -> Network:
    return Spring(log_uniform(rng, 1e5, 3e6)) | Damper(log_uniform(rng, 500.0, 5e3))


def screw(rng: np.random.Generator, gap: bool = False) -> Network:
    flywheel = Inerter(log_uniform(rng, 5.0, 500.0)) | friction(rng)
    return shaft(rng) - Gap(log_uniform(rng, 2e-5, 5e-4)) - flywheel if gap else shaft(rng) - flywheel


STRUTS: dict[str, Callable[[np.random.Generator], Network]] = {
    "k | c | f": lambda rng: base(rng) | friction(rng),
    "k | c | b | f": lambda rng: base(rng) | Inerter(log_uniform(rng, 5.0, 500.0)) | friction(rng),
    "k | c - (b | f)": lambda rng: (
        Spring(log_uniform(rng, 2e4, 2e5))
        | Damper(log_uniform(rng, 1e3, 1e4)) - (Inerter(log_uniform(rng, 50.0, 500.0)) | friction(rng))
    ),
    "k | c - screw": lambda rng: Spring(log_uniform(rng, 2e4, 2e5)) | Damper(log_uniform(rng, 1e3, 1e4)) - screw(rng),
    "k | c | screw": lambda rng: base(rng) | screw(rng),
    "k | c | (k - f)": lambda rng: base(rng) | Spring(log_uniform(rng, 1e4, 1e6)) - friction(rng),
    "k | c | f | (k - f)": lambda rng: base(rng) | friction(rng) | Spring(log_uniform(rng, 1e4, 1e6)) - friction(rng),
    "k | c | f - b": lambda rng: base(rng) | friction(rng) - Inerter(log_uniform(rng, 5.0, 500.0)),
    "k | c | f | f": lambda rng: base(rng) | friction(rng) | friction(rng),
    "k | c - screw with play": lambda rng: (
        Spring(log_uniform(rng, 2e4, 2e5)) | Damper(log_uniform(rng, 1e3, 1e4)) - screw(rng, gap=True)
    ),
    "any": lambda rng: base(rng) | random_network(rng, int(rng.integers(1, 4))),
}
DEVICES: dict[str, Callable[[np.random.Generator], Network]] = {
    "screw": screw,
    "screw with play": lambda rng: screw(rng, gap=True),
    "k - (c | f)": lambda rng: (
        Spring(log_uniform(rng, 1e5, 3e6)) - (Damper(log_uniform(rng, 100.0, 5e3)) | friction(rng))
    ),
    "k - f - (b | f)": lambda rng: shaft(rng) - friction(rng) - (Inerter(log_uniform(rng, 5.0, 500.0)) | friction(rng)),
    "any": lambda rng: shaft(rng) - random_network(rng, int(rng.integers(1, 4))),
}


def drawn(rng: np.random.Generator, table: dict[str, Callable[[np.random.Generator], Network]]) -> tuple[str, Network]:
    name = str(rng.choice(list(table)))
    return name, table[name](rng)


def quarter_car(rng: np.random.Generator) -> tuple[str, Vehicle, str]:
    name, strut = drawn(rng, STRUTS)
    car = QuarterCar(log_uniform(rng, 100.0, 600.0), log_uniform(rng, 15.0, 60.0), log_uniform(rng, 8e4, 3e5), strut)
    return f"quarter car, {name}", car, "road"


def half_car(rng: np.random.Generator) -> tuple[str, Vehicle, str]:
    (front, first), (rear, second) = drawn(rng, STRUTS), drawn(rng, STRUTS)
    return (
        f"half car, {front} and {rear}",
        paper_half_car(first, second),
        "road",
    )


def custom(rng: np.random.Generator) -> tuple[str, Vehicle, str]:
    """A body on two or three axles in bounce and pitch, with a seat on it."""
    levers = {"front": 1.6, "middle": -0.4, "rear": -1.4}
    if rng.random() < 0.5:
        del levers["middle"]
    name, network = drawn(rng, STRUTS)
    car = Mechanism(
        coordinates=(
            it.Coordinate("seat", 60.0),
            it.Coordinate("body", 900.0),
            it.Coordinate("pitch", 800.0, angle=True),
            *(it.Coordinate(f"{axle}_wheel", 40.0) for axle in levers),
        ),
        struts=(
            it.Strut("cushion", base(rng) | friction(rng), {"seat": 1.0}, {"body": 1.0, "pitch": 0.3}),
            *(
                it.Strut(
                    axle, network if axle != "rear" else base(rng), {"body": 1.0, "pitch": x}, {f"{axle}_wheel": 1.0}
                )
                for axle, x in levers.items()
            ),
        ),
        tyres=tuple(it.Tyre(f"{a}_tyre", Spring(200e3), {f"{a}_wheel": 1.0}, f"{a}_road") for a in levers),
        roads=tuple(it.RoadInput(f"{a}_road", distance=levers["front"] - x) for a, x in levers.items()),
    )
    return f"{len(levers)} axles and a seat, {name}", car, "road"


def rig(rng: np.random.Generator) -> tuple[str, Vehicle, str]:
    name, device = drawn(rng, DEVICES)
    return f"rig, {name}", Rig(device), "displacement"


@cache
def profile_file() -> Path:
    """Heights every quarter of a metre along 60 m."""
    rng = np.random.default_rng(7)
    path = Path(tempfile.mkdtemp()) / "road.csv"
    height = 2.0 * np.cumsum(rng.standard_normal(241))
    rows = "\n".join(f"{0.25 * i},{h - height[0]:.6f}" for i, h in enumerate(height))
    path.write_text(f"distance [m],height [mm]\n{rows}\n")
    return path


def table(rng: np.random.Generator, size: float, hold: str) -> Signal:
    """Samples at uneven times; some tables stand still for a while."""
    time = np.concatenate([[0.0], np.cumsum(rng.uniform(2e-3, 3e-2, 400))])
    value = size * 0.3 * np.cumsum(rng.standard_normal(time.size))
    if rng.random() < 0.5:
        value[20:60] = value[20]
    value -= value[0]
    slope = np.gradient(value, time)  # without overshoot: a spline would ring on down to the size of rounding
    slope[20:60][np.diff(value[20:61]) == 0.0] = 0.0
    return Signal.sampled(time, value, hold, slope if hold == "cubic" else None, speed=SPEED)


SIGNALS: dict[str, Callable[[np.random.Generator, float], Signal]] = {
    "sine": lambda rng, a: it.sine(a, log_uniform(rng, 0.5, 15.0), rng.uniform(0.0, 6.0), speed=SPEED),
    "multisine": lambda rng, a: (
        it.multisine(Road(5e-7, SPEED), seed=int(rng.integers(1 << 30)), lowest=0.5, highest=100.0) * (a / 0.01)
    ),
    "held noise": lambda rng, a: it.held_noise(
        int(rng.integers(1 << 30)), (0.3 * a) ** 2 * 1e-2, interval=1e-2, duration=4.0, speed=SPEED
    ),
    "chirp": lambda rng, a: it.chirp(a, 0.5, log_uniform(rng, 3.0, 20.0), 4.0, speed=SPEED),
    "step": lambda rng, a: it.step(a, rng.uniform(0.0, 0.5), speed=SPEED),
    "bump": lambda rng, a: it.bump(4.0 * a, log_uniform(rng, 0.5, 5.0), SPEED, rng.uniform(0.0, 0.3)),
    "profile": lambda rng, a: it.profile(profile_file(), SPEED) * (a / 0.01),
    "cubic table": lambda rng, a: table(rng, a, "cubic"),
    "lines": lambda rng, a: table(rng, a, "linear"),
    "held table": lambda rng, a: table(rng, a, "zero"),
    "held sine": lambda rng, a: it.sine(a, 2.0, speed=SPEED).held(rng.choice([2e-3, 5e-3, 7e-3, 0.01]), duration=6.0),
    "sum": lambda rng, a: (
        it.sine(a, log_uniform(rng, 0.5, 5.0), speed=SPEED) + it.bump(a, 1.0, SPEED, 0.2) + table(rng, 0.3 * a, "cubic")
    ),
    "sum with steps": lambda rng, a: it.sine(a, 2.0, speed=SPEED) + it.step(a, rng.uniform(0.0, 0.5)) * 0.3,
}
_SMOOTH = ("sine", "multisine", "chirp", "bump", "profile", "cubic table", "sum")


def member(seed: int) -> Member:
    """A car, rig or custom mechanism and a signal of any kind that it takes."""
    rng = np.random.default_rng([seed, 12])
    made = (quarter_car, quarter_car, half_car, custom, rig)[seed % 5]
    words, vehicle, keyword = made(rng)
    size = log_uniform(rng, 1e-3, 2e-2) * (0.1 if keyword == "displacement" else 1.0)
    name = str(rng.choice(list(SIGNALS if keyword == "road" else _SMOOTH)))
    return Member(vehicle, {keyword: SIGNALS[name](rng, size)}, f"{words}; {name}")


WIDE = {Spring: (1e-2, 1e10), Damper: (1e-3, 1e8), Inerter: (1e-6, 1e6), Friction: (1e-9, 1e9), Gap: (1e-9, 0.1)}
PLAIN = {Spring: (2e4, 1e6), Damper: (300.0, 1e4), Inerter: (5.0, 500.0), Friction: (2.0, 600.0), Gap: (2e-5, 5e-4)}


def stopping(rng: np.random.Generator, size: float) -> Signal:
    """A motion that ends: what follows stands still for the rest of the run."""
    end = rng.uniform(0.1, 0.5)
    time = np.concatenate([np.linspace(0.0, end, 12), [6.0]])
    value = size * rng.standard_normal(13)
    value[-1], slope = value[-2], np.zeros(13)
    hold = str(rng.choice(["cubic", "linear", "zero"]))
    return Signal.sampled(time, value - value[0], hold, slope if hold == "cubic" else None, speed=SPEED)


def nothing(rng: np.random.Generator, size: float) -> Signal:
    return Signal.sampled([0.0, 6.0], [size, size], speed=SPEED)


def extreme(seed: int) -> Member:
    """Elements and masses over many decades, frictions side by side, none or huge, and signals that stop."""
    rng = np.random.default_rng([seed, 13])
    ranges = {kind: WIDE[kind] if rng.random() < 0.5 else PLAIN[kind] for kind in WIDE}

    def value(kind: type) -> float:
        if kind in (Friction, Gap) and rng.random() < 0.08:
            return 0.0
        return log_uniform(rng, *ranges[kind])

    def leaves(count: int, kinds: tuple[type, ...]) -> list[Network]:
        return [kind(value(kind)) for kind in rng.choice(np.array(kinds, dtype=object), count)]

    def joined(parts: list[Network]) -> Network:
        while len(parts) > 1:
            i = int(rng.integers(len(parts) - 1))
            parts[i : i + 2] = [parts[i] | parts[i + 1] if rng.random() < 0.6 else parts[i] - parts[i + 1]]
        return parts[0]

    some = leaves(int(rng.integers(1, 4)), (Friction, Friction, Gap))
    some += leaves(int(rng.integers(1, 4)), (Spring, Damper, Inerter))
    network = joined([some[i] for i in rng.permutation(len(some))])
    size = log_uniform(rng, 1e-6, 0.1)
    made = dict(SIGNALS) | {"stopping": stopping, "nothing": nothing}
    name = str(rng.choice(["stopping"] * 6 + ["nothing"] + list(made)))
    mass = lambda: log_uniform(rng, *((1e-3, 1e6) if ranges[Inerter] is WIDE[Inerter] else (10.0, 1000.0)))  # noqa: E731
    if seed % 3 == 0:
        smooth = name if name in _SMOOTH else "cubic table"
        return Member(
            Rig((Spring(value(Spring)) | Damper(value(Damper))) - network),
            {"displacement": SIGNALS[smooth](rng, size)},
            f"rig, wide; {smooth}",
        )
    strut = (Spring(value(Spring)) | Damper(value(Damper)) | network) if rng.random() < 0.7 else network
    return Member(QuarterCar(mass(), mass(), value(Spring), strut), {"road": made[name](rng, size)}, f"wide; {name}")
