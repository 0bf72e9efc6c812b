"""A study on the ranks of an MPI job gives the same files as in one process."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from study_text import study_text

import inerter as it

STUDY = study_text(
    'indices = ["J1", "J3"]\noptimise = "norm"\nsweep = { k = { from = "10 kN/m", to = "90 kN/m", points = 9 } }',
    elements='k = "20 kN/m"\nc = { from = "100 N s/m", to = "10 kN s/m" }\nb = "30 kg"',
)
LAUNCH = ("mpiexec", "-n", "2", sys.executable, "-m", "mpi4py.futures")
OPENMPI = {  # what it would refuse in a container: root, and two ranks on one core
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
}


@pytest.mark.skipif(shutil.which("mpiexec") is None, reason="there is no mpiexec (Debian: openmpi-bin)")
@pytest.mark.skipif(find_spec("mpi4py") is None, reason='mpi4py is not installed (pip install "inerter[mpi]")')
def test_ranks_give_the_same_files_as_one_process(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    one = it.run_study(it.load_study(tmp_path / "study.toml"), tmp_path / "one")
    script = Path(__file__).with_name("mpi_study.py")
    ended = subprocess.run(
        [*LAUNCH, script, tmp_path / "study.toml", tmp_path / "ranks"],
        env={**os.environ, **OPENMPI},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.stdout == f"{one.computed} cases on 2 ranks\n", ended.stderr
    assert one.computed == 36
    for name in ("results.nc", "summary.csv"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "ranks" / name).read_bytes(), name
