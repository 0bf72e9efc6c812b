"""Dask cluster of a command, if its options name a scheduler."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from inerter.cli.options import Cluster
from inerter.cli.streams import say
from inerter.errors import StudyError, WorkError
from inerter.work import cluster as clusters
from inerter.work.progress import report

_ANSWER = "10s"  # within which a scheduler must


@contextmanager
def workers(asked: Cluster, jobs: int | None = None) -> Iterator[Executor | None]:
    """Executor on the cluster of the options, with its worker count reported on stderr; None without a scheduler.

    Raises `StudyError` for options that do not go together, and `WorkError` if the cluster cannot be used.
    """
    if asked.scheduler is None and asked.scheduler_file is None:
        if asked.words:
            raise StudyError(f"Got {asked.words[0]} without a scheduler; add --scheduler tls://HOST:8786.")
        yield None
        return
    if asked.scheduler is not None and asked.scheduler_file is not None:
        raise StudyError("Got --scheduler and --scheduler-file; give one of them.")
    if jobs is not None:
        raise StudyError(
            "Got --jobs and a scheduler. Leave --jobs out: the cluster determines the number of processes."
        )
    tls = {"tls_ca_file": asked.tls_ca_file, "tls_client_cert": asked.tls_cert, "tls_client_key": asked.tls_key}
    given = {name: str(path) for name, path in tls.items() if path is not None}
    with cluster_executor(asked.scheduler, asked.scheduler_file, given) as executor:
        clusters.check(executor)
        say(_describe_workers(clusters.places(executor)))
        yield executor


@contextmanager
def cluster_executor(address: str | None, file: Path | None, tls: Mapping[str, str]) -> Iterator[Executor]:
    """Executor on a running cluster, by the address or the file of its scheduler.

    `tls` are fields of dask's `Security`.

    Raises `StudyError` for an address that is none, `WorkError` if dask is not installed or the scheduler does not
    answer.
    """
    report("connecting to the scheduler")
    try:
        import distributed
    except ImportError:
        raise WorkError(
            'A cluster needs Dask, which is not installed: pip install "inerter[cluster]", then try again.'
        ) from None
    try:
        distributed.comm.get_address_host_port(address or "host:1")
    except ValueError as error:
        raise StudyError(f'Got the scheduler "{address}" ({error}); expected, for example, tcp://HOST:8786.') from None
    if file is not None and not file.is_file():
        raise WorkError(f"{file}: file not found; a scheduler writes it with: dask scheduler --scheduler-file")
    security = distributed.Security(require_encryption=True, **tls) if tls else None
    where = {"address": address} if file is None else {"scheduler_file": str(file)}
    for name in tuple(logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado", "asyncio"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what goes wrong is told by errors
    try:
        client = distributed.Client(**where, security=security, timeout=_ANSWER, set_as_default=False)
    except Exception as error:  # of sockets, of TLS, of addresses that are none
        raise WorkError(
            f"no Dask scheduler answers at {address or file} ({str(error) or type(error).__name__}). Check that "
            "it is running, its address, and whether it requires TLS."
        ) from None
    with client:
        yield client.get_executor(pure=False)


def _describe_workers(places: Sequence[clusters.Worker]) -> str:
    threads = sum(place.threads for place in places)
    hosts = len({place.host for place in places})
    counts = ((len(places), "worker"), (threads, "thread"), (hosts, "machine"))
    workers, in_all, machines = (f"{count} {what}{'' if count == 1 else 's'}" for count, what in counts)
    hint = "; workers of one thread each are faster (--nthreads 1)" if threads > len(places) else ""
    return f"{workers} with {in_all} on {machines}{hint}"
