"""Options that several commands have."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

Output = Annotated[Path | None, Parameter(name=["--output", "-o"], help="Folder for the results.")]
Jobs = Annotated[int | None, Parameter(name=["--jobs", "-j"], help="Processes to use; all cores if left out.")]


@dataclass(frozen=True)
class Cluster:
    """A scheduler of dask to which work is handed."""

    scheduler: Annotated[
        str | None, Parameter(help="Work on the cluster of this dask scheduler, such as tcp://HOST:8786.")
    ] = None
    scheduler_file: Annotated[Path | None, Parameter(help="The same, by the file that the scheduler wrote.")] = None
    tls_ca_file: Annotated[Path | None, Parameter(help="Certificate of who signs for the scheduler (PEM).")] = None
    tls_cert: Annotated[Path | None, Parameter(help="Own certificate (PEM).")] = None
    tls_key: Annotated[Path | None, Parameter(help="Own private key (PEM).")] = None

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
        help="Continue an interrupted run: what its journal holds is not computed again.",
    ),
]
Force = Annotated[
    bool,
    Parameter(
        negative="",
        show_default=False,
        help="Replace the results in the folder when the new ones are whole. "
        "Files that inerter did not write, or that were edited since, are never replaced.",
    ),
]
Json = Annotated[
    bool, Parameter(name="--json", negative="", show_default=False, help="Print the results as JSON instead of text.")
]
