"""Files with thousands of mistakes, or of numbers beyond all reason: what is said stays as long as one reads."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest
from study_text import ELEMENTS, study_text

from inerter.cli.main import call

LAYOUTS = 'S1 = "k | c"\nS2 = "k | c - b"'
INDICES = 'indices = ["J1", "J3", "J5"]'
MISTAKES = {
    "layouts": [
        'L{i} = "k | q{i}"',
        'L{i} = "k | ("',
        "L{i} = 7",
        'L{i} = "b - c"',
        'L{i} = ["k"]',
        'L{i} = "k | e{i}"',
    ],
    "elements": ['e{i} = "1 parsec"', 'e{i} = "-1 kg"', "e{i} = {{ from = 1 }}", "e{i} = []", 'e{i} = "1 kg"'],
    "settings": ["s{i} = 1", "s{i} = [1]"],
}


def study(draw: random.Random, count: int) -> str:
    """A study file with so many mistakes of some kinds; names may be long."""
    long = "x" * draw.choice([0, 0, 300])
    parts = {
        part: "\n".join(draw.choice(lines).format(i=f"{long}{i}") for i in range(count if draw.random() < 0.6 else 0))
        for part, lines in MISTAKES.items()
    }
    return study_text(
        f"{INDICES}\n{parts['settings']}",
        elements=f"{ELEMENTS}\n{parts['elements']}",
        layouts=f"{LAYOUTS}\n{parts['layouts']}",
    )


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(n, marks=pytest.mark.marathon) for n in range(10, 60))])
def test_thousands_of_mistakes_are_told_in_a_page(
    seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "study.toml"
    path.write_text(study(random.Random(seed), 3000 if seed else 600), encoding="utf-8")
    assert call(["check", str(path)]) in (0, 2)
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    assert 0 < len(out + err) < 15_000
    assert len((out + err).splitlines()) < 40


def beyond_reason(seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A study with values of any size is run: each number is one, or has a status that says why not."""
    draw = random.Random(seed)
    path = tmp_path / f"{seed}.toml"
    values = {name: 10.0 ** draw.uniform(-50, 50) if draw.random() < 0.7 else 1e3 for name in "kcb"}
    if seed == 0:
        values["k"] = 1e49
    elements = 'k = "{k} N/m"\nc = "{c} N s/m"\nb = "{b} kg"'.format(**values)
    path.write_text(study_text(INDICES, elements=elements, layouts=LAYOUTS), encoding="utf-8")
    code = call(["run", str(path), "-j", "1", "-o", str(tmp_path / f"{seed}")])
    out, err = capsys.readouterr()
    assert code in (0, 1), err
    assert "Traceback" not in out + err
    lines = (tmp_path / f"{seed}" / "summary.csv").read_text(encoding="utf-8").splitlines()
    names = lines[0].split(",")
    for line in lines[1:]:
        row = dict(zip(names, line.split(","), strict=False))
        assert row["status"] != "ok" or math.isfinite(float(row["value"])), (values, row)


@pytest.mark.usefixtures("no_drawing")
@pytest.mark.campaign
def test_values_beyond_reason_are_numbers_or_say_why_not(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for seed in range(3):
        beyond_reason(seed, tmp_path, capsys)


@pytest.mark.marathon
@pytest.mark.parametrize("seed", range(3, 46))
def test_many_values_beyond_reason_are_numbers_or_say_why_not(
    seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    beyond_reason(seed, tmp_path, capsys)


@pytest.fixture
def no_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures take most of the time; the campaign draws them."""
    monkeypatch.setattr("inerter.report.writing.draw_study", lambda data, folder: folder.mkdir())
    monkeypatch.setattr("inerter.report.writing.write_report", lambda contents, figures, path: path.touch())
