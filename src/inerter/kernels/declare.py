"""How compiled code is declared: as plain functions, which are compiled, or read from the cache, at the first call.

The compiler itself is behind `inerter.kernels.compiler`, which is loaded by that first call and by nothing else.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])
Signature = str | Callable[[Any], Any] | None  # in the compiler's words, or made from its module of types


class Kernel:
    """A compiled function that Python calls. `title` tells people what it computes."""

    def __init__(
        self, function: Callable[..., Any], title: str, signature: Signature, *, fused: bool, borrowing: bool
    ) -> None:
        update_wrapper(self, function)
        self.function, self.title, self.signature = function, title, signature
        self.fused, self.borrowing = fused, borrowing
        self._compiled: Callable[..., Any] | None = None

    def __call__(self, *args: Any) -> Any:
        """Call it.

        Python code that makes the types of arrays that are returned runs inside the call. Where Ctrl-C breaks that, the
        call goes on, returns, and Python raises SystemError ("returned a result with an exception set") whose cause is
        the KeyboardInterrupt, or another such error, and so on down to it.
        """
        compiled = self._compiled or self.ready()
        try:
            return compiled(*args)
        except SystemError as error:
            cause: BaseException | None = error
            while isinstance(cause, SystemError):
                cause = cause.__cause__
            if isinstance(cause, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            raise

    def ready(self) -> Any:
        """The compiled function: for a kernel with a signature, compiled or read from the cache by now."""
        if self._compiled is None:
            from inerter.kernels.compiler import compiled  # noqa: PLC0415 - heavy

            self._compiled = compiled(self.function, self.signature, fused=self.fused, borrowing=self.borrowing)
        return self._compiled

    @property
    def _numba_type_(self) -> Any:
        return self.ready()._numba_type_


def kernel(
    title: str, signature: Signature = None, *, fused: bool = False, borrowing: bool = False
) -> Callable[[F], F]:
    """Compile for Python to call, and keep the result between processes.

    With a `signature` it can be made ready before it is called. A signature with a type that is returned is the only
    one; other arguments than those of one without it compile the function once more. `fused`: a product and a sum may
    become one instruction, with one rounding. `borrowing`: without reference counts.
    """

    def declared(function: F) -> F:
        return cast("F", Kernel(function, title, signature, fused=fused, borrowing=borrowing))

    return declared


class Part:
    """A function that is compiled within the compiled code that calls it; see `part`."""

    def __init__(self, function: Callable[..., Any], signature: Signature, borrowing: bool, place: str) -> None:
        update_wrapper(self, function)
        self.function, self.signature, self.borrowing, self.place = function, signature, borrowing, place

    def __call__(self, *args: Any) -> Any:
        return self.function(*args)

    @cached_property
    def _dispatcher(self) -> Any:
        from inerter.kernels.compiler import PartDispatcher  # noqa: PLC0415 - heavy

        return PartDispatcher(self.function, self.signature, self.borrowing, self.place)

    @property
    def _numba_type_(self) -> Any:
        return self._dispatcher._numba_type_


def part(
    signature: Signature = None, *, borrowing: bool = False, apart: bool = False, inside: bool = False
) -> Callable[[F], F]:
    """Compile as a part of the compiled code that calls it, and only there: from elsewhere it is plain Python.

    The compiler would make every function ready to be called from Python, optimise it and keep it on disk, for itself
    and once more in everything that calls it; that took half of the time. `apart` parts are not copied into what calls
    them: right for long ones that are called in many places. `inside` ones always are, fused: what calls them with
    constants becomes code for these, and yet they are read and typed only once. Calls with constants share the one
    `signature` given.
    """
    place = "apart" if apart else "inside" if inside else "within"

    def declared(function: F) -> F:
        return cast("F", Part(function, signature, borrowing, place))

    return declared


class Instruction:
    """What the compiler is told to generate, as in `numba.extending.intrinsic`."""

    def __init__(self, definition: Callable[..., Any]) -> None:
        self.definition = definition

    @cached_property
    def _numba_type_(self) -> Any:
        from inerter.kernels.compiler import instruction_type  # noqa: PLC0415 - heavy

        return instruction_type(self.definition)


def instruction(definition: Callable[..., Any]) -> Any:
    """Declare an instruction: the definition gets the types of its arguments, and imports the compiler itself."""
    return Instruction(definition)
