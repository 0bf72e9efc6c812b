"""Flags, strings and paths of public functions: another type is refused in one sentence that names the argument."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

import inerter as it

KINDS = {"bool", "str", "Path", "os.PathLike[str]", "None"}
WRONG = (["a"], np.array([1.0, 2.0]), object(), 2.5)


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


def test_arguments_that_raised_other_exceptions() -> None:
    with pytest.raises(it.InerterError, match=r"`parameter` must be a string, got array\(\[1., 2.\]\)"):
        it.break_even(None, None, None, parameter=np.array([1.0, 2.0]), method=it.Norm())
    with pytest.raises(it.InerterError, match=r"`energy` must be True or False, got \[1\]"):
        it.simulate(None, energy=[1])
    with pytest.raises(it.InerterError, match=r"`mount` must be a string, got \['a'\]"):
        it.static_stiffness(["a"])
    with pytest.raises(it.InerterError, match="`path` must be a string or a path, got None"):
        it.load_study(None)
