"""A simulation with events and a norm, by each way to compile: the numbers must not depend on it."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from campaigns import sampled

PROGRAM = """
import json
import sys
import inerter as it

k, c, b = it.Spring(120e3), it.Damper(it.free(1e3, 1e4, name="c")), it.Inerter(100.0)
moved = it.QuarterCar(181.75, 25, 120e3, k | it.Damper(3705.4) | b | it.Friction(100.0))
run = it.simulate(moved, road=it.sine(5e-3, 2.0), duration=0.5, step=1e-3)
index = it.RideComfort(it.Road(roughness=5e-7, speed=25))
norms = it.evaluate_many(it.QuarterCar(181.75, 25, 120e3, k | c | b), index, {"c": [2e3, 3e3]}, it.Norm())
events = [(e.time, e.before, e.after) for e in run.events]
print(json.dumps([run.final_state.tolist(), events, norms.tolist(), "numba" in sys.modules]))
"""


def result(way: str) -> tuple[list[float], list[list[object]], list[list[float]], bool]:
    environment = {**os.environ, "INERTER_COMPILER": way}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True, timeout=280
    )
    state, events, norms, compiler = json.loads(done.stdout)
    return state, events, norms, compiler


@pytest.mark.parametrize("way", sampled(["plain", "none"], ["none"]))
def test_numbers_do_not_depend_on_how_kernels_are_compiled(way: str) -> None:
    (state, events, norms, _), (other, seen, found, compiler) = result("tuned"), result(way)
    assert len(events) > 4
    assert [event[1:] for event in seen] == [event[1:] for event in events]
    if way == "plain":
        assert (other, seen, found) == (state, events, norms)
    else:  # products and sums are not fused, so that each is rounded once more
        assert not compiler
        assert other == pytest.approx(state, rel=1e-10)
        assert [event[0] for event in seen] == pytest.approx([event[0] for event in events], rel=1e-12)
        assert found[0] + found[1] == pytest.approx(norms[0] + norms[1], rel=1e-12)


def test_another_way_is_refused() -> None:
    with pytest.raises(subprocess.CalledProcessError) as failure:
        result("fast")
    assert "INERTER_COMPILER is" in failure.value.stderr
