"""Libraries of an FMU: by the C compiler of this machine, and for other systems by that of `ziglang`."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from inerter.errors import ExportError, WorkError
from inerter.registry import Registry

_OPTIONS = ("-std=c99", "-O2", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
_LONGEST = 900.0  # of a compilation [s]; the first one for Windows makes the libraries of C too


@dataclass(frozen=True)
class Platform:
    """A system: its folders in FMUs of FMI 2.0 and 3.0, the suffix of its libraries, and its name at the compiler."""

    key: str
    description: str
    folders: Mapping[int, str]
    suffix: str
    target: str


OWN = Platform("linux", "Linux on x86-64", {2: "linux64", 3: "x86_64-linux"}, ".so", "x86_64-linux-gnu")
PLATFORMS: Registry[Platform] = Registry(
    "platform",
    "key",
    ("description", "folders", "suffix", "target"),
    (
        OWN,
        Platform(
            "linux-arm", "Linux on ARM of 64 bits", {2: "aarch64-linux", 3: "aarch64-linux"}, ".so", "aarch64-linux-gnu"
        ),
        Platform("windows", "Windows on x86-64", {2: "win64", 3: "x86_64-windows"}, ".dll", "x86_64-windows-gnu"),
        Platform("macos", "macOS on x86-64", {2: "darwin64", 3: "x86_64-darwin"}, ".dylib", "x86_64-macos"),
        Platform(
            "macos-arm",
            "macOS on ARM of 64 bits",
            {2: "aarch64-darwin", 3: "aarch64-darwin"},
            ".dylib",
            "aarch64-macos",
        ),
    ),
)


def libraries(sources: Mapping[str, str], main: str, others: Sequence[str]) -> Iterator[tuple[Platform, bytes]]:
    """The library of this machine, and those of other platforms by their keys.

    Raises `ExportError` where a compiler is missing, `UnknownEntryError` for an unknown platform, `WorkError` if a
    compiler fails.
    """
    wanted = [PLATFORMS[key] for key in dict.fromkeys(others)]
    if platform.system() == "Linux" and platform.machine() == "x86_64":
        yield OWN, _compile([_own_compiler(), *_OPTIONS, "-fPIC"], sources, main)
        wanted = [one for one in wanted if one is not OWN]
    elif not wanted:
        raise ExportError(
            "The compiler of the system builds FMUs on Linux on x86-64 only. Export the design there, or name "
            'platforms, for which pip install "inerter[fmu]" provides a compiler.'
        )
    for each in wanted:
        yield each, _compile([*_compiler_of_all(), "-target", each.target, "-s", *_OPTIONS], sources, main)


def _own_compiler() -> str:
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise ExportError("An FMU requires a C compiler; cc not found. Install one, or name it in CC.")
    return compiler


def _compiler_of_all() -> list[str]:
    if importlib.util.find_spec("ziglang") is None:
        raise ExportError('FMUs for other platforms require their compiler: pip install "inerter[fmu]".')
    return [sys.executable, "-m", "ziglang", "cc"]


def _compile(command: Sequence[str], sources: Mapping[str, str], main: str) -> bytes:
    compiler = " ".join(command).partition(" -std")[0]
    with tempfile.TemporaryDirectory() as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        whole = [*command, "-o", "library", main, "-lm"]
        try:
            done = subprocess.run(whole, cwd=folder, capture_output=True, text=True, timeout=_LONGEST, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise WorkError(f"The C compiler {compiler} failed: {error}.") from None
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if "error" in line] or ["no message"]
            raise WorkError(f"The C compiler {compiler} failed: {lines[0]}.")
        return (Path(folder) / "library").read_bytes()
