"""Numbers of NumPy and fractions in place of Python's give the same result to the last bit, or one error."""

from fractions import Fraction

import numpy as np
import pytest

import inerter as it

# All values are small integers, which each kind represents exactly.
KINDS = [np.float32, np.int64, Fraction]


def road(n, **more):
    return it.Road(roughness=2.0**-21, speed=n(25), **more)


def strut(n):
    return it.Spring(n(24000)) | it.Damper(n(1600)) | it.Inerter(n(10))


def quarter(n, network=None):
    return it.QuarterCar(n(180), n(25), n(32000), strut=network or strut(n))


def half(n):
    return it.HalfCar(n(640), n(1000), n(40), n(35), n(32000), n(31008), n(1), n(3), front=strut(n), rear=strut(n))


def rocker(n):
    return it.Mechanism(
        coordinates=(it.Coordinate("body", n(900)), it.Coordinate("tilt", n(25), angle=True)),
        struts=(it.Strut("mount", it.Spring(n(9000)) | it.Damper(n(600)), upper={"tilt": n(3)}, lower={"body": n(1)}),),
        tyres=(
            it.Tyre("front", it.Spring(n(30000)), {"body": n(1), "tilt": n(-1)}, "ahead"),
            it.Tyre("rear", it.Spring(n(30000)), {"body": n(1), "tilt": n(2)}, "behind"),
        ),
        roads=(it.RoadInput("ahead"), it.RoadInput("behind", distance=n(3))),
        measures=it.PerformanceOutputs(
            comfort=(it.OutputWeight("body_acceleration"), it.OutputWeight("tilt_acceleration", weight=n(3))),
            tyre_load=(it.OutputWeight("front_load"), it.OutputWeight("rear_load")),
        ),
    )


def value(design, index, method=None):
    return it.evaluate(design, index, method or it.Norm()).value


def free_car(n):
    return quarter(n, it.Spring(n(24000)) | it.Damper(it.free(n(100), n(30000), "c")))


RESULTS = {
    "ride comfort": lambda n: value(quarter(n), it.RideComfort(road(n))),
    "tyre load": lambda n: value(quarter(n), it.TyreLoad(road(n), high_pass=n(3))),
    "load carrying": lambda n: value(quarter(n), it.LoadCarrying()),
    "half car": lambda n: value(half(n), it.RideComfort(road(n))),
    "mechanism": lambda n: value(rocker(n), it.RideComfort(road(n))),
    "tracks": lambda n: value(
        it.FullCar(
            n(640),
            n(500),
            n(300),
            n(40),
            n(35),
            n(32000),
            n(31008),
            n(1),
            n(3),
            n(2),
            n(2),
            front=strut(n),
            rear=strut(n),
        ),
        it.RideComfort(road(n, coherence=it.Coherence.first_order(n(3), n(1)))),
    ),
    "seat": lambda n: value(
        it.Seat(quarter(n), n(80), it.Spring(n(9000)) | it.Damper(n(300))), it.RideComfort(road(n))
    ),
    "absorber": lambda n: value(
        it.Absorber(n(900), n(9000), n(90), mount=it.Spring(n(900)) | it.Damper(n(30))),
        it.PeakResponse("primary_force", "primary_displacement"),
    ),
    "white force": lambda n: value(
        quarter(n), it.RandomResponse({"tyre_load": n(2)}, it.WhiteForce("sprung_force", intensity=n(3)))
    ),
    "amplitude": lambda n: value(
        quarter(n, strut(n) | it.Friction(n(10))), it.LoadCarrying(amplitude=n(1000)), it.StatisticalLinearisation()
    ),
    "simulation": lambda n: it.simulate(
        half(n), road=it.cosine(n(1), n(3), speed=n(25)), duration=n(1), step=2.0**-10
    ).rms("sprung_acceleration"),
    "optimum": lambda n: it.optimise(free_car(n), it.RideComfort(road(n)), it.Norm(), seed=0).value,
    "limit": lambda n: (
        it.optimise(
            free_car(n), it.RideComfort(road(n)), it.Norm(), subject_to=[it.at_most(it.TyreLoad(road(n)), n(300))]
        ).value
    ),
    "tolerance": lambda n: (
        it.tolerance_analysis(quarter(n), it.RideComfort(road(n)), it.Norm(), spread={"c": 0.125}, samples=16).mean
    ),
    "simulation file": lambda n: str(it.export(quarter(n), to="simulation")),
    "admittance": lambda n: str(it.realise([n(2), n(1)], [n(1), n(3)])),
}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("name", RESULTS)
def test_the_result_is_that_of_numbers_of_python(name, kind):
    assert RESULTS[name](kind) == RESULTS[name](int if kind is np.int64 else float)


def test_bounds_of_numpy_do_not_overflow():
    bounds = it.free(np.int32(100_000), np.int32(1_000_000))
    assert (type(bounds.lower), type(bounds.upper)) == (int, int)
    assert bounds.lower * bounds.upper == 10**11
