"""Compiling what panels and work call."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.indices.registry import INDICES, make_index
from inerter.kernels.cache import is_kept
from inerter.kernels.prepare import prepare
from inerter.methods.method import MethodWithKernels
from inerter.methods.registry import METHODS, is_blind, searches
from inerter.networks.elements import Damper, Friction, Inerter, Spring, free
from inerter.networks.parser import network
from inerter.signals.road import Road
from inerter.vehicle.quarter_car import QuarterCar


def warm(told: str) -> None:
    """Compile the kernels of all methods, linear ones first; append each to the file `told` when its turn comes."""
    with Path(told).open("a", encoding="utf-8") as stream:

        def tell(title: str, number: int, total: int) -> None:
            stream.write(json.dumps({"title": title, "number": number, "total": total}) + "\n")
            stream.flush()

        prepare(dict.fromkeys(_kernels()), tell)


def is_compiled(method: str) -> bool:
    """Whether the kernels of a method are compiled already, as far as a quick check shows."""
    return all(is_kept(kernel) for kernel in _of_method(method))


def _kernels() -> Iterator[Any]:
    for name in sorted(METHODS, key=is_blind, reverse=True):
        yield from _of_method(name)


def _of_method(name: str) -> Iterator[Any]:
    parts = {"k": Spring(1e5), "c": Damper(free(1e2, 1e5)), "b": Inerter(1e2), "f": Friction(10.0)}
    car = QuarterCar(250.0, 35.0, 150e3, strut=network("k | c - (b | f)", **parts))
    kind: Callable[..., Any] = METHODS[name]
    for symbol in INDICES:
        try:
            method = kind()
            definition = make_index(symbol, Road(roughness=5e-7, speed=25.0), {}).definition(car.mechanism())
            if isinstance(method, MethodWithKernels):
                yield from method.kernels(definition, search=car if searches(name) else None)
        except (InerterError, TypeError):  # what needs settings is compiled when it is called
            continue
