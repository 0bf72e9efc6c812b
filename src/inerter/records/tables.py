"""Records from text: CSV, TSV and columns of numbers, with units next to, below or above the names, or in the call."""

from __future__ import annotations

import csv
import io
import math
import os
import re
from codecs import getincrementaldecoder
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import SpooledTemporaryFile
from typing import Any, BinaryIO, cast

import numpy as np
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.headings import is_unit_cell, split_heading, without_brackets
from inerter.units import quote_value

HEAD = 1 << 18  # bytes within which the numbers must begin
BLOCK = 1 << 23  # bytes that are parsed at a time
MISSING = frozenset({"", "nan", "-nan", "+nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-"})
_LONGEST_NAME = 80
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_HEADING = re.compile(r"\s*(\S.*?)\s*[\[(]([^\[\]()]*(?:\([^()]*\)[^\[\]()]*)*)[\])]\s*")
_THOUSANDS = re.compile(
    r"[+-]?\d{1,3}(?:(?:\.\d{3})+,\d*|(?:,\d{3})+\.\d*|(?:['\u2019 \u00a0\u202f]\d{3})+(?:[.,]\d*)?|(?:[.,]\d{3}){2,})"
)
_UTF_16 = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
_THOUSANDS_SAID = "thousands separators. Export numbers without them, such as 1234.5."
_TAIL = 1 << 12  # bytes at the end in which lines of text are looked for
_FEW_ROWS = 20  # that do not show how long a row is
_ABSENT = ";"  # delimiter of a table of one column
_DELIMITERS = ("\t", ";", ",", None)  # None: any white space


@dataclass(frozen=True)
class TableLayout:
    """Format of a table, and the place at which its numbers begin."""

    delimiter: str | None
    decimal: str
    columns: int
    offset: int  # bytes before the first line of numbers
    line: int  # its number, from 1
    encoding: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    shorts: tuple[str, ...]  # names without remarks in brackets
    nameless: bool
    preamble: tuple[str, ...] = ()


@contextmanager
def open_channels(path: str, source: str) -> Iterator[Contents]:
    """The columns of a text file.

    Raises `RecordError`, which names the line, for a file that is not a table of numbers.
    """
    with open(path, "rb") as raw, _as_utf8(raw) as file:
        layout = _layout(source, file.read(HEAD))
        described = zip(layout.names, layout.units, layout.shorts, strict=True)
        channels = tuple(Channel(name, unit, short, key=at) for at, (name, unit, short) in enumerate(described))
        end, notes = _end_of_numbers(file, layout)

        def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
            wanted = [channel.key for channel in chosen]
            return [Samples(values) for values in _columns(source, file, end, layout, wanted, progress)]

        yield Contents(channels, read, notes, {"preamble": layout.preamble} if layout.preamble else {}, layout.nameless)


def _as_utf8(raw: BinaryIO) -> BinaryIO:
    """The file itself, or for one in UTF-16 a copy of it in UTF-8."""
    encoding = _UTF_16.get(raw.read(2))
    raw.seek(0)
    if encoding is None:
        return raw
    raw.seek(2)
    copy = SpooledTemporaryFile(max_size=BLOCK)  # noqa: SIM115 - the caller closes it
    decoder = getincrementaldecoder(encoding)(errors="replace")
    while block := raw.read(BLOCK):
        copy.write(decoder.decode(block).encode())
    copy.seek(0)
    return cast(BinaryIO, copy)


def _end_of_numbers(file: BinaryIO, layout: TableLayout) -> tuple[int, tuple[str, ...]]:
    """End of the numbers [bytes], and notes of what comes after.

    That is last lines without numbers, such as "Ende", and a last row that is cut short, as by a recording that broke
    off: "0.20" of "0.2034" is a number too.
    """
    end = file.seek(0, os.SEEK_END)
    start = max(layout.offset, end - _TAIL)
    file.seek(start)
    lines = file.read().splitlines(keepends=True)
    if start > layout.offset:
        start, lines = start + len(lines[0]), lines[1:]  # the first is cut
    rows = [_cells(line.decode(layout.encoding, errors="replace"), layout.delimiter) for line in lines]
    last = max((at for at, cells in enumerate(rows) if not all(map(_is_text, cells))), default=None)
    left = [] if last is None else [at for at in range(last + 1, len(rows)) if any(rows[at])]
    why = "no numbers"
    if not left and _is_cut_short(lines, rows):
        left, why = [len(lines) - 1], "the file ends within it"
    if not left:
        return end, ()
    said = quote_value(lines[left[0]].decode(layout.encoding, errors="replace").strip())
    which = f"The last line, {said}, was" if len(left) == 1 else f"The last {len(left)} lines, from {said} on, were"
    return start + sum(map(len, lines[: left[0]])), (f"{which} left out: {why}.",)


def _is_cut_short(lines: list[bytes], rows: list[list[str]]) -> bool:
    """Whether the last line has no end, and fewer cells, or a shorter last cell, than every line before it."""
    before = [cells for cells in rows[:-1] if cells]
    if len(before) < _FEW_ROWS or not rows[-1] or lines[-1].endswith((b"\n", b"\r")):
        return False
    return (len(rows[-1]), len(rows[-1][-1])) < min((len(cells), len(cells[-1])) for cells in before)


def _is_text(cell: str) -> bool:
    """Whether a cell is not a sample: empty, or words that do not denote a missing one."""
    return not cell or not (_is_value_or_missing(cell) or re.match(r"[+-]?[.,]?\d", cell))


def _layout(source: str, head: bytes) -> TableLayout:
    start = 3 if head.startswith(b"\xef\xbb\xbf") else 0
    raw = head[start:].splitlines(keepends=True)
    if len(head) == HEAD:
        raw = raw[:-1]  # may be cut short
    if not b"".join(raw).strip() and len(head) < HEAD:
        raise RecordError(f"{source}: empty file; expected a header with names and units, and rows of numbers.")
    lines, encoding = _decode(source, raw)
    for at, line in enumerate(lines):
        delimiters = [delimiter for delimiter in _DELIMITERS if _divides(lines[at : at + 3], delimiter)]
        if delimiters:  # prefer one that leaves only numbers
            delimiter = next((d for d in delimiters if all(map(_is_value_or_missing, _cells(line, d)))), delimiters[0])
            if delimiter == "," and _has_decimal_commas_alone(lines, at):
                delimiter = _ABSENT
            return _read_layout(source, lines, at, delimiter, start + sum(map(len, raw[:at])), encoding)
    for at in range(len(lines)):
        if all(map(_is_number, following := [line.strip() for line in lines[at : at + 3]])) and len(following) == 3:
            return _read_layout(source, lines, at, _ABSENT, start + sum(map(len, raw[:at])), encoding)
    grouped = (cell for line in lines for d in _DELIMITERS for cell in _cells(line, d) if _THOUSANDS.fullmatch(cell))
    if (cell := next(grouped, None)) is not None:
        raise RecordError(f"{source}: the number {quote_value(cell)} has {_THOUSANDS_SAID}")
    first = next((line for line in lines if line.strip()), "with one very long line")
    raise RecordError(
        f"{source}: rows of numbers not found; the file begins {quote_value(first.strip())}. Expected a header such as "
        f"'time [s], displacement [mm], force [N]', of a road 'distance [m], height [mm]', and rows of numbers below."
    )


def _has_decimal_commas_alone(lines: list[str], at: int) -> bool:
    """Whether what looks like two columns divided by a comma is one of numbers with decimal commas.

    Then the heading has one cell, or the second part of a number begins with a zero, or the first is minus zero.
    """
    rows = [line.strip().split(",") for line in lines[at:] if line.strip()]
    if not all(len(cells) == 2 and cells[1].isdecimal() for cells in rows):
        return False
    above = [line.strip() for line in lines[:at] if line.strip()]
    has_one_name = bool(above) and split_heading(above[-1])[1] != "" and len(_cells(above[-1], ",")) == 1
    return has_one_name or any(cells[0] == "-0" or re.fullmatch(r"0\d+", cells[1]) for cells in rows)


def _decode(source: str, raw: list[bytes]) -> tuple[list[str], str]:
    try:
        return [line.decode("utf-8") for line in raw], "utf-8"
    except UnicodeDecodeError:
        lines = [line.decode("latin-1") for line in raw]  # a micro sign of an older program
    text = "".join(lines)
    if sum(not c.isprintable() and not c.isspace() for c in text) > 0.01 * len(text):
        raise RecordError(f"{source} is not text, so it cannot be read as a table. Check its suffix.")
    return lines, "latin-1"


def _cells(line: str, delimiter: str | None) -> list[str]:
    line = line.strip("\r\n")
    if not line.strip() or line.lstrip().startswith(("#", "%")):
        return []
    if delimiter is None:
        return line.split()
    try:
        cells = next(csv.reader([line], delimiter=delimiter))
    except csv.Error:  # a cell beyond all length, a carriage return within the line: for those who look into cells
        cells = line.split(delimiter)
    return [cell.strip() for cell in cells]


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None


def _is_value_or_missing(cell: str) -> bool:
    return _is_number(cell) or cell.casefold() in MISSING


def _divides(lines: list[str], delimiter: str | None) -> bool:
    """Whether these lines look like rows of numbers: as many cells, two numbers or one and the rest missing."""
    columns = len(_cells(lines[0], delimiter))
    rows = [cells for line in lines if (cells := _cells(line, delimiter))]
    return columns >= 2 and all(len(cells) == columns and _is_row(cells) for cells in rows)


def _is_row(cells: list[str]) -> bool:
    numbers = sum(map(_is_number, cells))
    return numbers >= 2 or (numbers == 1 and all(map(_is_value_or_missing, cells)))


def _read_layout(
    source: str, lines: list[str], at: int, delimiter: str | None, offset: int, encoding: str
) -> TableLayout:
    columns = len(_cells(lines[at], delimiter))
    header, above = _header(source, lines[:at], delimiter, columns)
    names, units, shorts = _names(header, columns)
    numbers = [cell for line in lines[at:] for cell in _cells(line, delimiter) if _is_number(cell)]
    decimal = "," if delimiter != "," and any("," in cell for cell in numbers) else "."
    preamble = tuple(line.strip() for line in lines[: at - above][:50] if line.strip())
    return TableLayout(
        delimiter, decimal, columns, offset, at + 1, encoding, names, units, shorts, not header, preamble
    )


def _header(source: str, above: list[str], delimiter: str | None, columns: int) -> tuple[list[list[str]], int]:
    """The rows of names and units directly above the numbers: none, one or two; and how many lines they take."""
    rows: list[list[str]] = []
    for count, line in enumerate(reversed(above), 1):
        comment = line.lstrip().startswith(("#", "%"))
        if not line.strip():
            continue
        text = line.lstrip(" \t#%") if comment else line
        cells = _split_spaced(text) if delimiter is None else _cells(text, delimiter)
        if len(cells) != columns:
            _check_counts(source, len(above) - count + 1, cells, columns, comment, delimiter)
            return rows, count - 1
        if not comment and sum(map(_is_number, cells)) > columns / 2:
            raise _bad_cell(source, len(above) - count + 1, cells)
        rows.insert(0, cells)
        if len(rows) == 2 or comment or (any(map(_HEADING.fullmatch, cells)) and not all(map(is_unit_cell, cells))):
            return rows, count
    return rows, len(above)


def _check_counts(source: str, line: int, cells: list[str], columns: int, comment: bool, delimiter: str | None) -> None:
    headings = [cell for cell in cells if _HEADING.fullmatch(cell)]
    numbers = delimiter == "," and len(cells) >= 2 and all(map(_is_number, cells))
    if not comment and (len(headings) >= 2 or numbers):
        what = "row" if numbers else "header"
        half = (
            " A decimal comma requires a delimiter other than a comma." if numbers or columns == 2 * len(cells) else ""
        )
        raise RecordError(
            f"{source}, line {line}: the {what} has {len(cells)} columns, the rows below have {columns}.{half}"
        )


def _split_spaced(text: str) -> list[str]:
    """Cells between white space; a unit in brackets belongs to the name before it."""
    return re.findall(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?", text)


def _names(header: list[list[str]], columns: int) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """Names, units and short names of the columns.

    A row of units below the names goes before brackets, which are then a part of the name.
    """
    if not header:
        return tuple(f"column {at}" for at in range(columns)), ("",) * columns, ("",) * columns
    first, *second = [[cell[:_LONGEST_NAME] for cell in cells] for cells in header]  # a message may have to show it
    below = [cell.strip("[]() -") for cell in second[0]] if second else [""] * columns
    units_below = bool(second) and all(map(is_unit_cell, second[0])) and any(below)
    described = [
        (cell, unit, without_brackets(cell)) if units_below and unit else split_heading(cell)
        for cell, unit in zip(first, below, strict=True)
    ]
    names, units, shorts = zip(*described, strict=True)
    return names, tuple(a or b for a, b in zip(units, below, strict=True)), shorts


def _columns(
    source: str, file: BinaryIO, end: int, layout: TableLayout, wanted: list[int], progress: Progress
) -> list[NDArray[np.float64]]:
    """The wanted columns, read block by block so that the text is never held as a whole."""
    parts: list[list[NDArray[np.float64]]] = [[] for _ in wanted]
    file.seek(layout.offset)
    line, rest, more = layout.line, b"", True
    while more:
        block = file.read(min(BLOCK, end - file.tell()))
        more = bool(block)
        block = rest + block
        whole = block.rfind(b"\n") + 1 if more else len(block)
        block, rest = block[:whole], block[whole:]
        if block.strip():
            for part, values in zip(parts, _parse(source, block, line, layout, wanted), strict=True):
                part.append(values)
        line += block.count(b"\n")
        progress(min(file.tell() / max(end, 1), 1.0))
    return [np.concatenate(parts.pop(0)) for _ in wanted]


def _parse(source: str, block: bytes, line: int, layout: TableLayout, wanted: list[int]) -> list[NDArray[np.float64]]:
    """The wanted columns of a block of lines; a second, slower reading finds the line of an error."""
    import pandas as pd  # noqa: PLC0415 - heavy

    options: dict[str, Any] = {"sep": layout.delimiter or r"\s+", "decimal": layout.decimal, "comment": "#"}
    if tuple(map(int, pd.__version__.split(".")[:2])) < (3, 1):  # whose default loses the last three digits
        options["float_precision"] = "round_trip"
    try:
        frame = pd.read_csv(
            io.BytesIO(block), header=None, names=list(range(layout.columns)), usecols=wanted, dtype=float,
            skipinitialspace=True, index_col=False, encoding=layout.encoding, na_values=["-"], **options,
        )  # fmt: skip
        columns = [frame[at].to_numpy() for at in wanted]
        clean = all(np.isfinite(values).all() for values in columns) and _has_equal_rows(block, len(frame), layout)
    except (ValueError, TypeError):
        columns, clean = [], False  # pandas' errors do not name the line of the file
    if not clean:
        _find_bad_row(source, block, line, layout, wanted)
    if not columns:
        raise RecordError(f"{source}: the rows after line {line - 1} cannot be read as numbers.")
    return columns


def _has_equal_rows(block: bytes, rows: int, layout: TableLayout) -> bool:
    """Whether there are as many delimiters as rows of equal length have."""
    return layout.delimiter is not None and block.count(layout.delimiter.encode()) == rows * (layout.columns - 1)


def _find_bad_row(source: str, block: bytes, line: int, layout: TableLayout, wanted: list[int]) -> None:
    """Raise `RecordError` for the first row of another length, or cell that is neither a number nor missing."""
    for at, text in enumerate(block.decode(layout.encoding, errors="replace").split("\n"), line):
        cells = _cells(text.split("#")[0], layout.delimiter)
        if not cells:
            continue
        spare = cells[layout.columns :]
        if len(cells) < layout.columns or any(spare):
            raise RecordError(
                f"{source}, line {at}: expected {layout.columns} cells, got {len(cells)} in "
                f"{quote_value(text.strip())}. Remove or complete this line."
            )
        for column in wanted:
            if not _is_value(cells[column], layout.decimal):
                raise _bad_cell(source, at, [cells[column]], layout.decimal)


def _is_value(cell: str, decimal: str) -> bool:
    if cell.casefold() in MISSING:
        return True
    if decimal == ",":
        cell = cell.replace(".", "?").replace(",", ".")
    try:
        return not math.isnan(float(cell))
    except ValueError:
        return False


def _bad_cell(source: str, line: int, cells: list[str], decimal: str = ".") -> RecordError:
    cell = next((cell for cell in cells if not _is_number(cell)), cells[0])
    mark = "comma" if decimal == "," else "point"
    if _THOUSANDS.fullmatch(cell):
        return RecordError(f"{source}, line {line}: {quote_value(cell)} has {_THOUSANDS_SAID}")
    return RecordError(
        f"{source}, line {line}: expected a number with a decimal {mark}, got {quote_value(cell)}. "
        f"Leave the cell empty, or write nan, where a sample is missing."
    )
