"""One measurement, written in many ways by other programs, is one record."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from bench import KGF, bench, write_csv, write_mat, write_mat73, write_mdf, write_tdms
from hypothesis import given, settings
from hypothesis import strategies as st

import inerter as it
from inerter.errors import RecordError

BENCH = bench()
T, X, F = BENCH.time, BENCH.displacement, BENCH.force
SI = {"time": "s", "displacement": "m", "force": "N"}
LBF = 4.4482216152605  # N


def alike(record, expected=BENCH):
    for role, values in expected.channels().items():
        assert record.channels()[role] == pytest.approx(values, rel=1e-12, abs=1e-15), role


TEXTS = {
    "units beside": ([["time [s]", "force [N]", "displacement [m]"]], [T, F, X], {}),
    "units in round brackets": ([["t (ms)", "x (µm)", "F (kN)"]], [T * 1e3, X * 1e6, F / 1e3], {}),
    "units below": ([["Time", "Position", "Load"], ["s", "mm", "kgf"]], [T, X * 1e3, F / KGF], {}),
    "below in brackets": ([["Time", "Position", "Load"], ["[s]", "[in]", "[lbf]"]], [T, X / 0.0254, F / LBF], {}),
    "other columns": ([["a [V]", "X [mm]", "b", "Load [N]", "time [s]"]], [T * 0, X * 1e3, T, F, T], {}),
    "named": ([["s1 [s]", "s2 [mm]", "s3 [N]"]], [T, X * 1e3, F], {"time": "s1", "displacement": "S2", "force": "s3"}),
    "units in the call": ([["time", "disp", "load"]], [T, X * 1e3, F], {"units": SI | {"displacement": "mm"}}),
    "no header": ([], [F, T, X], {"time": 1, "displacement": 2, "force": 0, "units": SI}),
    "no times": ([["x [m]", "F [N]"]], [X, F], {"interval": 2e-3}),
    "times overruled": ([["time [s]", "x [m]", "F [N]"]], [T * 0, X, F], {"interval": 2e-3}),
    "kilograms by the call": ([["time [s]", "x [m]", "Load [kg]"]], [T, X, F / KGF], {"units": {"force": "kgf"}}),
    "volts by the call": ([["time [s]", "x [m]", "Load [V]"]], [T, X, F / -250.0], {"units": {"force": "-250 N"}}),
    "millivolts by the call": ([["time [s]", "x [m]", "Load [mV]"]], [T, X, F / -0.25], {"units": {"force": "-250 N"}}),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize(("delimiter", "decimal"), [(",", "."), (";", ","), ("\t", "."), ("\t", ",")])
def test_text(tmp_path, name, delimiter, decimal):
    header, columns, call = TEXTS[name]
    alike(it.read_record(write_csv(tmp_path / "a.csv", header, columns, delimiter, decimal), **call))


@settings(max_examples=20)
@given(st.permutations(range(5)), st.sampled_from(["mm", "um", "in"]), st.sampled_from(["N", "kN", "lbf", "kgf"]))
def test_order_and_units_do_not_matter(tmp_path_factory, order, length, load):
    units = {"displacement": (length, {"mm": 1e-3, "um": 1e-6, "in": 0.0254}[length])}
    units |= {"force": (load, {"N": 1.0, "kN": 1e3, "lbf": LBF, "kgf": KGF}[load])}
    columns = [("time [s]", T), (f"position [{length}]", X / units["displacement"][1])]
    columns += [(f"load [{load}]", F / units["force"][1]), ("spare [V]", T), ("other", T)]
    path = tmp_path_factory.mktemp("orders") / "a.tsv"
    alike(it.read_record(write_csv(path, [[columns[i][0] for i in order]], [columns[i][1] for i in order], "\t")))


def test_text_with_all_sorts_of_things_around_it(tmp_path):
    rows = "".join(f"{t!r}; {x!r} ;{f!r};\r\n" for t, x, f in zip(T.tolist(), X.tolist(), F.tolist(), strict=True))
    head = (
        "\ufeffBench 3;7.2\r\nOperator: nobody\r\n\r\n# a comment; with; marks;\r\ntime;position;force;\r\ns;m;N;\r\n"
    )
    (tmp_path / "a.txt").write_bytes((head + rows[:4000].rsplit("\n", 1)[0] + "\n# half\r\n\r\n").encode())
    with open(tmp_path / "a.txt", "ab") as file:
        file.write(rows[len(rows[:4000].rsplit("\n", 1)[0]) + 1 :].encode())
    record = it.read_record(tmp_path / "a.txt")
    alike(record)
    assert "Operator: nobody" in record.meta["preamble"]


def test_columns_as_numpy_saves_them(tmp_path):
    np.savetxt(tmp_path / "a.txt", np.c_[T, X, F], header="time [s] displacement [m] force [N]", fmt="%.17g")
    alike(it.read_record(tmp_path / "a.txt"))
    np.savetxt(tmp_path / "b.txt", np.c_[T, X, F], fmt="%.17g")
    alike(it.read_record(tmp_path / "b.txt", time=0, displacement=1, force=2, units=SI))


def test_a_micro_sign_of_an_older_program(tmp_path):
    path = write_csv(tmp_path / "a.csv", [["time [s]", "x [µm]", "F [N]"]], [T, X * 1e6, F])
    path.write_bytes(path.read_text(encoding="utf-8").encode("latin-1"))
    alike(it.read_record(path))


def test_many_blocks(tmp_path, monkeypatch):
    """Blocks end anywhere in a line; the progress grows to 1."""
    monkeypatch.setattr("inerter.records.tables.BLOCK", 500)
    seen = []
    alike(it.read_record(write_csv(tmp_path / "a.csv", *TEXTS["units beside"][:2]), progress=seen.append))
    assert len(seen) > 20
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_tdms(tmp_path):
    units = {"Time": {"unit_string": "ms"}, "Position": {"NI_UnitDescription": "mm"}, "Load": {"unit_string": "kgf"}}
    path = write_tdms(tmp_path / "a.tdms", {"Load": F / KGF, "Time": T * 1e3, "Position": X * 1e3}, **units)
    alike(it.read_record(path, displacement="Position", force="Load"))
    alike(it.read_record(path, displacement="Measurement/Position"))
    wave = {"wf_increment": 2e-3, "wf_start_offset": 0.0, "wf_samples": T.size}
    units = {"Position": {"unit_string": "m", **wave}, "Load": {"unit_string": "N", **wave}}
    alike(it.read_record(write_tdms(tmp_path / "b.tdms", {"Load": F, "Position": X}, **units)))


def test_tdms_with_instants_and_small_numbers(tmp_path):
    instants = np.datetime64("2024-03-01T12:00:00", "us") + np.round(T * 1e6).astype("timedelta64[us]")
    counts = np.round(X * 1e6).astype(np.int16)
    units = {"x": {"unit_string": "um"}, "F": {"unit_string": "N"}}
    record = it.read_record(write_tdms(tmp_path / "a.tdms", {"time": instants, "x": counts, "F": F}, **units))
    alike(record)


def test_tdms_of_several_groups(tmp_path):
    path = tmp_path / "a.tdms"
    from nptdms import ChannelObject, TdmsWriter  # noqa: PLC0415 - an extra

    def group(name, sign):
        wave = {"wf_increment": 2e-3}
        return [
            ChannelObject(name, "x", sign * X, {"unit_string": "m", **wave}),
            ChannelObject(name, "F", sign * F, {"unit_string": "N", **wave}),
        ]

    with TdmsWriter(str(path)) as writer:
        writer.write_segment([*group("up", 1.0), *group("down", -1.0)])
    alike(it.read_record(path, displacement="up/x", force="up/F"))
    with pytest.raises(RecordError, match=r"displacement channel: 'down/x' \(number 0\) and 'up/x' \(number 2\)"):
        it.read_record(path)


@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_mdf(tmp_path, version):
    path = tmp_path / ("a.mf4" if version == "4.10" else "a.mdf")
    write_mdf(
        path, [("Load", T, F, "N"), ("Position", T, X * 1e3, "mm"), ("acc", T, X / 9.80665, "g")], version=version
    )
    record = it.read_record(path)
    alike(record)
    assert record.acceleration == pytest.approx(X, rel=1e-12)


def test_mdf_of_several_rasters(tmp_path):
    """The force keeps its samples; a smooth displacement with its own clock is brought to its times."""
    fine = np.arange(0.1, 0.8, 0.7e-3)
    smooth = 1e-3 * np.cos(2 * np.pi * 3.0 * fine)
    path = write_mdf(tmp_path / "a.mf4", [("force", T, F, "N")], [("position", fine, smooth, "m")])
    record = it.read_record(path)
    inside = (BENCH.time >= fine[0]) & (BENCH.time <= fine[-1])
    assert record.time == pytest.approx(T[inside])
    assert record.force == pytest.approx(F[inside])
    assert record.displacement == pytest.approx(1e-3 * np.cos(2 * np.pi * 3.0 * T[inside]), abs=1e-12)
    assert "interpolated to the times of the force, every 2 ms" in record.notes[0]


@pytest.mark.parametrize("write", [write_mat, write_mat73])
def test_mat(tmp_path, write):
    path = tmp_path / "a.mat"
    alike(it.read_record(write(path, time=T, x=X * 1e3, F=F, units={"time": "s", "x": "mm", "F": "N"})))
    alike(it.read_record(write(path, run={"t": T, "position": X, "load": F}), displacement="run.position", units=SI))
    columns = np.c_[F, T, X]
    alike(it.read_record(write(path, data=columns), time="data[1]", displacement="data[2]", force="data[0]", units=SI))
    tree = {"position": {"data": X * 1e3, "unit": "mm"}, "load": {"data": F / KGF, "unit": "kgf"}}
    alike(it.read_record(write(path, run=tree), interval=2e-3))


def test_missing_libraries_are_named(tmp_path, monkeypatch):
    files = {
        "nptdms": ("tdms", write_tdms(tmp_path / "a.tdms", {"x": X})),
        "asammdf": ("mdf", write_mdf(tmp_path / "a.mf4", [("x", T, X, "m")])),
        "pymatreader": ("mat", write_mat(tmp_path / "a.mat", x=X)),
    }
    for module, (extra, path) in files.items():
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(RecordError, match=rf'pip install "inerter\[{extra}\]"'):
            it.read_record(path)


def test_gaps_are_filled_or_cut_away(tmp_path):
    smooth = 1e-3 * np.cos(18.0 * T)
    holed = smooth.copy()
    holed[[0, 100, 101, 102, 300]] = np.nan
    path = write_csv(tmp_path / "a.csv", [["time [s]", "x [m]", "F [N]"]], [T, holed, F])
    filled = it.read_record(path, gaps="fill")
    assert filled.time == pytest.approx(T[1:])
    assert filled.displacement == pytest.approx(smooth[1:], abs=1e-9)
    assert filled.notes[0] == "Missing samples of the displacement, interpolated: 4, up to 3 in a row."
    assert filled.meta["filled"] == {"displacement": (4, 3)}
    longest = it.read_record(path, gaps="longest")
    assert longest.time == pytest.approx(T[301:])
    assert it.read_record(path, gaps=0.01).time.size == T.size - 1


def test_gaps_in_the_first_rows_and_a_blank_end(tmp_path):
    rows = "0.0,,\n0.1,1.0,\n0.2,,-3\n" + "".join(f"{0.1 * i:.1f},{i},{-i}\n" for i in range(3, 20)) + ",,\n,,\n"
    (tmp_path / "a.csv").write_text("time [s],x [mm],F [N]\n" + rows)
    record = it.read_record(tmp_path / "a.csv", gaps="longest")
    assert record.force == pytest.approx(-np.arange(3.0, 20.0))
    assert record.notes[0] == "Empty samples at the end, cut off: 2."


def test_what_was_decided_is_noted(tmp_path):
    path = write_csv(tmp_path / "a.csv", [["time [s]", "x [m]", "F [kg]", "vel [V]"]], [T, X, F / KGF, T])
    record = it.read_record(path, units={"force": "kg"})
    alike(record)
    assert record.velocity is None
    assert record.notes == (
        "The force 'F' was read in kg (1 kg = 9.80665 N), instead of kg in the file.",
        "The channel vel [V] was left out: its unit is not a unit of velocity.",
    )
    assert record.meta["channels"] == {"time": "time", "displacement": "x", "force": "F"}


def test_an_angle_is_no_displacement_without_the_lead_of_the_screw(tmp_path):
    turns = X / 0.016 * 360.0
    path = write_csv(tmp_path / "a.csv", [["time [s]", "x [°]", "F [N]"]], [T, turns, F])
    with pytest.raises(RecordError, match="is a unit of angle, not of displacement"):
        it.read_record(path)
    with_lead = it.read_record(path, units={"displacement": f"{16 / 360} mm"})
    assert with_lead.displacement == pytest.approx(X, abs=1e-12)
    assert it.read_record(path, units={"displacement": "mm"}).notes == (
        "The displacement 'x' was read in mm, instead of ° in the file, a unit of angle: 1 ° counts as 1 mm.",
    )


def test_a_file_that_was_cut_short(tmp_path):
    wave = {"wf_increment": 2e-3}
    units = {"x": {"unit_string": "m", **wave}, "F": {"unit_string": "N", **wave}}
    path = write_tdms(tmp_path / "a.tdms", {"x": X, "F": F}, **units)
    path.write_bytes(path.read_bytes()[:-2000])
    record = it.read_record(path)
    assert record.notes == (f"The file is truncated: the first {record.time.size} samples are complete and were kept.",)
    assert record.displacement == pytest.approx(X[: record.time.size])
