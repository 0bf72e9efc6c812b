"""Declaration of compiled code: plain functions, compiled, or read from the cache, at the first call.

The compiler itself is behind `inerter.kernels.compiler`, which is loaded by that first call and by nothing else.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, TypeVar, cast

import numpy as np

from inerter.errors import InerterError
from inerter.work.progress import report_if_long

F = TypeVar("F", bound=Callable[..., Any])
Signature = str | Callable[[Any], Any] | None  # in the compiler's words, or made from its module of types
TUNED, PLAIN, NONE = "tuned", "plain", "none"
SWITCH = "INERTER_COMPILER"


def compiler_mode() -> str:
    """Mode of compilation: TUNED, PLAIN (documented features of the compiler alone) or NONE (kernels run as Python).

    Raises `InerterError` if the environment names another one.
    """
    chosen = os.environ.get(SWITCH) or TUNED
    if chosen not in (TUNED, PLAIN, NONE):
        raise InerterError(f'{SWITCH}: unknown mode; got {chosen!r}, expected "{TUNED}", "{PLAIN}" or "{NONE}".')
    return chosen


def numba_internals() -> Any:
    """The module that rests on private parts of the compiler; imported only while code is compiled."""
    from inerter.kernels import numba_compiler  # noqa: PLC0415 - heavy

    return numba_compiler


class Kernel:
    """A compiled function that Python calls, or other compiled code by its address; `title` names the result."""

    def __init__(
        self,
        function: Callable[..., Any],
        title: str,
        signature: Signature,
        *,
        fused: bool,
        borrowing: bool,
        by_address: bool,
    ) -> None:
        update_wrapper(self, function)
        self.function, self.title, self.signature = function, title, signature
        self.options = {"fused": fused, "borrowing": borrowing, "by_address": by_address}
        self._compiled: Callable[..., Any] | None = None
        self._called: Callable[..., Any] | None = None
        self.typed = False

    def __reduce__(self) -> str:
        """Another process finds it by its name."""
        return str(self.function.__qualname__)

    def __call__(self, *args: Any) -> Any:
        """Call it.

        Python code that makes the types of arrays that are returned runs inside the call. Where Ctrl-C breaks that, the
        call goes on, returns, and Python raises SystemError ("returned a result with an exception set") whose cause is
        the KeyboardInterrupt, or another such error, and so on down to it.
        """
        called = self._called or self._callable()
        try:
            return called(*args)
        except SystemError as error:
            cause: BaseException | None = error
            while isinstance(cause, SystemError):
                cause = cause.__cause__
            if isinstance(cause, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            raise

    def _callable(self) -> Callable[..., Any]:
        """Function to call: of a typed kernel its machine code, since inspection of the structures takes longer."""
        compiled = self.ready()
        self._called = compiled
        if self.typed and compiler_mode() == TUNED:
            self._called = numba_internals().entry_of(compiled)
        return self._called

    def ready(self) -> Any:
        """The compiled function: for a kernel with a signature, compiled or read from the cache by now."""
        if self._compiled is None and compiler_mode() == NONE:
            self._compiled = np.errstate(all="ignore")(self.function)  # without warnings, as compiled code
        if self._compiled is None:
            with report_if_long(f"compiling a numerical kernel ({self.title})"):
                from inerter.kernels.compiler import compile_function  # noqa: PLC0415 - heavy

                self._compiled = compile_function(self.function, self.signature, **self.options)
        return self._compiled

    @property
    def _numba_type_(self) -> Any:
        return self.ready()._numba_type_


def kernel(
    title: str,
    signature: Signature = None,
    *,
    typed: bool = False,
    fused: bool = False,
    borrowing: bool = False,
    by_address: bool = False,
) -> Callable[[F], F]:
    """Compile for Python to call, and keep the result between processes.

    With a `signature`, or `typed` by annotations, it can be made ready before it is called. A signature with a type
    that is returned is the only one; other arguments than those of one without it compile the function once more.
    `fused`: a product and a sum may become one instruction, with one rounding. `borrowing`: without reference counts.
    What is only called `by_address`, see `FunctionAt`, is not made ready for Python, which takes half of the time of
    a short one.
    """

    def decorate(function: F) -> F:
        given = _signature_from_annotations(function) if typed else signature
        made = Kernel(function, title, given, fused=fused, borrowing=borrowing, by_address=by_address)
        made.typed = typed
        return cast("F", made)

    return decorate


def _signature_from_annotations(function: Callable[..., Any]) -> Signature:
    """Signature from a function's annotations: numbers and the types of `kernels.arrays`."""

    def signature(types: Any) -> Any:
        return numba_internals().signature_of(function)

    return signature


class Part:
    """A function that is compiled within the compiled code that calls it; see `part`."""

    def __init__(
        self,
        function: Callable[..., Any],
        signature: Signature,
        borrowing: bool,
        fused: bool,
        place: str,
        plain: Callable[..., Any] | None,
    ) -> None:
        update_wrapper(self, function)
        self.function, self.signature, self.borrowing, self.fused = function, signature, borrowing, fused
        self.place, self.plain = place, getattr(plain, "function", function)

    def __call__(self, *args: Any) -> Any:
        return self.plain(*args)

    @cached_property
    def _dispatcher(self) -> Any:
        return numba_internals().PartDispatcher(self.function, self.signature, self.borrowing, self.fused, self.place)

    @property
    def _numba_type_(self) -> Any:
        return self._dispatcher._numba_type_


def part(
    signature: Signature = None,
    *,
    typed: bool = False,
    borrowing: bool = False,
    apart: bool = False,
    inside: bool = False,
    fused: bool = False,
    plain: Callable[..., Any] | None = None,
) -> Callable[[F], F]:
    """Compile as a part of the compiled code that calls it, and only there: from elsewhere it is plain Python.

    The compiler would make every function ready to be called from Python, optimise it and keep it on disk, for itself
    and once more in everything that calls it; that took half of the time. `apart` parts are not copied into what calls
    them: right for long ones that are called in many places. `inside` ones always are: what calls them with
    constants becomes code for these, and yet they are read and typed only once, and structures cost nothing to hand
    over. Calls with constants share the one `signature` given, or that of the annotations if it is `typed`. `fused` is
    as in `kernel`. `plain` does the same without private parts of the compiler, where the function needs them.
    """
    place = "apart" if apart else "inside" if inside else "within"

    def decorate(function: F) -> F:
        given = _signature_from_annotations(function) if typed else signature
        return cast("F", Part(function, given, borrowing, fused, place, plain))

    return decorate


class Instruction:
    """Instruction for the compiler, as in `numba.extending.intrinsic`, with an equivalent plain function."""

    def __init__(self, plain: Callable[..., Any]) -> None:
        self.plain = plain

    def __call__(self, *args: Any) -> Any:
        return self.plain(*args)

    @cached_property
    def _numba_type_(self) -> Any:
        from inerter.kernels import numba_lanes  # noqa: PLC0415 - heavy

        return numba_internals().instruction_type(getattr(numba_lanes, self.plain.__name__))


def instruction(plain: F) -> F:
    """Declare an instruction by its plain function; `numba_lanes` has the definition of the same name."""
    return cast("F", Instruction(plain))


class FunctionAt:
    """Compiled code that calls other compiled code of one type by its address; see `Part.plain` for code without."""

    def __init__(self, kind: Callable[..., Any]) -> None:
        """Make the type of `kind`, a function with annotations."""
        self.signature, self._alive = _signature_from_annotations(kind), list[Any]()

    @cached_property
    def _numba_type_(self) -> Any:
        return numba_internals().function_at_type(self.signature)

    def address_of(self, function: Any) -> int:
        """The address of a kernel of this type, compiled by now; 0 where none is needed."""
        if compiler_mode() != TUNED:
            return 0
        self._alive.append(function)  # its code goes with it
        address: int = numba_internals().address_of(function.ready(), self.signature)
        return address
