"""One thread for linear algebra on small matrices.

Searches call a BLAS thousands of times on matrices of order ten. Its threads gain nothing there, and where cores are
busy they wait for each other: measured on two cores with other work on them, one optimisation took 6.8 s instead of
0.13 s.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import cache
from types import ModuleType

import scipy
from threadpoolctl import ThreadpoolController


def one_blas_thread() -> AbstractContextManager[object]:
    """A context in which the BLAS libraries that are loaded use one thread."""
    limit: AbstractContextManager[object] = _controller(scipy.linalg).limit(limits=1, user_api="blas")
    return limit


@cache
def _controller(loaded: ModuleType) -> ThreadpoolController:
    """Thread controller of the loaded libraries, including that of SciPy, which must be loaded before."""
    return ThreadpoolController()
