"""The cluster on which a command works, if it is told to."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager

from inerter.cli.options import Cluster
from inerter.errors import StudyError
from inerter.work import cluster as clusters


@contextmanager
def workers(asked: Cluster, jobs: int | None = None) -> Iterator[Executor | None]:
    """An executor on the cluster that is asked for, whose workers are told; None if none is.

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
        raise StudyError("Got --jobs and a scheduler; leave --jobs out: the cluster has as many processes as it has.")
    tls = {"tls_ca_file": asked.tls_ca_file, "tls_client_cert": asked.tls_cert, "tls_client_key": asked.tls_key}
    given = {name: str(path) for name, path in tls.items() if path is not None}
    with clusters.connected(asked.scheduler, asked.scheduler_file, given) as executor:
        clusters.check(executor)
        print(f"inerter: {_told(clusters.places(executor))}", file=sys.stderr, flush=True)
        yield executor


def _told(places: Sequence[clusters.Place]) -> str:
    threads = sum(place.threads for place in places)
    hosts = len({place.host for place in places})
    counts = ((len(places), "worker"), (threads, "thread"), (hosts, "machine"))
    workers, in_all, machines = (f"{count} {what}{'' if count == 1 else 's'}" for count, what in counts)
    hint = "; workers of one thread each are faster (--nthreads 1)" if threads > len(places) else ""
    return f"{workers} with {in_all} on {machines}{hint}"
