"""Reading a study file: TOML to a checked `Study`, or one error with a line for every problem."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from inerter.errors import NetworkError, StudyError
from inerter.networks.elements import Element, Free
from inerter.networks.elements.registry import kinds_by_unit
from inerter.networks.parser import names, network
from inerter.signals.road import Road
from inerter.study.entries import Amount
from inerter.study.method_problems import method_problems
from inerter.study.problems import at, explain, refusal
from inerter.study.schema import Axles, Range, StudyFile, SweepRange
from inerter.study.suggest import nearest, some
from inerter.study.told_kind import ToldKind
from inerter.study.values import MOUNTS, StrutLayout, Study, Sweep, elements_used, write_resolved
from inerter.units import shown
from inerter.writing import characters

__all__ = ["StrutLayout", "Study", "Sweep", "load_study", "write_resolved"]

_LARGEST = 1_000_000  # bytes
_POSITION = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$")


def load_study(path: str | Path) -> Study:
    """The study in the TOML file at `path`.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    tables = read_tables(path)
    try:
        shape = StudyFile.model_validate(tables)
    except ValidationError as error:
        raise refusal(path, explain(error)) from None
    study = _resolve(path, shape)
    problems = [
        *layout_problems(study.model, study.elements, study.layouts),
        *_sweep_problems(study),
        *_setting_problems(study),
        *method_problems(study),
    ]
    if not problems:
        problems = list(_free_value_problems(study))
    if problems:
        raise refusal(path, problems)
    return study


def read_tables(path: Path, what: str = "a study file") -> dict[str, Any]:
    """The tables of a TOML file; `what` it should be is for messages.

    Raises `StudyError` for a file that cannot be read, or is no TOML.
    """
    if path.is_dir():
        raise StudyError(f"{path}: this is a folder; expected {what}. Give the path of a .toml file in it.")
    try:
        with path.open("rb") as stream:
            data = stream.read(_LARGEST + 1)
    except FileNotFoundError:
        raise StudyError(f"{path}: there is no such file; expected {what}. Check the path.") from None
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}); expected {what}.") from None
    if len(data) > _LARGEST:
        raise refusal(path, [f"larger than {_LARGEST} bytes; expected {what}, which is a page of TOML."])
    try:
        return tomllib.loads(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise refusal(path, [f"line {line}: not UTF-8 text; save the file with the encoding UTF-8."]) from None
    except tomllib.TOMLDecodeError as error:
        raise refusal(path, [_syntax_problem(str(error), data)]) from None
    except (RecursionError, ValueError):  # thousands of brackets, or of digits in a whole number
        raise refusal(path, [f"not {what}: brackets nested too deeply, or a number too long."]) from None


def _syntax_problem(message: str, data: bytes) -> str:
    """Tomllib's message with its position in front and a hint for the two most frequent causes."""
    position = _POSITION.search(message)
    lines = data.decode("utf-8-sig").split("\n")
    line, column = position.groups() if position else (None, None)
    where = f"line {line or len(lines)}, column {column or len(lines[-1]) + 1}"
    what = _POSITION.sub("", message)
    if what.startswith(("Cannot", "Duplicate")):
        return f"{where}: a key or section is given twice ({what}); expected each once. Rename or remove one."
    return f'{where}: not valid TOML ({what}); quantities, names and networks are quoted, such as k = "120 kN/m".'


def _resolve(path: Path, shape: StudyFile) -> Study:
    vehicle = shape.vehicle.model_dump()
    model = vehicle.pop("model")
    layouts = {name: StrutLayout(struts_of(model, entry)) for name, entry in shape.layouts.items()}
    settings = shape.study
    baseline = settings.baseline
    if baseline is None and len(layouts) > 1:
        baseline = next(iter(layouts))
    return Study(
        title=characters(path.stem) if shape.title is None else shape.title,
        path=path,
        model=model,
        vehicle=vehicle,
        road=Road(roughness=shape.road.roughness, speed=shape.road.speed),
        elements={name: element_of(name, entry) for name, entry in shape.elements.items()},
        layouts=layouts,
        indices=settings.indices,
        conventions=settings.conventions,
        optimise=settings.optimise,
        evaluate=settings.evaluate,
        baseline=baseline,
        sweep=None if settings.sweep is None else _sweep(*next(iter(settings.sweep.items()))),
        seed=settings.seed,
        high_pass=settings.high_pass,
        realisations=settings.realisations,
        relative_error=settings.relative_error,
        force=settings.force,
        budgets=settings.budgets,
    )


def struts_of(model: str, entry: Axles | str) -> dict[str, str]:
    """The network of every mount."""
    return entry.model_dump() if isinstance(entry, Axles) else dict.fromkeys(MOUNTS[model], entry)


def element_of(name: str, entry: Range | Amount | ToldKind) -> Element:
    """The element that its entry, or else the unit of its value, tells."""
    if isinstance(entry, ToldKind):
        return entry.element(name)
    if isinstance(entry, Range):
        return kinds_by_unit()[entry.lower.unit].of(Free(entry.lower.value, entry.upper.value, name), name)
    return kinds_by_unit()[entry.unit].of(entry.value, name)


def _sweep(name: str, entry: SweepRange | tuple[Amount, ...]) -> Sweep:
    if not isinstance(entry, SweepRange):
        return Sweep(name, tuple(amount.value for amount in entry), entry[0].unit)
    space = np.geomspace if entry.spacing == "log" else np.linspace
    values = space(entry.lower.value, entry.upper.value, entry.points)
    return Sweep(name, tuple(float(value) for value in values), entry.lower.unit)


def layout_problems(model: str, elements: Mapping[str, Element], layouts: Mapping[str, StrutLayout]) -> Iterator[str]:
    """What is wrong with layouts: networks that cannot be, and elements that are not there."""
    for name, layout in layouts.items():
        if tuple(layout.struts) != MOUNTS[model]:
            yield at(
                ("layouts", name),
                f"got a table; a {model.replace('-', ' ')} has one {MOUNTS[model][0]}, so expected its network in "
                f"quotes, such as {shown(next(iter(layout.struts.values())))}.",
            )
            continue
        alike = len(set(layout.struts.values())) == 1
        for mount, expression in list(layout.struts.items())[: 1 if alike else None]:
            place = ("layouts", name) if alike else ("layouts", name, mount)
            yield from (at(place, problem) for problem in network_problems(expression, elements))


def network_problems(expression: str, elements: Mapping[str, Element]) -> Iterator[str]:
    """What is wrong with one network: its syntax, or elements that are not there."""
    try:
        unknown = [name for name in names(expression) if name not in elements]
        for name in unknown:
            defined = some(elements)
            yield (
                f"got {shown(expression)}: {shown(name)} is not in [elements], where there are {defined}"
                f".{nearest(name, elements)}"
            )
        if not unknown:
            network(expression, **elements)
    except NetworkError as error:
        yield str(error)


def _sweep_problems(study: Study) -> Iterator[str]:
    sweep = study.sweep
    if sweep is None:
        return
    place, name = ("study", "sweep", sweep.element), sweep.element
    if name not in study.elements:
        hint = nearest(name, study.elements)
        yield at(place, f"{shown(name)} is not in [elements], where there are {some(study.elements)}.{hint}")
        return
    element = study.elements[name]
    if isinstance(element.value, Free):
        yield at(place, f"{name} is free; expected an element with a fixed value. Fix it, or leave the sweep out.")
    if element.unit != sweep.unit:
        yield at(place, f"got values in {sweep.unit}, but {name} is in {element.unit}; expected the unit of {name}.")
    if name not in elements_used(study):
        yield at(place, f"{name} is in no layout, so a sweep changes nothing; expected an element that a layout uses.")


def _setting_problems(study: Study) -> Iterator[str]:
    if study.baseline is not None and study.baseline not in study.layouts:
        known = some(study.layouts)
        hint = nearest(study.baseline, study.layouts)
        yield at(("study", "baseline"), f"got {shown(study.baseline)}; expected a layout, one of {known}.{hint}")
    if study.high_pass is not None and "J3" not in study.indices:
        yield at(
            ("study", "high_pass"), 'a filter of J3, which is not in indices; expected "J3" there, or no high_pass.'
        )


def _free_value_problems(study: Study) -> Iterator[str]:
    used = [name for name in elements_used(study) if isinstance(study.elements[name].value, Free)]
    if used and study.optimise is None:
        yield at(
            ("study", "optimise"),
            f'missing, but there are free values, {some(used)}; expected optimise = "norm", or fixed values.',
        )
    if not used and study.optimise is not None:
        yield at(
            ("study", "optimise"),
            f"got {shown(study.optimise)}, but no layout has a free value; expected one such as "
            f'c = {{ from = "100 N s/m", to = "100 kN s/m" }} in [elements], or no optimise.',
        )
