"""With a token in the place of every sentence, decisions, values and exit codes are what they are with sentences."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st
from study_text import RIG_FIT
from troubled_rig import Device, Sensors, Tones, measured

import inerter as it
from inerter.cli.main import call
from inerter.errors import InerterError, RecordError, Status, StatusKind
from inerter.files.study import running
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.loading import load_study
from inerter.identification import diagnosis
from inerter.identification.friction_law import friction_law
from inerter.identification.statements.causes import Suspect
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.friction import FrictionLaw
from inerter.identification.statements.identifiability import Identifiability
from inerter.records.finding_texts import RecordFinding
from inerter.records.remedy import Remedy
from inerter.records.writers import write_record
from inerter.report import identified_values

TOKEN = "told."  # what was once looked for in sentences, and what begins a status, are the worst of tokens
WORDS = {
    "sentence", "status", "message", "notes", "next_experiment", "remedy", "choice", "versions", "title", "model",
    "elements",
}  # fmt: skip


def opaque(patch: pytest.MonkeyPatch) -> None:
    """Put a token in the place of every sentence that records, identification and statuses make."""
    for kinds in (RecordFinding, FitFinding):
        patch.setattr(kinds, "text", lambda kind, finding: (TOKEN,))
    patch.setattr(Suspect, "sentence", lambda suspect, details: TOKEN)
    patch.setattr(Suspect, "remedy", lambda suspect, details: (TOKEN,))
    patch.setattr(Remedy, "__str__", lambda remedy: TOKEN)
    for shown in (Identifiability, FrictionLaw):
        patch.setattr(shown, "sentence", property(lambda found: TOKEN))
    for error in (InerterError, RecordError):
        patch.setattr(error, "__str__", lambda error: TOKEN)
    patch.setattr(identified_values, "_WORDS", dict.fromkeys(identified_values.ResultKind, TOKEN))
    made = Status.__init__

    def other(status: Status, kind: StatusKind = StatusKind.OK, message: str = "") -> None:
        made(status, kind, message and f"failed: {TOKEN}")

    patch.setattr(Status, "__init__", other)


def with_few_rivals(patch: pytest.MonkeyPatch) -> None:
    """Try every eighth hypothesis only, since each is a fit; and draw nothing."""
    whole = diagnosis.hypotheses
    patch.setattr(diagnosis, "hypotheses", lambda problem, places=(): whole(problem, places)[::8])
    patch.setattr("inerter.cli.identify.write_identification", lambda *arguments: None)


def without_words(data: Any) -> Any:
    """Data without what is there for a reader."""
    if isinstance(data, dict):
        return {key: without_words(value) for key, value in data.items() if key not in WORDS}
    return [without_words(value) for value in data] if isinstance(data, list) else data


RECORDS = ["late", "late-few", "sound", "saturated", "saturated-few"]


@pytest.fixture(scope="module", params=sampled(RECORDS, kept=0))
def bench(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record: of sensors without fault, of a late displacement, or of a load cell at its limit.

    With "few", few hypotheses are tried of what is wrong.
    """
    folder = tmp_path_factory.mktemp(request.param)
    sensors = Sensors(cell=300.0, displacement_late=4e-3 if request.param.startswith("late") else 0.0)
    device = Device(b=113.0, f=10.0, ks=1e6, cs=3200.0)
    time, displacement, force = measured(device, Tones((1e-3, 3e-4), (4.0, 9.0), (0.0, 1.0)), sensors, 1.0, 1)
    if request.param.startswith("saturated"):
        force = np.clip(force, -70.0, 70.0)
    write_record(it.Record(time, displacement, force), folder / "bench.csv")
    (folder / "rig.toml").write_text(RIG_FIT, encoding="utf-8")
    return folder


def test_an_identification_is_the_same_with_tokens_for_words(bench: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ran = []
    for name in ("sentences", "tokens"):
        with pytest.MonkeyPatch.context() as patch:
            if name == "tokens":
                opaque(patch)
            if "few" in bench.name:
                with_few_rivals(patch)
            arguments = [str(bench / "bench.csv"), "--config", str(bench / "rig.toml"), "-o", str(bench / name)]
            code = call(["identify", *arguments, "--json"])
            out = capsys.readouterr().out
            data = json.loads(out)
            assert (TOKEN in data["records"][0]["findings"][-1]["sentence"]) == (name == "tokens")
            ran.append((code, data["status"].partition(":")[0], without_words(data)))
    assert ran[0] == ran[1]
    assert ran[0][0] == (bench.name.startswith("late") or bench.name.startswith("saturated"))


@pytest.mark.marathon
def test_a_choice_and_a_law_are_the_same_with_tokens_for_words() -> None:
    record = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), seed=1, sampling=400.0).run(it.cosine(1e-3, 4.0), 1.5)
    ran = []
    for tokens in (False, True):
        with pytest.MonkeyPatch.context() as patch:
            if tokens:
                opaque(patch)
            with_few_rivals(patch)
            found, law = it.select_model(record, ["ideal", "friction"], starts=8), friction_law(record, 113.0)
            assert (found.notes[0] == TOKEN) == (law.sentence == TOKEN) == tokens
            ran.append((found.name, [(c.name, c.loss, c.as_good, c.status.kind) for c in found.candidates], law.law))
    assert ran[0] == ran[1]


@pytest.mark.parametrize("force", [np.ones(400), np.full(400, np.nan), np.ones(3)], ids=["constant", "nan", "short"])
def test_a_record_that_is_refused_is_refused_with_tokens_too(force: np.ndarray) -> None:
    time = np.arange(force.size) / 200.0
    with pytest.MonkeyPatch.context() as patch:
        opaque(patch)
        with pytest.raises(InerterError):
            it.identify(it.Record(time, np.cos(time), force), "ideal")


STUDY = load_study(EXAMPLES / "quarter-car.toml")


@pytest.mark.campaign
@settings(max_examples=8)
@given(kinds=st.lists(st.sampled_from(StatusKind), min_size=1, max_size=3), word=st.sampled_from(StatusKind))
def test_a_study_has_failed_where_a_status_is_and_not_where_a_word_is(
    kinds: list[StatusKind], word: StatusKind, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Messages that begin as a status does decide nothing."""
    folder = tmp_path_factory.mktemp("study")
    taken = iter([*kinds, *[StatusKind.OK] * 100])

    def compute(case: Case, study: object, designs: object, threads: int) -> Outcome:
        status = {"norm": next(taken).value}
        return Outcome(case.layout, case.index, case.point, {}, {}, {}, 0, 0, 0, {}, {}, status, f"{word}: {TOKEN}")

    few = {name: STUDY.layouts[name] for name in ("S1", "S2", "S3")}
    study = replace(STUDY, evaluate=("norm",), budgets=(), layouts=few, indices=("J1",))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Case, "compute", compute)
        result = running.run_study(study, folder / "out")
    assert result.failed == (StatusKind.FAILED in kinds)
    assert len(result.failures) == sum(kind is not StatusKind.OK for kind in kinds)
