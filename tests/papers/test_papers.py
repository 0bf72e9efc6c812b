"""What is true of every paper that can be reproduced, and that nothing else knows one."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest

import inerter
from inerter.cli import papers as command
from inerter.cli.main import call
from inerter.cli.options import WorkOptions
from inerter.errors import StudyError
from inerter.papers.paper import Paper
from inerter.papers.registry import PAPERS
from inerter.statements import exit_code

SOURCES = Path(inerter.__file__).parent
WORK = ("recompute", "write", "data", "text")


@pytest.mark.parametrize("name", PAPERS)
def test_a_row_tells_all_of_a_paper(name: str) -> None:
    paper = PAPERS[name]
    assert paper.name == name
    assert len(set(paper.parts)) == len(paper.parts) > 0
    assert list(paper.claims) == list(range(1, len(paper.claims) + 1))
    assert all(caption.endswith(".") for caption in (*paper.claims.values(), *paper.figures.values()))
    for work in WORK:
        assert callable(resolve_name(getattr(paper, work)))


@pytest.mark.parametrize("name", PAPERS)
def test_nothing_outside_papers_names_one(name: str) -> None:
    known = (name, name.replace("-", "_"))
    sources = [path for path in SOURCES.rglob("*") if path.suffix in (".py", ".html", ".css")]
    outside = [path for path in sources if path.relative_to(SOURCES).parts[0] != "papers"]
    assert len(outside) > 100
    assert [path for path in outside if any(word in path.read_text(encoding="utf-8") for word in known)] == []


@pytest.mark.parametrize("name", PAPERS)
def test_what_shows_results_has_no_word_of_a_paper(name: str) -> None:
    """Elsewhere an author is named as the source of a formula."""
    author = name.partition("-")[0]
    for package in ("cli", "report", "figures", "files", "work"):
        sources = [path for path in (SOURCES / package).rglob("*") if path.suffix in (".py", ".html", ".css")]
        assert sources
        assert [path for path in sources if author in path.read_text(encoding="utf-8").lower()] == []


def test_the_papers_are_listed_where_none_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["reproduce"]) == 0
    told = capsys.readouterr().out
    assert all(len(line) <= 80 for line in told.splitlines())
    words = " ".join(told.split())
    for paper in PAPERS.values():
        assert f"{paper.name} {paper.title} Parts: {', '.join(paper.parts)}." in words


@pytest.mark.parametrize("options", [["--only", "linear"], ["-o", "out"], ["--json"], ["-j", "2"], ["--resume"]])
def test_options_without_a_paper_are_refused(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["reproduce", *options]) == 2
    assert f"expected the name of one: {', '.join(PAPERS)}." in capsys.readouterr().err


@pytest.mark.parametrize("name", PAPERS)
def test_a_part_that_a_paper_does_not_have_is_refused_before_anything_is_written(name: str, tmp_path: Path) -> None:
    parts = PAPERS[name].parts
    words = f"Unknown part 'table 9' of {name}; available: {', '.join(parts)}"
    with pytest.raises(StudyError, match=words):
        PAPERS[name].reproduce(tmp_path / "out", only=(parts[0], "table 9"))
    assert not (tmp_path / "out").exists()


@dataclass(frozen=True)
class Found:
    """What another paper may have: one number, and no study."""

    folder: Path
    given: dict[str, Any]
    studies: dict[str, Any] = field(default_factory=dict)


def recompute(folder: Path, *, finish: Callable[..., object], **given: Any) -> Found:
    folder.mkdir()
    found = Found(folder, given)
    finish(found, folder, None)
    return found


def write(found: Found, folder: Path, pool: None) -> None:
    (folder / "table.csv").write_text("7\n")


def data(found: Found) -> dict[str, Any]:
    return {"table": [{"value": 7, "only": list(found.given["only"]), "jobs": found.given["jobs"]}]}


def text(found: Found) -> str:
    return "seven"


@pytest.mark.parametrize("as_json", [False, True])
def test_another_paper_needs_no_more_than_its_row(
    as_json: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    works = {name: f"{__name__}:{name}" for name in WORK}
    one = Paper("one-2031", "One (2031), A table of one number", ("table",), {}, {"seven": "Seven."}, (), **works)
    monkeypatch.setattr(PAPERS, "_entries", dict(PAPERS))
    PAPERS.add(one)
    folder = tmp_path / "out"
    told = command.reproduce(one.name, ("table",), WorkOptions(folder, jobs=2, json=as_json))
    assert exit_code(told) == 0
    assert (folder / "table.csv").read_text() == "7\n"
    said = capsys.readouterr()
    assert f"report: {folder}" in said.err
    if as_json:
        assert json.loads(said.out) == {"table": [{"value": 7, "only": ["table"], "jobs": 2}]}
    else:
        assert said.out == "seven\n"
    command.papers()
    assert "one-2031\n  One (2031), A table of one number\n  Parts: table.\n  Claims: 0. Figures: 1." in (
        capsys.readouterr().out
    )
