"""Options that several commands have."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

from inerter.errors import StudyError
from inerter.units import quote_value


def _whole_number(_: type, tokens: Sequence[Token]) -> int:
    """The integer of an option, which cyclopts would round; raises `ValueError` for any other text."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"got {quote_value(tokens[0].value)}; expected an integer.") from None


Whole = Parameter(converter=_whole_number)
Output = Annotated[Path | None, Parameter(name=["--output", "-o"], help="Folder for the results.")]
Jobs = Annotated[int | None, Whole, Parameter(name=["--jobs", "-j"], help="Number of processes; default: all cores.")]


@dataclass(frozen=True)
class Cluster:
    """A scheduler of dask to which work is handed."""

    scheduler: Annotated[
        str | None, Parameter(help="Address of a Dask scheduler to run on, such as tcp://HOST:8786.")
    ] = None
    scheduler_file: Annotated[
        Path | None, Parameter(help="Scheduler file of Dask, as an alternative to its address.")
    ] = None
    tls_ca_file: Annotated[
        Path | None, Parameter(help="Certificate of the authority that signed the scheduler's certificate (PEM).")
    ] = None
    tls_cert: Annotated[Path | None, Parameter(help="Client certificate (PEM).")] = None
    tls_key: Annotated[Path | None, Parameter(help="Private key of the client certificate (PEM).")] = None

    @property
    def words(self) -> tuple[str, ...]:
        """The options that were given."""
        given = ((f"--{f.name.replace('_', '-')}", getattr(self, f.name)) for f in fields(self))
        return tuple(word for option, value in given if value is not None for word in (option, str(value)))


NO_CLUSTER = Cluster()
ClusterOptions = Annotated[Cluster, Parameter(name="*")]
Resume = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Continue an interrupted run; completed results are reused.",
    ),
]
Force = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Replace previous results once the run has completed. "
        "Your own files in the folder, and files you edited, are kept.",
    ),
]
Json = Annotated[
    bool, Parameter(name="--json", negative="", show_default=False, help="Print the results as JSON instead of text.")
]


@dataclass(frozen=True)
class WorkOptions:
    """Options of a command that computes into a folder: where, with what, and what becomes of results in the folder."""

    output: Output = None
    jobs: Jobs = None
    cluster: ClusterOptions = NO_CLUSTER
    resume: Resume = False
    force: Force = False
    json: Json = False

    @property
    def processes(self) -> int:
        """Number of processes; raises `StudyError` below one."""
        if self.jobs is not None and self.jobs < 1:
            raise StudyError(f"--jobs must be 1 or more processes, got {self.jobs}. Leave it out to use all cores.")
        return self.jobs or os.cpu_count() or 1

    def continuation_clause(self, command: Iterable[str], folder: Path) -> str:
        """Clause on results kept at an interruption, with the complete command that continues the work."""
        jobs = () if self.jobs is None else ("-j", str(self.jobs))
        options = (*jobs, *self.cluster.words, *(("--json",) if self.json else ()))
        again = shlex.join(["inerter", *command, "-o", str(folder), "--resume", *options])
        return f"; completed results are kept. Continue with: {again}"


DEFAULT_WORK = WorkOptions()
LongWork = Annotated[WorkOptions, Parameter(name="*")]
ForceFile = Annotated[bool, Parameter(negative="", show_default=False, help="Replace a file that this command wrote.")]
BestFor = Annotated[str | None, Parameter(help="Index whose best designs are taken, if there are design variables.")]
SweepPoint = Annotated[int | None, Whole, Parameter(help="Number of the point of a sweep, from 1.")]
AtCondition = Annotated[str | None, Parameter(help="Name or number of the operating condition.")]
