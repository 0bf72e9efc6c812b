"""Ctrl-C keeps searches that have ended within a design; a run that goes on from them gives the same bytes."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path

import pytest
from campaigns import sampled
from study_text import load_text, study_text

import inerter as it
from inerter.cli.main import call
from inerter.files.study.journal import journal_of, results_of
from inerter.files.study.search_parts import result_of
from inerter.files.study.searching import search_study
from inerter.work import checkpoints
from inerter.work.checkpoints import Checkpoint
from inerter.work.progress import count_evaluation

FREE = 'k = "20 kN/m"\nc = { from = "300 N s/m", to = "8 kN s/m" }\nb = { from = "1 kg", to = "400 kg" }'
LIMIT = "\n[study.subject_to]\ndynamic-load-coefficient = { at_most = 0.4 }"
STUDIES = {
    "limits": study_text(f'indices = ["J1"]\noptimise = "norm"{LIMIT}', elements=FREE, layouts='S = "k | c - b"'),
    "smooth": study_text('indices = ["J1", "J3"]\noptimise = "norm"', elements=FREE, layouts='S = "k | c - b"'),
    "minimax": study_text('indices = ["J5"]\noptimise = "norm"', elements=FREE, layouts='S = "k | c - b"'),
    "front": study_text(
        'indices = ["J1", "J3"]\noptimise = "norm"\ntrade_off = ["J1", "J3"]\npoints = 4',
        elements=FREE,
        layouts='S = "k | c - b"',
    ),
}


@contextmanager
def counted(stop_at: int | None = None) -> Iterator[list[int]]:
    """How many evaluations searches do, and Ctrl-C at one of them."""
    count = [0]

    def count_one() -> None:
        count[0] += 1
        if count[0] == stop_at:
            raise KeyboardInterrupt
        count_evaluation()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checkpoints, "_SELDOM", 0.0)
        patch.setattr("inerter.optimisation.optimise._compiled_searches", lambda *_: None)  # which end at once
        for module in ("minimax_level", "local"):
            patch.setattr(f"inerter.optimisation.{module}.count_evaluation", count_one)
        yield count


@pytest.mark.parametrize(("name", "seed"), sampled(product(STUDIES, range(2)), [("limits", 0)], kept=1))
def test_a_run_interrupted_within_a_design_goes_on_from_its_searches(name: str, seed: int, tmp_path: Path) -> None:
    path, draw = tmp_path / "study.toml", random.Random(f"{name} {seed}")
    path.write_text(STUDIES[name], encoding="utf-8")
    study = it.load_study(path)
    with counted() as every:
        it.run_study(study, tmp_path / "whole")
    done = 0
    for _ in range(2):  # and interrupted again
        stop = draw.randrange(1, every[0] - done)
        with counted(stop), pytest.raises(KeyboardInterrupt):
            it.run_study(study, tmp_path / "out", resume=done > 0 or (tmp_path / "out").exists())
        done += stop - 1
    journal = journal_of(study, tmp_path / "out" / "journal.jsonl")
    rows = sum(len(one.rows) for one in results_of(journal) if isinstance(one, Checkpoint))
    assert rows > 0
    with counted() as again:
        result = it.run_study(study, tmp_path / "out", resume=True)
    assert again[0] < every[0]
    assert result.computed <= 2
    for file in ("summary.csv", "results.nc"):
        assert (tmp_path / "out" / file).read_bytes() == (tmp_path / "whole" / file).read_bytes()
    assert it.run_study(study, tmp_path / "out", resume=True).computed == 0


def test_a_search_of_networks_interrupted_within_one_goes_on_from_its_searches(tmp_path: Path) -> None:
    """The last designs are those with a real inerter."""
    kinds = (
        'springs = { from = "1 kN/m", to = "1 MN/m" }, dampers_at_most = 0, inerters = { from = "1 kg", to = "1 t" }'
    )
    study = load_text(
        tmp_path,
        study_text(
            'indices = ["J1"]\noptimise = "norm"\nreal_inerters = { friction = "10 N", best = 1 }',
            elements=f'k = "20 kN/m"\nc = "2 kN s/m"\nany = {{ network = 1, {kinds} }}',
            layouts='S = "k | c | any"',
        ),
    )
    with counted() as every:
        whole = search_study(study, tmp_path / "whole")
    with counted(every[0] - 1), pytest.raises(KeyboardInterrupt):
        search_study(study, tmp_path / "out")
    journal = journal_of(whole.study, tmp_path / "out" / "journal.jsonl")
    assert any(isinstance(one, Checkpoint) for one in results_of(journal, result_of))
    with counted() as again:
        search_study(study, tmp_path / "out", resume=True)
    assert again[0] < every[0]
    for file in ("search.csv", "search_real_inerters.csv"):
        assert (tmp_path / "out" / file).read_bytes() == (tmp_path / "whole" / file).read_bytes()


def test_short_designs_keep_nothing_but_their_outcome(tmp_path: Path) -> None:
    study = load_text(tmp_path, STUDIES["smooth"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checkpoints, "_SELDOM", 1e9)
        it.run_study(study, tmp_path / "out")
    assert (tmp_path / "out" / "journal.jsonl").read_bytes().count(b"\n") == 3


def test_rows_that_were_altered_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "study.toml", tmp_path / "out"
    path.write_text(STUDIES["limits"], encoding="utf-8")
    with counted(60), pytest.raises(KeyboardInterrupt):
        it.run_study(it.load_study(path), out)
    journal = out / "journal.jsonl"
    lines = journal.read_bytes()
    at = lines.index(b'"rows": [["') + 40
    digit = lines[at : at + 1]
    journal.write_bytes(lines[:at] + (b"1" if digit != b"1" else b"2") + lines[at + 1 :])
    assert call(["run", str(path), "-o", str(out), "--resume"]) == 2
    assert "modified line" in capsys.readouterr().err
