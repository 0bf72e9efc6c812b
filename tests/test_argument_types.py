"""Flags, strings and paths of public functions: another type is refused in one sentence that names the argument."""

from __future__ import annotations

import inspect

import matplotlib.pyplot as plt
import numpy as np
import pytest

import inerter as it

KINDS = {"bool", "str", "Path", "os.PathLike[str]", "None"}
WRONG = (["a"], np.array([1.0, 2.0]), object(), 2.5)


CAR = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
FREE = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(it.free(100.0, 1e5, "c")))
COMFORT = it.RideComfort(it.Road(1e-6, 20.0))
OWN = {"any_network", "free", "network", "tied"}  # which say it in their own words
DECLARATIONS = {"choice_field", "mount", "quantity", "typed_field"}  # of classes that a programmer writes


def arguments() -> list[tuple[str, str]]:
    """Every function and argument whose annotation has such types alone."""
    found = []
    for name in it.__all__:
        function = getattr(it, name)
        if not inspect.isfunction(function) or name in DECLARATIONS:
            continue
        for argument in inspect.signature(function).parameters.values():
            if {kind.strip() for kind in str(argument.annotation).split("|")} <= KINDS:
                found.append((name, argument.name))
    return found


@pytest.mark.parametrize(("name", "argument"), arguments())
def test_a_wrong_type_is_refused_by_name(name: str, argument: str) -> None:
    function = getattr(it, name)
    given = inspect.signature(function).parameters.values()
    others = {one.name: None for one in given if one.default is one.empty and one.kind is not one.VAR_KEYWORD}
    for wrong in WRONG:
        if argument == "expression":
            with pytest.raises(it.InerterError):
                function(wrong)
            continue
        with pytest.raises(it.InerterError) as told:
            function(**{argument: wrong} | {one: value for one, value in others.items() if one != argument})
        assert name in OWN or f"`{argument}` must be " in str(told.value)
        assert "\n" not in str(told.value)


def test_objects_of_other_classes_are_refused() -> None:
    for call in (
        lambda: it.plot_trajectory([1.0], "tyre_load"),
        lambda: it.plot_poles(it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3)), ax=[1]),
        lambda: it.write_record(None, "record.csv"),
    ):
        with pytest.raises(it.InerterError, match=r"` must be an? .*, got "):
            call()


RUN = it.simulate(CAR, road=it.sine(1e-3, 2.0), duration=0.1)
LAG = it.LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]])
BODE = ("road", "tyre_load")
OTHER_EXCEPTIONS = {
    "networks": (
        lambda: it.plot_network(None),
        "`networks` must be a Network or a mapping of names to Network objects",
    ),
    "names of networks": (lambda: it.plot_admittance({1: it.Spring(1.0)}), "a mapping of names to Network objects"),
    "fronts": (lambda: it.plot_front(["a"]), "`fronts` must be a ParetoFront or a mapping of names to ParetoFront"),
    "frequencies": (lambda: it.plot_bode(CAR, BODE, frequency=["a"]), r"positive numbers of Hz, got \['a'\]"),
    "an axis": (lambda: it.plot_bode(CAR, BODE, axes=[1, 2]), r"`axes` must be a list of Axes objects or None"),
    "no axes": (lambda: it.plot_bode(CAR, BODE, axes=[]), "need two axes, got 0"),
    "response": (lambda: it.plot_step_response(CAR, None), "`response` must be two strings, got None"),
    "duration": (lambda: it.plot_step_response(CAR, BODE, duration=-1.0), "duration must be a positive number of s"),
    "window": (
        lambda: it.plot_trajectory(RUN, "tyre_load", window=0.1),
        "`window` must be two numbers in SI units or None",
    ),
    "empty window": (lambda: it.plot_loop(RUN, "tyre_load", "strut_force", window=(8, 9)), "known from 0 to 0.1 s"),
    "outputs": (lambda: it.plot_trajectory(RUN, None), "`outputs` must be a list of strings or a string, got None"),
    "no index": (lambda: it.evaluate_many(CAR, [], {}, it.Norm()), "at least one index"),
    "estimates": (lambda: it.compare(CAR, CAR, it.LoadCarrying(), it.Norm(), known=[1]), "two estimates, or None"),
    "no kinds": (lambda: it.enumerate_networks(2, kinds=None), "kinds must be kinds of elements"),
    "too many elements": (lambda: it.enumerate_networks(10**400), "a positive integer such as 4, of at most 20"),
    "no model": (lambda: it.linear_response(None, [1.0]), "Expected an element or a network"),
    "a load cell": (
        lambda: it.linear_response(it.Spring(1.0), [1.0], "a"),
        "load cell must be a positive number of Hz",
    ),
    "a spring of many digits": (lambda: it.Spring(10**5000), "got an integer of 16610 bits"),
    "a road of many digits": (lambda: it.Road(10**5000, 25.0), "got an integer of 16610 bits"),
    "too many starts": (
        lambda: it.optimise(FREE, COMFORT, it.Norm(), starts=10**400),
        "from 1 to 100000, got an",
    ),
    "too many points": (
        lambda: it.pareto_front(CAR, [COMFORT, it.TyreLoad(it.Road(1e-6, 20.0))], it.Norm(), points=10**400),
        "of 2 indices must be an integer from 3 to 10000, got an integer of 1329 bits",
    ),
    "an array as an estimator": (
        lambda: it.frequency_response(LAG, [1.0], estimator=np.array([1.0, 2.0])),
        "apply to records only",
    ),
    "a huge frequency": (lambda: it.frequency_response(LAG, 10**400), "needs a list of frequencies"),
    "a huge number": (lambda: it.LinearSystem([[10**400]], [[1.0]], [[1.0]], [[0.0]]), "A must be a matrix of real"),
    "a huge acceleration": (lambda: it.frequency_weight([0.0, 1.0], [10**400, 1]), "two lists of numbers"),
    "an index": (lambda: it.on_road("text", CAR.mechanism(), (), "struts"), r"needs a Road\(roughness"),
    "a weighting": (lambda: it.iso2631_weighting(["Wk"]), "`name` must be a string"),
    "a ragged record": (lambda: it.Record([0, 1, 2, 3], [[1, 2], [3]], [0] * 4), "must be a vector of real numbers"),
    "a record without force": (lambda: it.Record([0, 1, 2, 3], [0] * 4, None), "force of a record must be a vector"),
    "further channels": (
        lambda: it.Record([0, 1, 2, 3], [0] * 4, [0] * 4, further=None),
        "mapping of names to vectors, got None",
    ),
    "a ragged profile": (lambda: it.Profile([[1, 2], [3]], [1.0, 2.0]), "a vector of two or more real numbers"),
    "a flag": (lambda: it.FitOptions(gain=np.array([1.0, 2.0])), "gain must be True or False"),
    "options": (lambda: it.identify(None, None, None), r"must be FitOptions\(\.\.\.\), got None"),
    "a vehicle": (
        lambda: it.optimise_robust(None, it.LoadCarrying(), it.Norm(), spread={"c": 0.1}),
        "Expected a vehicle",
    ),
    "an array without dimensions": (lambda: it.realise(np.array(1.0), [1.0]), "a list of real numbers"),
    "conditions": (lambda: it.Conditions(np.array(1.0)), "a list of Condition"),
    "coordinates": (lambda: it.Mechanism(np.array(1.0), ()), "a tuple of Coordinate"),
    "an excitation": (lambda: it.FilteredExcitation(np.array([1.0, 2.0]), it.Filter([1.0], [1.0, 1.0])), "excitation"),
    "progress": (lambda: it.simulate(CAR, duration=1.0, progress=1), "`progress` must be a function or None, got 1"),
    "progress of a fit": (lambda: it.identify(None, "ideal", progress=[]), r"`progress` must be a function"),
    "progress of a selection": (lambda: it.select_model(None, progress=[]), r"`progress` must be a function"),
    "progress of many runs": (
        lambda: it.simulate_many([CAR], outputs="tyre_load", duration=1.0, progress=[]),
        r"`progress` must be a function or None, got \[\]",
    ),
}


@pytest.mark.parametrize("case", OTHER_EXCEPTIONS)
def test_what_raised_another_exception_is_refused_in_a_sentence(case: str) -> None:
    call, words = OTHER_EXCEPTIONS[case]
    with pytest.raises(it.InerterError, match=words) as told:
        call()
    assert "\n" not in str(told.value)


def test_lists_of_any_kind_are_accepted() -> None:
    assert it.plot_trajectory(RUN, ("tyre_load",), window=[0.0, 0.1], axes=it.plot_trajectory(RUN, ["strut_force"]))
    figure, axes = plt.subplots(2)
    assert it.plot_bode({"S1": CAR}, BODE, axes=axes) == tuple(axes)
    plt.close(figure)


def test_generators_are_iterables() -> None:
    assert len(it.Conditions(it.Condition(1.0) for _ in range(2)).conditions) == 2
    assert it.is_positive_real((c for c in (1.0,)), (c for c in (1.0, 1.0)))


def test_arguments_that_raised_other_exceptions() -> None:
    with pytest.raises(it.InerterError, match=r"`parameter` must be a string, got array\(\[1., 2.\]\)"):
        it.break_even(None, None, None, parameter=np.array([1.0, 2.0]), method=it.Norm())
    with pytest.raises(it.InerterError, match=r"`energy` must be True or False, got \[1\]"):
        it.simulate(None, energy=[1])
    with pytest.raises(it.InerterError, match=r"`mount` must be a string, got \['a'\]"):
        it.static_stiffness(["a"])
    with pytest.raises(it.InerterError, match="`path` must be a string or a path, got None"):
        it.load_study(None)
