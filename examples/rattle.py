"""When a ball screw with backlash first knocks, and where the energy goes that shakes it."""

from math import acos, pi, sin

import inerter as it

amplitude, frequency, play, inertance = 1e-3, 3.0, 1e-4, 113.0  # [m], [Hz], half the backlash [m], [kg]
omega = 2 * pi * frequency

shaft = it.Spring(1e6) | it.Damper(3200)
rig = it.Rig(device=shaft - it.Gap(play, "play") - (it.Inerter(inertance, "b") | it.Friction(10, "friction")))
table = it.cosine(amplitude=amplitude, frequency=frequency)
run = it.simulate(rig, displacement=table, duration=2.0, step=1e-4, energy=True)

knock = next(event for event in run.events if event.element == "play")
print(f"first knock: {knock.after} at {1e3 * knock.time:.4f} ms, of {len(run.events)} events in 2 s")
for state in ("open", "upper contact", "lower contact"):
    share = sum(end - begin for begin, end in run.intervals("play", state)) / run.time[-1]
    print(f"  {state:<13}  {100 * share:.1f} % of the time")
print(f"force of the device: {run.rms('force'):.1f} N r.m.s., at most {abs(run['force']).max():.1f} N")
print(f"energy put in: {run.energy.input_work:.4f} J, of which friction took {sum(run.energy.friction.values()):.4f} J")

# The screw rests, held by its friction, until the table has used up the play: amplitude (1 - cos(omega t)) = play.
expected = acos(1 - play / amplitude) / omega
assert abs(knock.time - expected) < 1e-12
assert knock.after == "lower contact"  # the table moves down first
# The shaft's damper then feels the whole speed of the table at once; until the next sample its spring adds a little.
speed = amplitude * omega * sin(omega * expected)
after = run["force"][run.time > knock.time][0]
assert 0.0 <= -after - 3200 * speed < 1e6 * speed * 1e-4
assert run.energy.relative_residual < 1e-10
