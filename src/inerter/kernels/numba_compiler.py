"""Compilation by private parts of Numba: a cache that may fail, parts compiled within callers, calls by address.

It is used only where `decorators.compiler_mode` selects it; `pyproject.toml` bounds the versions of Numba for its sake.
"""

from __future__ import annotations

import errno
import gc
import hashlib
import io
import os
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast, get_type_hints

import numba
import numpy as np
from numba.core import cgutils, sigutils, typeinfer
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.serialize import dumps
from numba.experimental import function_type

from inerter.kernels.cache import announce, warn_of_damage, warn_of_no_cache
from inerter.kernels.compiler import FUSED
from inerter.kernels.decorators import Signature

_SUM = hashlib.sha256().digest_size


def compile_tuned(
    function: Callable[..., Any],
    signature: Signature,
    folder: Path | None,
    *,
    fused: bool,
    borrowing: bool,
    by_address: bool,
) -> Callable[..., Any]:
    """Compile a function at once for a given signature, and keep it in a cache that may fail."""
    settings: Any = numba.config
    empty = folder is not None and not any(folder.glob("*"))  # nor is there anything if somebody has deleted it
    kept = _cache_in(folder, function)
    if empty and kept:
        announce()
    options: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cpython_wrapper": by_address}
    if fused:  # a product and a sum in one instruction, with one rounding, and four of them side by side
        options["fastmath"] = FUSED
        settings.SLP_VECTORIZE = 1
    if borrowing:  # no reference counts, which took half of the time
        options["_nrt"] = False
    result: Any = numba.njit(**options)(function)
    if kept:
        result._cache = kept
    types = _types(signature)
    if types is not None and not settings.DISABLE_JIT:
        _compile(result, types)
    return cast("Callable[..., Any]", result)


def _types(signature: Signature) -> Any:
    """A signature as the compiler takes it."""
    return signature(numba.types) if callable(signature) else signature


def signature_of(function: Callable[..., Any]) -> Any:
    """Signature from a function's annotations, in the compiler's types."""
    hints = get_type_hints(function, include_extras=True)
    returned = _type_of(hints.pop("return"))
    return returned(*(_type_of(hint) for hint in hints.values()))


_NUMBERS: dict[Any, Any] = {int: numba.int64, float: numba.float64, bool: numba.boolean, type(None): numba.void}


def _type_of(hint: Any) -> Any:
    """Compiler type of a hint: a number, a `NamedTuple` of types, or that in `Annotated` (text, record, array)."""
    if hint in _NUMBERS:
        return _NUMBERS[hint]
    if isinstance(hint, type) and issubclass(hint, tuple):
        fields = [_type_of(field) for field in get_type_hints(hint, include_extras=True).values()]
        uniform = all(field == fields[0] for field in fields)
        types: Any = numba.types
        return types.NamedUniTuple(fields[0], len(fields), hint) if uniform else types.NamedTuple(tuple(fields), hint)
    (given,) = hint.__metadata__
    if isinstance(given, np.dtype):
        return numba.from_dtype(given)
    return numba.from_dtype(given[0])[::1] if isinstance(given, tuple) else eval(given, {}, vars(numba.types))


class _CheckedFiles(IndexDataCacheFile):
    """Files of the cache with a check sum at their end: machine code in which a bit has changed crashes, or worse."""

    def _load_index(self) -> Any:
        _check(self._index_path)
        return super()._load_index()  # type: ignore[no-untyped-call]

    def _load_data(self, name: str) -> Any:
        _check(self._data_path(name))  # type: ignore[no-untyped-call]
        return super()._load_data(name)  # type: ignore[no-untyped-call]

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        with super()._open_for_write(filepath) as file:
            content = io.BytesIO()
            yield content
            file.write(content.getvalue() + hashlib.sha256(content.getvalue()).digest())

    def _data_name(self, number: int) -> str:
        """Two processes that compile at once would take the next free number both, and one the code of the other."""
        return f"{self._index_name.removesuffix('.nbi')}.{secrets.token_hex(4)}.nbc"


def _check(path: str) -> None:
    """Raises `ValueError` unless the file ends in the check sum of what comes before; one that is missing may be."""
    with suppress(FileNotFoundError):
        content = Path(path).read_bytes()
        if hashlib.sha256(content[:-_SUM]).digest() != content[-_SUM:]:
            raise ValueError(f"{Path(path).name} does not have its check sum")


class _Cache(FunctionCache):
    """The compiler's cache, which may fail: what cannot be read is compiled, and what cannot be kept is not.

    The compiler has a folder for each place where the package is installed, and a stamp with the time of the source.
    Here the folder's name tells the source (see `cache.source_hash`), so that all installations share what it holds.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        if Path(self._cache_path).is_relative_to(folder):  # elsewhere if nothing can be written in it
            with suppress(OSError):
                Path(self._cache_path).rmdir()
            self._cache_path = str(folder)
        base: Any = self._impl.filename_base
        if function.__closure__:  # an index of its own: two processes that save at once would lose one of two entries
            contents = tuple(cell.cell_contents for cell in function.__closure__)
            given: Any = dumps(contents)  # type: ignore[no-untyped-call]
            base += f"-{hashlib.sha256(given).hexdigest()[:16]}"
        self._cache_file = _CheckedFiles(self._cache_path, base, "")  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # a file cut short may raise anything
            warn_of_damage(Path(self.cache_path).parent)
            self._forget()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError as error:
            self._forget()
            warn_of_no_cache(Path(self.cache_path).parent, error)
        except RuntimeError:  # no code: Ctrl-C came while LLVM handed it over to Python, which can only ignore it there
            raise KeyboardInterrupt from None

    def _forget(self) -> None:
        with suppress(OSError):
            self.flush()  # type: ignore[no-untyped-call]


def _cache_in(folder: Path | None, function: Callable[..., Any]) -> _Cache | None:
    """The cache of a function in a folder; None if nothing can be written there."""
    if folder is None:
        return None
    try:
        found: Any = _Cache(function, folder)
    except RuntimeError:  # no place at all can be written
        found = None
    if found is not None and Path(found.cache_path).is_relative_to(folder):
        return cast("_Cache", found)
    warn_of_no_cache(folder.parent, OSError(errno.EACCES, os.strerror(errno.EACCES)))
    return None


def _compile(function: Any, signature: Any) -> None:
    """Compile for one signature; it stays the only one if it has a type that is returned."""
    collecting = gc.isenabled()
    gc.disable()  # compiling makes millions of objects that stay: looking for garbage takes a sixth of the time
    try:
        with typeinfer.register_dispatcher(function):
            function.compile(signature)
    finally:
        if collecting:
            gc.enable()
    if not isinstance(parse_signature(signature), tuple):
        function.disable_compile()


def parse_signature(signature: Any) -> Any:
    """A signature as types; without one that is returned, only those of the arguments."""
    arguments, returned = sigutils.normalize_signature(signature)  # type: ignore[no-untyped-call]
    return arguments if returned is None else returned(*arguments)


def entry_of(function: Any) -> Any:
    """The machine code of a function with one signature, for Python to call with arguments of just these types."""
    overloads = getattr(function, "overloads", None)  # none if the compiler is off
    return next(iter(overloads.values())).entry_point if overloads else function


def address_of(function: Any, signature: Signature) -> int:
    """The address of a compiled function, for other compiled code that is handed it."""
    wrapper_address: Any = function_type._get_wrapper_address
    return int(wrapper_address(function, parse_signature(_types(signature))))


def function_at_type(signature: Signature) -> Any:
    """The compiler's type of what makes a function of an address."""
    kind: Any = numba.types.FunctionType(parse_signature(_types(signature)))

    def definition(typing: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            struct_of: Any = cgutils.create_struct_proxy
            function = struct_of(kind)(context, builder)
            function[0] = builder.inttoptr(given[0], cgutils.voidptr_t)
            return function._getvalue()

        return kind(numba.types.int64), generate

    return instruction_type(definition)


def instruction_type(definition: Callable[..., Any]) -> Any:
    """The compiler's type of an instruction."""
    made: Any = numba.extending.intrinsic(definition)
    context = cpu_target.typing_context
    context.refresh()
    return context.resolve_value_type(made)


class PartDispatcher(CPUDispatcher):
    """Dispatcher of a part of compiled code, see `decorators.part`."""

    def __init__(
        self, function: Callable[..., Any], signature: Signature, borrowing: bool, fused: bool, place: str
    ) -> None:
        self.library: Any = {"apart": _Apart, "inside": _Inside, "within": _Within}[place]
        options: dict[str, Any] = {"nopython": True, "boundscheck": None, "error_model": "numpy", "nogil": True}
        options |= {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        if fused:
            options["fastmath"] = FUSED
        super().__init__(function, targetoptions=options | ({"_nrt": False} if borrowing else {}))
        self.wanted = _types(signature)

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


class _Within(JITCodeLibrary):
    """Code that others contain: they optimise it, and it never becomes machine code alone."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)

    def get_pointer_to_function(self: Any, name: str) -> int:
        self._ensure_finalized()
        return 0

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _AttributeLibrary(_Within):
    """Code whose functions carry an attribute for the optimiser, on the inlining of their calls."""

    attribute: str

    def add_llvm_module(self, module: Any) -> None:
        for function in module.functions:
            if not function.is_declaration:
                function.add_function_attribute(self.attribute)
        super().add_llvm_module(module)  # type: ignore[no-untyped-call]


class _Inside(_AttributeLibrary):
    attribute = "alwaysinline"


class _Apart(_AttributeLibrary):
    attribute = "noinline"
