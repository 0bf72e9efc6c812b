"""What a command loads: only what it needs, and nothing is compiled or started by an import."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from campaigns import sampled
from folders import EXAMPLES, ROOT

from inerter.files.study.parts import resume_part
from inerter.papers.wang_su_2008.reproduce import work

STUDIES = sorted(path.name for path in EXAMPLES.glob("*.toml") if "[study]" in path.read_text(encoding="utf-8"))
HEAVY = {
    *("numba", "llvmlite", "matplotlib", "pandas", "xarray", "h5netcdf", "h5py", "jinja2", "rich.progress"),
    *("scipy.linalg", "scipy.optimize", "scipy.stats", "scipy.signal", "scipy.interpolate", "scipy.spatial"),
}
LIBRARIES = HEAVY | {"numpy", "scipy", "pydantic", "pint"}
RARE_UNITS = {"building_quake.toml"}  # studies that need pint to read them
COMMAND = """
import sys, json
sys.modules["dask"] = None  # as without the extra for clusters: where dask is, pint loads it, and jinja2 with it
from inerter.cli.main import call
codes = [call(arguments) for arguments in json.loads(sys.argv[1])]
sys.stdout.flush()
print(json.dumps([codes, sorted(sys.modules)]), file=sys.stderr)
"""
EVERYTHING = """
import json, multiprocessing, pkgutil, subprocess, sys, threading
from importlib import import_module
import inerter

started = []

def refuse(process, command=(), *args, **options):
    started.append(command[:1] if isinstance(command, (list, tuple)) else command)
    raise OSError("no process today")  # which a library that looks for fonts takes well

subprocess.Popen.__init__ = multiprocessing.Process.start = refuse
names = [found.name for found in pkgutil.walk_packages(inerter.__path__, "inerter.")]
for name in names:
    if name not in ("inerter.kernels.compiler", "inerter.kernels.numba_compiler", "inerter.kernels.numba_lanes"):
        import_module(name)
print(json.dumps([names, "numba" in sys.modules, threading.active_count(), started]))
"""


def loaded_by(*commands: tuple[str, ...]) -> set[str]:
    """Names of the modules that a process has loaded at the end of these commands."""
    program = [sys.executable, "-c", COMMAND, json.dumps(commands)]
    done = subprocess.run(program, capture_output=True, text=True, cwd=ROOT, check=True, timeout=280)
    codes, modules = json.loads(done.stderr.splitlines()[-1])
    assert set(codes) == {0}
    return set(modules)


def test_help_loads_no_library_of_numbers() -> None:
    assert not loaded_by(("--help",), ("--version",), ("run", "--help"), ("reproduce", "--help")) & LIBRARIES


def test_what_tells_of_files_is_light() -> None:
    assert not loaded_by(("schema",), ("explain", "road.speed"), ("new", "-o", "-")) & (HEAVY | {"pint"})


@pytest.mark.parametrize("study", sampled(STUDIES, ["ball_screw.toml", "half-car.toml"], kept=1))
def test_check_loads_nothing_that_only_the_work_needs(study: str) -> None:
    assert len(STUDIES) >= 4
    assert not loaded_by(("check", str(EXAMPLES / study))) & (HEAVY | (set() if study in RARE_UNITS else {"pint"}))


@pytest.mark.marathon
def test_a_run_loads_no_distributions(tmp_path: Path) -> None:
    assert "scipy.stats" not in loaded_by(("run", str(EXAMPLES / "quarter-car.toml"), "-o", str(tmp_path / "out")))


@pytest.mark.campaign
def test_an_import_compiles_nothing_and_starts_nothing(tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "MPLCONFIGDIR": matplotlib.get_cachedir()}
    done = subprocess.run(
        [sys.executable, "-c", EVERYTHING], capture_output=True, text=True, env=environment, check=True, timeout=280
    )
    names, compiler, threads, started = json.loads(done.stdout)
    assert {"inerter.kernels.events", "inerter.identification.friction_models", "inerter.cli.commands"} <= set(names)
    assert not compiler
    assert threads == 1
    assert not [command for command in started if not command or command[0] == sys.executable]
    assert not list(tmp_path.glob("inerter*"))


def test_a_worker_process_loads_nothing_that_shows_results() -> None:
    """Every process of a study, or of the reproduction of a paper, imports the module of the function that it calls."""
    modules = [resume_part.__module__, work.__module__]
    program = f"import json, sys, {', '.join(modules)}\nprint(json.dumps(sorted(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=280)
    assert not set(json.loads(loaded.stdout)) & (HEAVY - {"scipy.linalg", "scipy.optimize", "scipy.spatial"})
