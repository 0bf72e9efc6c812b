"""Wrong input: always an error of the project's own, with the words that help, and never any other exception."""

import math
from dataclasses import replace

import numpy as np
import pytest
from wang_su import J1, J5, ROAD, paper_quarter_car

from inerter import (
    GROUND,
    Coordinate,
    Damper,
    Force,
    Friction,
    Gap,
    HalfCar,
    Inerter,
    InerterError,
    LinearSystem,
    Mechanism,
    Norm,
    OutputWeight,
    PerformanceOutputs,
    QuarterCar,
    RideComfort,
    Road,
    RoadInput,
    Spring,
    Strut,
    Tyre,
    TyreLoad,
    evaluate,
    evaluate_many,
    export,
    free,
    frequency_response,
    h2_norm,
    hinf_norm,
    network,
    optimise,
    plot_bode,
    run_study,
    state_space,
    tied,
)

k, c, b = Spring(60e3), Damper(3e3), Inerter(50.0)


def car(strut=k | c):
    return paper_quarter_car(strut)


def open_car():
    return car(k | Damper(free(10.0, 1e6, "c")) - Inerter(free(0.01, 1e5, "b")))


def half(**changes):
    values = {"sprung_mass": 363.5, "pitch_inertia": 200.0, "unsprung_mass_front": 25.0, "unsprung_mass_rear": 20.0}
    values |= {"tyre_stiffness_front": 120e3, "tyre_stiffness_rear": 100e3, "distance_front": 0.8, "distance_rear": 1.2}
    return HalfCar(**(values | {"front": k | c, "rear": k | c} | changes))


def mechanism(**changes):
    parts = {
        "coordinates": (Coordinate("a", 10.0),),
        "struts": (Strut("s", k | c, {"a": 1.0}, GROUND),),
        "tyres": (Tyre("t", k, {"a": 1.0}, "r"),),
        "roads": (RoadInput("r"),),
        "measures": PerformanceOutputs(comfort=(OutputWeight("a_acceleration"),)),
    }
    return Mechanism(**(parts | changes))


def system():
    return state_space(car(), "road", "sprung_acceleration")


WRONG = {
    # elements and networks
    "negative stiffness": (lambda: Spring(-1.0), "Stiffness must be positive, got k = -1"),
    "no inertance": (lambda: Inerter(0.0), "drop its branch"),
    "damping not a number": (lambda: Damper(math.nan), "Damping must be a finite number"),
    "endless damping": (lambda: Damper(math.inf), "finite number of N s/m"),
    "stiffness as text": (lambda: Spring("120 kN/m"), "'120 kN/m'"),
    "stiffness as truth": (lambda: Spring(True), "True"),
    "negative friction": (lambda: Friction(-1.0), "Force must be positive"),
    "a bad name": (lambda: Spring(1.0, "main spring"), "'main spring'"),
    "a named element is told by name": (lambda: Spring(-1.0, "main"), "Stiffness of 'main'"),
    "reversed bounds": (lambda: free(2.0, 1.0), "Swap them"),
    "equal bounds": (lambda: free(1.0, 1.0), "give the number itself"),
    "negative bound": (lambda: free(-1.0, 1.0), "0 <= lower < upper"),
    "bound not a number": (lambda: free(math.nan, 1.0), "finite number, got nan"),
    "endless bound": (lambda: free(1.0, math.inf), "finite number, got inf"),
    "a bad free name": (lambda: free(1.0, 2.0, name="2c"), "'2c'"),
    "a lower bound of nothing": (lambda: Damper(free(0.0, 1.0)), "small positive bound"),
    "a number in a network": (lambda: k | 5.0, "got float 5.0"),
    "a class in a network": (lambda: k - Damper, "got type"),
    "classes joined": (lambda: car(Spring | Damper), "Expected an element or a network"),
    "an expression that is none": (lambda: network(5, k=k), "expression must be a string"),
    "an empty expression": (lambda: network("  "), "is empty"),
    "code in an expression": (lambda: network("k.__class__", k=k), "column 2: '.'"),
    "a part that is none": (lambda: network("k", k=3.0), "got float 3.0"),
    "admittance of a free value": (lambda: Spring(free(1.0, 2.0, "k1")).admittance(1j), "'k1' is free"),
    # cars
    "no strut": (lambda: car(None), "Expected an element or a network"),
    "no mass": (lambda: QuarterCar(0.0, 25.0, 1e5, k), "sprung mass of the quarter car must be a positive"),
    "mass not a number": (lambda: QuarterCar(180.0, math.nan, 1e5, k), "unsprung mass"),
    "tyre as text": (lambda: QuarterCar(180.0, 25.0, "1e5", k), "tyre stiffness"),
    "no pitch inertia": (
        lambda: half(pitch_inertia=0.0),
        "pitch inertia of the half car must be a positive number of kg m^2",
    ),
    "negative distance": (lambda: half(distance_rear=-1.2), "distance rear"),
    "no rear strut": (lambda: half(rear=None), "NoneType"),
    "one name with two ranges": (
        lambda: half(front=k | Damper(free(1.0, 2.0, "c")), rear=k | Damper(free(1.0, 3.0, "c"))),
        "'c' has two ranges: 1 to 2 N s/m and 1 to 3 N s/m",
    ),
    "one name with two units": (
        lambda: car(Spring(free(1.0, 2.0, "x")) | Damper(free(1.0, 2.0, "x"))),
        "'x' has two ranges",
    ),
    # mechanisms
    "no coordinates": (lambda: mechanism(coordinates=(), struts=(), tyres=()), "at least one coordinate"),
    "coordinate of negative mass": (lambda: mechanism(coordinates=(Coordinate("a", -1.0),)), "Mass of 'a'"),
    "angle without inertia": (lambda: mechanism(coordinates=(Coordinate("a", -1.0, angle=True),)), "Moment of inertia"),
    "two parts of one name": (lambda: mechanism(roads=(RoadInput("a"),)), "Duplicate name 'a' in the mechanism"),
    "a part with a bad name": (lambda: mechanism(coordinates=(Coordinate("a b", 1.0),)), "'a b'"),
    "held by nothing": (
        lambda: mechanism(coordinates=(Coordinate("a", 1.0), Coordinate("z", 1.0))),
        "'z' is unconstrained",
    ),
    "port that is not there": (lambda: mechanism(forces=(Force("f", {"x": 1.0}),)), "unknown coordinate 'x'"),
    "lever not a number": (lambda: mechanism(struts=(Strut("s", k, {"a": math.nan}, GROUND),)), "lever arm of 'a'"),
    "lever as text": (lambda: mechanism(struts=(Strut("s", k, {"a": "1"}, GROUND),)), "lever arm of 'a'"),
    "both ends at one port": (lambda: mechanism(struts=(Strut("s", k, {"a": 1.0}, {"a": 1.0}),)), "its travel is zero"),
    "road that is not there": (lambda: mechanism(tyres=(Tyre("t", k, {"a": 1.0}, "q"),)), "unknown road 'q'"),
    "road before the first": (lambda: mechanism(roads=(RoadInput("r", -1.0),)), "zero or more metres"),
    "strut that is no network": (lambda: mechanism(struts=(Strut("s", Spring, {"a": 1.0}, GROUND),)), "got type"),
    "friction alone": (lambda: state_space(car(Friction(5.0, "seal"))), "carries no force in linear analysis"),
    "friction in series": (lambda: state_space(car(k - Friction(5.0, "seal"))), "(seal)"),
    "gap alone": (lambda: state_space(car(Gap(1e-3, "play"))), "'strut' is rigid in linear analysis"),
    "gap beside a spring": (lambda: state_space(car(k | Gap(1e-3, "play"))), "'play' joins its two ends"),
    "inerter on the road": (
        lambda: state_space(mechanism(tyres=(Tyre("t", k | Inerter(1.0, "b1"), {"a": 1.0}, "r"),))),
        "'b1' is mounted on the road itself",
    ),
    "inerter at the foot of a tyre": (
        lambda: state_space(mechanism(tyres=(Tyre("t", k - Inerter(1.0, "b1"), {"a": 1.0}, "r"),))),
        "'b1' is mounted on the road itself",
    ),
    "unknown output": (lambda: state_space(car(), outputs="comfort"), "Unknown output 'comfort'"),
    "unknown input": (lambda: state_space(car(), inputs="wind"), "Unknown input 'wind'"),
    "assembling free values": (lambda: state_space(open_car()), "still has free values: c, b"),
    # values
    "fixing what is not free": (lambda: open_car().with_values({"d": 1.0}), "unknown free value 'd'"),
    "fixing to nothing": (lambda: open_car().with_values({"c": 0.0}), "must be positive"),
    "free values in evaluate": (lambda: evaluate(open_car(), J1, Norm()), "still has free values: c, b"),
    "nothing to optimise": (lambda: optimise(car(), J1, Norm()), "no free value"),
    "no starts": (
        lambda: optimise(open_car(), J1, Norm(), starts=0),
        "`starts` must be an integer from 1 to 100000, got 0",
    ),
    "a truth for a seed": (
        lambda: optimise(open_car(), J1, Norm(), seed=True),
        "`seed` must be a non-negative integer",
    ),
    "seed as text": (lambda: optimise(open_car(), J1, Norm(), seed="0"), "`seed`"),
    "a free value without effect": (
        lambda: optimise(car(k | Friction(free(1.0, 5.0, "f")) | Damper(free(10.0, 1e6, "c"))), J1, Norm()),
        "no effect",
    ),
    "values missing": (lambda: evaluate_many(open_car(), J1, {"c": [1.0]}, Norm()), "Values for b missing"),
    "values of a stranger": (lambda: evaluate_many(open_car(), J1, {"q": [1.0]}, Norm()), "unknown free value 'q'"),
    "values of two lengths": (
        lambda: evaluate_many(open_car(), J1, {"c": [1.0, 2.0], "b": [1.0, 2.0, 3.0]}, Norm()),
        "c: 2, b: 3",
    ),
    "values not positive": (lambda: evaluate_many(open_car(), J1, {"c": [-1.0], "b": 1.0}, Norm()), "values of 'c'"),
    "values not numbers": (lambda: evaluate_many(open_car(), J1, {"c": [1.0], "b": ["x"]}, Norm()), "values of 'b'"),
    "values not finite": (
        lambda: evaluate_many(open_car(), J1, {"c": [1.0], "b": [math.nan]}, Norm()),
        "values of 'b'",
    ),
    "values in a table": (lambda: evaluate_many(open_car(), J1, {"c": [[1.0]], "b": 1.0}, Norm()), "values of 'c'"),
    # indices and methods
    "road without roughness": (lambda: Road(0.0, 25.0), "roughness of a road"),
    "endless speed": (lambda: Road(5e-7, math.inf), "speed of a road"),
    "no road": (lambda: evaluate(car(), RideComfort(25.0), Norm()), "J1 needs a Road"),
    "negative filter": (lambda: TyreLoad(ROAD, high_pass=-1.0), "high-pass corner"),
    "a class as index": (lambda: evaluate(car(), RideComfort, Norm()), "Expected an index"),
    "a class as method": (lambda: evaluate(car(), J1, Norm), "Expected a method"),
    "a name as method": (lambda: evaluate(car(), J1, "norm"), "Expected a method such as Norm()"),
    "a number as vehicle": (lambda: evaluate(5, J1, Norm()), "Expected a vehicle"),
    "an optimum as vehicle": (
        lambda: evaluate(optimise(open_car(), J1, Norm()), J1, Norm()),
        "got Optimum. Its vehicle is its attribute design.",
    ),
    "one name as a response": (
        lambda: plot_bode(car(), "sprung_acceleration"),
        'of an input and an output such as ("road", "sprung_acceleration"), got \'sprung_acceleration\'',
    ),
    "unknown conventions": (lambda: Norm("paper2009"), "available: exact, paper2008"),
    "no comfort defined": (
        lambda: evaluate(mechanism(measures=PerformanceOutputs()), J1, Norm()),
        "Set measures.comfort, such as a_acceleration.",
    ),
    "no load carrying defined": (lambda: evaluate(mechanism(), J5, Norm()), "measures.load_input"),
    "no road to drive on": (lambda: evaluate(mechanism(tyres=(), roads=()), J1, Norm()), "has no tyre"),
    # systems
    "matrices that do not fit": (
        lambda: LinearSystem([[1.0, 2.0]], [[1.0]], [[1.0]], [[0.0]]),
        "A has the shape (1, 2)",
    ),
    "a vector as matrix": (lambda: LinearSystem([-1.0], [[1.0]], [[1.0]], [[0.0]]), "A must be a matrix"),
    "matrices not finite": (lambda: LinearSystem([[math.nan]], [[1.0]], [[1.0]], [[0.0]]), "A has entries"),
    "too many names": (
        lambda: LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]], inputs=("a", "b")),
        "The 1 inputs of the system require as many different names",
    ),
    "negative delay": (lambda: system().with_delays("road", [-1.0]), "zero or more seconds"),
    "selecting a stranger": (lambda: system().subsystem(outputs="x"), "Unknown output 'x'"),
    "no such approximant": (
        lambda: h2_norm(state_space(half()).with_delays("road", [0.0, 0.1, 0.0, 0.0]), 0),
        "order 1 to 10",
    ),
    "frequencies not finite": (lambda: frequency_response(system(), [math.nan]), "finite frequencies"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_is_refused_with_the_words_that_help(case):
    request, words = WRONG[case]
    with pytest.raises(InerterError) as refusal:
        request()
    message = str(refusal.value)
    assert words in message
    assert message.endswith(".") or "got" in message


OTHER_EXCEPTIONS = {
    "a number beyond floating point": lambda: Spring(10**400),
    "a number before a network": lambda: 5.0 | k,
    "a class before a network": lambda: Damper | k,
    "brackets without end": lambda: network("(" * 5000 + "k" + ")" * 5000, k=k),
    "admittance at a word": lambda: k.admittance("fast"),
    "a coordinate as port": lambda: mechanism(struts=(Strut("s", k, "a", GROUND),)),
    "nothing as port": lambda: mechanism(struts=(Strut("s", k, {"a": 1.0}, None),)),
    "a name as coordinate": lambda: mechanism(coordinates=("a",)),
    "one coordinate instead of several": lambda: mechanism(coordinates=Coordinate("a", 1.0)),
    "a name as measure": lambda: evaluate(
        mechanism(measures=PerformanceOutputs(comfort=("a_acceleration",))), J1, Norm()
    ),
    "a weight as text": lambda: evaluate(
        mechanism(measures=PerformanceOutputs(comfort=(OutputWeight("a_acceleration", "1"),))), J1, Norm()
    ),
    "a weight not a number": lambda: evaluate(
        mechanism(measures=PerformanceOutputs(comfort=(OutputWeight("a_acceleration", math.nan),))), J1, Norm()
    ),
    "no measures": lambda: evaluate(mechanism(measures=None), J1, Norm()),
    "a class as vehicle": lambda: evaluate(QuarterCar, J1, Norm()),
    "assembling a number": lambda: state_space(5),
    "assembling a class": lambda: state_space(QuarterCar),
    "norm of a car": lambda: h2_norm(car()),
    "largest gain of a car": lambda: hinf_norm(car()),
    "ragged matrices": lambda: LinearSystem([[1.0, 2.0], [1.0]], [[1.0]], [[1.0]], [[0.0]]),
    "outputs as a number": lambda: state_space(car(), outputs=5),
    "outputs as numbers": lambda: state_space(car(), outputs=[5]),
    "a selection by number": lambda: system().subsystem(outputs=5),
    "states as a number": lambda: LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]], states=5),
    "a delay as text": lambda: LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]], delays="a"),
    "a number as measures of comfort": lambda: mechanism(measures=PerformanceOutputs(comfort=5)),
    "endless delay": lambda: system().with_delays("road", [math.inf]),
    "frequencies as text": lambda: frequency_response(system(), ["a"]),
    "a tie by an array": lambda: tied("c", factor=np.array([1.0, 2.0])),
    "a frequency as text": lambda: frequency_response(system(), "1.0"),
    "a frequency that is true": lambda: frequency_response(system(), True),
    "the path of a study for the study": lambda: run_study("my-car.toml", "out"),
    "kinds of export in a list": lambda: export(car(), ["matlab"], "car.m"),
    "no values": lambda: evaluate_many(open_car(), J1, None, Norm()),
    "complex values": lambda: evaluate_many(open_car(), J1, {"c": np.array([1j]), "b": 1.0}, Norm()),
    "values that are no mapping": lambda: open_car().with_values(5),
    "conventions in a list": lambda: Norm([]),
    "an approximant of no order where nothing is late": lambda: h2_norm(system(), 0),
}


@pytest.mark.parametrize("case", OTHER_EXCEPTIONS)
def test_wrong_input_never_makes_another_exception(case):
    with pytest.raises(InerterError):
        OTHER_EXCEPTIONS[case]()


def test_a_car_is_not_changed_by_a_refusal():
    before = open_car()
    with pytest.raises(InerterError):
        replace(before, sprung_mass=-1.0)
    assert before == open_car()
