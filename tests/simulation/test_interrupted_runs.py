"""Ctrl-C ends a script soon, as KeyboardInterrupt and nothing else, whatever is being computed."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pytest
from campaigns import sampled
from processes import processor_time

_BEFORE = """
import os, random, signal, sys, threading, time
import numpy as np
import inerter as it
signal.signal(signal.SIGINT, signal.default_int_handler)
stiff = (it.Spring(1e9) | it.Damper(1e4)) - it.Gap(1e-6) - (it.Inerter(0.01) | it.Friction(0.01))
storm, road = it.Rig(stiff), it.Road(5e-7, 25.0)
shaken = it.multisine(road, seed=0, highest=500.0)
car = it.QuarterCar(181.75, 25, 120e3, it.Spring(110e3) | it.Damper(4100) | it.Friction(135))
wave = it.sine(0.01, 1.2)
"""
LONG = {
    "an event storm": "it.simulate(storm, displacement=shaken, duration=50.0, every=10)",
    "its energy": "it.simulate(storm, displacement=shaken, duration=50.0, every=10, energy=True)",
    "its steady state": "it.simulate(storm, displacement=shaken, initial='periodic')",
    "many storms": "it.simulate_many([storm] * 4, displacement=[shaken] * 4, outputs=['device_force'], duration=50.0)",
    "a long march": "it.simulate(car, road=wave, duration=200.0, step=5e-5, every=1000)",
    "time stepping": "it.simulate(car, road=wave, duration=300.0, step=1e-4, every=100, integrator='time-stepping')",
}
_LONG = """
def work():
    {work}
it.simulate(storm, displacement=shaken, duration=0.01, energy=True), it.simulate(car, road=wave, duration=0.01)
it.simulate(car, road=wave, duration=0.01, integrator="time-stepping")
it.simulate_many([storm], displacement=[shaken], outputs=["device_force"], duration=0.01)
print("begun", flush=True)
try:
    while True:
        work()
except KeyboardInterrupt:
    print(time.process_time(), flush=True)
"""
_OFTEN = """
shaft = it.Spring(1e6) | it.Damper(it.free(1e3, 1e4, name="c"))
design, index = it.QuarterCar(181.75, 25, 120e3, it.Spring(120e3) | shaft - it.Inerter(300)), it.RideComfort(road)
points = {{"c": np.linspace(1e3, 1e4, 3)}}
def work():
    {work}
work()
caught, main = [], threading.main_thread().ident
for i in range(200):
    def press():
        time.sleep(random.uniform(0.0, 0.01))
        signal.pthread_kill(main, signal.SIGINT)
    thread = threading.Thread(target=press)
    try:
        thread.start()
        while True:
            work()
    except BaseException as error:
        caught.append(type(error).__name__)
    thread.join()
print(sorted(set(caught)), len(caught))
"""
SHORT = {
    "simulate": "it.simulate(car, road=wave, duration=0.02)",
    "evaluate_many": "it.evaluate_many(design, index, points, it.Norm())",
}


def script(text: str, work: str) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-c", _BEFORE + text.format(work=work)], stdout=subprocess.PIPE, text=True)


@pytest.mark.parametrize("what", sampled(LONG, kept=0))
def test_ctrl_c_ends_long_work_soon(what: str) -> None:
    with script(_LONG, LONG[what]) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.5)
        pressed = processor_time(process.pid)
        process.send_signal(signal.SIGINT)
        ended = float(process.stdout.readline())
    assert ended - pressed < 2.0  # seconds of the processor
    assert process.returncode == 0


@pytest.mark.parametrize("what", sampled(SHORT, kept=1))
def test_ctrl_c_is_a_keyboard_interrupt(what: str) -> None:
    with script(_OFTEN, SHORT[what]) as process:
        output, _ = process.communicate(timeout=240)
    assert output == "['KeyboardInterrupt'] 200\n"
