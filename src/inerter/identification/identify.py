"""`identify`: from measured records to the parameters of a device, with honest uncertainty."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

from inerter.checks import is_number
from inerter.errors import IdentificationError
from inerter.identification import hypotheses
from inerter.identification.concluding import fit_of
from inerter.identification.fit import Fit
from inerter.identification.given import checked_records, model_of
from inerter.identification.models import mounted
from inerter.identification.search import POINTS
from inerter.identification.solving import Request, Solution, part, solve
from inerter.networks.elements import Network
from inerter.networks.elements.roles import Linear
from inerter.optimisation.threads import one_blas_thread
from inerter.records.record import Record
from inerter.vehicle.rig import Rig

_SOLVED = 0.8  # of the work, before explanations are looked for


def identify(
    records: Record | Sequence[Record],
    model: Network | str,
    *,
    seed: int = 0,
    offset: bool = True,
    gain: bool = False,
    delay: bool | float | None = None,
    check: float = 0.2,
    bandwidth: float | None = None,
    lead: float | None = None,
    starts: int = POINTS,
    progress: Callable[[float], None] | None = None,
) -> Fit:
    """Fit the free values of `model`, the device on the rig, to the force of one record or several together.

    `model` is a network with free values, or the name of one of `inerter.identification.models.MODELS`.

    The model is moved as the record's displacement was, smoothed below `bandwidth` [Hz] (by default as far as it
    stands out of its noise), and its force compared; no measured motion is differentiated twice. Sensors may have an
    `offset` of their own in each record, and one `gain` and one `delay` (up to a number of seconds) of the force in
    all; by default a delay is sought where the bandwidth of a load cell is not known, because that is what its filter
    does to slow forces. The last part `check` of each record is not fitted but kept to check the fit on; `lead` [s]
    at the start, or as much as the start of the device matters, are not compared either.

    `starts` points from a Sobol sequence with `seed`, and a first guess without simulation for devices that are a
    chain, are improved by least squares; errors are weighted and whitened by what errors like those of the sensors
    would leave; intervals are from profile likelihoods at 95 %, at least as wide as fits to records drawn anew
    scatter. A parameter that the records cannot tell has the value nan, with a sentence in `fit.identifiable`.

    Where more is left than the errors of the sensors (`fit.misfit`; those of the record where they are known, such as
    `Record.force_noise`), on the fitted part or on the check part, the status is not ok, `fit.explanations` names what
    may be wrong with the model or the sensors, and intervals are withheld, or hold what the explanations say. A mass
    between load cell and device, `Record.fixture_mass`, has to be known: it cannot be told from an inertance.
    See docs/identification.md.

    Raises `IdentificationError` for a model without free values or a request that cannot be, and `RecordError` for
    records that cannot be used.
    """
    asked = Request(offset, gain, delay, check, bandwidth, lead, starts, seed)
    fit = fit_of(solution_of(records, model_of(model), asked, part(progress, 0.0, _SOLVED)))
    if progress is not None:
        progress(1.0)
    return fit


def solution_of(
    records: Record | Sequence[Record], model: Network, asked: Request, progress: Callable[[float], None] | None
) -> Solution:
    """What `identify` finds, before anything is said of it."""
    given, rig = _checked(records, model, asked.check, asked.starts)
    sought = any(r.force_bandwidth is None for r in given) if asked.delay is None else asked.delay
    longest = hypotheses.LONGEST_DELAY if sought is True else float(sought)
    if not is_number(longest) or not 0.0 <= longest < 0.5 * min(r.duration for r in given):
        raise IdentificationError(f"A delay is True, False or its largest size in s, got {asked.delay!r}.")
    _check_gain(rig, asked.gain)
    assumed = [hypotheses.gain()] if asked.gain else []
    assumed += [hypotheses.delay(longest)] if longest > 0.0 else []
    with one_blas_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", category=RuntimeWarning)
        return solve(given, rig, tuple(assumed), asked, progress)


def _checked(records: Record | Sequence[Record], model: Network, check: float, starts: int) -> tuple[list[Record], Rig]:
    given = checked_records(records)
    rig = Rig(mounted(model))
    if not rig.free_values():
        raise IdentificationError(
            "The model has no free values: there is nothing to identify. Write Spring(free(1e5, 1e7, name='ks')), ..."
        )
    if not is_number(check) or not 0.0 <= check <= 0.6:
        raise IdentificationError(f"The part kept for the check is a fraction from 0 to 0.6, got {check!r}.")
    if isinstance(starts, bool) or not isinstance(starts, int) or starts < 8:
        raise IdentificationError(f"The number of starts is a whole number from 8 on, got {starts!r}.")
    return given, rig


def _check_gain(rig: Rig, gain: bool) -> None:
    """A gain of the load cell and the size of every element are one and the same, unless one of them is known."""
    known = [e for e in rig.device.elements() if e.linear is not Linear.CLOSED and is_number(e.value)]
    if gain and not known:
        raise IdentificationError(
            "A gain of the load cell cannot be told from larger springs, dampers, inerters and frictions: fix one of "
            "them, such as the inertance from the geometry, or leave the gain out."
        )
