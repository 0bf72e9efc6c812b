"""Entry point of the command: handles Ctrl-C and replaces the standard streams before other modules are imported."""

from __future__ import annotations

import atexit
import os
import signal
import sys

from inerter.cli.streams import replace_standard_streams
from inerter.statements import INTERRUPTED
from inerter.work.own_process import leave, look_for_garbage_seldom


def main() -> None:
    """Run the command line."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:  # as it is for work in the background
        signal.signal(signal.SIGINT, _stop)
    replace_standard_streams()
    look_for_garbage_seldom()
    codes: list[int] = []
    atexit.register(_leave, codes)  # before all that others register: it is called after them
    from inerter.cli.main import main as command

    codes.append(command())
    sys.exit(codes[-1])


def _leave(codes: list[int]) -> None:
    if codes:  # there are none after an error of the program
        leave(codes[-1])


def _stop(number: int, frame: object) -> None:
    os.write(2, b"inerter: interrupted.\n")
    os._exit(INTERRUPTED)
