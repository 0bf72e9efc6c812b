"""`identify`: parameters of a device from measured records, with their uncertainty."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from typing import Unpack

from inerter.errors import IdentificationError
from inerter.formatting import format_quantity
from inerter.identification import hypotheses
from inerter.identification.arguments import check_progress, checked_records, model_of, warn_of_units
from inerter.identification.conclusions import fit_of
from inerter.identification.fit import Fit
from inerter.identification.models import with_mount
from inerter.identification.options import DEFAULTS, FitOptions, OptionChanges, options_of
from inerter.identification.scales import apply_scales
from inerter.identification.solving import SolvedFit, solve
from inerter.kernels.prepare import prepare_on
from inerter.networks.elements import Network
from inerter.networks.elements.roles import LinearRole
from inerter.records.record import Record
from inerter.simulation.event_driven import KERNELS
from inerter.validation import is_number
from inerter.vehicle.rig import Rig
from inerter.work.blas_threads import one_blas_thread
from inerter.work.progress import part
from inerter.work.running import running_on

_SOLVED = 0.8  # of the work, before explanations are sought


def identify(
    records: Record | Sequence[Record],
    model: Network | str,
    options: FitOptions = DEFAULTS,
    *,
    progress: Callable[[float], None] | None = None,
    executor: Executor | None = None,
    **changes: Unpack[OptionChanges],
) -> Fit:
    """Fit the free values of `model`, the device on the rig, to the force of one record or several together.

    `model` is a network with free values, or the name of one of `inerter.identification.models.MODELS`. Fields of
    `options` may be given, or changed, as keywords: `identify(record, model, seed=1, gain=True)`. An `executor`
    (of `concurrent.futures`, of a dask client, of mpi4py) shares the searches, profiles and the bootstrap.

    The model follows the smoothed displacement of the record, and its force is compared; no measured motion is
    differentiated twice. Points of a Sobol' sequence, and an initial estimate without simulation for devices that are a
    chain, are improved by least squares; residuals are weighted and whitened by simulated sensor noise; intervals are
    from profile likelihoods at 95 %, widened by the scatter of a parametric bootstrap. A parameter that is not
    identifiable has the value nan, with the reason in `fit.identifiable`.

    Where the residual exceeds sensor noise (`fit.misfit`; that of the record where it is stated, such as
    `Record.force_noise`), on the estimation or the validation data, the status is not ok, `fit.explanations` lists
    possible causes in the model or the sensors, and values are withheld; at most a range under explanations is given.
    Records do not show the scales of the sensors: state them with `force_scale` and `displacement_scale`. A mass
    between load cell and device, `Record.fixture_mass`, must be known: it cannot be distinguished from an inertance.
    See docs/identification.md.

    Raises `IdentificationError` for a model without free values or invalid options, and `RecordError` for records that
    cannot be used. Warns, before the fit, of records whose units may be wrong.

    >>> import inerter as it
    >>> rig = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), sampling=500.0)
    >>> record = rig.run(it.cosine(1e-3, 3.0), 2.0)  # m, Hz, s
    >>> fit = it.identify(record, it.Inerter(it.free(10, 500, name="b")) | it.Friction(10.0), starts=8)
    >>> fit.status.ok, abs(fit.parameters["b"].value - 113.0) < 1.0  # kg
    (True, True)
    """
    asked = options_of(options, changes)
    check_progress(progress)
    given, device = checked_records(records), model_of(model)
    warn_of_units(given)
    with running_on(executor) as pool:
        prepare_on(pool, KERNELS)
        fit = fit_of(solution_of(given, device, asked, part(progress, 0.0, _SOLVED)))
    if progress is not None:
        progress(1.0)
    return fit


def solution_of(
    records: Record | Sequence[Record], model: Network, asked: FitOptions, progress: Callable[[float], None] | None
) -> SolvedFit:
    """Solution of the least-squares problem of `identify`, before conclusions."""
    given, rig = _validate(records, model)
    given = [apply_scales(record, asked) for record in given]
    longest = _longest_delay(given, asked.delay)
    _check_gain(rig, asked.gain)
    assumed = [hypotheses.gain()] if asked.gain else []
    assumed += [hypotheses.delay(longest)] if longest > 0.0 else []
    with one_blas_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", category=RuntimeWarning)
        return solve(given, rig, tuple(assumed), asked, progress)


def _validate(records: Record | Sequence[Record], model: Network) -> tuple[list[Record], Rig]:
    given = checked_records(records)
    rig = Rig(with_mount(model))
    if not rig.free_values():
        raise IdentificationError(
            "The model has no free values to identify. Write, for example, Spring(free(1e5, 1e7, name='ks'))."
        )
    return given, rig


def _longest_delay(records: Sequence[Record], asked: bool | float | None) -> float:
    """Largest delay of the force that is sought [s]: of None, a usual one if the bandwidth of a load cell is unknown.

    Raises `IdentificationError` unless it is a number of at least 0 below half of every record.
    """
    sought = any(r.force_bandwidth is None for r in records) if asked is None else asked
    longest = hypotheses.LONGEST_DELAY if sought is True else float(sought)
    if not is_number(longest) or longest < 0.0:
        raise IdentificationError(f"delay must be True, False or its largest size in s, got {asked!r}.")
    shortest = min(records, key=lambda record: record.duration)
    if longest > 0.0 and longest >= 0.5 * shortest.duration:
        raise IdentificationError(
            f"A delay of the force of up to {format_quantity(longest, 's')} is sought, but {shortest.source!r} lasts "
            f"{format_quantity(shortest.duration, 's')}, not twice as long. Use a longer record, or delay = false."
        )
    return longest


def _check_gain(rig: Rig, gain: bool) -> None:
    """Raise `IdentificationError` for a free gain unless the size of at least one element is known."""
    known = [e for e in rig.device.elements() if e.linear is not LinearRole.CLOSED and is_number(e.value)]
    if gain and not known:
        raise IdentificationError(
            "gain: a gain of the load cell is not identifiable if all springs, dampers, inerters and frictions are "
            "free. Fix one of them, such as the inertance from the geometry, or leave the gain out."
        )
