"""The server of the web that carries the workbench, until it is interrupted."""

from __future__ import annotations

import os
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread, current_thread, main_thread
from typing import Any

import uvicorn

from inerter.app.requests import opened
from inerter.app.routes import application
from inerter.app.server import Server
from inerter.errors import StudyError, WorkError

ADDRESS, PORT, TOKEN = "127.0.0.1", 8722, "INERTER_TOKEN"
_TRIED = 20  # ports, where none is asked for
_NOTHING: dict[str, Any] = {"name": "", "text": "", "study": {}, "problems": []}
_BACKLOG = 2048  # connections that wait to be taken


def run(
    study: str | Path | None,
    *,
    port: int | None,
    browser: bool,
    limits: tuple[int, int],
    folder: str | Path | None,
    tell: Callable[[str], object],
) -> None:
    """Serve until an interrupt: see `serve`."""
    if min(limits) < 1:
        raise StudyError(f"A limit is a number of bytes from 1 on, got {min(limits)}.")
    start = _NOTHING if study is None else _started(Path(study))
    with _listening(port) as listening, _folder(folder) as root, _ended_gently():
        _many_connections()
        token = os.environ.get(TOKEN) or secrets.token_urlsafe(24)
        number = int(listening.getsockname()[1])
        link = f"http://{ADDRESS}:{number}/#token={token}"
        app = application(Server(root, start), token, lambda: number, *limits)
        settings: dict[str, Any] = {"ws": "none", "proxy_headers": False, "server_header": False, "access_log": False}
        config = uvicorn.Config(
            app, log_level="warning", lifespan="on", timeout_graceful_shutdown=2, backlog=_BACKLOG, **settings
        )
        tell(link)
        if browser:
            Thread(target=webbrowser.open, args=(link,), daemon=True).start()
        with suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])


@contextmanager
def _ended_gently() -> Iterator[None]:
    """Another process that ends this one lets it put its things away, as Ctrl-C does."""
    if current_thread() is not main_thread():
        yield
        return

    def end(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _started(path: Path) -> dict[str, Any]:
    try:
        return opened(path)
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}). Check the path.") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: not UTF-8 text; expected a study file.") from None


@contextmanager
def _listening(port: int | None) -> Iterator[socket.socket]:
    """A socket on this machine alone."""
    if port is not None and not 0 <= port <= 65535:
        raise StudyError(f"A port is a number from 0 to 65535, got {port}.")
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        if sys.platform != "win32":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        for number in [port] if port is not None else [*range(PORT, PORT + _TRIED), 0]:
            try:
                listening.bind((ADDRESS, number))
                break
            except OSError as error:
                if port is not None:
                    raise StudyError(f"Port {port} cannot be taken ({error.strerror}). Leave it out.") from None
        else:
            raise WorkError("no port is free on this machine.")
        listening.listen(_BACKLOG)
        yield listening


@contextmanager
def _folder(folder: str | Path | None) -> Iterator[Path]:
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        yield Path(folder).absolute()
        return
    with TemporaryDirectory(prefix="inerter-", ignore_cleanup_errors=True) as made:
        yield Path(made)


def _many_connections() -> None:
    """As many connections at the same time as this machine allows."""
    with suppress(ImportError, ValueError, OSError):
        import resource  # noqa: PLC0415 - not on all machines

        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
