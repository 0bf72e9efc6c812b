"""The cache of compiled kernels: where it cannot be used, every command works without, and says so."""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from campaigns import sampled

KERNEL = """
from inerter.kernels.decorators import kernel


@kernel("twice", "float64(float64)")
def doubled(x):
    return 2.0 * x
"""
WORDS = "the cache of compiled kernels cannot be written"
SLOW = re.compile(r"inerter: compiling .* so far; this happens once\.\n")  # said where that takes more than two seconds


def compile_with(cache: Path | None, temporary: Path) -> tuple[str, str]:
    """Compile a small kernel in a process with that cache; what it prints, except how long it takes already."""
    (temporary.parent / "small.py").write_text(KERNEL, encoding="utf-8")
    (temporary.parent / "__init__.py").touch()  # as in a package of kernels
    environment = {**os.environ, "TMPDIR": str(temporary), "PYTHONPATH": str(temporary.parent)}
    environment |= {"PYTHONDONTWRITEBYTECODE": "1"}
    environment = {name: value for name, value in environment.items() if name not in ("HOME", "XDG_CACHE_HOME")}
    environment |= (
        {"XDG_CACHE_HOME": str(cache)} if cache else {"HOME": str(temporary.parent / "small.py")}
    )  # no folder
    found = subprocess.run(
        [sys.executable, "-c", "import small; print(small.doubled(21.0))"],
        env=environment, capture_output=True, text=True, check=True, timeout=280,
    )  # fmt: skip
    return found.stdout, SLOW.sub("", found.stderr)


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
    mount(path, "size=8k")


def read_only(path: Path) -> None:
    path.mkdir()
    mount(path, "ro")


def mount(path: Path, options: str) -> None:
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", path], capture_output=True, check=False)
    if made.returncode != 0:
        pytest.skip("only the administrator can mount a file system")


@pytest.mark.parametrize("make", sampled([no_folder, no_right, full, read_only], [no_folder], kept=1))
def test_a_cache_that_cannot_be_written_is_told_and_done_without(
    make: Callable[[Path], None], tmp_path: Path, temporary: Path
) -> None:
    cache = tmp_path / "cache"
    make(cache)
    try:
        out, err = compile_with(cache, temporary)
    finally:
        subprocess.run(["umount", "-l", cache], capture_output=True, check=False)
    assert out == "42.0\n"
    assert err.count(WORDS) == 1
    assert str(cache) in err
    assert "Traceback" not in err


@pytest.mark.campaign
def test_nobody_at_home(temporary: Path) -> None:
    out, err = compile_with(None, temporary)
    assert out == "42.0\n"
    assert err.count(WORDS) == 1


@pytest.mark.campaign
def test_a_cache_is_used_and_its_files_that_were_cut_short_are_made_anew(tmp_path: Path, temporary: Path) -> None:
    cache = tmp_path / "cache"
    said = [compile_with(cache, temporary)[1] for _ in range(2)]
    assert said == ["inerter: compiling the numerical kernels; this happens once.\n", ""]
    for number, path in enumerate(sorted(cache.rglob("*.nb?"))):
        path.write_bytes(path.read_bytes()[: (0, 10, path.stat().st_size // 2)[number % 3]])
    number, said = compile_with(cache, temporary)
    assert number == "42.0\n"
    assert "are damaged; they are compiled again" in said
    assert compile_with(cache, temporary) == ("42.0\n", "")
    assert all(path.stat().st_size > 100 for path in cache.rglob("*.nbi"))


@pytest.mark.campaign
def test_a_cache_that_is_deleted_while_a_process_works_is_filled_again(tmp_path: Path) -> None:
    """A server runs for days, and somebody clears the folder of caches."""
    (tmp_path / "small.py").write_text(KERNEL, encoding="utf-8")
    (tmp_path / "__init__.py").touch()
    lines = """
import os, pathlib, shutil
from inerter.kernels.cache import cache_folder
import small
folder = cache_folder(pathlib.Path(small.__file__))
shutil.rmtree(folder.parent)
print(small.doubled(21.0), [path.suffix for path in sorted(folder.glob("*.*"))])
"""
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    found = subprocess.run(
        [sys.executable, "-c", lines], env=environment, capture_output=True, text=True, check=True, timeout=280
    )
    assert found.stdout == "42.0 ['.nbc', '.nbi']\n"


@pytest.mark.campaign
def test_another_installation_of_the_same_sources_uses_the_cache(tmp_path: Path) -> None:
    """As the two commands of the README make two: for use, and to work on the package."""
    for name, compiles in (("one", True), ("other", False)):
        (tmp_path / name / "temporary").mkdir(parents=True)
        number, said = compile_with(tmp_path / "cache", tmp_path / name / "temporary")
        assert number == "42.0\n"
        assert ("compiling the numerical kernels" in said) == compiles
    assert len([*(tmp_path / "cache").rglob("*.nbc")]) == 1


@pytest.mark.parametrize("seed", sampled(range(8), kept=1))
def test_a_changed_bit_is_found_before_the_code_runs(tmp_path: Path, temporary: Path, seed: int) -> None:
    """Three bits of machine code, or one of the constant in it: compiled again, never another number."""
    cache, rng = tmp_path / "cache", random.Random(seed)
    compile_with(cache, temporary)
    path = rng.choice(sorted(cache.rglob("*.nb?")))
    content = bytearray(path.read_bytes())
    for _ in range(3 if seed % 2 else 1):
        content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    path.write_bytes(content)
    number, said = compile_with(cache, temporary)
    assert number == "42.0\n"
    assert "are damaged; they are compiled again" in said
    assert compile_with(cache, temporary) == ("42.0\n", "")


OF_SIZES = """
from inerter.kernels.decorators import kernel


def times(n):
    @kernel("times", "float64(float64)")
    def scaled(x):
        return n * x

    return scaled
"""


@pytest.mark.campaign
def test_damage_to_the_code_for_one_size_leaves_that_for_others(tmp_path: Path) -> None:
    (tmp_path / "sizes.py").write_text(OF_SIZES, encoding="utf-8")
    (tmp_path / "__init__.py").touch()
    path = os.pathsep.join(filter(None, (str(tmp_path), os.environ.get("PYTHONPATH"))))
    environment = {**os.environ, "PYTHONPATH": path, "XDG_CACHE_HOME": str(tmp_path / "cache")}

    def compile_sizes(*sizes: float) -> tuple[str, str]:
        program = f"from sizes import times; print(*(times(size)(2.0) for size in {sizes}))"
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True, timeout=280
        )
        return done.stdout, SLOW.sub("", done.stderr)

    assert compile_sizes(3.0)[0] == "6.0\n"
    (first,) = (tmp_path / "cache").rglob("*.nbi")
    assert compile_sizes(5.0)[0] == "10.0\n"
    first.write_bytes(first.read_bytes()[:-1])
    assert compile_sizes(5.0) == ("10.0\n", "")
    stdout, stderr = compile_sizes(3.0)
    assert stdout == "6.0\n"
    assert "are damaged" in stderr


SEVERAL = """
from inerter.kernels.decorators import kernel


@kernel("twice", "float64(float64)")
def doubled(x):
    return 2.0 * x


@kernel("thrice", "float64(float64)")
def tripled(x):
    return 3.0 * x


@kernel("half", "float64(float64)")
def halved(x):
    return 0.5 * x
"""
PREPARED = """
from inerter.kernels.prepare import prepare
from small import doubled, halved, tripled

prepare([doubled, tripled, halved, doubled], lambda *told: print(*told))
print("ready")
prepare([doubled, tripled, halved], lambda *told: print(*told))
print(doubled(1.0), tripled(1.0), halved(1.0))
"""


@pytest.mark.parametrize(
    "helper", sampled(["inerter.kernels.prepare", "there.is.no.such.module"], seldom=["there.is.no.such.module"])
)
def test_kernels_that_are_missing_are_compiled_beforehand_and_each_is_told_once(tmp_path: Path, helper: str) -> None:
    (tmp_path / "small.py").write_text(SEVERAL, encoding="utf-8")
    program = PREPARED.replace(
        "prepare([",
        f"import inerter.kernels.prepare as m; m._HELPER = m._HELPER.replace(m.__name__, {helper!r})\nprepare([",
        1,
    )
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    found = [
        subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True, timeout=280
        )
        for _ in range(2)
    ]
    assert [SLOW.sub("", done.stderr) for done in found] == ["", ""]
    lines = found[0].stdout.splitlines()
    told = [line.split() for line in lines[:3]]
    assert {title for title, _, _ in told} == {"twice", "thrice", "half"}
    assert sorted(number for _, number, _ in told) == ["1", "2", "3"]
    assert {total for _, _, total in told} == {"3"}
    assert lines[3:] == ["ready", "2.0 3.0 0.5"]
    assert found[1].stdout.splitlines() == ["ready", "2.0 3.0 0.5"]


PRESSED = """
from numba.core.codegen import CodeLibrary, JITCodeLibrary

def press(cls, module, data):
    raise KeyboardInterrupt

for library in (CodeLibrary, JITCodeLibrary, *JITCodeLibrary.__mro__):
    if "_object_compiled_hook" in vars(library):
        library._object_compiled_hook = classmethod(press)
import small
try:
    small.doubled(21.0)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.campaign
def test_ctrl_c_while_the_compiler_hands_over_its_code_is_an_interrupt(tmp_path: Path, temporary: Path) -> None:
    """Python can only ignore it there, and the compiler then says that it has no code."""
    (temporary.parent / "small.py").write_text(KERNEL, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(temporary.parent), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    found = subprocess.run(
        [sys.executable, "-c", PRESSED], env=environment, capture_output=True, text=True, check=True, timeout=280
    )
    assert found.stdout == "interrupted\n"
