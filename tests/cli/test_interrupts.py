"""Ctrl-C is one exception to the commands, also where a compiled call had hidden it."""

from __future__ import annotations

import pytest

from inerter.cli.interrupts import interruptible


def test_an_interrupt_hidden_by_a_compiled_call_is_an_interrupt() -> None:
    with pytest.raises(KeyboardInterrupt), interruptible():
        raise SystemError("returned a result with an exception set") from KeyboardInterrupt()


def test_one_hidden_twice_is_an_interrupt_too() -> None:
    inner = SystemError("returned a result with an exception set")
    inner.__cause__ = KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt), interruptible():
        raise SystemError("returned a result with an exception set") from inner


@pytest.mark.parametrize("cause", [None, ValueError("wrong"), SystemError("inner")])
def test_another_system_error_stays_what_it_is(cause: Exception | None) -> None:
    with pytest.raises(SystemError, match="internal"), interruptible():
        raise SystemError("internal") from cause
