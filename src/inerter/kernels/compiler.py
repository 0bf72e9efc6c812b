"""The compiler: how declared functions become machine code, and which parts of it are used.

There are two modes. The plain one, here, is `numba.njit` with documented options. The tuned one, in
`inerter.kernels.numba_compiler`, compiles the same functions in half the time: it rests on private parts of Numba,
which may change with any release. `decorators.compiler_mode` is the switch between them. Besides these two modules
only `numba_lanes` uses Numba, for numbers side by side and instructions.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from threading import RLock
from types import FunctionType
from typing import Any, cast

import numba

from inerter.kernels.cache import cache_folder
from inerter.kernels.decorators import PLAIN, Instruction, Kernel, Part, Signature, compiler_mode, numba_internals

FUSED = {"contract"}
_ALONE = RLock()


def compile_function(
    function: Callable[..., Any],
    signature: Signature = None,
    *,
    fused: bool = False,
    borrowing: bool = False,
    by_address: bool = False,
) -> Callable[..., Any]:
    """Compile a function at once for a given signature, else at each first call with other types.

    One thread at a time: the compiler's settings, such as where it keeps its files, belong to the whole process.
    """
    with _ALONE:
        folder = cache_folder(Path(function.__code__.co_filename))
        settings: Any = numba.config
        before = settings.CACHE_DIR, settings.SLP_VECTORIZE
        settings.CACHE_DIR = str(folder)
        try:
            if compiler_mode() == PLAIN:
                return _plain(function, fused, folder)
            found: Callable[..., Any] = numba_internals().compile_tuned(
                function, signature, folder, fused=fused, borrowing=borrowing, by_address=by_address
            )
            return found
        finally:
            settings.CACHE_DIR, settings.SLP_VECTORIZE = before


def _plain(function: Callable[..., Any], fused: bool, folder: Path | None) -> Callable[..., Any]:
    """Compile at each first call with other types, with all that the function calls."""
    options: dict[str, Any] = {"fastmath": FUSED} if fused else {}
    decorate = numba.njit(error_model="numpy", nogil=True, cache=folder is not None, **options)
    return cast("Callable[..., Any]", decorate(_with_compiled_globals(function)))


def _with_compiled_globals(function: Callable[..., Any]) -> Callable[..., Any]:
    """Copy of a function whose global names of declared kernels and parts refer to compiled code."""
    names: dict[str, Any] = dict(function.__globals__)
    for name in function.__code__.co_names:
        if isinstance(names.get(name), (Kernel, Part, Instruction)):
            names[name] = _plain_part(names[name])
    code, closure = function.__code__, function.__closure__
    return FunctionType(code, names, function.__name__, function.__defaults__, closure)


@cache
def _plain_part(declared: Kernel | Part | Instruction) -> Any:
    fused = isinstance(declared, Part) and declared.fused
    return _plain(declared.function if isinstance(declared, Kernel) else declared.plain, fused, None)
