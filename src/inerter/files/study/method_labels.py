"""Methods of a study in the terms of the field: with friction, without."""

from __future__ import annotations

from collections import Counter

from inerter.files.study.study import Study
from inerter.methods.method import NonlinearitySupport
from inerter.methods.registry import brief_words_of, nonlinearities_of
from inerter.networks.elements.roles import GuardRole

_SEEN = {
    NonlinearitySupport.NEITHER: (),
    NonlinearitySupport.FRICTION: (GuardRole.FORCE,),
    NonlinearitySupport.BOTH: tuple(GuardRole),
}


def method_labels(study: Study) -> dict[str, str]:
    """Words for each method of `evaluate`, such as "with friction"; empty without nonlinear elements.

    Two methods that see the same are told apart by what they are.
    """
    there = _losses(study)
    told = {method: _describe_guards(there, _SEEN[nonlinearities_of(method)]) for method in study.evaluate}
    count = Counter(told.values())
    return {method: words if count[words] == 1 else _apart(words, method) for method, words in told.items()}


def neglect_clause(study: Study, method: str) -> str:
    """Nonlinear effects of the layouts that a method neglects, such as "without friction"; empty if none."""
    seen = _SEEN[nonlinearities_of(method)]
    without = [word for word, by in _losses(study).items() if by not in seen]
    return f"without {' or '.join(without)}" if without else ""


def limit_basis(study: Study) -> str:
    """Method by which the values of limits are computed, if the study has several, and the condition; may be empty."""
    by = []
    if study.optimise is not None and set(study.methods) != {study.optimise}:
        by = [neglect_clause(study, study.optimise) or f"by {brief_words_of(study.optimise)}"]
    return ", ".join([*by, *["in the worst condition"] * bool(study.conditions)])


def _losses(study: Study) -> dict[str, GuardRole]:
    """Nonlinear effects of the layouts that linear analysis neglects, with the kind of guard of each: force first."""
    parts = [part for own in study.nonlinear_parts.values() for part in own]
    found = {part.effect or part.key: part.switch.guard for part in parts if part.switch is not None}
    return dict(sorted(found.items(), key=lambda one: list(GuardRole).index(one[1])))


def _describe_guards(there: dict[str, GuardRole], seen: tuple[GuardRole, ...]) -> str:
    with_, without = ([word for word, by in there.items() if (by in seen) == wanted] for wanted in (True, False))
    words = [f"with {' and '.join(with_)}"] * bool(with_) + [f"without {' or '.join(without)}"] * bool(without)
    return ", ".join(words)


def _apart(words: str, method: str) -> str:
    by = f"by {brief_words_of(method)}"
    return f"{words} {by}" if words else by
