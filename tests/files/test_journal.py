"""Journals: what was written is read, and nothing else is believed."""

from __future__ import annotations

import json
import random
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from campaigns import sampled
from limits import file_size
from world import STUDY, cheap, files_of, inputs

from inerter.cli.main import call
from inerter.errors import StudyError
from inerter.work import journal as journals
from inerter.work import origin
from inerter.work.journal import Journal, is_intact

ENTRIES = [{"name": f"case {i}", "value": 0.1 * i, "more": {"a": [1, None, "é\u2028"]}} for i in range(6)]


def written(path: Path, entries: list[dict[str, object]], about: str = "this") -> Journal:
    journal = Journal(path, {"study": about})
    with journal.appending() as append:
        append(*entries[:2])
        for entry in entries[2:]:
            append(entry)
    return journal


def test_entries_come_back(tmp_path: Path) -> None:
    journal = written(tmp_path / "j", ENTRIES)
    assert list(journal.read()) == ENTRIES
    assert is_intact(tmp_path / "j")
    assert all(json.loads(line) for line in (tmp_path / "j").read_text().splitlines())


def test_there_is_nothing_in_a_journal_that_is_not_there(tmp_path: Path) -> None:
    assert list(Journal(tmp_path / "j", {}).read()) == []


def test_a_journal_that_goes_on_is_the_same_as_one_in_one_go(tmp_path: Path) -> None:
    one = written(tmp_path / "one", ENTRIES)
    other = written(tmp_path / "other", ENTRIES[:4])
    with other.appending(again=True) as append:
        for entry in ENTRIES[4:]:
            append(entry)
    assert one.path.read_bytes() == other.path.read_bytes()


def test_what_was_cut_short_anywhere_is_whole_lines(tmp_path: Path) -> None:
    journal = written(tmp_path / "j", ENTRIES)
    text = journal.path.read_bytes()
    for size in range(len(text)):
        journal.path.write_bytes(text[:size])
        assert list(journal.read()) == ENTRIES[: max(text[:size].count(b"\n") - 1, 0)]


def test_a_journal_of_other_work_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    journal = written(tmp_path / "j", ENTRIES)
    with pytest.raises(StudyError, match=r'another study or version \(study "this" there, "that" here\)'):
        list(Journal(journal.path, {"study": "that"}).read())
    more = {"study": {"seed": 1, **dict.fromkeys("abcd", 2)}}
    with pytest.raises(
        StudyError, match=r"\(study\.seed not set there, 1 here, .*study\.c not set there, 2 here and 2 more\)"
    ):
        list(Journal(journal.path, more).read())
    monkeypatch.setattr(journals, "origin", lambda: "corrected")
    with pytest.raises(StudyError, match="sources or numerical libraries"):
        list(journal.read())


def test_a_corrected_numeric_makes_other_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any source but those that only show numbers counts, and so do tables and the libraries."""
    root = Path(origin.__file__).parents[1]
    shutil.copytree(root, tmp_path / "inerter", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(origin, "__file__", str(tmp_path / "inerter" / "work" / "origin.py"))
    fresh = origin.origin.__wrapped__
    before = fresh()
    assert before == origin.origin()
    for name, matters in {
        "kernels/h2.py": True,
        "norms/h2.py": True,
        "files/study/cases.py": True,
        "errors.py": True,
        "papers/wang_su_2008/data/table1.csv": True,
        "papers/wang_su_2008/rows.py": True,
        "papers/wang_su_2008/report/text.py": False,
        "report/text.py": False,
        "figures/style.py": False,
        "cli/main.py": False,
    }.items():
        path = tmp_path / "inerter" / name
        text = path.read_bytes()
        path.write_bytes(text.replace(b"1", b"2", 1) if b"1" in text else text + b"\n")
        assert (fresh() != before) == matters, name
        path.write_bytes(text)
    monkeypatch.setattr(origin, "version", lambda name: "0.0.0")
    assert fresh() != before


def altered(lines: list[bytes], draw: random.Random) -> tuple[list[bytes], int]:
    """Lines of which one is not what was written, and its number."""
    at = draw.randrange(len(lines))
    line = lines[at]
    found = list(lines)
    match draw.randrange(9):
        case 0:  # a digit, as a hand that improves a result would change it
            places = [i for i, byte in enumerate(line) if byte in b"0123456789"]
            place = draw.choice(places)
            found[at] = (
                line[:place] + bytes([draw.choice([b for b in b"0123456789" if b != line[place]])]) + line[place + 1 :]
            )
        case 1:
            place = draw.randrange(len(line))
            found[at] = line[:place] + bytes([line[place] ^ (1 << draw.randrange(8))]) + line[place + 1 :]
            if b"\n" in found[at]:
                found[at] = b""
        case 2:
            found.insert(at + 1, line)
            at += 1
        case 3 if at < len(lines) - 1:
            del found[at]
        case 4 if at < len(lines) - 1:
            found[at], found[at + 1] = found[at + 1], line
        case 5:
            found[at] = draw.choice([b"", b"{}", b"[]", b"null", b"1e999", b'"text"', b"\x00" * 40, b"\xff\xfe"])
        case 6:
            found[at] = b"[" * 100_000
        case 7:
            entry = json.loads(line)
            entry[draw.choice(list(entry))] = draw.choice([None, [], {}, "x" * 100, 1e308, True, -1])
            found[at] = json.dumps(entry).encode()
        case _:
            entry = {key: value for key, value in json.loads(line).items() if key != "check"}
            found[at] = json.dumps(entry).encode()
    return found, at + 1


def believed(count: int, seed: int, tmp_path: Path) -> Iterator[str]:
    """What is wrong with how altered journals are read."""
    draw = random.Random(seed)
    original = written(tmp_path / "original", ENTRIES)
    other = written(tmp_path / "other", ENTRIES, "that").path.read_bytes().split(b"\n")[:-1]
    lines = original.path.read_bytes().split(b"\n")[:-1]
    for number in range(count):
        found, at = altered(lines, draw)
        if draw.random() < 0.1:  # a line of another study in the place of one
            at = draw.randrange(2, len(lines) + 1)
            found = [*lines[: at - 1], other[at - 1], *lines[at:]]
        if found == lines:
            continue
        path = tmp_path / "altered"
        path.write_bytes(b"\n".join(found) + b"\n")
        try:
            entries = list(Journal(path, {"study": "this"}).read())
        except StudyError as error:
            if f", line {at}:" not in str(error) and "another study" not in str(error):
                yield f"{number}: {error}"
            if len(str(error)) > 500:
                yield f"{number}: {len(str(error))} characters"
        else:
            yield f"{number}: believed {entries}"
        if is_intact(path) and at > 1:
            yield f"{number}: intact"


def test_an_altered_line_is_told_by_its_number(tmp_path: Path) -> None:
    assert list(believed(300, 0, tmp_path)) == []


@pytest.mark.marathon
def test_no_altered_journal_is_believed(tmp_path: Path) -> None:
    assert list(believed(20_000, 1, tmp_path)) == []


OLD = '{"format": 1, "inerter": "0.1.0", "title": "study", "study": "0123"}\n{"layout": "S1", "index": "J1"}\n'
SPOILT: dict[str, Callable[[bytes], bytes]] = {
    "of an older version": lambda text: OLD.encode(),
    "an altered value": lambda text: text.replace(b'"J1": 4.0', b'"J1": 3.0', 1),
    "a value that is a text": lambda text: text.replace(b'"starts": 0', b'"starts": "0"', 1),
    "depth": lambda text: text + b"[" * 200_000 + b"\n",
    "a line twice": lambda text: text + text.split(b"\n")[-2] + b"\n",
    "no text": lambda text: text + b"\xff\x00\n",
}


@pytest.mark.parametrize("name", sampled(SPOILT, ["of an older version", "an altered value", "no text"]))
def test_a_spoilt_journal_is_one_sentence_and_nothing_is_touched(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    inputs(tmp_path)
    with cheap():
        assert call(["run", "study.toml", "-o", "out", "-j", "1"]) == 0
        path = tmp_path / "out" / "journal.jsonl"
        text = path.read_bytes()
        path.write_bytes(SPOILT[name](text))
        assert path.read_bytes() != text
        before = files_of(tmp_path)
        for option in ("--resume", "--force"):
            capsys.readouterr()
            assert call(["run", "study.toml", "-o", "out", "-j", "1", option]) == 2
            out, err = capsys.readouterr()
            assert out == ""
            assert err.startswith("inerter: ")
            assert err.count("\n") == 1
            assert "journal.jsonl" in err
            assert files_of(tmp_path) == before


def test_resuming_another_study_changes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A refused --resume once rewrote the resolved study and the versions."""
    monkeypatch.chdir(tmp_path)
    inputs(tmp_path)
    with cheap():
        assert call(["run", "study.toml", "-o", "out", "-j", "1"]) == 0
        (tmp_path / "study.toml").write_text(STUDY.replace("250 kg", "260 kg"), encoding="utf-8")
        before = files_of(tmp_path)
        assert call(["run", "study.toml", "-o", "out", "-j", "1", "--resume"]) == 2
        assert "another study" in capsys.readouterr().err
        assert files_of(tmp_path) == before


def test_a_disk_that_is_full_in_the_midst_of_a_line_keeps_the_lines_before(tmp_path: Path) -> None:
    journal = written(tmp_path / "j", ENTRIES[:3])
    size = journal.path.stat().st_size

    def go_on() -> None:
        with journal.appending(again=True) as append, file_size(size + 30):
            append(ENTRIES[3])

    with pytest.raises(OSError, match="large"):
        go_on()
    assert journal.path.stat().st_size == size + 30
    assert list(journal.read()) == ENTRIES[:3]
