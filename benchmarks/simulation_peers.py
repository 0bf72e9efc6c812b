"""Reference solutions for the event-driven simulation: a quarter car with Coulomb friction, by other solvers.

    python benchmarks/simulation_peers.py [seconds]

Needs the extra "bench" (scikit-sundae). Nothing here uses `inerter`: the equations are written out by hand, so that
trajectories can be compared as well as times. Problem A has the friction beside everything else in the strut, problem
B in series with an elastic shaft and a damper.

Every peer gets a table of displacement and slope, between which the road is a cubic Hermite, and returns the state at
every time of the table (or every `stride`-th). A peer runs in one mode (slip down, stick, slip up) until its root
finder meets the end of that mode, and is started again in the next. Times are the shortest of some repeats,
compilation left out. The reference is the exact flow for the same table, so an error holds nothing of the table's own.

The road's velocity has a kink at every time of the table, which costs a variable step dear and deceives its error
estimate. Each peer is therefore given what suits it best: DOP853 steps that end at the kinks, CVODE a table so fine
that the kinks no longer matter.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq
from sksundae.cvode import CVODE
from threadpoolctl import threadpool_limits

SPRUNG, UNSPRUNG, TYRE, SPRING = 181.75, 25.0, 120e3, 120e3  # [kg] [kg] [N/m] [N/m]
FRICTION = 10.0  # [N]
SLIP_DOWN, STICK, SLIP_UP = -1.0, 0.0, 1.0
Array = np.ndarray


# --- The equations. Velocities and elongations are the states, the road's velocity w is the input; forces are tensions.


@njit(error_model="numpy")
def rates_a(x: Array, w: float, mode: float, dx: Array) -> None:
    """S2. States: body velocity, velocity over the strut, elongations of tyre and spring."""
    c, b = 3705.4, 128.57
    v, tyre, spring = x[1], TYRE * x[2], SPRING * x[3]
    if mode == STICK:
        dx[0] = -tyre / (SPRUNG + UNSPRUNG)
        dx[1] = 0.0
    else:
        mobility = 1.0 / SPRUNG + 1.0 / UNSPRUNG
        without_inerter = spring + c * v + mode * FRICTION
        dx[1] = (tyre / UNSPRUNG - mobility * without_inerter) / (1.0 + mobility * b)
        dx[0] = -(without_inerter + b * dx[1]) / SPRUNG
    dx[2] = x[0] - v - w
    dx[3] = v


@njit(error_model="numpy")
def stick_force_a(x: Array) -> float:
    """The friction force that keeps body and wheel together: what accelerates the body as both, less the spring."""
    return TYRE * x[2] * SPRUNG / (SPRUNG + UNSPRUNG) - SPRING * x[3]


@njit(error_model="numpy")
def chain_force_b(x: Array) -> tuple[float, float]:
    """Force in the chain damper - shaft - inerter, and the velocity of the massless node between damper and shaft."""
    c, ks, cs = 7353.0, 1e6, 3200.0
    node = (c * x[0] + cs * (x[1] + x[2]) - ks * x[5]) / (c + cs)
    return c * (x[0] - node), node


@njit(error_model="numpy")
def rates_b(x: Array, w: float, mode: float, dx: Array) -> None:
    """S3 with a real inerter. States: velocities of body, inerter and wheel; elongations of tyre, k and ks.

    The inerter's velocity is that of its upper end less that of the wheel.
    """
    b = 328.72
    force, node = chain_force_b(x)
    tyre, spring = TYRE * x[3], SPRING * x[4]
    dx[0] = -(spring + force) / SPRUNG
    dx[1] = 0.0 if mode == STICK else (force - mode * FRICTION) / b
    dx[2] = (spring + force - tyre) / UNSPRUNG
    dx[3] = x[2] - w
    dx[4] = x[0] - x[2]
    dx[5] = node - (x[1] + x[2])


@njit(error_model="numpy")
def stick_force_b(x: Array) -> float:
    """While the inerter is stuck the friction carries the whole chain."""
    return chain_force_b(x)[0]


@dataclass(frozen=True)
class Problem:
    """A quarter car with one friction. State 0 is the body's velocity, state 1 the velocity over the friction."""

    name: str
    rates: Callable[[Array, float, float, Array], None]  # (x, w, mode, dx): fills dx
    stick_force: Callable[[Array], float]
    scale: tuple[float, ...]  # usual size of each state; absolute tolerances are this times the relative one

    @property
    def size(self) -> int:
        return len(self.scale)


PROBLEMS = {
    "A": Problem("A", rates_a, stick_force_a, (0.1, 0.1, 1e-3, 1e-3)),
    "B": Problem("B", rates_b, stick_force_b, (0.1, 0.1, 0.1, 1e-3, 1e-3, 1e-4)),
}


# --- The road.


@dataclass(frozen=True, eq=False)
class RoadTable:
    """Road displacement [m] and velocity [m/s] at times 0, step, 2 step, ...; between them a cubic Hermite."""

    step: float
    displacement: Array
    velocity: Array
    stride: int = 1  # results are wanted at every so many times of the table

    @property
    def intervals(self) -> int:
        return len(self.displacement) - 1

    @property
    def duration(self) -> float:
        return self.intervals * self.step

    @cached_property
    def times(self) -> Array:
        """Where results are wanted."""
        return self.step * np.arange(0, self.intervals + 1, self.stride)

    def until(self, duration: float) -> RoadTable:
        count = round(duration / self.step) + 1
        return replace(self, displacement=self.displacement[:count], velocity=self.velocity[:count])

    @cached_property
    def quadratics(self) -> Array:
        """Velocity in interval i at s = t / step - i, 0 to 1: q[i, 0] + q[i, 1] s + q[i, 2] s^2."""
        rise = np.diff(self.displacement) / self.step
        left, right = self.velocity[:-1], self.velocity[1:]
        return np.column_stack([left, 6 * rise - 4 * left - 2 * right, 3 * (left + right) - 6 * rise])


def road_table(step: float, duration: float, seed: int = 0, stride: int = 1) -> RoadTable:
    """The multisine of Wang and Su (2008), eq. (17), 0.1 to 1000 Hz, for kappa = 5e-7 m^3/cycle and V = 25 m/s.

    The period of 10 s must be a whole number of steps. The phases are `default_rng(seed).uniform(0, 2 pi, 10000)`.
    """
    period, harmonics = round(10.0 / step), np.arange(1, 10_001)
    if not np.isclose(period * step, 10.0):
        raise ValueError(f"The step must divide the period of 10 s, got {step} s. Try 2e-4.")
    omega = 0.2 * np.pi * harmonics
    amplitude = np.sqrt(8.0 * np.pi * 5e-7 * 25.0 * 0.2 * np.pi) / omega
    phasors = amplitude * np.exp(1j * np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(harmonics)))
    spectra = np.zeros((2, period), dtype=complex)
    np.add.at(spectra, (slice(None), harmonics % period), np.array([phasors, 1j * omega * phasors]))
    samples = np.arange(round(duration / step) + 1) % period
    displacement, velocity = (period * np.fft.ifft(spectra).real)[:, samples]
    return RoadTable(step, displacement, velocity, stride)


# --- What comes out.


@dataclass(frozen=True)
class Run:
    """One peer on one problem. `error`: relative L2 error of the body's acceleration at the times of the results."""

    peer: str
    problem: str
    step: float  # of the table [s]
    tolerance: float
    seconds_per_second: float  # computing time per simulated second
    error: float
    events: int
    evaluations: int  # of the right-hand side


@dataclass(frozen=True)
class Path:
    """States at the times of the results with the mode each belongs to, and the events as (time, mode after it)."""

    states: Array = field(repr=False)
    modes: Array = field(repr=False)
    events: tuple[tuple[float, float], ...] = field(repr=False)
    evaluations: int = 0


@dataclass(frozen=True)
class Reference:
    times: Array = field(repr=False)
    acceleration: Array = field(repr=False)  # of the body [m/s^2]
    path: Path = field(repr=False)

    @property
    def events(self) -> int:
        return len(self.path.events)


@dataclass(frozen=True)
class Loop:
    states: int
    inputs: int
    seconds_per_step: float


def body_acceleration(problem: Problem, path: Path) -> Array:
    """A row of the equations, so linear in the state but for the friction force."""
    stuck = affine(problem, STICK)[0]
    slipping, _, friction = affine(problem, SLIP_UP)
    return np.where(path.modes == STICK, path.states @ stuck[0], path.states @ slipping[0] + friction[0] * path.modes)


def relative_error(found: Array, expected: Array) -> float:
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def mode_after(problem: Problem, mode: float, x: Array) -> float:
    """The mode that follows an event; a friction that stops slipping sticks if the force to hold it is small enough."""
    force = problem.stick_force(x)
    if mode != STICK and abs(force) <= FRICTION:
        return STICK
    return SLIP_UP if force > 0.0 else SLIP_DOWN


# --- The reference: the exact flow of each mode.


def affine(problem: Problem, mode: float) -> tuple[Array, Array, Array]:
    """A, b, c of x' = A x + b w + c in this mode, read off the equations column by column."""

    def rates(x: Array, w: float) -> Array:
        dx = np.empty(problem.size)
        problem.rates(x, w, mode, dx)
        return dx

    zero = np.zeros(problem.size)
    c = rates(zero, 0.0)
    A = np.column_stack([rates(unit, 0.0) - c for unit in np.eye(problem.size)])
    return A, rates(zero, 1.0) - c, c


@dataclass(frozen=True)
class Flow:
    """One mode over one interval of the table, as a power series in s = t / step that is summed to rounding.

    The state is extended by the road's velocity, its first and second derivative in s, and 1: then the flow is linear.
    """

    series: Array  # (terms, n + 4, n + 4): M^k / k!
    over_interval: Array  # expm(M)
    guards: Array  # rows; the mode ends where one of them falls through zero
    scan: Array  # (points, terms): powers of s where the guards are looked at


def flow(problem: Problem, mode: float, step: float, points: int, terms: int = 24) -> Flow:
    n = problem.size
    A, b, c = affine(problem, mode)
    M = np.zeros((n + 4, n + 4))
    M[:n, :n], M[:n, n], M[:n, n + 3] = A * step, b * step, c * step
    M[n, n + 1] = M[n + 1, n + 2] = 1.0
    series = [np.eye(n + 4)]
    for k in range(1, terms):
        series.append(M @ series[-1] / k)
    velocity, limit, force = np.zeros((3, n + 4))
    velocity[1], limit[n + 3] = 1.0, FRICTION
    force[:n] = [problem.stick_force(unit) for unit in np.eye(n)]
    guards = np.array([limit - force, limit + force] if mode == STICK else [mode * velocity])
    scan = np.linspace(0.0, 1.0, points + 1)[1:, None] ** np.arange(terms)
    return Flow(np.array(series), expm(M), guards, scan)


def first_root(powers: Array, scan: Array) -> float | None:
    """Where, in (0, 1], a polynomial that is positive at 0+ first turns negative; None if it does not."""
    negative = np.flatnonzero(scan @ powers < 0.0)
    if len(negative) == 0:
        return None
    i = negative[0]
    return brentq(np.polynomial.Polynomial(powers), scan[i - 1, 1] if i else 0.0, scan[i, 1], xtol=1e-16, rtol=1e-15)


def mode_end(mode: Flow, z: Array, zeros: int, rest: float) -> float | None:
    """When, in (0, rest], this mode ends. The guard starts with a zero of order `zeros`, divided out here."""
    powers = (mode.series @ z) * (rest ** np.arange(len(mode.series)))[:, None]
    guards = (powers @ mode.guards.T)[zeros:]
    roots = [first_root(guard, mode.scan[:, : len(guard)]) for guard in guards.T]
    found = [root for root in roots if root is not None]
    return min(found) * rest if found else None


def exact_path(problem: Problem, table: RoadTable, points: int = 16) -> Path:
    """From rest, event by event. The guards are looked at `points` times an interval of the table."""
    n, h = problem.size, table.step
    flows = {mode: flow(problem, mode, h, points) for mode in (SLIP_DOWN, STICK, SLIP_UP)}
    states, modes = np.zeros((table.intervals + 1, n)), np.zeros(table.intervals + 1)
    events: list[tuple[float, float]] = []
    mode, zeros = STICK, 0
    z = np.zeros(n + 4)
    z[n + 3] = 1.0
    for i, (q0, q1, q2) in enumerate(table.quadratics):
        z[n : n + 3] = q0, q1, 2.0 * q2
        s = 0.0
        while (end := mode_end(flows[mode], z, zeros, 1.0 - s)) is not None:
            z = np.polynomial.polynomial.polyval(end, flows[mode].series @ z)
            z[1] = 0.0
            s += end
            was, mode = mode, mode_after(problem, mode, z[:n])
            # Slip starts from v = 0, and from v' = 0 too where the friction was at its limit.
            zeros = 0 if mode == STICK else 2 if was == STICK else 1
            events.append(((i + s) * h, mode))
        if s == 0.0:
            z = flows[mode].over_interval @ z
        else:
            z = np.polynomial.polynomial.polyval(1.0 - s, flows[mode].series @ z)
        zeros = 0
        states[i + 1], modes[i + 1] = z[:n], mode
    return Path(states[:: table.stride], modes[:: table.stride], tuple(events))


def reference(problem: Problem, table: RoadTable, points: int = 16) -> Reference:
    """Exact but for rounding: see `disagreement` for a check against another method."""
    path = exact_path(problem, table, points)
    return Reference(table.times, body_acceleration(problem, path), path)


def disagreement(problem: Problem, table: RoadTable) -> float:
    """How far the reference is from DOP853 stepping from kink to kink, and from itself with a closer look at guards.

    The larger of two relative L2 differences of the body's acceleration.
    """
    expected = reference(problem, table)
    others = dop853_path(problem, table, 1e-7, stop_at_kinks=True), exact_path(problem, table, points=128)
    return max(relative_error(body_acceleration(problem, path), expected.acceleration) for path in others)


# --- The peers' right-hand sides. One float array carries all they need, because each argument of a compiled function
# --- costs time when Python calls it: mode, 1 / step, last interval, then the quadratics of the road's velocity.


def pack(table: RoadTable) -> Array:
    return np.concatenate([[STICK, 1.0 / table.step, table.intervals - 1.0], table.quadratics.ravel()])


@njit(error_model="numpy")
def road_velocity(t: float, data: Array) -> float:
    position = t * data[1]
    i = int(min(max(position, 0.0), data[2]))
    s = position - i
    return data[3 * i + 3] + s * (data[3 * i + 4] + s * data[3 * i + 5])


@dataclass(frozen=True)
class CompiledFunctions:
    rates: Callable[[float, Array, Array, Array], None]  # (t, x, data, dx): fills dx
    guard: Callable[[Array, Array], float]  # (x, data): positive inside the mode
    jacobian: Callable[[Array, Array], None]  # (data, J): fills J


@lru_cache
def compile_functions(problem: Problem) -> CompiledFunctions:
    rates, stick_force = problem.rates, problem.stick_force
    stuck, slipping = affine(problem, STICK)[0], affine(problem, SLIP_UP)[0]

    @njit(error_model="numpy")
    def rates_at(t, x, data, dx):
        rates(x, road_velocity(t, data), data[0], dx)

    @njit(error_model="numpy")
    def guard(x, data):
        return FRICTION - abs(stick_force(x)) if data[0] == STICK else data[0] * x[1]

    @njit(error_model="numpy")
    def jacobian(data, J):
        J[:, :] = stuck if data[0] == STICK else slipping

    return CompiledFunctions(rates_at, guard, jacobian)


# --- scipy.integrate.solve_ivp.


def dop853_path(problem: Problem, table: RoadTable, rtol: float, stop_at_kinks: bool) -> Path:
    """With `stop_at_kinks` each interval of the table is one step, and no dense output is needed for the results.

    That is both several times faster and far more accurate than steps which the kinks of the road cut short. It fails
    if the tolerance asks for a shorter step than the table's.
    """
    functions, data = compile_functions(problem), pack(table)
    times, n, end = table.times, problem.size, table.duration

    def rates(t: float, x: Array) -> Array:
        dx = np.empty(n)  # here, because Numba takes longer to make and return an array
        functions.rates(t, x, data, dx)
        return dx

    def guard(t: float, x: Array) -> float:
        return functions.guard(x, data)

    guard.terminal, guard.direction = True, -1
    integrate = partial(solve_ivp, rates, method="DOP853", events=guard, rtol=rtol, atol=rtol * np.array(problem.scale))
    states, modes = np.zeros((len(times), n)), np.full(len(times), np.nan)
    modes[0] = STICK
    events: list[tuple[float, float]] = []
    t, x, evaluations = 0.0, np.zeros(n), 0
    while t < end:
        if stop_at_kinks:
            last = next_kink(table, t)
            run = integrate((t, last), x, max_step=table.step, first_step=min(table.step, last - t))
        else:
            run = integrate((t, end), x, t_eval=times[np.searchsorted(times, t, side="right") :])
        evaluations += run.nfev
        if run.status < 0:
            raise RuntimeError(run.message)
        reached = np.array(run.t)
        at = reached / (table.step * table.stride)
        wanted = (np.abs(at - np.rint(at)) < 1e-6) & (reached > t)
        i = np.rint(at[wanted]).astype(int)
        states[i], modes[i] = np.reshape(run.y, (n, -1)).T[wanted], data[0]
        if run.status == 1:
            t, x = run.t_events[0][0], run.y_events[0][0]
            x[1] = 0.0
            data[0] = mode_after(problem, data[0], x)
            events.append((t, data[0]))
        else:
            t, x = (last, run.y[:, -1]) if stop_at_kinks else (end, x)
    if np.isnan(modes).any():
        raise RuntimeError(f"DOP853 refused the table's step of {table.step} s at rtol {rtol}. Use a finer table.")
    return Path(states, modes, tuple(events), evaluations)


def next_kink(table: RoadTable, t: float) -> float:
    """The end for equal steps from `t`: that of the table if t is one of its times, else the next of its times."""
    position = t / table.step
    return table.duration if abs(position - round(position)) < 1e-9 else np.ceil(position) * table.step


# --- SUNDIALS CVODE.


def cvode_path(
    problem: Problem, table: RoadTable, rtol: float, method: str = "Adams", chunk: int = 1000, jacobian: bool = True
) -> Path:
    """`solve` is asked for at most `chunk` times at once: it walks over all of them in Python at every start."""
    functions, data = compile_functions(problem), pack(table)

    # scikit-sundae 1.2 refuses an array as its `userdata`.
    def rates(t: float, x: Array, dx: Array) -> None:
        functions.rates(t, x, data, dx)

    def guard(t: float, x: Array, out: Array) -> None:
        out[0] = functions.guard(x, data)

    def fill_jacobian(t: float, x: Array, dx: Array, J: Array) -> None:
        functions.jacobian(data, J)

    guard.terminal, guard.direction = [True], [-1]
    solver = CVODE(
        rates, method=method, rtol=rtol, atol=rtol * np.array(problem.scale), max_num_steps=100_000,
        eventsfn=guard, num_events=1, jacfn=fill_jacobian if jacobian else None,
    )  # fmt: skip
    times, n = table.times, problem.size
    states, modes = np.zeros((len(times), n)), np.zeros(len(times))
    events: list[tuple[float, float]] = []
    t, x, evaluations, done = 0.0, np.zeros(n), 0, 1
    while done < len(times):
        run = solver.solve(np.concatenate([[t], times[done : done + chunk]]), x)
        evaluations += run.nfev
        count = len(run.t) - 1 - (run.status == 2)
        states[done : done + count], modes[done : done + count] = run.y[1 : count + 1], data[0]
        done += count
        t, x = run.t[-1], run.y[-1].copy()
        if run.status == 2:
            x[1] = 0.0
            data[0] = mode_after(problem, data[0], x)
            events.append((t, data[0]))
        elif run.status < 0:
            raise RuntimeError(run.message)
    return Path(states, modes, tuple(events), evaluations)


# --- The measurements.


def measure(
    peer: str,
    path: Callable[..., Path],
    problem: Problem,
    table: RoadTable,
    rtol: float,
    expected: Reference | None,
    repeats: int,
) -> Run:
    expected = expected or reference(problem, table)
    path(problem, table.until(0.1), rtol)  # compiles
    spent = []
    for _ in range(repeats):
        start = time.perf_counter()
        found = path(problem, table, rtol)
        spent.append(time.perf_counter() - start)
    error = relative_error(body_acceleration(problem, found), expected.acceleration)
    rate = min(spent) / table.duration
    return Run(peer, problem.name, table.step, rtol, rate, error, len(found.events), found.evaluations)


def solve_ivp_run(
    problem: Problem,
    table: RoadTable,
    rtol: float = 1e-7,
    expected: Reference | None = None,
    repeats: int = 2,
    stop_at_kinks: bool = True,
) -> Run:
    """scipy's DOP853 with a terminal event. Without `stop_at_kinks` it chooses its own steps, as one would write it."""
    path = partial(dop853_path, stop_at_kinks=stop_at_kinks)
    name = "DOP853 to kinks" if stop_at_kinks else "DOP853 free"
    return measure(name, path, problem, table, rtol, expected, repeats)


def cvode_run(
    problem: Problem,
    table: RoadTable,
    rtol: float = 1e-8,
    expected: Reference | None = None,
    repeats: int = 3,
    method: str = "Adams",
) -> Run:
    """CVODE through scikit-sundae; right-hand side, root function and Jacobian are compiled by Numba.

    Fastest with a fine table: `road_table(1e-5, duration, stride=20)` gives results every 0.2 ms.
    """
    return measure(f"CVODE {method}", partial(cvode_path, method=method), problem, table, rtol, expected, repeats)


@njit(error_model="numpy")
def matrix_vector_products(Phi: Array, G: Array, inputs: Array, states: Array) -> None:
    for step in range(inputs.shape[0]):
        for i in range(Phi.shape[0]):
            total = 0.0
            for j in range(Phi.shape[1]):
                total += Phi[i, j] * states[step, j]
            for j in range(G.shape[1]):
                total += G[i, j] * inputs[step, j]
            states[step + 1, i] = total


@njit(nogil=True)
def burn(steps: int) -> float:
    """Arithmetic alone."""
    total = 0.0
    for i in range(steps):
        total += (i % 7) * 0.5
    return total


def bare_loop(n: int, m: int, steps: int, repeats: int = 20) -> Loop:
    """x <- Phi x + G u for every step, n states and m inputs, each state kept: the least an exact flow has to do.

    A road by Hermite needs three inputs for a step: its rise and the slopes at both ends.
    """
    random = np.random.default_rng(0)
    Phi, G = random.standard_normal((n, n)), random.standard_normal((n, m))
    Phi *= 0.99 / np.abs(np.linalg.eigvals(Phi)).max()
    inputs, states = random.standard_normal((steps, m)), np.zeros((steps + 1, n))
    spent = []
    for _ in range(repeats + 1):
        start = time.perf_counter()
        matrix_vector_products(Phi, G, inputs, states)
        spent.append(time.perf_counter() - start)
    return Loop(n, m, min(spent[1:]) / steps)


def show(run: Run) -> None:
    cost = f"{1e3 * run.seconds_per_second:9.1f}{run.error:12.1e}{run.events:8d}{run.evaluations:9d}"
    print(f"{run.problem}, {run.peer:20}{1e3 * run.step:9.2f}{run.tolerance:9.0e}{cost}")


def main(duration: float = 2.0) -> None:
    coarse, fine = road_table(2e-4, duration), road_table(1e-5, duration, stride=20)
    print(f"{'':23}{'table':>9}{'rtol':>9}{'time':>9}{'error':>12}{'events':>8}{'calls':>9}")
    print(f"{'':23}{'ms':>9}{'':9}{'ms/s':>9}")
    for problem in PROBLEMS.values():
        exact, smooth = reference(problem, coarse), reference(problem, fine)
        show(solve_ivp_run(problem, coarse, 1e-7, exact))
        show(solve_ivp_run(problem, coarse, 1e-7, exact, repeats=1, stop_at_kinks=False))
        show(solve_ivp_run(problem, fine, 1e-7, smooth, stop_at_kinks=False))
        show(cvode_run(problem, coarse, 1e-9, exact))
        for rtol in (1e-6, 1e-7, 1e-8, 1e-9):
            show(cvode_run(problem, fine, rtol, smooth))
        print(
            f"{problem.name}, the reference is within {disagreement(problem, coarse.until(0.5)):.0e} of DOP853 (0.5 s)"
        )
        print(f"{problem.name}, the coarse table itself: {relative_error(exact.acceleration, smooth.acceleration):.1e}")
        loop = bare_loop(problem.size, 3, 50_000)
        print(f"{problem.name}, bare loop, {loop.states} states, 3 inputs: {1e9 * loop.seconds_per_step:.1f} ns a step")


if __name__ == "__main__":
    with threadpool_limits(1):
        main(*map(float, sys.argv[1:2]))
