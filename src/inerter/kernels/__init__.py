"""All compiled code, on plain arrays. Importing this package imports Numba; nothing else in the project does.

The compiler caches a function by its own file and would run stale code when a function that it calls, in another
file, has changed. So each module's cache folder is named after a hash of its source and of all that it imports here.
"""

from __future__ import annotations

import errno
import gc
import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from multiprocessing import parent_process
from pathlib import Path
from threading import Event, RLock
from types import SimpleNamespace
from typing import Any, TypeVar, cast

import numba
from numba.core import typeinfer
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import CPUDispatcher, cpu_target

F = TypeVar("F", bound=Callable[..., Any])
_ALONE = RLock()
_TOLD = Event()
_FUSED = {"contract"}

_IMPORTED = re.compile(r"^from inerter\.kernels\.(\w+) import", re.MULTILINE)


def source_hash(module: Path) -> str:
    """A short hash of a kernel module, of every kernel module that it rests on, and of the compiler's version."""
    found, waiting = {module.parent / "__init__.py"}, [module]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += [path.parent / f"{name}.py" for name in _IMPORTED.findall(path.read_text(encoding="utf-8"))]
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(found):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder(module: Path) -> Path | None:
    """Where a module's compiled code is kept, below the user's cache folder; None if it cannot be made."""
    base = os.environ.get("XDG_CACHE_HOME") or (os.environ.get("LOCALAPPDATA") if sys.platform == "win32" else None)
    try:
        base = base or str(Path.home() / ".cache")
        folder = Path(base) / "inerter" / f"{module.stem}-{source_hash(module)}"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError) as error:  # the latter: nobody is at home
        _tell_of_no_cache(base or "no home folder", error)
        return None
    return folder


@cache
def _tell() -> None:
    print("inerter: compiling the numerical kernels; this happens once.", file=sys.stderr, flush=True)


def _tell_of_no_cache(folder: object, error: Exception) -> None:
    """Say once, and in one of several processes, that the next run will have to compile again."""
    if not _TOLD.is_set() and parent_process() is None:
        why = error.strerror if isinstance(error, OSError) else error
        what = f"the cache of compiled kernels cannot be written ({folder}: {why})"
        print(f"inerter: {what}; every run compiles them anew.", file=sys.stderr, flush=True)
    _TOLD.set()


class _Cache(FunctionCache):
    """The compiler's cache, which may fail: what cannot be read is compiled, and what cannot be kept is not."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # a file cut short may raise anything
            self._forget()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError as error:
            self._forget()
            _tell_of_no_cache(Path(self.cache_path).parents[1], error)

    def _forget(self) -> None:
        with suppress(OSError):
            self.flush()  # type: ignore[no-untyped-call]


def _cache_in(folder: Path | None, function: Callable[..., Any]) -> _Cache | None:
    """The cache of a function in a folder; None if nothing can be written there."""
    if folder is None:
        return None
    try:
        found: Any = _Cache(function)  # type: ignore[no-untyped-call]
    except RuntimeError:  # no place at all can be written
        found = None
    if found is not None and Path(found.cache_path).is_relative_to(folder):
        return cast("_Cache", found)
    _tell_of_no_cache(folder.parent, OSError(errno.EACCES, os.strerror(errno.EACCES)))
    return None


def compiled(function: F, signature: Any = None, *, fused: bool = False, borrowing: bool = False) -> F:
    """Compile on first use, or at once for a given signature, and keep the result between processes.

    One thread at a time: the compiler's settings, such as where it keeps its files, belong to the whole process.
    """
    with _ALONE:
        return _compiled(function, signature, fused, borrowing)


def _compiled(function: F, signature: Any, fused: bool, borrowing: bool) -> F:
    folder = cache_folder(Path(function.__code__.co_filename))
    settings: Any = numba.config
    before = settings.CACHE_DIR, settings.SLP_VECTORIZE
    settings.CACHE_DIR = str(folder)
    try:
        empty = folder is not None and not any(folder.iterdir())
        kept = _cache_in(folder, function)
        if empty and kept:
            _tell()
        options: dict[str, Any] = {"error_model": "numpy", "nogil": True}
        if fused:  # a product and a sum in one instruction, with one rounding, and four of them side by side
            options["fastmath"] = _FUSED
            settings.SLP_VECTORIZE = 1
        if borrowing:  # no reference counts, which took half of the time
            options["_nrt"] = False
        result: Any = numba.njit(**options)(function)
        if kept:
            result._cache = kept
        collecting = gc.isenabled()
        gc.disable()  # compiling makes millions of objects that stay: looking for garbage takes a sixth of the time
        try:
            if signature is not None and not settings.DISABLE_JIT:
                with typeinfer.register_dispatcher(result):
                    result.compile(signature)
                    result.disable_compile()
        finally:
            if collecting:
                gc.enable()
    finally:
        settings.CACHE_DIR, settings.SLP_VECTORIZE = before
    if isinstance(result, CPUDispatcher):
        result.__class__ = _Entry
    return cast("F", result)


class _Entry(CPUDispatcher):
    """A compiled function that lets Ctrl-C through.

    Python code that makes the types of arrays that are returned runs inside the call. Where Ctrl-C breaks that, the
    call goes on, returns, and Python raises SystemError ("returned a result with an exception set") whose cause is the
    KeyboardInterrupt, or another such error, and so on down to it.
    """

    def __call__(self, *args: Any) -> Any:
        try:
            return super().__call__(*args)
        except SystemError as error:
            cause: BaseException | None = error
            while isinstance(cause, SystemError):
                cause = cause.__cause__
            if isinstance(cause, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            raise


def typed(signature: str, *, borrowing: bool = False) -> Callable[[F], F]:
    """Compile for one signature, when the module is loaded."""
    return lambda function: compiled(function, signature, borrowing=borrowing)


def part(
    signature: Any = None, *, borrowing: bool = False, apart: bool = False, inside: bool = False
) -> Callable[[F], F]:
    """Compile as a part of the compiled code that calls it, and only there: from elsewhere it is plain Python.

    The compiler would make every function ready to be called from Python, optimise it and keep it on disk, for itself
    and once more in everything that calls it; that took half of the time. `apart` parts are not copied into what calls
    them: right for long ones that are called in many places. `inside` ones always are, fused: what calls them with
    constants becomes code for these, and yet they are read and typed only once. Calls with constants share the one
    `signature` given.
    """

    def declared(function: F) -> F:
        made: Any = _Part(function, signature, borrowing, _Apart if apart else _Inside if inside else _Within)
        return cast("F", made)

    return declared


class _Part(CPUDispatcher):
    def __init__(self, function: Callable[..., Any], signature: Any, borrowing: bool, library: Any) -> None:
        options: dict[str, Any] = {"nopython": True, "boundscheck": None, "error_model": "numpy", "nogil": True}
        options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        if library is _Inside:
            options["fastmath"] = _FUSED
        super().__init__(function, targetoptions=options | ({"_nrt": False} if borrowing else {}))
        self.wanted, self.library = signature, library

    def get_call_template(self: Any, args: Any, kws: Any) -> Any:
        codegen = cpu_target.target_context.codegen()  # the compiler's lock is held here
        before, codegen._library_class = codegen._library_class, self.library
        try:
            if self.wanted is not None and self._can_compile:
                self.compile(self.wanted)
                self.disable_compile()
            return super().get_call_template(args, kws)
        finally:
            codegen._library_class = before

    def __call__(self, *args: Any) -> Any:
        return self.py_func(*args)


class _Within(JITCodeLibrary):
    """Code that others contain: they optimise it, and it never becomes machine code by itself."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)

    def get_pointer_to_function(self: Any, name: str) -> int:
        self._ensure_finalized()
        return 0

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _Marked(_Within):
    """Code whose functions carry an attribute that tells the optimiser what to do with calls of them."""

    attribute: str

    def add_llvm_module(self, module: Any) -> None:
        for function in module.functions:
            if not function.is_declaration:
                function.add_function_attribute(self.attribute)
        super().add_llvm_module(module)  # type: ignore[no-untyped-call]


class _Inside(_Marked):
    attribute = "alwaysinline"


class _Apart(_Marked):
    attribute = "noinline"


def compiling_beside(module: str) -> Callable[[], None]:
    """Have a kernel module compiled by another process if it is not yet, while this one goes on; wait by calling.

    Should that fail, this process compiles the module itself when it imports it.
    """
    path = Path(__file__).with_name(f"{module}.py")
    folder = cache_folder(path)
    if folder is None or any(folder.iterdir()):
        return lambda: None
    _tell()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    try:
        process = subprocess.Popen(
            [sys.executable, "-c", f"import inerter.kernels.{module}"],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except OSError:
        return lambda: None
    return lambda: (process.wait(), None)[1]
