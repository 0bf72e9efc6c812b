"""Linear systems x' = A x + B u, y = C x + D u, whose inputs may share a source and arrive late."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from operator import is_

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import LinearSystemError
from inerter.systems.polynomials import TransferFunctions
from inerter.validation import real_numbers

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ExtendedMatrices:
    """The block matrix [A B; C D] in extended precision, and bounds of what rounding has done to its entries."""

    values: NDArray[np.longdouble]
    errors: Matrix
    order: int

    @property
    def double_precision(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """A, B, C and D in double precision."""
        whole, n = self.values.astype(float), self.order
        return whole[:n, :n], whole[:n, n:], whole[n:, :n], whole[n:, n:]


@dataclass(frozen=True, eq=False)
class Origin:
    """Exact origin of a mechanism's rounded matrices A, B, C, D.

    `functions` gives the transfer functions from named inputs to named outputs without rounding.
    """

    functions: Callable[[Sequence[str], Sequence[str]], TransferFunctions]
    rounded: tuple[Matrix, Matrix, Matrix, Matrix]
    fine: ExtendedMatrices
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def of(self, system: LinearSystem) -> ExtendedMatrices | None:
        """The part that a system has of it; None if the system's matrices were changed by hand."""
        given = (system.A, system.B, system.C, system.D)
        if (system.inputs, system.outputs) == (self.inputs, self.outputs) and all(map(is_, given, self.rounded)):
            return self.fine
        if not (set(system.inputs) <= set(self.inputs) and set(system.outputs) <= set(self.outputs)):
            return None
        n = self.fine.order
        rows = [*range(n), *(n + self.outputs.index(name) for name in system.outputs)]
        columns = [*range(n), *(n + self.inputs.index(name) for name in system.inputs)]
        chosen = np.ix_(rows, columns)
        part = ExtendedMatrices(self.fine.values[chosen], self.fine.errors[chosen], n)
        return part if all(map(np.array_equal, given, part.double_precision)) else None


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """A linear system x' = A x + B u, y = C x + D u, with named states, inputs and outputs.

    `A` (n, n), `B` (n, m), `C` (p, n), `D` (p, m). Input j is the signal `sources[j]` delayed by `delays[j]` seconds;
    inputs of the same source are one signal that arrives at several places, as a road does at the axles. By default
    every input is a source of its own and arrives at once.

    Raises `LinearSystemError` if shapes or names do not fit, if a number is not finite, or if a delay is negative.

    >>> import inerter as it
    >>> lag = it.LinearSystem(A=[[-1.0]], B=[[1.0]], C=[[1.0]], D=[[0.0]])
    >>> round(it.h2_norm(lag) ** 2, 12), lag.order
    (0.5, 1)
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    delays: Matrix = field(default_factory=lambda: np.zeros(0))
    sources: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()  # what was left out on the way here, for a reader
    origin: Origin | None = None  # of matrices that come from a mechanism

    def __post_init__(self) -> None:
        for name in "ABCD":
            matrix = real_numbers(getattr(self, name))
            if matrix is None:
                raise LinearSystemError(f"{name} must be a matrix of real numbers.")
            if matrix.ndim != 2:
                raise LinearSystemError(f"{name} must be a matrix, got an array of shape {matrix.shape}.")
            _check_finite(name, matrix)
            object.__setattr__(self, name, matrix)
        n, m, p = self.A.shape[0], self.B.shape[1], self.C.shape[0]
        wanted = {"A": (n, n), "B": (n, m), "C": (p, n), "D": (p, m)}
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise LinearSystemError(
                    f"{name} has the shape {getattr(self, name).shape}, but A, B and C require {shape}."
                )
        for name, letter, count in (("states", "x", n), ("inputs", "u", m), ("outputs", "y", p)):
            object.__setattr__(self, name, _labels(name, getattr(self, name), letter, count))
        object.__setattr__(self, "sources", check_names("sources", self.sources) or self.inputs)
        delays = real_numbers(self.delays)
        if delays is None:
            raise LinearSystemError(f"The delays of a system are numbers of seconds, got {self.delays!r}.")
        object.__setattr__(self, "delays", delays if delays.size else np.zeros(m))
        fits = len(self.sources) == m and self.delays.shape == (m,)
        if not (fits and all(0.0 <= delay < math.inf for delay in self.delays.tolist())):
            raise LinearSystemError(f"Each of the {m} inputs needs one source and one delay of zero or more seconds.")

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.A.shape[0])

    @property
    def fine(self) -> ExtendedMatrices | None:
        """The matrices before they were rounded; None where they were given, or changed by hand."""
        return None if self.origin is None else self.origin.of(self)

    def with_matrices(self, matrices: tuple[Matrix, Matrix, Matrix, Matrix], origin: Origin) -> LinearSystem:
        """System with the same names, sources and delays, and other matrices of the same shapes, with their origin.

        Raises `LinearSystemError` if a number is not finite.
        """
        if not math.isfinite(np.vdot(origin.fine.values, origin.fine.values)):
            for name, matrix in zip("ABCD", matrices, strict=True):
                _check_finite(name, matrix)
        found = object.__new__(LinearSystem)  # as a new one would check all names again
        A, B, C, D = matrices
        found.__dict__.update(self.__dict__, A=A, B=B, C=C, D=D, delays=self.delays.copy(), origin=origin)
        return found

    def subsystem(
        self, inputs: Sequence[str] | str | None = None, outputs: Sequence[str] | str | None = None
    ) -> LinearSystem:
        """Subsystem with only the named inputs and outputs, in that order; None keeps all.

        Raises `LinearSystemError` for a name that is not there.
        """
        columns = _positions("input", inputs, self.inputs)
        rows = _positions("output", outputs, self.outputs)
        return replace(
            self,
            B=self.B[:, columns],
            C=self.C[rows],
            D=self.D[np.ix_(rows, columns)],
            inputs=tuple(self.inputs[j] for j in columns),
            outputs=tuple(self.outputs[i] for i in rows),
            delays=self.delays[columns],
            sources=tuple(self.sources[j] for j in columns),
        )

    def with_delays(self, source: str, delays: Sequence[float]) -> LinearSystem:
        """System with all inputs driven by one `source`, each with its delay [s]."""
        return replace(self, sources=(source,) * len(self.inputs), delays=np.asarray(delays, dtype=float))

    select, delayed = RenamedAttribute("subsystem"), RenamedAttribute("with_delays")

    def __repr__(self) -> str:
        return (
            f"LinearSystem({self.order} states; inputs {', '.join(self.inputs) or 'none'}; "
            f"outputs {', '.join(self.outputs) or 'none'})"
        )


def _check_finite(name: str, matrix: Matrix) -> None:
    if not (math.isfinite(np.vdot(matrix, matrix)) or np.isfinite(matrix).all()):  # the first takes less time
        raise LinearSystemError(f"{name} has entries that are not finite numbers.")


def check_system(system: object) -> None:
    """Raises `LinearSystemError` unless `system` is a `LinearSystem`."""
    if not isinstance(system, LinearSystem):
        raise LinearSystemError(f"Expected a LinearSystem, such as state_space(vehicle), got {system!r}.")


def check_names(what: str, names: object) -> tuple[str, ...]:
    """Names as a tuple of texts, a single text as one name; raises `LinearSystemError` if it is neither."""
    given = (names,) if isinstance(names, str) else tuple(names) if isinstance(names, Sequence) else (names,)
    if not all(isinstance(name, str) for name in given):
        raise LinearSystemError(f"The {what} of a system are given by name, such as 'road', got {names!r}.")
    return given


def _labels(what: str, given: object, letter: str, count: int) -> tuple[str, ...]:
    names = check_names(what, given)
    if not names:
        return tuple(f"{letter}{i + 1}" for i in range(count))
    if len(names) != count or len(set(names)) != count:
        raise LinearSystemError(f"The {count} {what} of the system require as many different names, got {names}.")
    return tuple(names)


def _positions(what: str, names: Sequence[str] | str | None, known: tuple[str, ...]) -> list[int]:
    if names is None:
        return list(range(len(known)))
    wanted = check_names(f"{what}s", names)
    for name in wanted:
        if name not in known:
            raise LinearSystemError(f"Unknown {what} {name!r}; available: {', '.join(known) or 'none'}.")
    return [known.index(name) for name in wanted]
