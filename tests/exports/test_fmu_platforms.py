"""Libraries for other platforms are inspected: their formats, processors and functions. They have not run here."""

from __future__ import annotations

import io
import struct
import subprocess
import zipfile
from pathlib import Path

import pytest
from campaigns import sampled
from wang_su import paper_quarter_car

import inerter as it
from inerter.exports.kinds.fmu.platforms import PLATFORMS

pytest.importorskip("fmpy", reason='FMPy has the headers of FMI: pip install "inerter[test]".')
from fmu_functions import declared
from fmu_roads import needs_compiler

pytestmark = needs_compiler
CAR = paper_quarter_car(it.Spring(120e3) | it.Damper(7544.2) - (it.Inerter(366.52) | it.Friction(9.0)))
FOLDERS = {
    ("linux-arm", "fmu"): "aarch64-linux",
    ("linux-arm", "fmu3"): "aarch64-linux",
    ("windows", "fmu"): "win64",
    ("windows", "fmu3"): "x86_64-windows",
    ("macos", "fmu"): "darwin64",
    ("macos", "fmu3"): "x86_64-darwin",
    ("macos-arm", "fmu"): "aarch64-darwin",
    ("macos-arm", "fmu3"): "aarch64-darwin",
}
PROCESSORS = {"linux-arm": "aarch64", "windows": "x86_64", "macos": "x86_64", "macos-arm": "aarch64"}
REGULAR = [("macos-arm", "fmu3")]


@pytest.mark.timeout(900)
@pytest.mark.parametrize(("platform", "kind"), sampled(FOLDERS, seldom=[o for o in FOLDERS if o not in REGULAR]))
def test_a_library_for_another_platform(platform: str, kind: str, tmp_path: Path) -> None:
    pytest.importorskip("ziglang", reason='Other platforms have their compiler: pip install "inerter[fmu]".')
    with zipfile.ZipFile(io.BytesIO(it.export(CAR, kind, title="car", platforms=[platform]))) as archive:
        own = {"fmu": "linux64", "fmu3": "x86_64-linux"}[kind]
        found = {name for name in archive.namelist() if name.startswith("binaries/")}
        library = f"binaries/{FOLDERS[platform, kind]}/car{PLATFORMS[platform].suffix}"
        assert found == {f"binaries/{own}/car.so", library}
        data = archive.read(library)
    read = {"linux-arm": elf, "windows": windows, "macos": macos, "macos-arm": macos}[platform]
    assert read(data, tmp_path) == (PROCESSORS[platform], declared(kind))


def elf(data: bytes, folder: Path) -> tuple[str, set[str]]:
    """Processor and functions of a library of Linux."""
    assert data[:6] == b"\x7fELF\x02\x01"
    (machine,) = struct.unpack_from("<H", data, 18)
    (folder / "library.so").write_bytes(data)
    command = ["nm", "-D", "--defined-only", folder / "library.so"]
    symbols = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    names = {line.split()[-1] for line in symbols.splitlines()}
    return {0xB7: "aarch64"}[machine], {name for name in names if name.startswith("fmi")}


def windows(data: bytes, folder: Path) -> tuple[str, set[str]]:
    """Processor and exports of a library of Windows, after the specification of its portable executables."""
    assert data[:2] == b"MZ"
    (head,) = struct.unpack_from("<I", data, 0x3C)
    assert data[head : head + 4] == b"PE\0\0"
    machine, sections, optional = struct.unpack_from("<HH12xH", data, head + 4)
    (exports,) = struct.unpack_from("<I", data, head + 24 + 112)

    def place(address: int) -> int:
        """Place in the file of an address in memory."""
        for i in range(sections):
            size, begin, _, start = struct.unpack_from("<4I", data, head + 24 + optional + 40 * i + 8)
            if begin <= address < begin + size:
                return int(start + address - begin)
        raise AssertionError(address)

    table = place(exports)
    (count,), (names,) = struct.unpack_from("<I", data, table + 24), struct.unpack_from("<I", data, table + 32)
    texts = [place(*struct.unpack_from("<I", data, place(names) + 4 * i)) for i in range(count)]
    found = {data[at : data.index(b"\0", at)].decode() for at in texts}
    return {0x8664: "x86_64"}[machine], {name for name in found if name.startswith("fmi")}


def macos(data: bytes, folder: Path) -> tuple[str, set[str]]:
    """Processor and external functions of a library of macOS, by its table of symbols."""
    magic, processor, _, kind, commands = struct.unpack_from("<5I", data)
    assert (magic, kind) == (0xFEEDFACF, 6)
    found, at = set(), 32
    for _ in range(commands):
        command, size = struct.unpack_from("<2I", data, at)
        if command == 2:  # the table
            symbols, count, texts = struct.unpack_from("<3I", data, at + 8)
            for i in range(count):
                name, what, section = struct.unpack_from("<IBB", data, symbols + 16 * i)
                if what & 1 and not what & 0x10 and section:  # external, not private, and defined here
                    begin = texts + name
                    found.add(data[begin : data.index(b"\0", begin)].decode().removeprefix("_"))
        at += size
    return {0x01000007: "x86_64", 0x0100000C: "aarch64"}[processor], {name for name in found if name.startswith("fmi")}


def test_an_unknown_platform_and_a_missing_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(it.InerterError, match=r"Unknown platform 'windos'.*Did you mean 'windows'"):
        it.export(CAR, "fmu", platforms=["windos"])
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(it.InerterError, match=r"require their compiler: pip install \"inerter\[fmu\]\""):
        it.export(CAR, "fmu", platforms=["windows"])
    monkeypatch.setattr("platform.system", lambda: "Windows")
    with pytest.raises(it.InerterError, match="on Linux on x86-64 only"):
        it.export(CAR, "fmu")
