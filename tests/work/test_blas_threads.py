"""Linear algebra on small matrices uses one thread, in whatever process it begins."""

from __future__ import annotations

import os
import subprocess
import sys

_FRESH = """
from inerter.work.blas_threads import one_blas_thread
with one_blas_thread():
    import scipy.linalg, scipy.optimize
    from threadpoolctl import threadpool_info
    print(*{one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"})
"""


def test_a_fresh_process_has_one_thread_whatever_it_loads_later() -> None:
    free = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    fresh = [sys.executable, "-c", _FRESH]
    told = subprocess.run(fresh, capture_output=True, text=True, timeout=60, check=True, env=free)
    assert told.stdout.strip() == "1"
