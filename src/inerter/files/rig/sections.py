"""The keys of a rig file: what it shares with simulation files, and [rig]."""

from __future__ import annotations

from inerter.files.common.codec import TableCodec, key, keyed_dataclass, section, table_of, without_none
from inerter.files.common.elements import elements_codec
from inerter.files.common.entries import POSITIVE, TEXT, YES_OR_NO, any_quantity, not_negative, positive, whole
from inerter.files.common.layouts import layouts_section
from inerter.files.common.signals import signal_section
from inerter.files.common.titles import title_section
from inerter.registry import cache_until_registration
from inerter.vehicle.rig import Rig


@keyed_dataclass
class RigSettings:
    """Duration of the measurement, and the sensors; omitted values are those of `VirtualRig`."""

    layout: str | None = key(TEXT, "Layout of the measured device; optional if there is only one.", default=None)
    duration: float = key(positive("s"), "Duration of the record.", 'duration = "5 s"')
    start: float = key(not_negative("s"), "Duration of the motion before the record.", default=0.0)
    seed: int = key(whole(0, 2**63 - 1), "Seed of the sensor noise.", default=0)
    sampling: float | None = key(positive("Hz"), "Sampling rate.", default=None)
    table_bandwidth: float | None = key(positive("Hz"), "Bandwidth of the table.", default=None)
    encoder_resolution: float | None = key(not_negative("m"), "Resolution of the encoder.", default=None)
    encoder_noise: float | None = key(not_negative("m"), "Noise of the encoder, r.m.s.", default=None)
    force_range: float | None = key(positive("N"), "Measuring range of the load cell.", default=None)
    force_resolution: float | None = key(not_negative("N"), "Resolution of the load cell.", default=None)
    force_noise: float | None = key(not_negative("N"), "Noise of the load cell, r.m.s.", default=None)
    force_bandwidth: float | None = key(positive("Hz"), "Bandwidth of the load cell.", default=None)
    force_offset: float | None = key(any_quantity("N"), "Offset of the load cell.", default=None)
    force_gain: float | None = key(POSITIVE, "Gain of the load cell: reading over true force.", default=None)
    force_delay: float | None = key(not_negative("s"), "Delay of the load cell relative to the encoder.", default=None)
    reversed: bool = key(YES_OR_NO, "Whether the load cell is positive in compression.", default=False)


@cache_until_registration
def rig_codec() -> TableCodec:
    """The whole file, as a dictionary by its sections."""
    return TableCodec(
        (
            title_section("the record"),
            section(
                "elements",
                elements_codec(free=False),
                "Elements of the device, by names that you choose. The unit determines the kind.",
                'a section [elements] with lines such as b = "113 kg"',
            ),
            layouts_section('a line such as screw = "(ks | cs) - (b | f)"', Rig.key),
            signal_section("cosine"),
            section(
                "rig",
                table_of(RigSettings, make=without_none),
                "Duration of the measurement, and the sensors.",
                'a section [rig] with duration = "5 s"',
            ),
        )
    )
