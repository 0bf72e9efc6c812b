"""A simulation with events and a norm, by each way to compile: the numbers must not depend on it."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout
from itertools import product
from typing import Any

import pytest
from campaigns import sampled

from inerter.kernels import decorators

BEFORE = """
import json
import sys
import inerter as it

k, c, b = it.Spring(120e3), it.Damper(it.free(1e3, 1e4, name="c")), it.Inerter(100.0)
"""
MOTION = """
moved = it.QuarterCar(181.75, 25, 120e3, k | it.Damper(3705.4) | b | it.Friction(100.0))
run = it.simulate(moved, road=it.sine(5e-3, 2.0), duration=0.5, step=1e-3)
events = [(e.time, e.before, e.after) for e in run.events]
print(json.dumps([run.final_state.tolist(), events, "numba" in sys.modules]))
"""
STEPS = """
moved = it.QuarterCar(181.75, 25, 120e3, k | it.Damper(3705.4) | b | it.Friction(100.0))
run = it.simulate(moved, road=it.sine(5e-3, 2.0), duration=0.5, step=1e-3, integrator="time-stepping")
print(json.dumps({name: run[name].tolist() for name in run.outputs}))
"""
NORMS = """
index = {index}
norms = it.evaluate_many(it.QuarterCar(181.75, 25, 120e3, k | c | b), index, {{"c": [2e3, 3e3]}}, it.Norm())
print(json.dumps([norms.tolist(), "numba" in sys.modules]))
"""
SEARCH = """
car = it.QuarterCar(181.75, 25, 120e3, k | it.any_network(2, dampers=(10.0, 1e6), inerters=(0.01, 1e5)))
found = it.search(car, it.RideComfort(it.Road(roughness=5e-7, speed=25)), it.Norm(), starts=1)
print(json.dumps([[[one.layout, one.value] for one in found.ranking], found.failed, "numba" in sys.modules]))
"""


def result(program: str, way: str) -> Any:
    """What a program prints: by the usual way here, by another one in a process of its own."""
    if way == decorators.compiler_mode() == "tuned":
        with redirect_stdout(io.StringIO()) as printed:
            exec(BEFORE + program, {"__name__": "__main__"})
        return json.loads(printed.getvalue())
    environment = {**os.environ, "INERTER_COMPILER": way}
    command = [sys.executable, "-c", BEFORE + program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=1000)
    return json.loads(done.stdout)


# Without what the compiler does not document it takes long.
WAYS = ["none", pytest.param("plain", marks=[pytest.mark.marathon, pytest.mark.timeout(1200)])]


@pytest.mark.parametrize("way", WAYS)
def test_a_motion_does_not_depend_on_how_kernels_are_compiled(way: str) -> None:
    (state, events, _), (other, seen, compiler) = result(MOTION, "tuned"), result(MOTION, way)
    assert len(events) > 4
    assert [event[1:] for event in seen] == [event[1:] for event in events]
    if way == "plain":
        assert (other, seen) == (state, events)
    else:  # products and sums are not fused, so that each is rounded once more
        assert not compiler
        assert other == pytest.approx(state, rel=1e-10)
        assert [event[0] for event in seen] == pytest.approx([event[0] for event in events], rel=1e-12)


@pytest.mark.marathon
def test_steps_are_the_same_without_what_the_compiler_does_not_document() -> None:
    """Of all that is compiled this is the least: the plain way takes long."""
    steps, plain = result(STEPS, "tuned"), result(STEPS, "plain")
    assert steps == plain
    assert all(len(samples) > 400 for samples in steps.values())


RMS, PEAK = "it.RideComfort(it.Road(roughness=5e-7, speed=25))", "it.LoadCarrying()"


@pytest.mark.parametrize(
    ("way", "index"),
    sampled(product(["none", "plain"], [RMS, PEAK]), [("none", RMS)], seldom=[("plain", PEAK), ("plain", RMS)]),
)
def test_norms_do_not_depend_on_how_kernels_are_compiled(way: str, index: str) -> None:
    program = NORMS.format(index=index)
    (norms, _), (other, compiler) = result(program, "tuned"), result(program, way)
    if way == "plain":
        assert other == norms
    else:
        assert not compiler
        assert other[0] + other[1] == pytest.approx(norms[0] + norms[1], rel=1e-12)


def test_a_search_does_not_depend_on_how_kernels_are_compiled() -> None:
    (ranking, failed, _), (other, without, compiler) = result(SEARCH, "tuned"), result(SEARCH, "none")
    assert not compiler
    assert without == failed
    assert [layout for layout, _ in other] == [layout for layout, _ in ranking]
    assert [value for _, value in other] == pytest.approx([value for _, value in ranking], rel=1e-10)


def test_another_way_is_refused() -> None:
    with pytest.raises(subprocess.CalledProcessError) as failure:
        result(NORMS.format(index=RMS), "fast")
    assert "INERTER_COMPILER: unknown mode" in failure.value.stderr
