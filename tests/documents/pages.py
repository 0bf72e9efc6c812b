"""What the README and the pages of docs/ hold: blocks of Python, commands, and the figures that they print."""

from __future__ import annotations

import ast
import io
import json
import re
import tokenize
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from folders import ROOT

PAGES = {path.name: path for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/*.md")))}
NUMBER = re.compile(r"(?<![\w^.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w^]|\.\d)")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    code: str
    line: int
    after: str  # the sentence that follows, if it begins with "prints"


def text_of(page: str) -> str:
    return PAGES[page].read_text(encoding="utf-8")


def blocks(page: str, language: str = "python") -> list[Block]:
    found = []
    text = text_of(page)
    for match in re.finditer(
        rf"^```{language}\n(.*?)^```\n\n?(prints .*?(?:\.\s|\n\n))?", text, re.DOTALL | re.MULTILINE
    ):
        found.append(Block(match[1], text[: match.start()].count("\n") + 2, match[2] or ""))
    return found


def notebook(path: Path) -> list[Block]:
    """The cells of code of a notebook, which must not hold outputs: the site has those of the day."""
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] for cell in cells)
    return [Block("".join(cell["source"]), 1, "") for cell in cells]


def commands() -> dict[str, list[str]]:
    """Each whole command of `inerter` that pages show, and the pages: not those with names for what a user has."""
    found: dict[str, list[str]] = {}
    for page in PAGES:
        text = text_of(page)
        shown = re.findall(r"^    (?:.*&& \.venv/bin/)?(inerter .*)$", text, re.MULTILINE)
        shown += re.findall(r"`(inerter(?: [^`]+)?)`", text)
        for command in shown:
            command = command.partition("  #")[0].strip()
            if re.search(r"\b[A-Z]{3,}\b|\[", command) is None:
                found.setdefault(command, []).append(page)
    return found


def table(page: str, header: str) -> list[list[str]]:
    """The cells of the table with this header, row by row."""
    lines = text_of(page).partition(header + "\n")[2].splitlines()[1:]
    rows = lines[: next(i for i, line in enumerate(lines) if not line.startswith("|"))]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def printed(page: str, command: str) -> str:
    """The block that a page shows as what a command prints; empty if there is none."""
    after = text_of(page).partition(f"    {command}\n")[2]
    match = re.match(r"\nprints\n\n((?:(?:    .*)?\n)+?)(?=\S)", after)
    return "" if match is None else re.sub(r"^    ", "", match[1], flags=re.MULTILINE).strip("\n")


def assert_printed(out: str, page: str, command: str) -> None:
    """What a command prints is what the page shows, if it shows anything: numbers to two units of their last digits."""
    shown = printed(page, command)
    if shown:
        assert NUMBER.sub("#", out.strip("\n")) == NUMBER.sub("#", shown)
        for found, expected in zip(NUMBER.findall(out), NUMBER.findall(shown), strict=True):
            assert rounds_to(float(found), expected, 2.0), f"{page}: {expected}, now {found}"


def run(block: Block, page: str, namespace: dict[str, Any]) -> None:
    """Run a block, and compare what its comments and the sentence below say with what it gives."""
    said = comments(block.code)
    everything = ""
    for statement in ast.parse(block.code).body:
        place, out = f"{page}:{block.line + statement.lineno - 1}", io.StringIO()
        expected = said.get(statement.end_lineno or 0, "")
        ast.increment_lineno(statement, block.line - 1)
        with redirect_stdout(out):
            if isinstance(statement, ast.Expr):
                value = eval(compile(ast.Expression(statement.value), place, "eval", dont_inherit=True), namespace)
                figures = [*numbers_in(value), *map(float, NUMBER.findall(out.getvalue()))]
                assert_figures(expected, figures, place)
            else:
                exec(compile(ast.Module([statement], []), place, "exec", dont_inherit=True), namespace)
        if out.getvalue().count("\n") == 1 and expected and re.search("[a-z]{2}", out.getvalue()):
            assert expected.startswith(out.getvalue().strip()), place
        everything += out.getvalue()
    assert_figures(block.after, [float(n) for n in NUMBER.findall(everything)], f"{page}: below line {block.line}")


def comments(code: str) -> dict[int, str]:
    """The comment at the end of each line of code that has one."""
    tokens = list(tokenize.generate_tokens(io.StringIO(code).readline))
    return {t.start[0]: t.string.removeprefix("#").strip() for t in tokens if t.type == tokenize.COMMENT}


def assert_figures(text: str, figures: list[float], place: str) -> None:
    """Every number of a text is one of these figures, rounded as it is."""
    for number in NUMBER.findall(text):
        assert any(rounds_to(figure, number) for figure in figures), f"{place}: {number} is none of {figures}"


def rounds_to(figure: float, number: str, units: float = 0.5) -> bool:
    """Whether a figure is a printed number, to so many units of its last digit."""
    mantissa, _, power = number.partition("e")
    digit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
    return bool(abs(figure - float(number)) <= units * digit * (1.0 + 1e-9))


def numbers_in(value: Any) -> Iterator[float]:
    """All numbers that a value holds."""
    if isinstance(value, bool | str | bytes) or value is None:
        return
    if isinstance(value, int | float | np.number):
        yield float(value)
    elif isinstance(value, Mapping):
        yield from numbers_in(list(value.values()))
    elif isinstance(value, list | tuple):
        for part in value:
            yield from numbers_in(part)
    elif is_dataclass(value):
        yield from numbers_in([getattr(value, field.name) for field in fields(value)])
