"""Valid files of every kind with quantities over all magnitudes end in time, in a result or in one sentence."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from extremes import BASES, extreme, what_is_wrong

from inerter.cli.main import call
from inerter.methods.error_bounds import ErrorSource, with_error_sources
from inerter.methods.method import Estimate

LIMIT = 20.0  # s of a processor
CHEAP = [6, 16]  # of the first round of bases, none of which takes a search


@pytest.mark.parametrize("seed", sampled(range(300), CHEAP, [0], often=[151], kept=0))
def test_a_valid_extreme_ends_in_time(tmp_path: Path, capsys: pytest.CaptureFixture[str], seed: int) -> None:
    case = extreme(seed)
    path, output = tmp_path / "case.toml", tmp_path / ("case.csv" if case.command == "rig" else "results")
    path.write_text(case.text, encoding="utf-8")
    if call(["check", str(path)]) == 2:
        assert len(capsys.readouterr().err.splitlines()) <= 4  # a line for each layout
        return
    capsys.readouterr()
    begun = time.process_time()
    more = ["-j", "1"] if case.command == "run" else []
    code = call([case.command, str(path), "-o", str(output), *more])
    found = capsys.readouterr()
    assert what_is_wrong(code, found.out, found.err, time.process_time() - begun, LIMIT) == [], case.text


def test_bases_are_valid_and_their_quantities_are_changed() -> None:
    """The generator changes what it means to: bounds stay in order, motions keep a whole number of steps."""
    for seed, name in enumerate(BASES):
        case = extreme(seed)
        assert case.base == name
        assert case.command == BASES[name][0]
        for low, high in re.findall(r'from = "([\d.e+-]+) [^"]+", to = "([\d.e+-]+) ', case.text):
            assert 0.0 < float(low) < float(high)
        steps = [float(v) for v in re.findall(r'^(?:duration|step) = "([\d.e+-]+) ', case.text, re.MULTILINE)]
        if case.command == "simulate" and len(steps) == 2:
            scale = 1e3 if 'ms"' in case.text else 1.0
            assert max(steps) * scale / min(steps) == pytest.approx(round(max(steps) * scale / min(steps)), rel=1e-9)
    changed = [extreme(seed).text for seed in range(0, 34, len(BASES))]
    assert len({*changed}) == len(changed)


def test_an_error_that_nobody_knows_is_no_number() -> None:
    """A bound that is nan was told as "off by nan of itself"."""
    estimate = Estimate(1.0, "m/s^2")
    found = with_error_sources(estimate, (ErrorSource("time step", math.nan), ErrorSource("lines", 1e-4)), 0.01)
    assert not found.status.ok
    assert found.status.message == "unknown error from time step"
    assert np.isnan(sum(source.bound for source in found.error_sources))
