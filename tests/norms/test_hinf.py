"""The H-infinity norm and its peaks: closed forms, partial fractions, dense grids, and what is infinite."""

import math

import numpy as np
import pytest
from campaigns import sampled
from hypothesis import given
from hypothesis import strategies as st
from strategies import logarithmic, random_stable

from inerter import (
    Coordinate,
    Damper,
    Force,
    LinearSystem,
    Mechanism,
    Spring,
    StatusKind,
    Strut,
    frequency_response,
    hinf_norm,
    state_space,
)
from inerter.errors import LinearSystemError

ZERO = [[0.0]]


def oscillator(omega, zeta, C=(1.0, 0.0), D=0.0):
    return LinearSystem([[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]], [[0.0], [1.0]], [C], [[D]])


@given(logarithmic(1e-4, 1e4), logarithmic(1e-6, 0.7))
def test_resonance_of_one_degree_of_freedom(omega, zeta):
    """Textbook: 1/(2 zeta sqrt(1 - zeta^2)) times the static gain, at omega sqrt(1 - 2 zeta^2)."""
    result = hinf_norm(oscillator(omega, zeta))
    assert result.value == pytest.approx(1.0 / (2.0 * zeta * math.sqrt(1.0 - zeta**2) * omega**2), rel=1e-9)
    assert [peak.gain for peak in result.peaks] == [result.value]
    assert result.peaks[0].omega == pytest.approx(omega * math.sqrt(1.0 - 2.0 * zeta**2), rel=1e-5, abs=1e-3 * omega)


@given(logarithmic(1e-4, 1e4), logarithmic(1e-6, 30.0))
def test_velocity_resonates_at_the_natural_frequency(omega, zeta):
    result = hinf_norm(oscillator(omega, zeta, (0.0, 1.0)))
    assert result.value == pytest.approx(1.0 / (2.0 * zeta * omega), rel=1e-9)


@pytest.mark.parametrize("zeta", [0.71, 1.0, 5.0, 1e3])
def test_without_resonance_the_static_gain_is_the_largest(zeta):
    result = hinf_norm(oscillator(2.0, zeta))
    assert result.status.ok
    assert result.value == pytest.approx(0.25, rel=1e-12)
    assert [peak.omega for peak in result.peaks] == [0.0]


@pytest.mark.parametrize("zeta", [1e-6, 1e-3, 0.3])
def test_acceleration_of_one_degree_of_freedom(zeta):
    """s^2 / (s^2 + 2 zeta s + 1): its peak is the mirror image of that of the displacement; D = 1 is the far end."""
    result = hinf_norm(oscillator(1.0, zeta, (-1.0, -2.0 * zeta), 1.0))
    assert result.value == pytest.approx(1.0 / (2.0 * zeta * math.sqrt(1.0 - zeta**2)), rel=1e-9)


@pytest.mark.parametrize("corner", [1e-3, 1.0, 1e5])
def test_a_high_pass_filter_is_largest_at_infinity(corner):
    result = hinf_norm(LinearSystem([[-corner]], [[1.0]], [[-3.0 * corner]], [[3.0]]))
    assert result.value == pytest.approx(3.0, rel=1e-9)
    assert result.peaks[0].omega == math.inf


@pytest.mark.parametrize("omegas", [[1.0], [1.0, 30.0], [0.3, 7.0, 7.1, 50.0]])
@pytest.mark.parametrize("zeta", [1e-6, 1e-3, 0.3])
def test_an_all_pass_system_passes_everything_once(omegas, zeta):
    """Products of (s^2 - 2 zeta w s + w^2)/(s^2 + 2 zeta w s + w^2)."""
    system = LinearSystem(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[1.0]])
    for omega in omegas:
        stage = oscillator(omega, zeta, (0.0, -4.0 * zeta * omega), 1.0)
        n = system.order
        system = LinearSystem(
            np.block([[system.A, np.zeros((n, 2))], [stage.B @ system.C, stage.A]]),
            np.vstack([system.B, stage.B @ system.D]),
            np.hstack([stage.D @ system.C, stage.C]),
            stage.D @ system.D,
        )
    assert hinf_norm(system).value == pytest.approx(1.0, rel=1e-8)


def modes(omegas, zetas, weights):
    n = len(omegas)
    A, B, C = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 1)), np.zeros((1, 2 * n))
    for i, (w, z, p) in enumerate(zip(omegas, zetas, weights, strict=True)):
        A[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[0.0, w], [-w, -2.0 * z * w]]
        B[2 * i + 1, 0], C[0, 2 * i] = 1.0, p

    def gain(omega):
        s = 1j * np.asarray(omega)[:, None]
        return np.abs(np.sum(weights * omegas / (s**2 + 2.0 * zetas * omegas * s + omegas**2), axis=1))

    return LinearSystem(A, B, C, ZERO), gain


def local_maxima(gain, omegas, zetas):
    """By brute force: a grid that resolves every resonance, refined by parabolas through three points."""
    around = (omegas[:, None] * (1.0 + zetas[:, None] * np.linspace(-8.0, 8.0, 2001))).ravel()
    grid = np.unique(np.concatenate([np.geomspace(1e-3, 1e3, 60000), around[around > 0.0]]))
    values = gain(grid)
    inner = np.flatnonzero((values[1:-1] > values[:-2]) & (values[1:-1] >= values[2:])) + 1
    found = []
    for i in inner:
        x = (grid[i - 1 : i + 2] - grid[i]) / (grid[i + 1] - grid[i - 1])
        a, b, _ = np.polyfit(x, values[i - 1 : i + 2] / values[i], 2)
        found.append((grid[i], values[i] * (1.0 - b * b / (4.0 * a))))
    return found


@pytest.mark.parametrize("seed", sampled(range(12), range(2), kept=4))
@pytest.mark.parametrize("lightest", [1e-6, 1e-2])
def test_every_peak_of_many_modes(seed, lightest):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 21))
    omegas = np.geomspace(0.1, 100.0, n) * 10 ** rng.uniform(-0.05, 0.05, n)
    zetas = lightest * 10 ** rng.uniform(0.0, 1.0, n)
    system, gain = modes(omegas, zetas, rng.uniform(0.1, 1.0, n) * rng.choice([-1.0, 1.0], n))
    result, expected = hinf_norm(system), local_maxima(gain, omegas, zetas)
    peaks = sorted((peak.omega, peak.gain) for peak in result.peaks if peak.omega > 0.0)
    assert [w for w, _ in peaks] == pytest.approx([w for w, _ in expected], rel=1e-3)
    assert [g for _, g in peaks] == pytest.approx([g for _, g in expected], rel=1e-5)
    assert result.value == max(peak.gain for peak in result.peaks)


def brute_force(system):
    """Largest singular value on a dense grid, three times refined about its maximum."""
    poles = np.abs(np.linalg.eigvals(system.A))
    low, high = 0.0, 100.0 * poles.max()
    grid = np.concatenate([[0.0], np.geomspace(1e-3 * poles.min(), high, 6000)])
    for _ in range(6):
        values = np.linalg.svd(frequency_response(system, grid), compute_uv=False)[:, 0]
        best = int(np.argmax(values))
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
        grid = np.linspace(low, high, 200)
    return float(values.max())


@pytest.mark.parametrize("order", sampled([1, 2, 3, 5, 9, 14, 21, 30, 40], [1, 2, 5, 14, 21]))
def test_random_systems_with_several_inputs_and_outputs(order):
    rng = np.random.default_rng(order)
    m, p = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    plain = random_stable(rng, order, m, p, 1e-2)
    system = LinearSystem(plain.A, plain.B, plain.C, 0.1 * rng.standard_normal((p, m)))
    result, expected = hinf_norm(system), brute_force(system)
    assert result.value == pytest.approx(expected, rel=1e-7)
    assert result.value >= expected * (1.0 - 1e-10)


@given(logarithmic(1e-9, 1e9), st.integers(0, 30))
def test_time_in_other_units(factor, seed):
    system = random_stable(np.random.default_rng(seed), 6, 2, 2, 1e-3)
    slow, fast = hinf_norm(system), hinf_norm(LinearSystem(factor * system.A, factor * system.B, system.C, system.D))
    assert fast.value == pytest.approx(slow.value, rel=1e-8)
    assert fast.peaks[0].omega == pytest.approx(factor * slow.peaks[0].omega, rel=1e-4)


@pytest.mark.parametrize("seed", range(8))
def test_units_of_the_states_change_nothing(seed):
    rng = np.random.default_rng(seed)
    omegas, zetas = 10 ** rng.uniform(-1, 2, 8), 10 ** rng.uniform(-6, -1, 8)
    system, _ = modes(omegas, zetas, rng.standard_normal(8))
    units = 10.0 ** rng.uniform(-6, 6, 16)
    scaled = LinearSystem(system.A * units[:, None] / units, system.B * units[:, None], system.C / units, system.D)
    assert hinf_norm(scaled).value == pytest.approx(hinf_norm(system).value, rel=1e-8)


@pytest.mark.parametrize(
    ("part", "kind", "omega"),
    [
        (oscillator(5.0, 0.0), StatusKind.MARGINAL, 5.0),
        (LinearSystem(ZERO, [[1.0]], [[1.0]], ZERO), StatusKind.MARGINAL, 0.0),
        (LinearSystem([[0.5]], [[1.0]], [[1.0]], ZERO), StatusKind.UNSTABLE, 0.0),
        (oscillator(5.0, -1e-3), StatusKind.UNSTABLE, 5.0),
    ],
)
def test_a_motion_that_does_not_decay_has_no_bound_unless_it_is_hidden(part, kind, omega):
    n = part.order
    A = np.block([[part.A, np.zeros((n, 1))], [np.zeros((1, n)), -np.eye(1)]])
    B, C = np.vstack([part.B, [[1.0]]]), np.hstack([part.C, [[2.0]]])
    seen = hinf_norm(LinearSystem(A, B, C, ZERO))
    assert seen.value == math.inf
    assert seen.status.kind is kind
    assert seen.peaks[0].omega == pytest.approx(omega, rel=1e-6, abs=1e-12)
    for B2, C2 in ((B * ([[0.0]] * n + [[1.0]]), C), (B, C * ([0.0] * n + [1.0]))):
        hidden = hinf_norm(LinearSystem(A, B2, C2, ZERO))
        assert hidden.status.ok
        assert hidden.value == pytest.approx(2.0, rel=1e-9)


def test_nothing_in_nothing_out_is_zero():
    assert hinf_norm(LinearSystem([[-1.0]], [[0.0]], [[1.0]], ZERO)).value == 0.0
    assert hinf_norm(LinearSystem([[-1.0]], np.zeros((1, 0)), [[1.0]], np.zeros((1, 0)))).value == 0.0
    assert hinf_norm(LinearSystem(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[-4.0]])).value == 4.0


def test_inputs_of_one_source_add_up_if_they_arrive_together():
    system = LinearSystem([[-1.0]], [[1.0, 2.0]], [[1.0]], [[0.0, 0.0]])
    assert hinf_norm(system).value == pytest.approx(math.sqrt(5.0))
    assert hinf_norm(system.with_delays("road", [0.2, 0.2])).value == pytest.approx(3.0)
    with pytest.raises(LinearSystemError, match=r"0\.3 s apart"):
        hinf_norm(system.with_delays("road", [0.2, 0.5]))


@pytest.mark.parametrize("damping", [1e-9, 1e-5, 1e-2, 0.5])
@pytest.mark.parametrize("omega", [1e-8, 1.0, 3e9])
def test_peaks_of_one_mass_by_the_textbook(damping, omega):
    """1/(m (s^2 + 2 d w s + w^2)) has its peak 1/(2 m w^2 d sqrt(1 - d^2)) at w sqrt(1 - 2 d^2)."""
    mass = 3.0
    mechanism = Mechanism(
        (Coordinate("body", mass),),
        (Strut("s", Spring(mass * omega**2) | Damper(2.0 * damping * omega * mass), {"body": 1.0}, {}),),
        forces=(Force("push", {"body": 1.0}),),
    )
    found = hinf_norm(state_space(mechanism, "push", "body_displacement"))
    assert found.value == pytest.approx(1.0 / (2.0 * mass * omega**2 * damping * np.sqrt(1.0 - damping**2)), rel=1e-12)
    assert found.peaks[0].omega == pytest.approx(omega * np.sqrt(1.0 - 2.0 * damping**2), rel=2e-7)
