"""MAT and TDMS files in the layouts in which recorders and simulators write them: the same record as from a table."""

from __future__ import annotations

from datetime import datetime, timedelta

import h5py
import numpy as np
import pytest
from bench import KGF, bench, write_mat, write_mat73, write_tdms
from test_readers import alike

import inerter as it
from inerter.errors import RecordError

BENCH = bench(120)
T, X, F = BENCH.time, BENCH.displacement, BENCH.force
SI = {"time": "s", "displacement": "m", "force": "N"}
ROW, COLUMN = np.atleast_2d, lambda values: np.atleast_2d(values).T


def control_desk(names, time_unit="s", rasters=None):
    """As ControlDesk exports a recording: a struct named as the file, with X of times and an array Y of signals."""
    signals = [(names[0], X * 1e3, "mm"), (names[1], F, "N"), ("Model Root/Strom/Out1", T * 7.0, "A")]
    y = [
        {"Name": name, "Type": "FLOAT", "Data": ROW(values), "Unit": unit, "XIndex": float(at) if rasters else 1.0}
        for at, (name, values, unit) in enumerate(signals, start=1)
    ]
    x = [{"Name": "HostService", "Type": "FLOAT", "Data": ROW(times), "Unit": time_unit} for times in rasters or [T]]
    return {"Messung": {"X": x if rasters else x[0], "Y": y, "Description": {"General": {"DateTime": "2024"}}}}


def scope():
    """As a Scope block of Simulink logs: structure with time."""
    signals = [
        {"values": COLUMN(X), "dimensions": 1.0, "label": "Weg", "title": "strut", "plotStyle": 0.0},
        {"values": COLUMN(F), "dimensions": 1.0, "label": "Kraft", "title": "strut", "plotStyle": 0.0},
    ]
    return {"ScopeData": {"time": COLUMN(T), "signals": signals, "blockName": "bench/Scope"}}


def catman(time="Zeit  1 - Standardmessrate"):
    """As catman exports: Channel_i_Data, and a header with the name and unit of each."""
    found = {"File_Header": {"NumberOfChannels": "3"}}
    for at, (name, unit, values) in enumerate([(time, "s", T), ("Weg", "mm", X * 1e3), ("Kraft", "kN", F / 1e3)], 1):
        found[f"Channel_{at}_Header"] = {"SignalName": name, "Unit": unit, "SampleFrequency": "500"}
        found[f"Channel_{at}_Data"] = COLUMN(values)
    return found


def waveforms():
    """As LabVIEW gives waveforms to MATLAB: structs of a start, an interval and values."""
    return {name: {"t0": 0.0, "dt": 2e-3, "Y": COLUMN(values)} for name, values in (("Weg", X), ("Kraft", F))}


def timeseries():
    """As struct(timeseries) gives them: Time, Data and what is known of both."""
    return {
        name: {
            "Name": name,
            "Time": COLUMN(T * 1e3),
            "TimeInfo": {"Units": "milliseconds"},
            "Data": COLUMN(values),
            "DataInfo": {"Units": unit},
        }
        for name, values, unit in (("position", X * 1e3, "mm"), ("load", F, "N"))
    }


MAT = {
    "ControlDesk": (control_desk(["Weg", "Kraft"]), {}, "force from Messung.Y.Kraft [N]"),
    "ControlDesk with paths": (
        control_desk(["Model Root/mess/Weg/Out1", '"Model Root"/"mess"/"Kraft"']), {}, "displacement from Messung.Y."
    ),
    "ControlDesk without units of time": (control_desk(["Weg", "Kraft"], ""), {}, "ControlDesk writes times in s"),
    "ControlDesk of two rasters": (control_desk(["Weg", "Kraft"], rasters=[T, T, T[:5]]), {}, "force from Messung.Y"),
    "ControlDesk by name": (control_desk(["a", "b"]), {"displacement": "a", "force": "b"}, None),
    "Simulink": (scope(), {"units": SI}, "Simulink writes times in s"),
    "catman": (catman(), {}, "time from Channel_1_Data.Zeit 1 - Standardmessrate [s]"),
    "catman in English": (catman("Time  1 - default sample rate"), {}, "force from Channel_3_Data.Kraft [kN]"),
    "LabVIEW": (waveforms(), {"units": SI}, "displacement from Weg"),
    "timeseries": (timeseries(), {}, None),
    "vectors": ({"zeit": T, "weg": X, "kraft": F}, {"units": SI}, "time from zeit"),
}  # fmt: skip


@pytest.mark.parametrize("write", [write_mat, write_mat73])
@pytest.mark.parametrize("name", MAT)
def test_mat(tmp_path, name, write):
    variables, call, said = MAT[name]
    record = it.read_record(write(tmp_path / "a.mat", **variables), **call)
    alike(record, BENCH)
    assert said is None or said in " ".join(record.notes)


def test_objects_of_matlab_are_named(tmp_path):
    """A timetable in version 7.3 is numbers that refer to a hidden part of the file, and no channel."""
    path = write_mat73(tmp_path / "a.mat")
    with h5py.File(path, "r+") as file:
        data = file.create_dataset("run", data=np.array([[3707764736, 2, 1, 1, 1, 1]], dtype=np.uint32))
        data.attrs["MATLAB_class"] = np.bytes_("timetable")
        data.attrs["MATLAB_object_decode"] = 3
    with pytest.raises(RecordError, match=r"a\.mat: run: MATLAB objects, such as a timetable"):
        it.read_record(path)


def test_two_recordings_of_one_file_are_not_chosen_between(tmp_path):
    both = {**control_desk(["Weg", "Kraft"]), "Zweite": control_desk(["Weg", "Kraft"])["Messung"]}
    path = write_mat(tmp_path / "a.mat", **both)
    with pytest.raises(RecordError, match=r"'Messung\.Y\.Weg' \(number 1\) and 'Zweite\.Y\.Weg' .* Select one"):
        it.read_record(path)
    alike(it.read_record(path, displacement="Zweite.Y.Weg", force="Zweite.Y.Kraft", time="Zweite.X"), BENCH)


WAVE = {"wf_increment": 2e-3, "wf_start_offset": 0.0, "wf_samples": T.size}
START = datetime(2024, 3, 1, 12, 0, 0)
TDMS = {
    "German names": ({"Zeit": T, "Weg": X, "Kraft": F}, {}, SI | {"Zeit": "s", "Weg": "m", "Kraft": "N"}, "time from"),
    "units in names": ({"Zeit [s]": T, "Weg (mm)": X * 1e3, "Kraft / kN": F / 1e3}, {}, {}, "force from"),
    "over milliseconds": (
        {"x": X, "F": F}, WAVE | {"wf_increment": 2.0, "wf_xunit_string": "ms"}, {"x": "m", "F": "N"}, None),
    "one start": ({"x": X, "F": F / KGF}, WAVE | {"wf_start_time": START}, {"x": "m", "F": "kgf"}, None),
}  # fmt: skip


@pytest.mark.parametrize("name", TDMS)
def test_tdms(tmp_path, name):
    channels, wave, units, said = TDMS[name]
    properties = {name: {**wave, **({"unit_string": units[name]} if name in units else {})} for name in channels}
    record = it.read_record(write_tdms(tmp_path / "a.tdms", channels, **properties))
    alike(record, BENCH)
    assert said is None or said in " ".join(record.notes)


def test_tdms_of_waveforms_that_began_apart(tmp_path):
    """The second device began 50 ms later: its samples are at later times, and were silently moved before."""
    late = 25
    starts = {"x": START, "F": START + timedelta(seconds=late * 2e-3)}
    smooth = 1e-3 * np.cos(18.0 * T)
    units = {"x": "m", "F": "N"}
    properties = {name: WAVE | {"unit_string": units[name], "wf_start_time": starts[name]} for name in units}
    record = it.read_record(write_tdms(tmp_path / "a.tdms", {"x": smooth, "F": F}, **properties))
    assert record.force == pytest.approx(F[: T.size - late])
    assert record.displacement == pytest.approx(smooth[late:], abs=1e-9)


def test_tdms_takes_the_times_of_the_group_that_was_chosen(tmp_path):
    from nptdms import ChannelObject, TdmsWriter  # noqa: PLC0415 - an extra

    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        for group, speed in (("slow", 1.0), ("fast", 0.5)):
            for name, values, unit in (("Zeit", speed * T, "s"), ("Weg", X, "m"), ("Kraft", F, "N")):
                writer.write_segment([ChannelObject(group, name, values, {"unit_string": unit})])
    record = it.read_record(tmp_path / "a.tdms", displacement="fast/Weg")
    assert record.time == pytest.approx(0.5 * T)
    assert "time from fast/Zeit [s], force from fast/Kraft [N]" in record.notes[0]
    with pytest.raises(RecordError, match="ambiguous displacement channel"):
        it.read_record(tmp_path / "a.tdms")


def test_tdms_over_something_else_is_refused(tmp_path):
    wave = WAVE | {"wf_xunit_string": "Hz"}
    properties = {"x": wave | {"unit_string": "m"}, "F": wave | {"unit_string": "N"}}
    with pytest.raises(RecordError, match=r"abscissa of 'x' has the unit 'Hz', which is not a unit of time"):
        it.read_record(write_tdms(tmp_path / "a.tdms", {"x": X, "F": F}, **properties))
