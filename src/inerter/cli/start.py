"""Where the command begins: it heeds Ctrl-C and has its streams before anything else is loaded."""

from __future__ import annotations

import gc
import os
import signal

from inerter.cli.interrupts import INTERRUPTED
from inerter.cli.streams import endure

_GARBAGE = 200_000  # new objects until garbage is looked for: most of a command's stay, and looking took a tenth of it


def main() -> None:
    """Run the command line."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:  # as it is for work in the background
        signal.signal(signal.SIGINT, _stop)
    endure()
    gc.set_threshold(_GARBAGE, 20, 100)
    from inerter.cli.main import main as command

    command()


def _stop(number: int, frame: object) -> None:
    os.write(2, b"inerter: interrupted.\n")
    os._exit(INTERRUPTED)
