"""Fields of a record of other types, and channels of sizes that no sensor reads, are refused in one sentence."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import inerter as it
from inerter.cli.main import call
from inerter.errors import IdentificationError, RecordError
from inerter.identification.choice import select_model
from inerter.records.inspection import findings

TIME = np.arange(500) / 250.0
X = 1e-3 * np.cos(9.0 * TIME) + 2e-4 * np.cos(21.0 * TIME)
BENCH = it.Record(TIME, X, -3e4 * X + np.random.default_rng(0).normal(0.0, 0.1, TIME.size), source="bench.csv")
VECTORS = ("time", "displacement", "force", "velocity", "acceleration")
MASKED = np.ma.masked_array(X, mask=X > 1.1e-3)


@pytest.mark.parametrize("wrong", ["abc", 3, [[1, 2], [3]], ["a"] * 500, [None] * 500, {}, X + 1j, X > 0.0, MASKED])
@pytest.mark.parametrize("name", VECTORS)
def test_a_channel_is_a_vector_of_finite_numbers(name: str, wrong: object) -> None:
    given = {**BENCH.channels(), name: wrong}
    said = "samples that are not finite" if wrong is MASKED else "must be a vector of real numbers, got "
    with pytest.raises(RecordError, match=rf"^The {name} of .*{said}"):
        it.Record(**given)


@pytest.mark.parametrize("name", VECTORS[:3])
def test_time_displacement_and_force_are_required(name: str) -> None:
    with pytest.raises(RecordError, match=rf"^The {name} of a record must be a vector of real numbers, got None\.$"):
        it.Record(**{**BENCH.channels(), name: None})


@pytest.mark.parametrize(
    ("name", "wrong", "wanted"),
    [
        *(("source", wrong, "a string") for wrong in (None, 3, ["a"])),
        *(("notes", wrong, "a tuple of strings") for wrong in (None, "Trimmed.", (3,))),
        *(("meta", wrong, "a mapping") for wrong in (None, ["a"])),
        *(("further", wrong, "a mapping of names to vectors") for wrong in (None, X, [("temperature", X)])),
    ],
)
def test_other_fields_are_of_their_types(name: str, wrong: object, wanted: str) -> None:
    with pytest.raises(RecordError, match=rf"^The {name} of a record must be {wanted}, got "):
        replace(BENCH, **{name: wrong})


@pytest.mark.parametrize("wrong", [None, "x", [[1, 2], [3]], X + 1j])
def test_further_channels_are_vectors(wrong: object) -> None:
    with pytest.raises(RecordError, match=r"^The further channel 'temperature' must be a vector of real numbers, got "):
        replace(BENCH, further={"temperature": wrong})


@pytest.mark.parametrize("factor", [1e-299, 1e-20, 1e20, 1e302])
@pytest.mark.parametrize("name", VECTORS)
def test_sizes_that_no_sensor_reads_are_refused_before_a_fit(name: str, factor: float) -> None:
    record = replace(BENCH, velocity=X, acceleration=X)
    record = replace(record, **{name: factor * getattr(record, name)})
    (found,) = findings(record)
    assert (found.kind, found.severity, found.about) == ("extreme", "error", name)
    for fit in (lambda: it.identify(record, "ideal"), lambda: select_model(record, ["ideal"])):
        with pytest.raises(
            IdentificationError, match=rf"^bench.csv: The {name} has values of .*, which no sensor reads"
        ):
            fit()


@pytest.mark.parametrize("factor", [1e-299, 1e302])
def test_the_command_refuses_them_too(factor: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bench.csv"
    it.write_record(replace(BENCH, force=factor * BENCH.force), file)
    assert call(["identify", str(file), "--model", "ideal", "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert [line for line in err.splitlines() if line.startswith("inerter: ")] == err.splitlines()[-1:]
    assert "inerter: bench.csv: The force has values of " in err
    assert not (tmp_path / "out").exists()
