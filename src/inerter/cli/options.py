"""Options that several commands have."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

Output = Annotated[Path | None, Parameter(name=["--output", "-o"], help="Folder for the results.")]
Jobs = Annotated[int | None, Parameter(name=["--jobs", "-j"], help="Number of processes; default: all cores.")]


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
        Path | None, Parameter(help="Certificate of the authority that signed the scheduler's (PEM).")
    ] = None
    tls_cert: Annotated[Path | None, Parameter(help="Client certificate (PEM).")] = None
    tls_key: Annotated[Path | None, Parameter(help="Private key of the client certificate (PEM).")] = None

    @property
    def words(self) -> tuple[str, ...]:
        """The options that were given."""
        given = ((f"--{f.name.replace('_', '-')}", getattr(self, f.name)) for f in fields(self))
        return tuple(word for option, value in given if value is not None for word in (option, str(value)))


OWN = Cluster()
ClusterOptions = Annotated[Cluster, Parameter(name="*")]
Resume = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Continue an interrupted run; what was computed is reused.",
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
ForceFile = Annotated[bool, Parameter(negative="", show_default=False, help="Replace a file that this command wrote.")]
BestFor = Annotated[str | None, Parameter(help="Index for which designs are best, if values are free.")]
SweepPoint = Annotated[int | None, Parameter(help="Number of the point of a sweep, from 1.")]
