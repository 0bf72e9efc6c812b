"""What is written is read back, to rounding."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench import bench
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import inerter as it
from inerter.errors import RecordError
from inerter.records.writers import WRITERS

finite = st.floats(-1e12, 1e12, allow_subnormal=False)


def same(a: it.Record, b: it.Record) -> bool:
    return a.channels().keys() == b.channels().keys() and all(
        np.allclose(values, b.channels()[role], rtol=5e-16, atol=0.0) for role, values in a.channels().items()
    )


@pytest.mark.parametrize("suffix", WRITERS)
def test_every_format_gives_the_same_numbers(tmp_path: Path, suffix: str) -> None:
    record = replace(bench(), velocity=np.arange(500.0), acceleration=np.arange(500.0) ** 2, notes=("One,", "two.\n"))
    path = tmp_path / f"bench{suffix}"
    it.write_record(record, path)
    back = it.read_record(path, force_range=981.0, period=1 / 3)
    assert same(record, back)
    assert (back.source, back.force_range, back.period) == (path.name, 981.0, 1 / 3)


@settings(max_examples=30)
@given(st.data(), st.sampled_from([".csv", ".txt", ".mat"]), st.integers(4, 30))
def test_any_numbers_survive(data: st.DataObject, suffix: str, size: int) -> None:
    columns = [data.draw(arrays(float, size, elements=finite)) for _ in range(2)]
    steps = data.draw(arrays(float, size, elements=st.floats(1e-6, 1e3)))
    record = it.Record(np.cumsum(steps), *columns)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"any{suffix}"
        it.write_record(record, path)
        assert same(record, it.read_record(path))


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    for path, said in (
        (tmp_path / "a.xlsx", "unsupported suffix; supported: .csv"),
        (tmp_path / "no" / "a.csv", "Cannot write"),
    ):
        with pytest.raises(RecordError, match=said):
            it.write_record(bench(), path)
    with pytest.raises(RecordError, match="`record` must be a Record"):
        it.write_record("bench", tmp_path / "a.csv")  # type: ignore[arg-type]
