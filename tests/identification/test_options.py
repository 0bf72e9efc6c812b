"""The options of a fit: one value, the same as keywords."""

from __future__ import annotations

from dataclasses import fields

import pytest
from hypothesis import given
from hypothesis import strategies as st

import inerter as it
from inerter.errors import IdentificationError
from inerter.identification.options import FitOptions, OptionChanges
from inerter.identification.statements.identifiability import Identifiability, Verdict


def test_the_keywords_are_the_fields() -> None:
    assert set(OptionChanges.__annotations__) == {field.name for field in fields(FitOptions)}


@given(st.integers(0, 99), st.floats(0.0, 0.6), st.booleans())
def test_a_changed_option_is_the_only_one_that_changes(seed: int, check: float, gain: bool) -> None:
    options = FitOptions(seed=seed, gain=gain)
    assert options.replace(check=check) == FitOptions(seed=seed, gain=gain, check=check)
    assert it.FitOptions is FitOptions


@pytest.mark.parametrize("function", [it.identify, it.select_model])
def test_an_option_that_there_is_not_is_refused_in_a_sentence(function) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(IdentificationError, match="unknown option 'sead' of a fit"):
        function(None, None, sead=1)


def test_the_old_name_of_a_verdict_works_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="identified"):
        assert Identifiability("b", Verdict.IDENTIFIED).told


def test_the_old_name_of_replace_works_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="`changed` is now `replace`"):
        assert FitOptions().changed(seed=3) == FitOptions(seed=3)
