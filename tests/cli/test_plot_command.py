"""`inerter plot`: files that are drawn, and one sentence for what cannot be."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from folders import EXAMPLES

from inerter.cli.main import call
from inerter.figures.plots.kinds import PLOTS

STUDY = EXAMPLES / "quarter-car.toml"


@pytest.mark.parametrize(
    ("kind", "name", "begins"),
    [("bode", "a.svg", b"<?xml"), ("network", "b.png", b"\x89PNG"), ("poles", "c.pdf", b"%PDF")],
)
def test_plots_are_files(kind: str, name: str, begins: bytes, tmp_path: Path) -> None:
    path = tmp_path / name
    arguments = [
        "plot",
        str(STUDY),
        "--kind",
        kind,
        "--layout",
        "S1",
        "--layout",
        "S3",
        "--index",
        "J1",
        "-o",
        str(path),
    ]
    assert call(arguments) == 0
    assert path.read_bytes().startswith(begins)
    assert call(arguments) == 2  # it exists
    assert call([*arguments, "--force"]) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--kind", "bodes"], "Unknown kind of plot 'bodes'"),
        (["--kind", "bode", "-o", "a.txt"], "a plot is a file with the suffix"),
        (["--kind", "bode", "--layout", "S9", "--index", "J1"], 'has no layout "S9"'),
        (["--kind", "bode"], "Choose one with --index"),
        (["--kind", "bode", "-o", "nowhere/a.svg"], "folder not found"),
        (["--kind", "bode", "--window", "1:2"], "does not use --window; it uses --layout, --index"),
        (["--kind", "front"], "expected a folder with the results of a study. Run the study: inerter run"),
        (["--kind", "trajectory"], "expected a simulation file"),
        (["--kind", "step", "--layout", "S1", "--index", "J1", "--only", "a", "--only", "b"], "Choose one with --only"),
    ],
)
def test_what_is_wrong_is_one_sentence(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(["plot", str(STUDY), *arguments]) == 2
    said = capsys.readouterr().err
    assert words in " ".join(said.split())
    assert list(tmp_path.iterdir()) == []


MOTION = """
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
[elements]
k = "60 kN/m"
c = "2 kN s/m"
f = "40 N"
[layouts]
S1 = "k | c | f"
[signal]
kind = "cosine"
amplitude = "2 mm"
frequency = "2 Hz"
[simulation]
duration = "2 s"
step = "1 ms"
"""


@pytest.mark.campaign
def test_motions_are_plots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a file or of its results: the same motion; the loop has one output over another."""
    monkeypatch.chdir(tmp_path)
    Path("motion.toml").write_text(MOTION, encoding="utf-8")
    assert call(["plot", "motion.toml", "--kind", "trajectory", "--window", "0.5:", "-o", "file.svg"]) == 0
    drawn = Path("file.svg").read_text(encoding="utf-8")
    assert "f sticks" in drawn
    assert "Sprung acceleration" in drawn
    assert call(["simulate", "motion.toml"]) == 0
    again = ["plot", "motion-results", "--kind", "trajectory", "--window", "0.5:", "-o", "folder.svg"]
    assert call(again) == 0
    paths = [re.findall(r' d="([^"]+)"', Path(name).read_text(encoding="utf-8")) for name in ("file.svg", "folder.svg")]
    assert paths[0] == paths[1] != []
    loop = ["plot", "motion.toml", "--kind", "loop", "--only", "strut_travel", "--only", "strut_force"]
    assert call(loop) == 0
    assert "Strut force [N]" in Path("motion-loop.svg").read_text(encoding="utf-8")
    capsys.readouterr()
    assert call([*loop[:-2], "-o", "one.svg"]) == 2
    assert "Name both" in capsys.readouterr().err
    assert call(["plot", "motion.toml", "--kind", "trajectory", "--window", "5:6", "-o", "late.svg"]) == 2
    assert "from 5 to 6 s" in capsys.readouterr().err
    assert not Path("late.svg").exists()


@pytest.mark.usefixtures("undrawn")
def test_results_are_plots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    text = STUDY.read_text(encoding="utf-8")
    Path("study.toml").write_text(text, encoding="utf-8")
    assert call(["run", "study.toml", "-j", "1"]) == 0
    capsys.readouterr()
    assert call(["plot", "study-results", "--kind", "improvement"]) == 0
    assert "S3" in Path("study-results-improvement.svg").read_text(encoding="utf-8")
    assert call(["plot", "study-results", "--kind", "front"]) == 2
    assert "they have improvement" in " ".join(capsys.readouterr().err.split())


def test_the_documentation_is_opened_or_said_where(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert call(["docs"]) == 0
    assert "sphinx-build docs site" in capsys.readouterr().out
    assert call(["docs", str(tmp_path)]) == 2
    assert "has no index.html" in capsys.readouterr().err
    (tmp_path / "index.html").write_text("", encoding="utf-8")
    assert call(["docs", str(tmp_path)]) == 0
    assert opened == [(tmp_path / "index.html").resolve().as_uri()]


def test_without_a_kind_all_kinds_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["plot", str(STUDY)]) == 2
    first, *lines = capsys.readouterr().err.splitlines()
    assert first == "inerter: --kind is missing; kinds of plots:"
    assert [line.split()[0] for line in lines] == list(PLOTS)
    assert all(kind.description in line for kind, line in zip(PLOTS.values(), lines, strict=True))


def test_a_folder_with_the_name_of_a_plot_is_refused_before_any_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.svg").mkdir()
    asked = ["plot", str(EXAMPLES / "quarter-car.toml"), "--kind", "poles", "--index", "J1"]
    assert call([*asked, "-o", str(tmp_path / "a.svg"), "--force"]) == 2
    assert "a.svg: this is a folder. Give the name of a file in it with -o." in capsys.readouterr().err
    assert call([*asked, "-o", str(tmp_path / "none" / "a.svg")]) == 2
    assert "none: folder not found. Create it, or choose another with -o." in capsys.readouterr().err
