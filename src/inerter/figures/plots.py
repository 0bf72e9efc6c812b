"""Plots of designs, networks, motions and fronts, one call each: axes go in and come back, or are made.

Every function draws on the axes that it is given; without, on new ones of the style of the package. In a notebook the
figure is shown by its axes, `ax.figure`; it is saved by `ax.figure.savefig("name.svg")`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from inerter.errors import DesignError, LinearSystemError, SimulationError
from inerter.figures.labels import axis_label, capital
from inerter.figures.networks import network_figure
from inerter.figures.style import colour, layout_styles, log_axis, new_figure, style_context
from inerter.files.study.responses import gain_unit, source_unit
from inerter.formatting import choose_scale, format_number, format_range
from inerter.indices.definition import Index
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.networks.elements.algebra import Network, check_network
from inerter.norms.response import frequency_response, resonant_range
from inerter.pareto_fronts.front import ParetoFront
from inerter.simulation.trajectory import Trajectory
from inerter.systems.assemble import state_space
from inerter.systems.descriptor import close
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import input_unit, unit_of
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle, check_vehicle

Array = NDArray[np.float64]
Designs = Vehicle | Mapping[str, Vehicle]
Response = Index | tuple[str, str]

_POINTS = 800  # frequencies of a response
_STEPS = 2000  # samples of a step response
_SHADES = {"stick": "#F6DDA8", "open": "#D5E4F2"}


def plot_bode(
    designs: Designs, response: Response, *, frequency: ArrayLike | None = None, axes: Sequence[Axes] | None = None
) -> tuple[Axes, Axes]:
    """Gain and phase of designs over frequency [Hz], on two axes.

    `designs` is one vehicle or several by their names; `response` an index, whose outputs are drawn without weights
    over its excitation, or the names of an input and an output of `state_space`. A road is an input by its velocity.

    Raises `DesignError` for a design with free values, or a response to several independent sources, as of two tracks
    with a coherence; and what `state_space` raises for unknown names.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(2e3)
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, strut)
    >>> gain, phase = it.plot_bode({"S1": car}, ("road", "sprung_acceleration"))
    >>> phase.get_ylabel(), phase.get_xlabel()
    ('Phase [deg]', 'Frequency [Hz]')
    """
    with style_context():
        upper, lower = _pair(axes)
        curves = list(_responses(designs, response, frequency))
        for curve in curves:
            upper.plot(curve.frequency, np.abs(curve.value), **curve.look)
            lower.plot(curve.frequency, np.unwrap(np.angle(curve.value)) * 180.0 / np.pi, **curve.look)
        upper.set(ylabel=curves[0].gain_label)
        lower.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Phase", "deg"))
        for ax in (upper, lower):
            log_axis(ax, "x")
            ax.margins(x=0.0)
        log_axis(upper, "y")
        lower.yaxis.set_major_locator(_degrees(lower))
        _legend(upper, len(curves))
    return upper, lower


def plot_nyquist(
    designs: Designs, response: Response, *, frequency: ArrayLike | None = None, ax: Axes | None = None
) -> Axes:
    """Responses of designs in the complex plane, as in `plot_bode`; a dot marks the lowest frequency.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_nyquist(car, ("road", "sprung_velocity")).get_xlabel()
    'Real part [(m/s)/(m/s)]'
    """
    with style_context():
        ax = _single(ax)
        curves = list(_responses(designs, response, frequency))
        for curve in curves:
            ax.plot(curve.value.real, curve.value.imag, **curve.look)
            ax.plot(curve.value.real[:1], curve.value.imag[:1], "o", color=curve.look["color"], markersize=3.5)
        unit = curves[0].unit
        ax.set(xlabel=axis_label("Real part", unit), ylabel=axis_label("Imaginary part", unit))
        ax.axhline(0.0, color="#999999", linewidth=0.6)
        ax.axvline(0.0, color="#999999", linewidth=0.6)
        ax.set_aspect("equal", adjustable="datalim")
        _legend(ax, len(curves))
    return ax


def plot_admittance(
    networks: Network | Mapping[str, Network], *, frequency: ArrayLike | None = None, axes: Sequence[Axes] | None = None
) -> tuple[Axes, Axes]:
    """Size [N s/m] and phase of the admittance (force over velocity) of networks over frequency [Hz], on two axes.

    -90 degrees is a spring, 0 a damper, 90 an inerter. Friction is neglected and gaps are closed.

    Raises `NetworkError` if there is no network, `DesignError` if a value is free.

    >>> import inerter as it
    >>> gain, phase = it.plot_admittance({"S3": it.Spring(120e3) | it.Damper(7e3) - it.Inerter(300.0)})
    >>> phase.get_yticks().tolist()
    [-90.0, -45.0, 0.0, 45.0, 90.0]
    """
    named = {"": networks} if isinstance(networks, Network) else dict(networks)
    if not named:
        check_network(None)
    hertz = _check_frequencies(np.geomspace(0.1, 100.0, _POINTS) if frequency is None else frequency)
    with style_context():
        upper, lower = _pair(axes)
        for look, network in zip(_looks(named), named.values(), strict=True):
            value = check_network(network).admittance(2j * np.pi * hertz)
            upper.plot(hertz, np.abs(value), **look)
            lower.plot(hertz, np.angle(value, deg=True), **look)
        upper.set(ylabel=axis_label("Admittance", "N s/m"))
        lower.set(xlabel=axis_label("Frequency", "Hz"), ylabel=axis_label("Phase", "deg"))
        lower.set_yticks([-90.0, -45.0, 0.0, 45.0, 90.0])
        for ax in (upper, lower):
            log_axis(ax, "x")
            ax.margins(x=0.0)
        log_axis(upper, "y")
        _legend(upper, len(named))
    return upper, lower


def plot_poles(designs: Designs, *, ax: Axes | None = None) -> Axes:
    """Poles of designs [1/s], with the rays of equal damping ratio.

    Raises `DesignError` for a design with free values.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_poles(car).get_xlabel()
    'Real part [1/s]'
    """
    with style_context():
        ax = _single(ax)
        named = _designs_by_name(designs)
        reach = 0.0
        for number, (name, vehicle) in enumerate(named.items()):
            poles = np.linalg.eigvals(state_space(vehicle).A)
            reach = max(reach, float(np.abs(poles.imag).max(initial=0.0)))
            ax.plot(poles.real, poles.imag, "x", color=colour(number), label=name, markersize=5)
        ax.axhline(0.0, color="#999999", linewidth=0.6)
        ax.axvline(0.0, color="#999999", linewidth=0.6)
        for ratio in (0.1, 0.3, 0.7) if reach else ():
            ray = np.array([0.0, reach])
            ax.plot(-ratio / np.sqrt(1.0 - ratio**2) * ray, ray, ":", color="#AAAAAA", linewidth=0.7)
            ax.annotate(
                format_number(ratio), (-ratio / np.sqrt(1.0 - ratio**2) * reach, reach), color="#777777", fontsize=6.5
            )
        ax.set(xlabel=axis_label("Real part", "1/s"), ylabel=axis_label("Imaginary part", "rad/s"))
        _legend(ax, len(named))
    return ax


def plot_step_response(
    designs: Designs, response: tuple[str, str], *, duration: float = 2.0, ax: Axes | None = None
) -> Axes:
    """Response of an output of designs to a unit step of an input over time [s].

    A road steps by its height of 1 m, a force by 1 N; `response` are names of an input and an output of `state_space`.

    Raises `DesignError` for a design with free values, and what `state_space` raises for unknown names.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3))
    >>> it.plot_step_response(car, ("road", "sprung_displacement")).get_ylabel()
    'Sprung displacement [m per m of road]'
    """
    time = np.linspace(0.0, duration, _STEPS)
    with style_context():
        ax = _single(ax)
        named = _designs_by_name(designs)
        label = ""
        for look, vehicle in zip(_looks(named), named.values(), strict=True):
            mechanism = vehicle.mechanism()
            system = state_space(vehicle, *response)
            roads = response[0] in {road.name for road in mechanism.roads}
            ax.plot(time, _impulse(system, time) if roads else _step(system, time), **look)
            what, per = unit_of(mechanism, [response[1]]), "m" if roads else input_unit(mechanism, response[0])
            label = f"{capital(_words(response[1]))} [{what} per {per} of {_words(response[0])}]"
        ax.set(xlabel=axis_label("Time", "s"), ylabel=label)
        ax.margins(x=0.0)
        _legend(ax, len(named))
    return ax


def plot_trajectory(
    run: Trajectory,
    outputs: Sequence[str] | str,
    *,
    window: tuple[float, float] | None = None,
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Outputs of a simulated motion over time, an axis each, shaded where friction sticks and where gaps are open.

    `window` is the time [s] from and to which is drawn; all by default.

    Raises `SimulationError` for an output that is not there, or a window without samples.

    >>> import inerter as it
    >>> screw = it.Inerter(100.0) | it.Friction(20.0, name="f")
    >>> car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(60e3) | it.Damper(2e3) | screw)
    >>> run = it.simulate(car, road=it.cosine(1e-3, 1.0), duration=2.0)
    >>> [ax.get_ylabel() for ax in it.plot_trajectory(run, ["sprung_acceleration", "tyre_load"])]
    ['Sprung acceleration [m/s²]', 'Tyre load [N]']
    """
    names = [outputs] if isinstance(outputs, str) else list(outputs)
    low, high = window if window is not None else (float(run.time[0]), float(run.time[-1]))
    inside = (run.time >= low) & (run.time <= high)
    if not names or not inside.any():
        known = format_range(run.time[0], run.time[-1], "s")
        raise SimulationError(
            f"A plot of a motion needs outputs, and samples in its window: got {names!r} from "
            f"{format_range(low, high, 's')}, where the motion is known from {known}."
        )
    with style_context():
        several = list(axes) if axes is not None else new_figure(len(names), height=1.9)[1]
        if len(several) != len(names):
            raise SimulationError(f"Each of {len(names)} outputs needs axes, got {len(several)}.")
        for name, ax in zip(names, several, strict=True):
            values, label = _scale_output(run, name, inside)
            ax.plot(run.time[inside], values, linewidth=0.9, color=colour(0))
            ax.set(ylabel=label, xlim=(low, high))
            _shade(run, (low, high), ax)
        several[-1].set(xlabel=axis_label("Time", "s"))
        _legend(several[0], len(several[0].get_legend_handles_labels()[1]) + 1)
    return several


def plot_loop(
    run: Trajectory,
    across: str,
    up: str,
    *,
    window: tuple[float, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """An output of a simulated motion over another one, such as a force over a displacement.

    Raises `SimulationError` for an output that is not there.

    >>> import inerter as it
    >>> rig = it.Rig((it.Spring(1e6) | it.Damper(3200.0)) - (it.Inerter(113.0) | it.Friction(10.0)))
    >>> run = it.simulate(rig, displacement=it.sine(1e-3, 3.0), duration=2.0)
    >>> it.plot_loop(run, "displacement", "device_force").get_ylabel()
    'Device force [N]'
    """
    low, high = window if window is not None else (float(run.time[0]), float(run.time[-1]))
    inside = (run.time >= low) & (run.time <= high)
    with style_context():
        ax = _single(ax)
        (along, x_label), (height, y_label) = (_scale_output(run, name, inside) for name in (across, up))
        ax.plot(along, height, linewidth=0.9, color=colour(0))
        ax.set(xlabel=x_label, ylabel=y_label)
    return ax


def plot_front(fronts: ParetoFront | Mapping[str, ParetoFront], *, ax: Axes | None = None) -> Axes:
    """Pareto fronts of two indices, with their knees.

    Raises `DesignError` for a front of three indices, or of other indices than the first one's.

    >>> import inerter as it
    >>> road = it.Road(roughness=5e-7, speed=25.0)
    >>> c = it.Damper(it.free(1e3, 1e4, name="c"))
    >>> car = it.QuarterCar(181.75, 25.0, 120e3, it.Spring(120e3) | c)
    >>> front = it.pareto_front(car, [it.RideComfort(road), it.LoadCarrying()], it.Norm(), points=3, seed=0)
    >>> it.plot_front({"S1": front}).get_xlabel()
    'Ride comfort J1 [m/s²]'
    """
    named = {"": fronts} if isinstance(fronts, ParetoFront) else dict(fronts)
    kinds = {tuple(index.symbol for index in front.indices) for front in named.values()}
    if len(kinds) != 1 or any(len(kind) != 2 for kind in kinds):
        raise DesignError(f"A plot of fronts needs fronts of the same two indices, got {sorted(kinds)}.")
    with style_context():
        ax = _single(ax)
        for number, (name, front) in enumerate(named.items()):
            ax.plot(*front.values.T, "o-", color=colour(number), label=name, markersize=3.0)
            if len(front.values):
                ax.plot(*front.values[front.knee], "o", color=colour(number), markersize=7, fillstyle="none")
        first, second = (
            axis_label(f"{capital(index.title)} {index.symbol}", index.unit)
            for index in next(iter(named.values())).indices
        )
        ax.set(xlabel=first, ylabel=second)
        _legend(ax, len(named))
    return ax


def plot_network(networks: Network | Mapping[str, Network], *, values: bool = False) -> Figure:
    """Drawing of a network, or of several below their names; `values` are written below the names of elements.

    Raises `NetworkError` if there is none.

    >>> import inerter as it
    >>> figure = it.plot_network({"S3": it.Spring(120e3) | it.Damper(7e3) - it.Inerter(300.0)}, values=True)
    >>> [round(float(size), 1) for size in figure.get_size_inches()] > [0.5, 0.5]
    True
    """
    named = {"": networks} if isinstance(networks, Network) else dict(networks)
    with style_context():
        return network_figure(named, values=values)


def network_svg(network: Network) -> str:
    """Drawing of a network as SVG, as notebooks show it."""
    drawn = StringIO()
    with style_context():
        plot_network(network, values=True).savefig(drawn, format="svg", metadata={"Date": None})
    return drawn.getvalue()


class _Curve:
    """The response of an output of one design."""

    def __init__(self, frequency: Array, value: NDArray[np.complex128], look: dict[str, Any], what: str, unit: str):
        self.frequency, self.value, self.look, self.unit = frequency, value, look, unit
        self.gain_label = axis_label(what, unit)


def _responses(designs: Designs, response: Response, frequency: ArrayLike | None) -> Iterator[_Curve]:
    """A curve for each design and each output of the response."""
    named = _designs_by_name(designs)
    found = [_system(vehicle.mechanism(), vehicle, response) for vehicle in named.values()]
    omega = resonant_range([system.A for system, *_ in found])
    hertz = omega / (2.0 * np.pi) if frequency is None else _check_frequencies(frequency)
    for look, (system, pade_order, what, unit) in zip(_looks(named), found, strict=True):
        values = frequency_response(system, 2.0 * np.pi * hertz, pade_order)
        if values.shape[2] > 1:
            raise DesignError(
                "Several independent sources excite this response, so that it has no phase. Plot it from one input to "
                'one output, such as ("road_front_left", "roll_acceleration").'
            )
        for row, output in enumerate(system.outputs):
            several = {"label": f"{look['label']} {_words(output)}".strip()} if len(system.outputs) > 1 else {}
            yield _Curve(hertz, values[:, row, 0], {**look, **several, **_fainter(row)}, what, unit)


def _system(mechanism: Mechanism, vehicle: Vehicle, response: Response) -> tuple[LinearSystem, int | None, str, str]:
    """System of a response, the order of its Pade approximants, what its gain is in words, and its unit."""
    if not isinstance(response, tuple):
        if free := ", ".join(mechanism.free_values()):
            raise DesignError(f"The value of {free} is still free. Fix it with with_values(...), or optimise first.")
        problem = linear_problem(mechanism, response.definition(mechanism), CONVENTIONS["exact"])
        system = problem.system(close(problem.descriptor, {}))
        own = unit_of(mechanism, [system.outputs[0]])
        return (
            system,
            problem.pade_order,
            capital(response.response),
            gain_unit(own, source_unit(mechanism, problem.definition)),
        )
    source, output = response
    system = state_space(vehicle, source, output)
    moved = source in {road.name for road in mechanism.roads}
    what = f"{capital(_words(output))} over {_words(source)}{' velocity' if moved else ''}"
    per = "m/s" if moved else input_unit(mechanism, source)
    return system, None, what, gain_unit(unit_of(mechanism, [output]), per)


def _designs_by_name(designs: Designs) -> dict[str, Vehicle]:
    named = dict(designs) if isinstance(designs, Mapping) else {"": designs}
    if not named:
        raise DesignError("A plot of designs needs at least one, got none.")
    for vehicle in named.values():
        check_vehicle(vehicle)
    return named


def _looks(named: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Keywords of a curve each; the first of several is what the others are compared with."""
    if len(named) == 1:
        return [{"color": colour(0), "label": name} for name in named]
    styles = layout_styles(named, next(iter(named)))
    return [{**styles[name].curve(), "label": name} for name in named]


def _fainter(row: int) -> dict[str, Any]:
    return {"alpha": 1.0 / (1 + row)} if row else {}


def _check_frequencies(frequency: ArrayLike) -> Array:
    found = np.atleast_1d(np.asarray(frequency, dtype=float))
    if found.ndim != 1 or not found.size or not np.all(np.isfinite(found) & (found > 0.0)):
        raise LinearSystemError("Frequencies of a plot are a list of positive numbers of Hz.")
    return found


def _step(system: LinearSystem, time: Array) -> Array:
    """Response to a unit step of the one input, at even times."""
    n = system.order
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = system.A, system.B[:, 0]
    return _free_motion(block, np.eye(n + 1)[n], np.append(system.C[0], system.D[0, 0]), time)


def _impulse(system: LinearSystem, time: Array) -> Array:
    """Response to a unit impulse of the one input, at even times: a step of what it is the velocity of."""
    if system.D[0, 0] != 0.0:
        raise LinearSystemError("This output has an impulse at a step of the road. Choose another, or another signal.")
    return _free_motion(system.A, system.B[:, 0], system.C[0], time)


def _free_motion(A: Array, begin: Array, row: Array, time: Array) -> Array:
    """Row exp(A t) begin at even times."""
    from scipy.linalg import expm  # noqa: PLC0415 - heavy

    flow, state, found = expm(A * (time[1] - time[0])), begin, np.empty(time.size)
    for i in range(time.size):
        found[i] = row @ state
        state = flow @ state
    return found


def _scale_output(run: Trajectory, name: str, inside: NDArray[np.bool_]) -> tuple[Array, str]:
    """Samples of an output in a unit that suits their size, and the label of their axis."""
    values, output = run[name][inside], run.outputs[name]
    scale = choose_scale([float(np.abs(values).max())], output.unit)
    return values * scale.factor, axis_label(capital(output.title), scale.unit)


def _shade(run: Trajectory, window: tuple[float, float], ax: Axes) -> None:
    """Filled where an element sticks or is open."""
    for element in run.states:
        for state, fill in _SHADES.items():
            for begin, end in run.intervals(element, state):
                if begin < window[1] and end > window[0]:
                    label = f"{element} {'sticks' if state == 'stick' else 'is open'}"
                    ax.axvspan(begin, end, color=fill, linewidth=0.0, zorder=0.5, label=label)


def _degrees(ax: Axes) -> Any:
    """Ticks at multiples of 45, 90 or 180 degrees."""
    from matplotlib.ticker import MultipleLocator  # noqa: PLC0415

    low, high = ax.get_ylim()
    return MultipleLocator(next((step for step in (45.0, 90.0, 180.0) if high - low <= 6.0 * step), 360.0))


def _words(name: str) -> str:
    return name.replace("_", " ")


def _single(ax: Axes | None) -> Axes:
    return ax if ax is not None else new_figure(height=3.0, width=4.6)[1][0]


def _pair(axes: Sequence[Axes] | None) -> tuple[Axes, Axes]:
    upper, lower = axes if axes is not None else new_figure(2, height=2.0, width=4.6)[1]
    return upper, lower


def _legend(ax: Axes, count: int) -> None:
    """A legend where there are several curves, each name once."""
    handles, labels = ax.get_legend_handles_labels()
    entries = {label: handle for handle, label in zip(handles, labels, strict=True) if label}
    if entries and count > 1:
        ax.legend(list(entries.values()), list(entries))
