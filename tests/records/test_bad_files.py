"""Files that are wrong in all the ways there are: one sentence each, of what arrived and what to try."""

from __future__ import annotations

import os
import re

import numpy as np
import pytest
from bench import bench, write_csv, write_mat, write_mat73, write_mdf, write_tdms

import inerter as it
from inerter.errors import RecordError

BENCH = bench(60)
T, X, F = BENCH.time, BENCH.displacement, BENCH.force
HEADER = "time [s],x [m],F [N]\n"
ROWS = [f"{t!r},{x!r},{f!r}\n" for t, x, f in zip(T.tolist(), X.tolist(), F.tolist(), strict=True)]


def text(content, name="a.csv", encoding="utf-8"):
    def write(folder):
        path = folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return path

    return write


def changed(row, new):
    return text(HEADER + "".join([*ROWS[:row], new, *ROWS[row + 1 :]]))


def columns(*named):
    return lambda folder: write_csv(folder / "a.csv", [[name for name, _ in named]], [values for _, values in named])


def cut(write, keep):
    def written(folder):
        path = write(folder)
        content = path.read_bytes()
        path.write_bytes(content[: int(keep * len(content))])
        return path

    return written


def renamed(write, name):
    return lambda folder: write(folder).rename(folder / name)


def holed(*samples):
    values = X.copy()
    values[list(samples)] = np.nan
    return values


def tdms(folder, **extra):
    properties = {"x": {"unit_string": "m"}, "F": {"unit_string": "N"}, "time": {"unit_string": "s"}}
    return write_tdms(folder / "a.tdms", {"time": T, "x": X, "F": F, **extra}, **properties)


def mdf(folder):
    return write_mdf(folder / "a.mf4", [("x", T, X, "m"), ("F", T, F, "N")])


def mat(folder):
    return write_mat(folder / "a.mat", time=T, x=X, F=F, units={"time": "s", "x": "m", "F": "N"})


def mat73(folder):
    return write_mat73(folder / "a.mat", time=T, x=X, F=F, units={"time": "s", "x": "m", "F": "N"})


def unreadable(folder):
    path = text(HEADER + "".join(ROWS))(folder)
    path.chmod(0)
    return path


good = text(HEADER + "".join(ROWS))
time, x, force = ("time [s]", T), ("x [m]", X), ("F [N]", F)
BAD = {
    "no path": (lambda _: 7, {}, "`path` must be a string or a path, got 7"),
    "no file": (lambda folder: folder / "b.csv", {}, "file not found"),
    "a folder": (lambda folder: folder, {}, "is a folder"),
    "a file without a suffix": (text("", "bench"), {}, "unsupported file suffix ''"),
    "a wrong suffix": (text("", "a.xlsx"), {}, "unsupported file suffix '.xlsx'; supported: .csv, .tsv"),
    "an empty text": (text(""), {}, "empty file; expected a header"),
    "blank lines": (text("\n \n\n"), {}, "empty file"),
    "an empty TDMS": (text("", "a.tdms"), {}, "the suffix indicates TDMS, but the first bytes indicate an empty file"),
    "a blank TDMS": (text("\0" * 200, "a.tdms"), {}, "the first bytes indicate a blank file"),
    "an empty MDF": (text("", "a.mf4"), {}, "an empty file"),
    "an empty MAT": (text("", "a.mat"), {}, "an empty file"),
    "text called TDMS": (renamed(good, "a.tdms"), {}, "the first bytes indicate another format"),
    "TDMS called text": (renamed(tdms, "a.csv"), {}, "indicate TDMS. Rename it to end in .tdms"),
    "MDF called MAT": (renamed(mdf, "b.mat"), {}, "indicate MDF. Rename it"),
    "MAT called text": (renamed(mat, "a.txt"), {}, "indicate MAT. Rename it"),
    "a workbook called text": (text(b"PK\x03\x04" + b"\0" * 99), {}, "Export the sheet as CSV"),
    "bytes called text": (text(bytes(range(256)) * 20), {}, "is not text"),
    "an essay": (text("It was a dark\nand stormy night.\n"), {}, "rows of numbers not found"),
    "a giant header": (text("x" * 1_000_000), {}, "rows of numbers not found"),
    "a header and no rows": (text(HEADER), {}, "rows of numbers not found"),
    "one column": (text("x [m]\n" + "1.5\n" * 9), {}, "force channel not found"),
    "one column without a name": (text("1.5\n" * 9), {}, "a.csv: no column has a header"),
    "a TDMS file cut in its heading": (cut(tdms, 0.02), {}, "not found by an obvious name|damaged or truncated"),
    "a TDMS file cut before its numbers": (cut(tdms, 0.25), {}, r"at least 4 samples.* complete\?|cut short"),
    "an MDF file cut short": (cut(mdf, 0.5), {}, "cannot be read as an MDF file: the file is damaged or truncated"),
    "an MDF file cut in its header": (cut(mdf, 0.01), {}, "damaged or truncated"),
    "an MDF file cut a little": (cut(mdf, 0.98), {}, "damaged or truncated"),
    "a MAT file cut short": (cut(mat, 0.5), {}, "cannot be read as a MAT file: the file is damaged or truncated"),
    "a MAT file of version 7.3 cut short": (cut(mat73, 0.5), {}, "cannot be read as a MAT file: the file is damaged"),
    "MAT in name only": (text(b"MATLAB 5.0 MAT-file" + b" " * 200, "a.mat"), {}, "cannot be read as a MAT file"),
    "HDF5 in name only": (text(b"\x89HDF\r\n\x1a\n" + b" " * 200, "a.mat"), {}, "cannot be read as a MAT file"),
    "a missing channel": (good, {"force": "Lode"}, r"unknown channel 'Lode' for the force; available: time \[s\], x"),
    "a name that is nearly right": (columns(time, x, ("Load_1 [N]", F)), {"force": "load1"}, "mean 'Load_1'"),
    "a number that is too large": (good, {"force": 3}, "force=3 is out of range; the file has 3 channels"),
    "no obvious displacement": (columns(time, ("s1 [m]", X), force), {}, "displacement channel not found by"),
    "no obvious time": (columns(("s0 [s]", T), x, force), {}, "or give interval=0.001"),
    "a channel that is no name": (good, {"force": 1.5}, "the name or the number of a channel, got 1.5"),
    "one channel for two": (good, {"force": "x"}, "'x' cannot be both the displacement and the force"),
    "two channels of one name": (columns(time, x, force, force), {}, "by number: force=2"),
    "an unknown unit": (columns(time, x, ("F [flup]", F)), {}, "unit 'flup' of 'F' is not a unit of force"),
    "a unit of another kind": (columns(time, x, ("F [mm]", F)), {}, "unit 'mm' of 'F' is not a unit of force"),
    "volts": (columns(time, x, ("F [V]", F)), {}, "the value of one count or volt of the file"),
    "kilograms": (columns(time, x, ("F [kg]", F)), {}, "is a unit of mass, not of force"),
    "capital kilograms": (columns(time, x, ("F [KG]", F)), {}, "is a unit of mass, not of force"),
    "dashes for units": (
        text("t,x,F\n-,-,-\n" + "".join(ROWS)), {}, "'t', 'x' and 'F' have no unit. .* units={'time': 's', "),
    "no header": (text("".join(ROWS)), {}, r"no column has a header \(3 found\)\..* time=0, displacement=1, force=2"),
    "thousands": (changed(30, '0.06,0.001,"1,234.5"\n'), {}, 'line 32: "1,234.5" has thousands separators'),
    "thousands everywhere": (text("".join(f"1'{i:03d}.5;2'500.0\n" for i in range(9))), {}, "thousands separators"),
    "a sum below the numbers": (
        text(HEADER + "".join(ROWS) + "Summe,1,2\n"),
        {},
        'line 62: expected a number .*, got "Summe"',
    ),
    "no unit": (columns(time, x, ("F", F)), {}, "'F' has no unit. Name the unit of the force, such as units={'force'"),
    "a unit that was misspelt": (good, {"units": {"force": "Newtn"}}, "specified unit 'Newtn' is not a unit of force"),
    "a unit of nothing": (good, {"units": {"Load": "N"}}, "unknown channel 'Load'; available: time"),
    "units that are no table": (good, {"units": "N"}, "units must be a table"),
    "a unit that is no text": (good, {"units": {"force": 3}}, "must be a text such as 'N', got 3"),
    "a unit of zero": (good, {"units": {"force": "0 N"}}, "is not a unit of force"),
    "both interval and time": (good, {"interval": 1e-3, "time": "time"}, "not both"),
    "an interval of nothing": (good, {"interval": 0.0}, "must be a positive number of s, got 0.0"),
    "NaN bursts": (columns(time, ("x [m]", holed(5, 6, 7, 30)), force), {}, "lacks 4 samples .* up to 3"),
    "NaN bursts that are too long": (
        columns(time, ("x [m]", holed(*range(9, 40))), force), {"gaps": "fill"}, "31 consecutive samples of"),
    "nothing but NaN in a channel": (columns(time, x, ("F [N]", T * np.nan)), {}, "no readings: .* another channel"),
    "nothing but NaN": (columns(time, ("x [m]", T * np.nan), force), {"gaps": "fill"}, "displacement has no readings"),
    "no stretch without NaN": (columns(time, ("x [m]", T * np.nan), force), {"gaps": "longest"}, "has no readings"),
    "times that are missing": (columns(("time [s]", holed(3)), x, force), {}, "1 times are missing"),
    "a wish for gaps that is not known": (good, {"gaps": "ignore"}, "'fill', 'longest' or the longest gap"),
    "infinite force": (columns(time, x, ("F [N]", np.where(BENCH.time == T[9], np.inf, F))), {}, "first at sample 9"),
    "three samples": (text(HEADER + "".join(ROWS[:3])), {}, "must have at least 4 samples; 'a.csv' has 3"),
    "times that repeat": (columns(("time [s]", np.round(T, 2)), x, force), {}, "must increase, but do not at sample"),
    "times that run backwards": (columns(("time [s]", -T), x, force), {}, "read it with interval= instead"),
    "a short row": (changed(30, "0.06,0.001\n"), {}, "line 32: expected 3 cells, got 2"),
    "a long row": (changed(30, "0.06,0.001,2.0,3.0\n"), {}, "line 32: expected 3 cells, got 4"),
    "a last row cut short": (changed(59, "0.118,0.0\n"), {}, "line 61: expected 3 cells, got 2"),
    "text among the numbers": (changed(30, "0.06,0.001,oops\n"), {}, 'line 32: expected a number .*, got "oops"'),
    "text in the first row": (changed(0, "0.0,0.001,oops\n"), {}, "line 2: expected a number with a decimal point"),
    "a decimal comma among points": (changed(30, '0.06,0.001,"2,5"\n'), {}, 'line 32: .* decimal point, got "2,5"'),
    "decimal commas between commas": (
        text(HEADER + "".join(f"0,{i:03d},0,5,1,25\n" for i in range(9))), {}, "requires a delimiter other than"),
    "decimal commas between commas, and a whole number in the first row": (
        text(HEADER + "0,0,5,1,25\n" + "".join(f"0,{i:03d},0,5,1,25\n" for i in range(1, 9))), {},
        "line 2: the row has 5 columns, the rows below have 6. A decimal comma requires a delimiter other than"),
    "complex numbers": (lambda folder: write_mat(folder / "a.mat", time=T, x=X, F=F * 1j), {"units": {
        "time": "s", "displacement": "m", "force": "N"}}, "'F' contains complex numbers"),
    "a matrix": (lambda folder: write_mat(folder / "a.mat", time=T, x=X, F=np.c_[F, F]), {}, r"F\[0\] \(no unit\)"),
    "channels of two lengths": (lambda folder: tdms(folder, F=F[:50]), {}, "different numbers of samples"),
    "only texts": (lambda folder: write_mat(folder / "a.mat", name="bench"), {}, "available: no channels of numbers"),
    "rasters that do not overlap": (
        lambda f: write_mdf(f / "a.mf4", [("x", T, X, "m")], [("F", T + 9, F, "N")]), {}, "do not overlap in time"),
    "a range that is none": (good, {"force_range": -1.0}, "The force_range of a record must be a positive number"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_one_clear_sentence(tmp_path, name):
    write, call, said = BAD[name]
    given = write(tmp_path)
    with pytest.raises(RecordError) as caught:
        it.read_record(given, **call)
    message = str(caught.value)
    assert re.search(said, message), message
    assert "\n" not in message
    assert 20 < len(message) < 500
    assert message.endswith((".", "?")), message
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__ or caught.value.__context__ is None


def test_there_are_forty_of_them():
    assert len(BAD) >= 40


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read(tmp_path):
    with pytest.raises(RecordError, match=r"a\.csv cannot be opened: Permission denied\."):
        it.read_record(unreadable(tmp_path))
