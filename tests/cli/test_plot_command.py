"""`inerter plot`: files that are drawn, and one sentence for what cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest

from inerter.cli.main import call

STUDY = Path(__file__).parents[2] / "examples" / "quarter-car.toml"


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
        (["--kind", "bode", "--layout", "S9", "--index", "J1"], "has no layout 'S9'"),
        (["--kind", "bode"], "Choose one with --index"),
        (["--kind", "bode", "-o", "nowhere/a.svg"], "folder not found"),
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
