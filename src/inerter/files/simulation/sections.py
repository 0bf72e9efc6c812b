"""The keys of a simulation file: what it shares with study files, [signal] and [simulation]."""

from __future__ import annotations

from inerter.files.common.codec import TableCodec, key, keyed_dataclass, section, table_of
from inerter.files.common.elements import elements_codec
from inerter.files.common.entries import TEXT, YES_OR_NO, one_of, positive, whole, word
from inerter.files.common.layouts import layouts_section
from inerter.files.common.roads import road_codec
from inerter.files.common.signals import signal_section
from inerter.files.common.titles import title_section
from inerter.files.common.vehicle_tables import vehicle_codec
from inerter.files.common.vehicles import models
from inerter.registry import cache_until_registration
from inerter.units import quote_value

INTEGRATORS = ("event-driven", "time-stepping")
INITIAL = ("rest", "preload", "periodic")


@keyed_dataclass
class SimulationSettings:
    """Settings of the integration, and of the samples that are kept."""

    layout: str | None = key(TEXT, "Layout to simulate; optional if there is only one.", 'layout = "S1"', default=None)
    duration: float | None = key(
        positive("s"),
        "Duration of the run; one period of a periodic steady state if left out.",
        'duration = "10 s"',
        default=None,
    )
    step: float = key(
        positive("s"), "Interval between samples, and longest step of the integrator.", 'step = "0.2 ms"', default=2e-4
    )
    integrator: str = key(
        word("an integrator", INTEGRATORS),
        "Integrator.",
        'integrator = "time-stepping"',
        default="event-driven",
    )
    initial: str = key(word("an initial state", INITIAL), "Initial state.", 'initial = "preload"', default="rest")
    energy: bool = key(YES_OR_NO, "Whether the energy balance is computed.", "energy = true", default=False)
    every: int = key(whole(1, 10**9), "Number of steps per stored sample.", "every = 10", default=1)


@cache_until_registration
def simulation_codec() -> TableCodec:
    """The whole file, as a dictionary by its sections."""
    *others, last = map(quote_value, models())
    return TableCodec(
        (
            title_section("the summary"),
            section(
                "vehicle",
                vehicle_codec(models(), one_of("a vehicle model", models()), free=False),
                "Vehicle model, or a rig; it determines the other keys of this section.",
                example=f"a section [vehicle] with model = {', '.join(others)} or {last}",
            ),
            section(
                "road",
                road_codec(rough=False),
                "Road and speed.",
                'a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"',
                default=None,
            ),
            section(
                "elements",
                elements_codec(free=False),
                "Elements of the struts, by names that you choose. The unit determines the kind.",
                'a section [elements] with lines such as k = "120 kN/m"',
            ),
            layouts_section(),
            signal_section("multisine"),
            section(
                "simulation",
                table_of(SimulationSettings, make=dict),
                "Settings of the integration, and of the samples that are kept.",
                'a section [simulation] with duration = "10 s"',
            ),
        )
    )
