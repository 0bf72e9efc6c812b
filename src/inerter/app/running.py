"""The server of the web that carries the workbench, until it is interrupted."""

from __future__ import annotations

import os
import re
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name
from tempfile import TemporaryDirectory
from threading import Event, Thread, current_thread, main_thread
from typing import Any

import uvicorn

from inerter.app.study_text import read_file
from inerter.errors import StudyError, WorkError
from inerter.work.processes import Processes

ADDRESS, PORT, TOKEN = "127.0.0.1", 8722, "INERTER_TOKEN"
_TRIED = 20  # ports, where none is asked for
_BACKLOG = 2048  # connections that wait to be taken


def run(
    study: object,
    *,
    port: int | None,
    browser: bool,
    limits: tuple[int, int],
    folder: str | Path | None,
    tell: Callable[[str], object],
) -> None:
    """Serve until an interrupt: see `serve`."""
    if min(limits) < 1:
        raise StudyError(f"A limit must be a positive number of bytes, got {min(limits)}.")
    file, token = _text_of(study), _token()
    with _listening(port) as listening, _folder(folder) as root, _ended_gently() as ended:
        _many_connections()
        quick = Processes(1)
        begun = Thread(target=_begin, args=(quick,), daemon=True)
        begun.start()
        number = int(listening.getsockname()[1])
        link = f"http://{ADDRESS}:{number}/#token={token}"
        tell(link)
        if browser:
            Thread(target=webbrowser.open, args=(link,), daemon=True).start()
        app = import_module("inerter.app.routes").of_file(file, root, quick, token, number, limits)
        begun.join()
        settings: dict[str, Any] = {"ws": "none", "proxy_headers": False, "server_header": False, "access_log": False}
        config = uvicorn.Config(
            app, log_level="warning", lifespan="on", timeout_graceful_shutdown=2, backlog=_BACKLOG, **settings
        )
        if not ended.is_set():  # nor was an interrupt swallowed by what was loaded
            with suppress(KeyboardInterrupt):
                uvicorn.Server(config).run(sockets=[listening])


@contextmanager
def _ended_gently() -> Iterator[Event]:
    """Raise KeyboardInterrupt at SIGTERM within the block, so that cleanup runs as after Ctrl-C.

    The event tells of both: some libraries swallow every exception while they are loaded, that of an interrupt too.
    """
    ended = Event()
    if current_thread() is not main_thread():
        yield ended
        return

    def end(number: int, frame: object) -> None:
        ended.set()
        raise KeyboardInterrupt

    before = {number: signal.signal(number, end) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield ended
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _begin(process: Processes) -> None:
    """Have a process begin while this one loads what it needs, and load what answers first."""
    with suppress(Exception):  # what fails is begun again when it is needed
        process.submit(resolve_name, "inerter.app.answers:first")


def _text_of(study: object) -> tuple[str, str, Path | None] | None:
    """Name and text of a study, and its file if it is given by a path."""
    if study is None:
        return None
    if not isinstance(study, str | Path):
        text: str = resolve_name("inerter.files.study.quantity_texts:write_resolved")(study)
        return "study.toml", text, None
    path = Path(study).absolute()
    text = read_file(Path(study))
    return path.name, text, path


def _token() -> str:
    """The token that the environment gives, or a new one."""
    given = os.environ.get(TOKEN)
    if given is not None and not re.fullmatch(r"[A-Za-z0-9_-]{16,200}", given):
        raise StudyError(
            f"{TOKEN} must have 16 to 200 letters, digits, hyphens and underscores. Leave it out for a new token."
        )
    return given or secrets.token_urlsafe(24)


@contextmanager
def _listening(port: int | None) -> Iterator[socket.socket]:
    """A socket on this machine alone."""
    if port is not None and not 0 <= port <= 65535:
        raise StudyError(f"A port must be a number from 0 to 65535, got {port}.")
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        if sys.platform != "win32":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        for number in [port] if port is not None else [*range(PORT, PORT + _TRIED), 0]:
            try:
                listening.bind((ADDRESS, number))
                break
            except OSError as error:
                if port is not None:
                    raise StudyError(
                        f"Port {port} is not available ({error.strerror}). Leave it out for a free port."
                    ) from None
        else:
            raise WorkError("no port is free on this machine.")
        listening.listen(_BACKLOG)
        yield listening


@contextmanager
def _folder(folder: str | Path | None) -> Iterator[Path]:
    if folder is not None:
        try:
            Path(folder).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StudyError(
                f"{folder}: cannot be used as the folder of jobs ({error.strerror}). Choose another."
            ) from None
        yield Path(folder).absolute()
        return
    with TemporaryDirectory(prefix="inerter-", ignore_cleanup_errors=True) as made:
        yield Path(made)


def _many_connections() -> None:
    """Raise the limit of open files to the maximum of this machine, for as many connections."""
    with suppress(ImportError, ValueError, OSError):
        resource = import_module("resource")  # not on all machines
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
