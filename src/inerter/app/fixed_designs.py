"""Study document with fixed designs, so that `inerter run` evaluates exactly these designs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from functools import reduce
from itertools import count
from operator import getitem
from typing import Any

from inerter.app.designs import Design
from inerter.errors import DesignError
from inerter.files.common.layouts import LayoutCodec
from inerter.files.study.places import free_in_vehicle
from inerter.files.study.study import Study

# keys of [study] that ask for more than the value of a design
_SEARCH = ("optimise", "break_even", "budgets", "sweep", "subject_to", "trade_off", "points")


def with_fixed_values(document: Mapping[str, Any], study: Study, designs: Sequence[Design]) -> dict[str, Any]:
    """Document with the layouts of these designs only, their design variables fixed to the last digit.

    An element that has several values becomes several elements, each with the name of its layout.

    Raises `DesignError` if the designs have several values for a number of the vehicle.
    """
    names, elements = _rename_elements(study, designs)
    made = deepcopy(dict(document))
    _fix_vehicle(made["vehicle"], study, designs)
    free = {name for design in designs for name in design.values}
    kept = {name: entry for name, entry in made["elements"].items() if name not in free}
    made["elements"] = {**kept, **elements}
    keys, layout = _keys(designs), LayoutCodec()
    made["layouts"] = {
        key: layout.rename(made["layouts"][design.layout], {name: new for (k, name), new in names.items() if k == key})
        for key, design in zip(keys, designs, strict=True)
    }
    settings = {key: value for key, value in made["study"].items() if key not in _SEARCH}
    base = next((key for key, design in zip(keys, designs, strict=True) if design.layout == study.baseline), keys[0])
    made["study"] = {"indices": list(study.indices), **settings, "baseline": base}
    return made


def _fix_vehicle(vehicle: dict[str, Any], study: Study, designs: Sequence[Design]) -> None:
    """Give the free numbers of the table `vehicle` the values of the designs."""
    for name, (place, number) in free_in_vehicle(study).items():
        values = {design.values[name] for design in designs}
        if len(values) > 1:
            raise DesignError(
                f"The designs differ in {name}, of which a study has one value. Write one design at a time."
            )
        *tables, key = place.key.split(".")
        reduce(getitem, tables, vehicle)[key] = f"{values.pop()!r} {number.unit}"


def _keys(designs: Sequence[Design]) -> list[str]:
    """A name for the layout of each design, none of them twice: its own, or with a number behind it."""
    layouts, keys = {design.layout for design in designs}, list[str]()
    for design in designs:
        numbered = (f"{design.layout[:35]}.{number}" for number in count(2))
        free = (key for key in numbered if key not in keys and key not in layouts)
        keys.append(next(free) if design.layout in keys else design.layout)
    return keys


def _rename_elements(study: Study, designs: Sequence[Design]) -> tuple[dict[tuple[str, str], str], dict[str, str]]:
    """New names of elements by layout and old name, and the value of each new element as text."""
    keys = _keys(designs)
    names: dict[tuple[str, str], str] = {}
    elements: dict[str, str] = {}
    for name in dict.fromkeys(n for design in designs for n in design.values if n in study.elements):
        values = {key: d.values[name] for key, d in zip(keys, designs, strict=True) if name in d.values}
        several = len(set(values.values())) > 1
        for key, value in values.items():
            new = _free_name(f"{name}_{re.sub(r'[^A-Za-z0-9]', '_', key)}", study, elements) if several else name
            names[key, name] = new
            elements[new] = f"{value!r} {study.elements[name].unit}"
    return names, elements


def _free_name(wanted: str, study: Study, taken: Mapping[str, str]) -> str:
    while wanted in study.elements or wanted in taken:
        wanted += "_"
    return wanted
