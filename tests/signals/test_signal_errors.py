"""Signals that cannot be: each is refused with the sentence that helps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from wang_su import ROAD

from inerter.errors import SignalError
from inerter.signals.harmonics import cosine, flat_multisine, multisine, sine
from inerter.signals.records import held_noise
from inerter.signals.signal import Signal
from inerter.signals.transients import bump, chirp, step

SINE = sine(1.0, 1.0)
T, V = [0.0, 1.0, 2.0], [0.0, 1.0, 0.0]

WRONG = {
    # harmonics
    "no road": (lambda: multisine(25.0, 0), r"requires a road such as Road\(5e-7, 25\.0\), got 25\.0"),
    "a seed that is a truth": (lambda: multisine(ROAD, True), "seed must be a non-negative integer, got True"),
    "a seed below zero": (lambda: multisine(ROAD, -1), "non-negative integer, got -1"),
    "half a seed": (lambda: held_noise(0.5, 1.0), "non-negative integer, got 0.5"),
    "no seed": (lambda: flat_multisine(None, 1.0, 1.0, 2.0), "got None"),
    "reversed frequencies": (lambda: multisine(ROAD, 0, 10.0, 1.0), "got 10 Hz and 1 Hz. Swap them"),
    "no lowest frequency": (
        lambda: multisine(ROAD, 0, 0.0),
        "lowest frequency of a multisine must be a positive number",
    ),
    "endless frequency": (lambda: multisine(ROAD, 0, 0.1, math.inf), "highest frequency of a multisine .* got inf"),
    "too many harmonics": (lambda: multisine(ROAD, 0, 1e-9, 1e3), r"has 1e\+12 harmonics"),
    "no r.m.s.": (lambda: flat_multisine(0, 0.0, 1.0, 2.0), "r.m.s. value of a multisine must be a positive"),
    "amplitude as text": (lambda: sine("1 mm", 1.0), "amplitude of a sine must be a finite number .* got '1 mm'"),
    "amplitude not a number": (lambda: cosine(math.nan, 1.0), "amplitude of a cosine must be a finite number"),
    "no frequency": (lambda: sine(1.0, 0.0), "frequency of a sine must be a positive number of Hz, got 0.0"),
    "a negative frequency": (lambda: cosine(1.0, -2.0), "frequency of a cosine .* got -2.0"),
    "phase as text": (lambda: sine(1.0, 1.0, "0"), "phase of a sine must be a finite number of rad"),
    "no speed": (lambda: sine(1.0, 1.0, speed=0.0), "speed of a signal must be a positive number of m/s, got 0.0"),
    # noise
    "no power": (lambda: held_noise(0, 0.0), "power of a noise must be a positive number"),
    "half an interval": (lambda: held_noise(0, 1.0, 0.3, 1.0), "A duration of 1 s is not a whole number of intervals"),
    "no interval": (lambda: held_noise(0, 1.0, 0.0), "interval of a noise"),
    "too long a noise": (lambda: held_noise(0, 1.0, 1e-9, 1e3), r"has 1e\+12 intervals"),
    "a noise of less than an interval": (lambda: held_noise(0, 1.0, 1.0, 0.2), "Use an interval such as 0.2 s"),
    # transients
    "reversed chirp": (lambda: chirp(1.0, 5.0, 1.0, 10.0), "got 5 Hz and 1 Hz. Swap them"),
    "no duration": (lambda: chirp(1.0, 1.0, 5.0, 0.0), "duration .* must be a positive number of s"),
    "a chirp as text": (lambda: chirp("1", 1.0, 5.0, 1.0), "amplitude of a chirp must be a finite number"),
    "endless step": (lambda: step(math.inf), "height of a step must be a finite number"),
    "a step never": (lambda: step(1.0, math.nan), "time of a step must be a finite number of s, got nan"),
    "no length": (lambda: bump(0.1, 0.0, 10.0), "length of a bump must be a positive number of m"),
    "a bump at rest": (lambda: bump(0.1, 1.0, 0.0), "speed over a bump must be a positive number of m/s"),
    "a bump as truth": (lambda: bump(True, 1.0, 1.0), "height of a bump must be a finite number .* got True"),
    # tables
    "not a number in the values": (
        lambda: Signal.sampled(T, [0.0, math.nan, 1.0]),
        "values of a table must be finite, but entry 1 is nan",
    ),
    "endless time": (lambda: Signal.sampled([0.0, 1.0, math.inf], V), "times of a table must be finite, but entry 2"),
    "unsorted times": (lambda: Signal.sampled([0.0, 2.0, 1.0], V), "time 2 is 1 s and follows 2 s"),
    "a time twice": (lambda: Signal.sampled([0.0, 1.0, 1.0], V), "time 2 is 1 s and follows 1 s. .*drop repeated"),
    "one sample": (lambda: Signal.sampled([0.0], [1.0]), "at least two samples, got 1"),
    "no samples": (lambda: Signal.sampled([], []), "at least two samples, got 0"),
    "lengths that differ": (lambda: Signal.sampled(T, V[:2]), "got 3 times and 2 values"),
    "complex values": (lambda: Signal.sampled(T, [0j, 1j, 0j]), "must be real numbers, got an array of complex128"),
    "two columns": (lambda: Signal.sampled(T, np.ones((3, 2))), r"one-dimensional array, got one of shape \(3, 2\)"),
    "ragged values": (
        lambda: Signal.sampled(T, [[1.0], [1.0, 2.0]]),
        "values of a table must be real numbers, got a list",
    ),
    "values as text": (lambda: Signal.sampled(T, "abc"), "must be real numbers, got 'abc'"),
    "truths": (lambda: Signal.sampled(T, [True, False, True]), "got an array of bool"),
    "nothing": (lambda: Signal.sampled(None, V), "times of a table must be real numbers, got None"),
    "a number for a table": (lambda: Signal.sampled(1.0, V), r"one-dimensional array, got one of shape \(\)"),
    "a bad hold": (lambda: Signal.sampled(T, V, "quadratic"), 'one of "cubic", "linear" and "zero", got \'quadratic\''),
    "a hold of no kind": (lambda: Signal.sampled(T, V, ["zero"]), "hold must be one of"),
    "slopes of lines": (lambda: Signal.sampled(T, V, "linear", derivative=V), 'Derivatives require hold = "cubic"'),
    "too few slopes": (lambda: Signal.sampled(T, V, derivative=V[:2]), "one derivative for each value, got 2 for 3"),
    "slopes that are none": (
        lambda: Signal.sampled(T, V, derivative=[0, math.inf, 0]),
        "derivatives of a table .*entry 1",
    ),
    "an open period": (
        lambda: Signal.sampled(T, [1.0, 2.0, 3.0], periodic=True),
        "must equal the first, got 1 first and 3 last",
    ),
    "periodic maybe": (lambda: Signal.sampled(T, V, periodic="yes"), "periodic must be True or False, got 'yes'"),
    "a label of no kind": (lambda: Signal.sampled(T, V, label=3), "label must be a text, got 3"),
    "times too close": (lambda: Signal.sampled([0.0, 1e-300, 1.0], [0.0, 1e10, 0.0]), "too close in time"),
    # use
    "complex times": (lambda: SINE(1j), "times of a signal must be real numbers, got 1j"),
    "a time as text": (lambda: SINE.sample("now"), "got 'now'"),
    "a time that is none": (
        lambda: SINE.sample([0.0, math.nan]),
        "times of a signal must be finite, but entry 1 is nan",
    ),
    "a grid at rest": (lambda: SINE.grid(0.0, 0.0, 5), "step of a grid must be a positive number of s"),
    "a grid from nowhere": (lambda: SINE.grid(math.nan, 0.1, 5), "start of a grid must be a finite number"),
    "half a point": (lambda: SINE.grid(0.0, 0.1, 2.5), "count of a grid must be an integer .* got 2.5"),
    "fewer than no points": (lambda: SINE.grid(0.0, 0.1, -1), "count of a grid"),
    "breaks of no span": (lambda: Signal.sampled(T, V).breaks(0.0, math.nan), "end of a span must be a finite number"),
    "countless breaks": (lambda: held_noise(0, 1.0).breaks(0.0, 1e12), "more than 1e8 knots from 0 to"),
    "a number added": (lambda: SINE + 1.0, "can be added to a signal only, got 1.0"),
    "added to a number": (lambda: 1.0 + SINE, "can be added to a signal only"),
    "a product of signals": (lambda: SINE * SINE, "multiplied by a finite number"),
    "times an array": (lambda: np.ones(3) * SINE, "multiplied by a finite number"),
    "times nothing": (lambda: math.nan * SINE, "multiplied by a finite number only, got nan"),
}


@pytest.mark.parametrize(("wrong", "sentence"), WRONG.values(), ids=WRONG.keys())
def test_wrong_input_is_refused_with_a_sentence(wrong, sentence):
    with pytest.raises(SignalError, match=sentence) as caught:
        wrong()
    assert str(caught.value).endswith((".", "..."))
