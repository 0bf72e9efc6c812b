"""What an inerter does for a vehicle, and which design is best.

Networks of springs, dampers, inerters, dry friction and gaps; quarter cars, half cars and any other mechanism; exact
norms and optimisation. Everything public is a name in this module; each is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from inerter.errors import InerterError as InerterError
    from inerter.errors import Status as Status
    from inerter.errors import StatusKind as StatusKind
    from inerter.files.study.loading import load_study as load_study
    from inerter.files.study.running import run_study as run_study
    from inerter.identification.choice import Choice as Choice
    from inerter.identification.choice import choose as choose
    from inerter.identification.fit import Fit as Fit
    from inerter.identification.identify import identify as identify
    from inerter.identification.response import linear_response as linear_response
    from inerter.identification.response import model_response as model_response
    from inerter.identification.staged import Staged as Staged
    from inerter.identification.staged import staged as staged
    from inerter.identification.virtual_rig import VirtualRig as VirtualRig
    from inerter.indices.index import LoadCarrying as LoadCarrying
    from inerter.indices.index import RideComfort as RideComfort
    from inerter.indices.index import TyreLoad as TyreLoad
    from inerter.methods.approximate_linear import ApproximateLinear as ApproximateLinear
    from inerter.methods.compare import Comparison as Comparison
    from inerter.methods.compare import compare as compare
    from inerter.methods.excitation import MultisineExcitation as MultisineExcitation
    from inerter.methods.excitation import NoiseExcitation as NoiseExcitation
    from inerter.methods.expected_value import ExpectedValue as ExpectedValue
    from inerter.methods.method import Estimate as Estimate
    from inerter.methods.method import evaluate as evaluate
    from inerter.methods.method import evaluate_many as evaluate_many
    from inerter.methods.norm import Norm as Norm
    from inerter.methods.statistical_linearisation import StatisticalLinearisation as StatisticalLinearisation
    from inerter.networks.catalogue import LAYOUTS as LAYOUTS
    from inerter.networks.elements import Damper as Damper
    from inerter.networks.elements import Friction as Friction
    from inerter.networks.elements import Gap as Gap
    from inerter.networks.elements import Inerter as Inerter
    from inerter.networks.elements import Spring as Spring
    from inerter.networks.elements import free as free
    from inerter.networks.parser import network as network
    from inerter.norms.h2 import h2_norm as h2_norm
    from inerter.norms.hinf import hinf_norm as hinf_norm
    from inerter.optimisation.budget import Budget as Budget
    from inerter.optimisation.budget import budget as budget
    from inerter.optimisation.optimise import Optimum as Optimum
    from inerter.optimisation.optimise import optimise as optimise
    from inerter.records.readers import read_record as read_record
    from inerter.records.record import Record as Record
    from inerter.records.response import frequency_response as frequency_response
    from inerter.records.result import Response as Response
    from inerter.records.writers import write_record as write_record
    from inerter.signals.harmonics import cosine as cosine
    from inerter.signals.harmonics import flat_multisine as flat_multisine
    from inerter.signals.harmonics import multisine as multisine
    from inerter.signals.harmonics import sine as sine
    from inerter.signals.records import held_noise as held_noise
    from inerter.signals.records import profile as profile
    from inerter.signals.road import Road as Road
    from inerter.signals.signal import Signal as Signal
    from inerter.signals.transients import bump as bump
    from inerter.signals.transients import chirp as chirp
    from inerter.signals.transients import step as step
    from inerter.simulation.batch import Batch as Batch
    from inerter.simulation.batch import simulate_many as simulate_many
    from inerter.simulation.simulate import simulate as simulate
    from inerter.simulation.trajectory import Trajectory as Trajectory
    from inerter.systems.assemble import assemble as assemble
    from inerter.systems.linear import LinearSystem as LinearSystem
    from inerter.vehicle.cars import HalfCar as HalfCar
    from inerter.vehicle.cars import QuarterCar as QuarterCar
    from inerter.vehicle.cars import Rig as Rig
    from inerter.vehicle.mechanism import GROUND as GROUND
    from inerter.vehicle.mechanism import Coordinate as Coordinate
    from inerter.vehicle.mechanism import Force as Force
    from inerter.vehicle.mechanism import Measures as Measures
    from inerter.vehicle.mechanism import Mechanism as Mechanism
    from inerter.vehicle.mechanism import RoadInput as RoadInput
    from inerter.vehicle.mechanism import Strut as Strut
    from inerter.vehicle.mechanism import Tyre as Tyre
    from inerter.vehicle.mechanism import Weighted as Weighted

__all__ = [
    "GROUND",
    "LAYOUTS",
    "ApproximateLinear",
    "Batch",
    "Budget",
    "Choice",
    "Comparison",
    "Coordinate",
    "Damper",
    "Estimate",
    "ExpectedValue",
    "Fit",
    "Force",
    "Friction",
    "Gap",
    "HalfCar",
    "Inerter",
    "InerterError",
    "LinearSystem",
    "LoadCarrying",
    "Measures",
    "Mechanism",
    "MultisineExcitation",
    "NoiseExcitation",
    "Norm",
    "Optimum",
    "QuarterCar",
    "Record",
    "Response",
    "RideComfort",
    "Rig",
    "Road",
    "RoadInput",
    "Signal",
    "Spring",
    "Staged",
    "StatisticalLinearisation",
    "Status",
    "StatusKind",
    "Strut",
    "Trajectory",
    "Tyre",
    "TyreLoad",
    "VirtualRig",
    "Weighted",
    "__version__",
    "assemble",
    "budget",
    "bump",
    "chirp",
    "choose",
    "compare",
    "cosine",
    "evaluate",
    "evaluate_many",
    "flat_multisine",
    "free",
    "frequency_response",
    "h2_norm",
    "held_noise",
    "hinf_norm",
    "identify",
    "linear_response",
    "load_study",
    "model_response",
    "multisine",
    "network",
    "optimise",
    "profile",
    "read_record",
    "run_study",
    "simulate",
    "simulate_many",
    "sine",
    "staged",
    "step",
    "write_record",
]

_HOME = {
    "ApproximateLinear": "methods.approximate_linear",
    "Batch": "simulation.batch",
    "simulate_many": "simulation.batch",
    "profile": "signals.records",
    "held_noise": "signals.records",
    "bump": "signals.transients",
    "step": "signals.transients",
    "chirp": "signals.transients",
    "cosine": "signals.harmonics",
    "sine": "signals.harmonics",
    "flat_multisine": "signals.harmonics",
    "multisine": "signals.harmonics",
    "Trajectory": "simulation.trajectory",
    "simulate": "simulation.simulate",
    "Signal": "signals.signal",
    "Rig": "vehicle.cars",
    "Budget": "optimisation.budget",
    "budget": "optimisation.budget",
    "Comparison": "methods.compare",
    "compare": "methods.compare",
    "Coordinate": "vehicle.mechanism",
    "Damper": "networks.elements",
    "Estimate": "methods.method",
    "ExpectedValue": "methods.expected_value",
    "Force": "vehicle.mechanism",
    "Friction": "networks.elements",
    "GROUND": "vehicle.mechanism",
    "Gap": "networks.elements",
    "HalfCar": "vehicle.cars",
    "Inerter": "networks.elements",
    "InerterError": "errors",
    "LAYOUTS": "networks.catalogue",
    "LinearSystem": "systems.linear",
    "LoadCarrying": "indices.index",
    "Measures": "vehicle.mechanism",
    "Mechanism": "vehicle.mechanism",
    "MultisineExcitation": "methods.excitation",
    "NoiseExcitation": "methods.excitation",
    "Norm": "methods.norm",
    "Optimum": "optimisation.optimise",
    "QuarterCar": "vehicle.cars",
    "Record": "records.record",
    "read_record": "records.readers",
    "write_record": "records.writers",
    "RideComfort": "indices.index",
    "Road": "signals.road",
    "RoadInput": "vehicle.mechanism",
    "Spring": "networks.elements",
    "StatisticalLinearisation": "methods.statistical_linearisation",
    "Status": "errors",
    "StatusKind": "errors",
    "Strut": "vehicle.mechanism",
    "Tyre": "vehicle.mechanism",
    "TyreLoad": "indices.index",
    "Fit": "identification.fit",
    "identify": "identification.identify",
    "VirtualRig": "identification.virtual_rig",
    "Choice": "identification.choice",
    "choose": "identification.choice",
    "Staged": "identification.staged",
    "staged": "identification.staged",
    "Weighted": "vehicle.mechanism",
    "assemble": "systems.assemble",
    "evaluate": "methods.method",
    "evaluate_many": "methods.method",
    "free": "networks.elements",
    "frequency_response": "records.response",
    "Response": "records.result",
    "linear_response": "identification.response",
    "model_response": "identification.response",
    "h2_norm": "norms.h2",
    "hinf_norm": "norms.hinf",
    "network": "networks.parser",
    "load_study": "files.study.loading",
    "run_study": "files.study.running",
    "optimise": "optimisation.optimise",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("inerter")  # which takes as long as all else here
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"inerter.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
