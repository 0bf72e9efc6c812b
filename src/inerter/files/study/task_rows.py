"""The table of tasks: by key, what is asked of the best designs of a study besides their values."""

from __future__ import annotations

from dataclasses import dataclass

from inerter.rows import Rows


@dataclass(frozen=True)
class TaskRow:
    """A task: where it is, as module:class, imported when a study asks for it, and the keys that [study] has for it.

    `keys` is a declared class; what a file says of it is `study.tasks[key]`.
    """

    key: str
    home: str
    keys: type | None = None


TASKS = Rows(
    "task",
    "key",
    ("home", "keys"),
    own=(
        TaskRow("fronts", "inerter.tasks.fronts:Fronts"),
        TaskRow("tolerances", "inerter.tasks.tolerances:Tolerances"),
        TaskRow("budgets", "inerter.tasks.budgets:Budgets"),
    ),
)
