"""Registry of the methods, by the names in files."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Container, Mapping
from typing import Any

from inerter.errors import Status, StatusKind
from inerter.field_metadata import Field, fields_of
from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Method, NonlinearitySupport
from inerter.methods.norm import Norm
from inerter.methods.statistical_linearisation import StatisticalLinearisation
from inerter.registry import Registry

METHODS: Registry[type[Method]] = Registry(
    "method",
    "name",
    (
        "description",
        "nonlinearity_support",
        "needs_amplitude",
        "supports_optimisation",
        "estimate",
        "estimate_many",
        "objective",
    ),
    (Norm, StatisticalLinearisation, ExpectedValue, ApproximateLinear),
    {"words": "description", "sees": "nonlinearity_support", "searches": "supports_optimisation"},
)
DEFAULT = Norm.name  # judges the designs of a study that names no method
_UNCERTAIN = (StatusKind.INACCURATE, StatusKind.FAILED)  # of an approximate method: simulation may find a value


def is_blind(name: str) -> bool:
    """Whether the method models neither friction nor gaps."""
    return _kind(name).nonlinearity_support is NonlinearitySupport.NEITHER


def refuses_gaps(name: str) -> bool:
    """Whether the method does not support gaps."""
    return _kind(name).nonlinearity_support is NonlinearitySupport.FRICTION


def needs_amplitude(name: str) -> bool:
    """Whether a peak gain of a design with friction or gaps needs the amplitude of its force."""
    return bool(_kind(name).needs_amplitude)


def searches(name: str) -> bool:
    """Whether the method supports optimisation."""
    return bool(_kind(name).supports_optimisation)


def words_of(name: str) -> str:
    """Description of the method's values, to follow "Values are"."""
    return str(_kind(name).description)


def brief_words_of(name: str) -> str:
    """Method in one or two words, to follow "by": its `brief`, or else its name."""
    return str(getattr(_kind(name), "brief", name))


def nonlinearities_of(name: str) -> NonlinearitySupport:
    """Nonlinearities that the method models."""
    return NonlinearitySupport(_kind(name).nonlinearity_support)


def simulating_method() -> str:
    """Name of the first method that models both friction and gaps."""
    return next(name for name in METHODS if nonlinearities_of(name) is NonlinearitySupport.BOTH)


def averages(name: str) -> bool:
    """Whether the values of the method are means over a number of random inputs."""
    return "realisations" in _settings(_kind(name))


def without_roads(name: str, *, has_play: bool) -> str:
    """Given method unless it averages; else statistical linearisation, or the norm if blind or if `has_play`."""
    if not averages(name):
        return name
    return DEFAULT if is_blind(name) or has_play else StatisticalLinearisation.name


def decisive_method_clause(name: str, status: Status) -> str:
    """Clause on the method that can decide an uncertain result, to follow the message of its status.

    Empty for a status that simulation confirms, such as that of an infinite variance.
    """
    others = [other for other in METHODS if nonlinearities_of(other) is NonlinearitySupport.BOTH]
    named = any(other in status.message for other in others)
    if status.kind not in _UNCERTAIN or nonlinearities_of(name) is NonlinearitySupport.BOTH or not others or named:
        return ""
    return f"; {others[0]} simulates it, and can decide"


def with_decisive_method(status: Status, name: str) -> Status:
    """The status of a result of a method; where another one can decide an uncertain result, its message says so."""
    clause = decisive_method_clause(name, status)
    return dataclasses.replace(status, message=f"{status.message.rstrip('.')}{clause}") if clause else status


def methods_that(can: Callable[[str], object]) -> tuple[str, ...]:
    """The names of those methods."""
    return tuple(name for name in METHODS if can(name))


def with_gradients(conventions: str) -> tuple[Method, ...]:
    """Methods whose objectives have gradients, under these conventions; those that model most first.

    They are quick, and so the first look at a search of what is not.
    """
    names = [name for name in METHODS if getattr(_kind(name), "has_gradients", False)]
    names.sort(key=lambda name: nonlinearities_of(name).value, reverse=True)
    return tuple(make_method(name, {"conventions": conventions}, {}) for name in names)


def method_settings(name: str) -> tuple[Field, ...]:
    """The settings that are the method's own, and no other's."""
    return fields_of(_kind(name))


def missing_settings(name: str, given: Container[str]) -> list[Field]:
    """Required settings of the method whose keys are not in `given`."""
    bare = {f.name for f in dataclasses.fields(_kind(name)) if f.default is f.default_factory is dataclasses.MISSING}
    return [field for field in method_settings(name) if field.name in bare and field.key not in given]


def make_method(name: str, shared: Mapping[str, Any], own: Mapping[str, float]) -> Method:
    """Method of that name, with its `own` settings and those `shared` settings that it has and that are not None."""
    kind = _kind(name)
    given = {key: shared[key] for key in _settings(kind) & set(shared) if shared[key] is not None}
    given |= {field.name: own[field.key] for field in method_settings(name) if field.key in own}
    method: Method = kind(**given)
    return method


def _kind(name: str) -> Any:
    return METHODS[name]


def _settings(kind: Any) -> set[str]:
    return {field.name for field in dataclasses.fields(kind)}
