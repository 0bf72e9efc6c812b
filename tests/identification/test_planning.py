"""The motion that halves an interval: promises in closed form, and kept by the records that are made as advised."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from troubled_records import clean, model_of, record_of

import inerter as it
from inerter.identification.conclusions import fit_of
from inerter.identification.identify import solution_of
from inerter.identification.options import FitOptions
from inerter.identification.planning import _possible_motions

IDEAL = it.Inerter(it.free(1.0, 500.0, name="b"))


def solved(force_range: float | None = 981.0):  # type: ignore[no-untyped-def]
    """An inertance alone under a cosine, read by a load cell that is worse than the encoder."""
    rig = it.VirtualRig(it.Inerter(50.0), seed=2, force_noise=0.5, encoder_noise=1e-8, encoder_resolution=0.0)
    record = replace(rig.run(it.cosine(2e-3, 2.0), duration=2.0), force_range=force_range)
    return solution_of(record, IDEAL, FitOptions(starts=8), None)


@pytest.mark.campaign
def test_an_inertance_is_known_better_by_its_acceleration() -> None:
    """White noise of the cell: the standard error of log b goes as one over the acceleration, and over root length."""
    solution = solved()
    motions = {(m.larger, m.faster): float(m.errors[0]) for m in _possible_motions(solution)}
    for (larger, faster), error in motions.items():
        assert error / motions[1.0, 1.0] == pytest.approx(1.0 / (larger * faster**2), rel=0.15), (larger, faster)
    assert {(2.0, 1.0), (4.0, 1.0), (1.0, 2.0), (1.0, 0.5)} <= set(motions)


@pytest.mark.parametrize("limit", sampled([981.0, 60.0], [60.0]))
def test_what_is_advised_is_the_mildest_that_halves_and_that_the_cell_bears(limit: float) -> None:
    """16 N now: with 60 N to read, twice the amplitude is borne, and twice the frequency is not."""
    fit = fit_of(solved(limit))
    (advised,) = [f for f in fit.suggestions if f.kind == "narrower"]
    n = advised.numbers
    assert n["expected"] <= 0.4 * n["width"] * 1.01
    assert 16.0 * n["larger"] * n["faster"] ** 2 <= 0.8 * limit * 1.1
    assert n["longer"] * n["larger"] * n["faster"] <= 4.0
    (sentence,) = fit.next_experiment
    assert sentence.startswith("b: the same motion, ")
    assert "instead of" in sentence


def kept(number: int) -> list[tuple[str, float, float, float]]:
    """Widths now, promised and of a record that is made as advised, by a simulator of its own."""
    case = replace(clean(number, 31)[0], duration=1.5)
    fit, rows = it.identify(record_of(case, number), model_of(case), starts=8), []
    for advised in [f for f in fit.suggestions if f.kind == "narrower"]:
        n, motion = advised.numbers, case.motion
        moved = replace(
            motion,
            amplitudes=tuple(n["larger"] * a for a in motion.amplitudes),
            frequencies=tuple(n["faster"] * f for f in motion.frequencies),
            ramp=motion.ramp / n["faster"],
        )
        again = replace(case, motion=moved, duration=n["longer"] * case.duration)
        p = it.identify(record_of(again, number + 1000), model_of(case), starts=8).parameters[advised.about]
        rows.append((advised.about, n["width"], n["expected"], p.interval[1] - p.interval[0]))
    return rows


@pytest.mark.parametrize("number", sampled(range(12), kept=0))
def test_promises_are_kept(number: int) -> None:
    for name, before, promised, after in kept(number):
        assert after <= 0.5 * before * 1.2, name
        assert 0.5 <= after / promised <= 2.0, name


@pytest.mark.marathon
@pytest.mark.timeout(3600)
def test_nearly_all_promises_are_kept() -> None:
    rows = [row for number in range(20) for row in kept(number)]
    halved = np.array([after <= 0.5 * before for _, before, _, after in rows])
    near = np.array([1 / 1.5 <= after / promised <= 1.5 for _, _, promised, after in rows])
    assert np.mean(halved) > 0.9
    assert np.mean(near) > 0.9
