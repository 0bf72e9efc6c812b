"""Tables with cells that no instrument writes: a record, or one error of a readable length."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest

import inerter as it
from inerter.errors import RecordError

ODD: dict[str, Callable[[random.Random], str]] = {
    "many digits": lambda draw: "1" * draw.choice([400, 140_000]),
    "a long name": lambda draw: "x" * draw.choice([400, 140_000]),
    "a quote that does not end": lambda draw: '"' + "1" * draw.choice([1, 140_000]),
    "a carriage return": lambda draw: draw.choice(["\r", "1\r2", "\r1", "1\r"]),
    "a null": lambda draw: draw.choice(["\0", "1\0"]),
    "a control character": lambda draw: chr(draw.choice([1, 7, 11, 12, 28, 133, 8232])),
    "an exponent": lambda draw: draw.choice(["1e400", "1e-400", "1e99999999999", "-1e151", "0x10", "1_000", "٣"]),
    "nothing": lambda draw: "",
}


def test_a_unit_that_no_reading_can_be_multiplied_by_is_named(tmp_path: Path) -> None:
    """Readings that are then infinite are not missing: no gaps can be filled."""
    table = tmp_path / "bench.csv"
    table.write_text("time [s],displacement [mm],force\n" + "".join(f"{i / 100},{i % 7},{i % 9}\n" for i in range(40)))
    with pytest.raises(RecordError, match=r"^bench.csv: 'force' has values .* multiplied by 1e\+308.* unit"):
        it.read_record(table, units={"force": "1e308 N"})


def odd_table(draw: random.Random) -> str:
    """A record of 40 samples in which one cell to three are odd."""
    delimiter, end = draw.choice([",", ";", "\t"]), draw.choice(["\n", "\r\n", "\n", "\r"])
    rows = [["time [s]", "displacement [mm]", "force [N]"]]
    rows += [[f"{i / 100}", f"{draw.uniform(-1, 1):.4f}", f"{draw.uniform(-9, 9):.4f}"] for i in range(40)]
    for _ in range(draw.randint(1, 3)):
        row = draw.choice(rows[: draw.choice([1, 41])])
        row[draw.randrange(3)] = ODD[draw.choice(list(ODD))](draw)
    return end.join(delimiter.join(row) for row in rows)


def what_goes_wrong(seeds: range, folder: Path) -> list[str]:
    found = []
    path = folder / "a.csv"
    for seed in seeds:
        path.write_text(odd_table(random.Random(seed)), encoding="utf-8", newline="")
        try:
            it.read_record(path)
        except RecordError as error:
            if len(str(error)) > 1500:
                found.append(f"{seed}: {len(str(error))} characters, {str(error)[:120]}...{str(error)[-120:]}")
        except Exception as error:
            found.append(f"{seed}: {error!r}"[:300])
    return found


def test_odd_cells_are_a_record_or_a_sentence(tmp_path: Path) -> None:
    assert what_goes_wrong(range(60), tmp_path) == []


@pytest.mark.marathon
def test_many_odd_cells_are_a_record_or_a_sentence(tmp_path: Path) -> None:
    assert what_goes_wrong(range(1000, 4000), tmp_path) == []
