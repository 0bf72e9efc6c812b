"""Runs a study on the ranks of an MPI job: `mpiexec -n 2 python -m mpi4py.futures mpi_study.py STUDY FOLDER`."""

from __future__ import annotations

import sys

import inerter as it

if __name__ == "__main__":
    from mpi4py import MPI  # an extra, which tests that are collected do without
    from mpi4py.futures import MPIPoolExecutor

    with MPIPoolExecutor() as ranks:
        found = it.run_study(it.load_study(sys.argv[1]), sys.argv[2], executor=ranks)
    print(f"{found.computed} cases on {MPI.COMM_WORLD.Get_size()} ranks")
