"""The cache of compiled kernels: where it cannot be used, every command works without, and says so."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

PROGRAM = """
import sys
from inerter.kernels import compiled, typed
import inerter.kernels.stepping
print("done")
"""
WORDS = "the cache of compiled kernels cannot be written"


def compile_with(cache: Path | None, temporary: Path) -> tuple[str, str]:
    """Compile a kernel module in a process with that cache; what it prints."""
    environment = {**os.environ, "TMPDIR": str(temporary)}
    environment = {name: value for name, value in environment.items() if name not in ("HOME", "XDG_CACHE_HOME")}
    environment |= {"XDG_CACHE_HOME": str(cache)} if cache else {"HOME": "/nobody"}
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True, timeout=280
    )
    return found.stdout, found.stderr


@pytest.fixture
def temporary(tmp_path: Path) -> Iterator[Path]:
    """The folder for temporary files, in which nothing may be left."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    yield folder
    assert os.listdir(folder) == []


def no_folder(path: Path) -> None:
    path.write_text("a file")


def no_right(path: Path) -> None:
    path.mkdir(mode=0o500)
    if os.access(path, os.W_OK):
        pytest.skip("the administrator may write everywhere")


def full(path: Path) -> None:
    path.mkdir()
    mount(path, "size=64k")


def read_only(path: Path) -> None:
    path.mkdir()
    mount(path, "ro")


def mount(path: Path, options: str) -> None:
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", path], capture_output=True, check=False)
    if made.returncode != 0:
        pytest.skip("only the administrator can mount a file system")


@pytest.mark.parametrize("make", [no_folder, no_right, full, read_only])
def test_a_cache_that_cannot_be_written_is_told_and_done_without(
    make: Callable[[Path], None], tmp_path: Path, temporary: Path
) -> None:
    cache = tmp_path / "cache"
    make(cache)
    try:
        out, err = compile_with(cache, temporary)
    finally:
        subprocess.run(["umount", "-l", cache], capture_output=True, check=False)
    assert out == "done\n"
    assert err.count(WORDS) == 1
    assert str(cache) in err
    assert "Traceback" not in err


def test_files_of_the_cache_that_were_cut_short_are_made_anew(tmp_path: Path, temporary: Path) -> None:
    cache = tmp_path / "cache"
    compile_with(cache, temporary)
    for number, path in enumerate(sorted(cache.rglob("*.nb?"))):
        path.write_bytes(path.read_bytes()[: (0, 10, path.stat().st_size // 2)[number % 3]])
    for _ in range(2):
        out, err = compile_with(cache, temporary)
        assert (out, err) == ("done\n", "")
    assert all(path.stat().st_size > 100 for path in cache.rglob("*.nbi"))


def test_nothing_is_left_in_the_temporary_folder(tmp_path: Path) -> None:
    assert not list(Path(tempfile.gettempdir()).glob("inerter-*"))
