"""What `identify` takes: records that count once each, and models by name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rigs import BALL_SCREW

import inerter as it
from inerter.cli.main import call
from inerter.errors import IdentificationError, NetworkError
from inerter.identification.arguments import checked_records, model_of
from inerter.identification.choice import select_model
from inerter.identification.models import MODELS, on_rig, with_mount

TIME = np.arange(400) / 500.0


def recorded(seed: int, source: str = "bench.csv") -> it.Record:
    """A motion that is always the same, and a force with noise of its own."""
    noise = np.random.default_rng(seed).normal(0.0, 0.1, TIME.size)
    return it.Record(TIME, 1e-3 * np.cos(18.0 * TIME), -30.0 * np.cos(18.0 * TIME) + noise, source=source)


AGAIN = {
    "itself": lambda r, folder: r,
    "a copy": lambda r, folder: replace(r, source="copy.csv", force_range=500.0),
    "a part": lambda r, folder: r.trim(0.2, 0.5),
    "overlapping parts": lambda r, folder: r.trim(0.3, 0.7),
    "in other units": lambda r, folder: it.Record(r.time, (1e3 * r.displacement) / 1e3, (r.force / 9.80665) * 9.80665),
    "through a file": lambda r, folder: through(r, folder / "again.txt"),
}


def through(record: it.Record, path: Path) -> it.Record:
    it.write_record(record, path)
    return it.read_record(path)


@pytest.mark.parametrize("kind", AGAIN)
def test_samples_that_count_twice_are_refused(kind: str, tmp_path: Path) -> None:
    first, between = recorded(1), recorded(2)
    again = AGAIN[kind](first, tmp_path)
    first = first.trim(0.0, 0.5) if kind == "overlapping parts" else first
    said = rf"Record 1 \(bench.csv\) and record 3 \({again.source}\) contain the same samples, .* Leave one of them"
    for call_it in (lambda r: it.identify(r, "ideal"), select_model):
        with pytest.raises(IdentificationError, match=f"^{said}"):
            call_it([first, between, again])


def test_times_in_a_wrong_unit_are_warned_of_before_a_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    def begin(*arguments: object) -> None:
        raise IdentificationError("begun")

    monkeypatch.setattr("inerter.identification.identify.solution_of", begin)
    monkeypatch.setattr("inerter.identification.choice.solution_of", begin)
    in_ms = replace(recorded(1), time=1e3 * TIME)
    for fit in (lambda: it.identify(in_ms, "ideal"), lambda: select_model(in_ms, ["ideal"])):
        with (
            pytest.raises(IdentificationError, match="begun"),
            pytest.warns(UserWarning, match=r"bench.csv: The motion is implausibly slow.*units={'time': 'ms'}") as told,
        ):
            fit()
        assert told[0].filename == __file__


def test_swapped_columns_are_refused() -> None:
    """A displacement of metres under a force of millinewtons: no device is that soft."""
    good = recorded(1)
    swapped = replace(good, displacement=100.0 * good.force / np.abs(good.force).max(), force=good.displacement)
    for fit in (lambda: it.identify(swapped, "ideal"), lambda: select_model(swapped, ["ideal"])):
        with pytest.raises(IdentificationError, match=r"^bench.csv: the displacement has an amplitude of .* swapped"):
            fit()
    in_mm = replace(good, displacement=1e3 * good.displacement)
    assert checked_records(in_mm) == [in_mm]


def test_records_of_one_motion_count_each() -> None:
    """The same motion again has other noise; two halves share no time, and a rest before the motion tells nothing."""
    whole, still = recorded(1), np.zeros(TIME.size)
    rest = [it.Record(TIME, still, still, source="rest"), it.Record(TIME, still, still, source="rest")]
    for records in ([whole, recorded(2)], [whole.trim(0.0, 0.4), whole.trim(0.4, 0.7)], rest):
        assert checked_records(records) == records
    assert checked_records(whole) == [whole]


def test_the_command_refuses_a_file_given_twice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bench.csv"
    it.write_record(recorded(1), path)
    assert call(["identify", str(path), str(path), "--model", "ideal", "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("inerter: Record 1 (bench.csv) and record 2 (bench.csv) contain the same samples")


def test_models_by_name() -> None:
    for name, model in MODELS.items():
        assert model_of(name) is model
    assert model_of(BALL_SCREW) is BALL_SCREW
    for wrong, hint in {
        "ballscrew": "ball-screw",
        "Ball_Screw": "ball-screw",
        "elastic friction": "elastic-friction",
    }.items():
        with pytest.raises(IdentificationError, match=f"Did you mean '{hint}'") as refused:
            it.identify(recorded(1), wrong)
        assert all(name in str(refused.value) for name in MODELS)
    for strange in ("zzz", "", None, 3, [BALL_SCREW], it.Inerter):
        with pytest.raises(IdentificationError, match="Or define a network"):
            it.identify(recorded(1), strange)  # type: ignore[arg-type]


@pytest.mark.marathon
def test_a_model_by_name_is_fitted_as_the_model_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("inerter.identification.conclusions.explanations", lambda *arguments: [])  # which take long
    named, given = (it.identify(recorded(1), model, starts=8) for model in ("ideal", MODELS["ideal"]))
    assert named.parameters == given.parameters


def test_what_is_no_network_is_told_wherever_one_is_mounted() -> None:
    for mount in (it.Rig, it.VirtualRig, with_mount, lambda device: on_rig(device, None)):
        for strange in ("ball-screw", None, [it.Inerter(1.0)]):
            with pytest.raises(NetworkError, match="Expected an element or a network"):
                mount(strange)  # type: ignore[arg-type]
