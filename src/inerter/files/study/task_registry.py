"""Registry of tasks: analyses of the best designs of a study, by key."""

from __future__ import annotations

from dataclasses import dataclass

from inerter.registry import Registry


@dataclass(frozen=True)
class TaskEntry:
    """Task: its class as module:class, imported when a study uses the task, and the keys of [study] that belong to it.

    `keys` is a class whose fields declare those keys; its instance with the values of a file is `study.tasks[key]`.

    >>> import inerter as it
    >>> it.TASKS["tolerances"].key
    'tolerances'
    """

    key: str
    home: str
    keys: type | None = None


TASKS = Registry(
    "task",
    "key",
    ("home", "keys"),
    own=(
        TaskEntry("fronts", "inerter.tasks.fronts:Fronts"),
        TaskEntry("tolerances", "inerter.tasks.tolerances:Tolerances"),
        TaskEntry("budgets", "inerter.tasks.budgets:Budgets"),
    ),
)
