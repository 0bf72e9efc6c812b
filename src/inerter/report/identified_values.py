"""Identified values as text, with as many digits as their confidence intervals justify."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum, auto
from math import isnan

from inerter.files.identification.running import IdentificationResult
from inerter.formatting import format_quantity, format_range, format_with_interval
from inerter.identification.friction_models import QUADRATIC_DAMPING
from inerter.networks.elements import Element, Free, Tied
from inerter.networks.parser import format_expression

_MOST_DIGITS = 6  # of values that are to be read back


class ResultKind(Enum):
    """Kind of result available for a parameter."""

    VALUE = auto()
    BOUNDS = auto()  # bounds at most: not identifiable
    NOTHING = auto()  # unreliable fit: values withheld


_WORDS = {ResultKind.BOUNDS: "not identifiable", ResultKind.NOTHING: "withheld"}


def result_kind(found: IdentificationResult, name: str) -> ResultKind:
    """Kind of result available for a parameter: a value, bounds only, or nothing."""
    if not found.explains:
        return ResultKind.NOTHING
    return ResultKind.BOUNDS if isnan(found.fit.parameters[name].value) else ResultKind.VALUE


def value_and_interval(found: IdentificationResult, name: str) -> tuple[str, str]:
    """Value of a parameter and its 95 % confidence interval as texts; words for a missing value."""
    parameter, bounds = found.fit.parameters[name], found.bounds(name)
    low, high = parameter.interval
    what = result_kind(found, name)
    if what is ResultKind.NOTHING:
        if isnan(low):
            return _WORDS[what], ""
        return _WORDS[what], f"{format_range(low, high, parameter.unit, 3)} over the possible causes"
    if what is ResultKind.VALUE:
        return format_with_interval(parameter.best, low, high, parameter.unit)
    if isnan(low):
        return _WORDS[what], ""
    below = low > (0.0 if bounds is None else bounds[0] * (1.0 + 1e-9))
    above = bounds is None or high < bounds[1] * (1.0 - 1e-9)
    if above and not below:
        return _WORDS[what], f"below {format_quantity(high, parameter.unit, 3)}"
    if below and not above:
        return _WORDS[what], f"above {format_quantity(low, parameter.unit, 3)}"
    return _WORDS[what], format_range(low, high, parameter.unit, 3)


def elements_block(found: IdentificationResult) -> str:
    """The identified device as sections of a study or simulation file: elements with their best values, one layout.

    Parameters that are not identifiable have their best values too, so that the layout can be computed, and a remark.
    Only a comment for unreliable estimates.
    """
    if not found.explains:
        return (
            f"# {found.name}, fitted to {_format_sources(found)}\n"
            f"# unreliable estimates ({found.fit.status.kind}): values withheld"
        )
    rows, expression = _element_rows(found)
    texts = {name: f'"{value}"' for name, (value, _) in rows.items()}
    keys = max(len(name) for name in rows)
    values = max(map(len, texts.values()))
    lines = [f"# {found.name}, identified from {_format_sources(found)}"]
    if QUADRATIC_DAMPING in found.fit.parameters:
        value, interval = value_and_interval(found, QUADRATIC_DAMPING)
        lines.append(f"# without its quadratic damping, {value} ({interval}), which no element has")
    lines.append("[elements]")
    lines += [f"{name:<{keys}} = {texts[name]:<{values}}  # {remark}" for name, (_, remark) in rows.items()]
    return "\n".join([*lines, "", "[layouts]", f'device = "{expression}"'])


def device_tables(found: IdentificationResult) -> dict[str, dict[str, str]]:
    """Tables of the sections of `elements_block`, of a reliable fit."""
    rows, expression = _element_rows(found)
    return {"elements": {name: value for name, (value, _) in rows.items()}, "layouts": {"device": expression}}


def _format_sources(found: IdentificationResult) -> str:
    names = list(dict.fromkeys(reading.used.source for reading in found.readings))
    text = ", ".join(names)
    return text if len(text) < 50 else f"{len(names)} records"


def _element_rows(found: IdentificationResult) -> tuple[dict[str, tuple[str, str]], str]:
    """Value and remark for each element name, and the expression of the network."""
    rows: dict[str, tuple[str, str]] = {}
    order = []
    for free, best in zip(found.model.elements(), found.device.elements(), strict=True):
        value, remark = _value_and_remark(found, free, best)
        for name in _possible_names(free):
            if rows.setdefault(name, (value, remark)) == (value, remark):
                order.append(name)
                break
    return rows, format_expression(found.device, order)


def _possible_names(element: Element) -> Iterator[str]:
    """Names of an element in a file: that of its free value, its own, or with a number where that is taken."""
    label = element.value.name if isinstance(element.value, Free) and element.value.name else element.label
    yield label
    yield from (f"{label}{count}" for count in range(2, 1000))


def _value_and_remark(found: IdentificationResult, free: Element, best: Element) -> tuple[str, str]:
    number = best.value
    assert not isinstance(number, Free | Tied)
    value = format_quantity(number, best.unit, _MOST_DIGITS)
    if not isinstance(free.value, Free):
        return value, "as given"
    name = str(free.value.name)
    shown, interval = value_and_interval(found, name)
    if result_kind(found, name) is ResultKind.VALUE:
        return value, f"95 %: {interval}"
    return value, f"{shown}: {interval}" if interval else shown
