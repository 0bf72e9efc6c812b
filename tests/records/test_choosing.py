"""A channel without an obvious name is proposed by its unit, wherever it stands."""

from __future__ import annotations

import re
from itertools import permutations
from pathlib import Path

import pytest
from bench import bench, write_csv

import inerter as it
from inerter.errors import RecordError

SPANISH = {"Tiempo": "s", "Recorrido": "mm", "Fuerza": "N"}
ROLES = {"time": "Tiempo", "displacement": "Recorrido", "force": "Fuerza"}


@pytest.mark.parametrize("order", list(permutations(SPANISH)))
def test_following_the_hints_reads_the_file(order: tuple[str, ...], tmp_path: Path) -> None:
    record = bench(100)
    columns = {"Tiempo": record.time, "Recorrido": 1e3 * record.displacement, "Fuerza": record.force}
    header = [f"{name} [{SPANISH[name]}]" for name in order]
    path = write_csv(tmp_path / "bench.csv", [header], [columns[name] for name in order])
    named: dict[str, str] = {}
    for _ in ROLES:
        with pytest.raises(RecordError) as refused:
            it.read_record(path, **named)  # type: ignore[arg-type]
        found = re.search(r"(time|displacement|force)='(\w+)'", str(refused.value))
        assert found is not None
        named[found[1]] = found[2]
    assert named == ROLES
    assert it.read_record(path, **named).displacement == pytest.approx(record.displacement)  # type: ignore[arg-type]


def test_without_units_no_channel_is_proposed(tmp_path: Path) -> None:
    record = bench(100)
    path = write_csv(
        tmp_path / "a.csv", [["Tiempo", "Recorrido", "Fuerza"]], [record.time, record.displacement, record.force]
    )
    with pytest.raises(RecordError, match=r"available: Tiempo .*Name it: displacement='name'\."):
        it.read_record(path)


def test_an_argument_that_there_is_not_is_refused_with_the_one_that_is_near(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"no argument 'forse'.* Did you mean 'force'"):
        it.read_record(tmp_path / "bench.csv", forse="Load")  # type: ignore[call-arg]
