"""Files that are there as a whole or not at all."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import limits
import numpy as np
import pytest
import xarray as xr

import inerter as it
from inerter.atomic_io import (
    atomic_write,
    defer_interrupts,
    export,
    remove_temporary_folders,
    temporary_folder,
    write_netcdf,
    write_text,
)
from inerter.errors import RecordError, SimulationError, WorkError
from inerter.figures.style import new_figure, save
from inerter.records.writers import WRITERS


def test_a_file_is_there_when_the_block_has_ended_well(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with atomic_write(path) as draft:
        draft.write_text("new")
        assert not path.exists()
        assert draft.name == "a.txt"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("problem", [ValueError, KeyboardInterrupt, OSError])
def test_else_nothing_has_changed(tmp_path: Path, problem: type[BaseException]) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")

    def write() -> None:
        with atomic_write(path) as draft:
            draft.write_text("half")
            raise problem

    with pytest.raises(problem):
        write()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_link_is_followed_and_permissions_are_kept(tmp_path: Path) -> None:
    path, link, other = tmp_path / "a.txt", tmp_path / "link", tmp_path / "other"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    other.hardlink_to(path)
    write_text(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    assert other.read_text() == "old"  # another name keeps what it had


def test_what_is_no_file_is_written_to_as_it_is() -> None:
    write_text(Path(os.devnull), "nobody reads this")
    assert not Path(os.devnull).is_file()


def test_what_is_no_character_is_escaped(tmp_path: Path) -> None:
    write_text(tmp_path / "a", os.fsdecode(b"caf\xe9"))
    assert (tmp_path / "a").read_text(encoding="utf-8") == "caf\\udce9"


def test_a_dataset_is_the_same_in_every_run(tmp_path: Path) -> None:
    data = xr.Dataset({"a": ("t", np.arange(5.0), {"units": "m"})}, {"t": np.arange(5.0)}, {"title": "ü"})
    for name in ("one.nc", "two.nc"):
        write_netcdf(tmp_path / name, data)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()
    with xr.open_dataset(tmp_path / "one.nc", engine="h5netcdf") as again:
        xr.testing.assert_identical(again.load(), data)


def test_ctrl_c_waits_for_the_end_of_a_move() -> None:
    done = []
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it

    def move() -> None:
        with defer_interrupts():
            signal.raise_signal(signal.SIGINT)
            done.append(True)

    try:
        with pytest.raises(KeyboardInterrupt):
            move()
    finally:
        signal.signal(signal.SIGINT, before)
    assert done


def test_what_is_left_when_a_process_ends_in_the_midst_is_swept(tmp_path: Path) -> None:
    with temporary_folder(tmp_path) as folder:
        (folder / "half").write_text("half")
        remove_temporary_folders()
        assert not folder.exists()


def test_an_export_says_what_was_wrong(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"Cannot write .*No such file"), export(tmp_path / "no" / "a", RecordError):
        pass
    with pytest.raises(WorkError, match="No space left"), export(tmp_path / "a", RecordError):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def record() -> it.Record:
    time = np.arange(400) / 100
    return it.Record(time, np.sin(9.0 * time), np.random.default_rng(0).normal(size=400))


def run() -> it.Trajectory:
    car = it.QuarterCar(250, 35, 150e3, it.Spring(20e3) | it.Damper(1e3) | it.Friction(50))
    return it.simulate(car, road=it.sine(0.01, 2.0), duration=1.0, step=1e-3)


EXPORTS: dict[str, Callable[[Path], object]] = {
    **{f"record{suffix}": lambda path: it.write_record(record(), path, overwrite=True) for suffix in WRITERS},
    "trajectory.csv": lambda path: run().to_csv(path, overwrite=True),
    "events.csv": lambda path: run().events_to_csv(path, overwrite=True),
    "trajectory.mat": lambda path: run().to_mat(path, overwrite=True),
    "response.csv": lambda path: it.frequency_response(record()).to_csv(path, overwrite=True),
    "trajectory.nc": lambda path: write_netcdf(path, run().to_xarray()),
    "figure.svg": lambda path: save(new_figure(height=2.0)[0], path.parent, "figure", png=False),
    "figure.png": lambda path: save(new_figure(height=2.0)[0], path.parent, "figure"),
}


@pytest.mark.parametrize("name", EXPORTS)
def test_an_export_from_python_on_a_full_disk_leaves_the_old_file(name: str, tmp_path: Path) -> None:
    """Whatever library writes, it is one error of this package, or of the system for what is internal."""
    path = tmp_path / name
    EXPORTS[name](path)
    first = path.read_bytes()
    path.write_bytes(b"old")
    whole_size = len(first)
    for size in (0, whole_size // 2, whole_size - 1):
        with limits.file_size(size), pytest.raises((WorkError, OSError)):
            EXPORTS[name](path)
        assert path.read_bytes() == b"old"
        assert not list(tmp_path.glob(".inerter-*"))
    with limits.file_size(4 * whole_size + 100_000):
        EXPORTS[name](path)
    assert path.read_bytes() != b"old"
    assert not list(tmp_path.glob(".inerter-*"))


CAREFUL: dict[str, Callable[[Path], object]] = {
    **{f"record{suffix}": lambda path: it.write_record(record(), path) for suffix in WRITERS},
    "trajectory.csv": lambda path: run().to_csv(path),
    "events.csv": lambda path: run().events_to_csv(path),
    "trajectory.mat": lambda path: run().to_mat(path),
    "response.csv": lambda path: it.frequency_response(record()).to_csv(path),
}


@pytest.mark.parametrize("name", CAREFUL)
def test_an_export_from_python_replaces_nothing_unless_it_is_told_to(name: str, tmp_path: Path) -> None:
    path, link = tmp_path / name, tmp_path / f"link{Path(name).suffix}"
    CAREFUL[name](path)
    path.write_bytes(b"old")
    link.symlink_to(path)
    for place in (path, link):
        with pytest.raises((RecordError, SimulationError), match=rf"{place.name}' exists\. .* overwrite=True\.$"):
            CAREFUL[name](place)
    assert path.read_bytes() == b"old"
    EXPORTS[name](path)
    assert path.read_bytes() != b"old"


def test_a_record_does_not_replace_the_file_that_it_was_read_from(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    it.write_record(record(), path)
    before, read = path.read_bytes(), it.read_record(path)
    with pytest.raises(RecordError, match="exists"):
        it.write_record(read.trim(0.0, 1.0), path)
    assert path.read_bytes() == before


def test_what_is_no_file_is_not_in_the_way() -> None:
    with export(os.devnull, RecordError) as draft:
        draft.write_text("nobody reads this")


def test_a_folder_that_is_not_there_is_a_wrong_request(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="Cannot write"):
        run().to_csv(tmp_path / "no" / "a.csv")


@pytest.fixture
def tiny_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 kB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True, check=False)
    if made.returncode != 0:
        pytest.skip("only the administrator can mount a file system")
    yield disk
    subprocess.run(["umount", "-l", disk], check=True)


def test_a_dataset_on_a_full_disk_does_not_end_the_process(tiny_disk: Path) -> None:
    """The C library under netCDF dies of a full disk when it closes the file, or when the process ends."""
    program = """
import sys, numpy as np, xarray as xr
from pathlib import Path
from inerter.atomic_io import write_netcdf
try:
    write_netcdf(Path(sys.argv[1]) / "a.nc", xr.Dataset({"a": ("t", np.random.default_rng(0).normal(size=100000))}))
except OSError as error:
    print(error.strerror)
"""
    found = subprocess.run([sys.executable, "-c", program, tiny_disk], capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout, found.stderr) == (0, "No space left on device\n", "")
    assert os.listdir(tiny_disk) == []
