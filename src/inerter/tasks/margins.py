"""Margins of one design against the baseline: break-even values, other speeds, and tolerances.

Each is computed by a method that models what it is about; where the given one does not, another one is chosen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, nan

from inerter.decision.of_study import nonlinear_elements
from inerter.decision.results import Improvement
from inerter.errors import MechanismError, StatusKind
from inerter.files.study.conditions import MOST_LISTED
from inerter.files.study.parts import FAILURES
from inerter.files.study.speeds import BESIDE, estimate_at_speed, is_at_one_speed, quick_method
from inerter.files.study.study import Study, elements_used
from inerter.formatting import (
    capital,
    format_decimals,
    format_list,
    format_percent_size,
    format_quantity,
    format_share,
)
from inerter.indices.names import title_with_name
from inerter.methods.compare import compare_estimates
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import evaluate
from inerter.methods.registry import brief_words_of, is_blind, methods_that, refuses_gaps, simulating_method
from inerter.methods.ties import percent_below
from inerter.network_search.real_inerters import RealInerter
from inerter.networks.elements import Damper, Element, Friction, Gap, Inerter, Network, Series, Spring
from inerter.networks.elements.algebra import CombinedNetwork
from inerter.optimisation.budget import BreakEven, better_clause
from inerter.statements import Severity
from inerter.systems.piecewise import piecewise
from inerter.tasks.budgets import element_break_even, known_numbers, range_text
from inerter.uncertainty.tolerance import tolerance_analysis
from inerter.validation import number_or_none
from inerter.vehicle.replace_values import with_elements
from inerter.vehicle.vehicle import Vehicle

USUAL: Mapping[type[Element], float] = {Damper: 0.2}  # relative tolerances where a study gives none, by kind of element
_USUAL = 0.1  # of all other kinds
SHARES = (0.05, 0.5, 0.95)  # of the sample, of the quantiles that are told
_SAMPLES, _FEW = 1024, 256  # of the sample, by a method with compiled code, and by one that linearises
_IMPACT = (
    "{} has no break-even value without an elastic shaft: with inertia on both sides, each closing of the gap "
    "would be an impact. Put the spring of the shaft in series with the inerter."
)
Progress = Callable[[int, int, str], object]


@dataclass(frozen=True)
class MarginRequest:
    """Design and baseline whose margins are computed, the index, and the method of the decision."""

    study: Study
    layout: str
    design: Vehicle
    baseline_layout: str
    baseline: Vehicle
    index: str
    method: str
    threads: int = 1

    @property
    def words(self) -> str:
        """Index in words."""
        return title_with_name(self.study.index(self.index).title, self.index)


@dataclass(frozen=True)
class ConditionMargin:
    """Break-even value [SI] in one operating condition, None if there is none; `text` is its range, or why."""

    name: str
    value: float | None
    status: str
    text: str


@dataclass(frozen=True, kw_only=True)
class BreakEvenMargin:
    """Break-even value of one element [SI], None if there is none; `is_present` is False for one of a real inerter."""

    parameter: str
    is_present: bool
    unit: str
    method: str
    value: float | None = None
    standard_error: float | None = None
    interval: tuple[float, float] | None = None
    error_bound: float | None = None
    in_conditions: list[ConditionMargin] = field(default_factory=list)
    status: str
    message: str
    short: str = ""  # "f up to 414 +- 18 N", "friction up to 390 +- 17 N" of one of a real inerter
    sentence: str


@dataclass(frozen=True)
class SpeedMargin:
    """Improvement over the baseline at `factor` times the speed of the study [%]; `short` is the speed in words."""

    factor: float
    speed: float
    short: str
    method: str
    improvement_percent: float | None
    improvement_error_percent: float | None  # its standard error, None if nothing is simulated
    status: str
    message: str


@dataclass(frozen=True)
class ScatterMargin:
    """Distribution of the index under tolerances; `worst_percent` is the worst value above the nominal one [%]."""

    index: str
    unit: str
    method: str
    spread: Mapping[str, float]
    is_assumed: bool
    nominal: float
    worst: float
    worst_percent: float
    worst_improvement_percent: float
    quantiles: Mapping[str, float]
    status: str
    message: str
    sentence: str


@dataclass(frozen=True)
class MarginCaveat:
    """Caveat of the margins."""

    sentence: str
    severity: str = Severity.WARNING.value


@dataclass(frozen=True)
class Margins:
    """Margins of a design against the baseline."""

    layout: str
    index: str
    break_even: list[BreakEvenMargin] = field(default_factory=list)
    speeds: list[SpeedMargin] = field(default_factory=list)
    scatter: ScatterMargin | None = None
    caveats: list[MarginCaveat] = field(default_factory=list)


@dataclass(frozen=True)
class _Trial:
    """Element whose break-even value is computed, in a design that has it."""

    parameter: str  # its label
    words: str
    brief: str
    design: Vehicle
    is_present: bool

    @property
    def element(self) -> Element:
        """The element, or the first of several with its label."""
        return next(one for one in self.design.mechanism().strut_elements() if one.label == self.parameter)

    @property
    def side(self) -> str:
        """Words after a value of the element: that of a gap is half of the backlash."""
        return " to each side" if isinstance(self.element, Gap) else ""


def margins(asked: MarginRequest, tell: Progress = lambda done, total, what: None) -> Margins:
    """Margins of a design: each friction, gap and compliance that it has or a real inerter has, speeds, tolerances."""
    trials = list(_trials(asked))
    caveats = [] if trials else [MarginCaveat(f"{asked.layout} has no inerter, friction or gap.", Severity.INFO.value)]
    found = []
    for done, trial in enumerate(trials):
        tell(done, len(trials) + 2, trial.words)
        if _closes_on_inertia(trial):
            caveats.append(MarginCaveat(_IMPACT.format(capital(trial.words)), Severity.INFO.value))
        else:
            found.append(_break_even(asked, trial))
    tell(len(trials), len(trials) + 2, "other speeds")
    speeds = list(_speeds(asked))
    tell(len(trials) + 1, len(trials) + 2, "tolerances")
    scatter, left_out = _scatter(asked)
    caveats += [*_speed_caveats(asked, speeds), *left_out]
    return Margins(asked.layout, asked.index, found, speeds, scatter, caveats)


def _closes_on_inertia(trial: _Trial) -> bool:
    """Whether a gap that the design does not have would have inertia on both sides: a spring in series mends that."""
    if trial.is_present or not isinstance(trial.element, Gap):
        return False

    def is_defined(real: Network) -> bool:
        design = with_elements(trial.design, lambda part: real if part.label == trial.parameter else part)
        try:
            piecewise(design.mechanism())
        except MechanismError:
            return False
        return True

    gap = trial.element.with_value(1.0)
    return not is_defined(gap) and is_defined(gap - Spring(RealInerter().stiffness))


def method_that_models(asked: MarginRequest, design: Vehicle, *, gaps: bool) -> str:
    """Method of the decision if it models friction (and `gaps`); else a quick one that does, or one that simulates."""
    has_gaps = gaps or any(part.acts and _needs_simulation(part) for part in design.mechanism().strut_elements())
    known = [asked.method, *asked.study.evaluate, *methods_that(lambda name: not is_blind(name) and refuses_gaps(name))]
    suited = [name for name in known if not is_blind(name) and not (has_gaps and refuses_gaps(name))]
    return suited[0] if suited else simulating_method()


def _needs_simulation(element: Element) -> bool:
    """Whether no damper represents an element that switches, such as a gap, at any positive value."""
    return element.switch is not None and not (element if element.acts else element.with_value(1.0)).is_damped


def _trials(asked: MarginRequest) -> Iterator[_Trial]:
    """Elements whose break-even value is computed: those of the design first."""
    own = {element.label: element for element in asked.design.mechanism().strut_elements()}
    budgets = [n for n in asked.study.budgets if asked.layout in elements_used(asked.study).get(n, ())]
    compliant = {label for strut in asked.design.mechanism().struts for label in compliant_springs(strut.network)}
    labels = [label for label, e in own.items() if e.may_vanish or label in compliant or label in budgets]
    for label in labels:
        what = "stiffness" if label in compliant else own[label].key
        yield _Trial(label, what if label == what else f"{what} {label}", label, asked.design, is_present=True)
    present = {own[label].key for label in labels}
    inerters = [label for label, element in own.items() if isinstance(element, Inerter)]
    if not inerters:
        return
    real, of = RealInerter(), format_list(inerters)
    if Friction.key not in present:
        yield _hypothetical(asked, Friction(0.0), "friction", "inerter", of, lambda b, new: b | new)
    if not compliant:
        shaft, damping = Spring(real.stiffness), Damper(real.damping)
        yield _hypothetical(asked, shaft, "stiffness", "shaft", of, lambda b, new: (new | damping) - b)
    if Gap.key not in present:
        yield _hypothetical(asked, Gap(0.0), "backlash", "inerter", of, lambda b, new: new - b)


def _hypothetical(
    asked: MarginRequest,
    element: Element,
    what: str,
    place: str,
    inerters: str,
    join: Callable[[Element, Element], Network],
) -> _Trial:
    """Trial with an element of a real inerter, at its `place` there, joined to each inerter of the struts."""
    name, own = f"{place}_{what}", {one.label for one in asked.design.mechanism().strut_elements()}
    while name in own.union(one.label for one in asked.baseline.mechanism().elements()):
        name += "_"
    new = element.of(element.value, name)

    def change(part: Element) -> Network:
        return join(part, new) if isinstance(part, Inerter) and part.label in own else part

    of = f"inerter {inerters}" if place == "inerter" else f"the {place} of inerter {inerters}"
    return _Trial(name, f"{what} of {of}", what, with_elements(asked.design, change), is_present=False)


def compliant_springs(network: Network) -> set[str]:
    """Labels of springs, alone or with dampers, in series with an inerter."""
    if not isinstance(network, CombinedNetwork):
        return set()
    found = set[str]().union(*map(compliant_springs, network.parts))
    if isinstance(network, Series):
        kinds = [list(part.elements()) for part in network.parts]
        shafts = [part for part in kinds if all(isinstance(one, Spring | Damper) for one in part)]
        if any(isinstance(one, Inerter) for part in kinds for one in part):
            found |= {one.label for part in shafts for one in part if isinstance(one, Spring)}
    return found


def _break_even(asked: MarginRequest, trial: _Trial) -> BreakEvenMargin:
    """Break-even value by a method that models the element; simulated where a quick one that was chosen is not sure."""
    method, element = asked.method, trial.element
    if element.switch is not None:
        method = method_that_models(asked, trial.design, gaps=_needs_simulation(element))
    found = _break_even_by(asked, trial, method)
    if found.status == StatusKind.INACCURATE and method != asked.method and refuses_gaps(method):
        found = _break_even_by(asked, trial, simulating_method())
    return found


def _break_even_by(asked: MarginRequest, trial: _Trial, method: str) -> BreakEvenMargin:
    study, element = asked.study, trial.element
    try:
        found = _find_break_even(asked, trial, method, study.over_conditions(asked.index))
    except FAILURES as error:
        message = str(error).rstrip(".")
        sentence = f"{capital(trial.words)}: break-even value not computed ({message})."
        return BreakEvenMargin(
            parameter=trial.parameter,
            is_present=trial.is_present,
            unit=element.unit,
            method=method,
            status=StatusKind.FAILED.value,
            message=message,
            sentence=sentence,
        )
    known, short, message = isfinite(found.value), "", found.status.message
    who = f"{asked.layout} is better than {asked.baseline_layout}"
    each = _in_conditions(asked, trial, method)
    conditions = "".join(f"; in condition {one.name} {one.text}" for one in each)
    if found.status.kind is StatusKind.UNBOUNDED:
        message = better_clause(found.ranges, trial.brief, found.unit)
    if known:
        end = _end_of_range(trial, found)
        short = f"{trial.brief} {end}"
        by = brief_words_of(method)
        sentence = f"{capital(trial.words)}: {who} {end} in {asked.words}, by {by}{conditions}."
    elif found.status.kind is StatusKind.UNBOUNDED:
        clause = better_clause(found.ranges, trial.brief, found.unit, who)
        sentence = f"{capital(trial.words)}: {clause}{trial.side}{conditions}."
    else:
        sentence = f"{capital(trial.words)}: {message.rstrip('.')}{conditions}."
    is_sure = found.status.severity is Severity.INFO
    doubt = f" Not certain: {message.rstrip('.')}." if known and not is_sure else ""
    return BreakEvenMargin(
        parameter=trial.parameter,
        is_present=trial.is_present,
        unit=found.unit,
        method=method,
        **known_numbers(found),
        in_conditions=each,
        status=found.status.kind.value,
        message=message,
        short=short,
        sentence=f"{sentence}{doubt}",
    )


def _find_break_even(asked: MarginRequest, trial: _Trial, method: str, index: IndexLike) -> BreakEven:
    by = asked.study.method(method, asked.threads)
    return element_break_even(trial.design, asked.baseline, index, trial.parameter, by)


def _end_of_range(trial: _Trial, found: BreakEven) -> str:
    ends = [crossing.value for crossing in found.crossings]
    errors = found.standard_error, found.error_bound
    return range_text(found.value, found.unit, *errors, ends, at_most=trial.element.may_vanish) + trial.side


def _in_conditions(asked: MarginRequest, trial: _Trial, method: str) -> list[ConditionMargin]:
    """Break-even value in each of several conditions of the study; none of many, each of which takes its time."""
    study = asked.study
    if not 1 < len(study.conditions) <= MOST_LISTED:
        return []
    each = []
    for name, index in zip(study.condition_labels, study.in_each(study.index(asked.index)), strict=True):
        try:
            found = _find_break_even(asked, trial, method, index)
        except FAILURES as error:
            each.append(
                ConditionMargin(name, None, StatusKind.FAILED.value, f"not computed ({str(error).rstrip('.')})")
            )
            continue
        if isfinite(found.value):
            doubt = (
                "" if found.status.severity is Severity.INFO else f" (not certain: {found.status.message.rstrip('.')})"
            )
            each.append(
                ConditionMargin(name, found.value, found.status.kind.value, _end_of_range(trial, found) + doubt)
            )
        else:
            unbounded = found.status.kind is StatusKind.UNBOUNDED
            why = better_clause(found.ranges, trial.brief, found.unit, "") if unbounded else found.status.message
            each.append(ConditionMargin(name, None, found.status.kind.value, why.strip().rstrip(".")))
    return each


def _speeds(asked: MarginRequest) -> Iterator[SpeedMargin]:
    """Improvements at other speeds; none where speed is not a property of the study."""
    study = asked.study
    if not is_at_one_speed(study) or not study.needs_road(asked.index) or study.road is None:
        return
    method = _quick_method(asked, has_friction=any(part.acts for part in asked.design.mechanism().strut_elements()))
    for factor in BESIDE:
        if factor != 1.0:
            yield _speed(asked, method, factor)


def _speed(asked: MarginRequest, method: str, factor: float) -> SpeedMargin:
    """Improvement at another speed, by the method of the decision where a quick one is not sure."""
    ends = [
        estimate_at_speed(asked.study, vehicle, (layout, asked.index, method), factor)
        for layout, vehicle in ((asked.layout, asked.design), (asked.baseline_layout, asked.baseline))
    ]
    (own, first), (base, second) = ends
    message = "; ".join(dict.fromkeys(filter(None, (first, second))))
    if message and method != asked.method and not is_blind(asked.method):
        return _speed(asked, asked.method, factor)
    two = None if own is None or base is None else compare_estimates(own, base)
    percent, error = (None, None) if two is None else (number_or_none(-two.percent), number_or_none(two.percent_error))
    kind = StatusKind.FAILED if percent is None else StatusKind.INACCURATE if message else StatusKind.OK
    assert asked.study.road is not None
    speed = factor * asked.study.road.speed
    short = f"{format_quantity(3.6 * speed, 'km/h')} ({format_decimals(100.0 * (factor - 1.0), 0, '+')} %)"
    return SpeedMargin(factor, speed, short, method, percent, error, kind.value, message)


def _speed_caveats(asked: MarginRequest, speeds: Sequence[SpeedMargin]) -> Iterator[MarginCaveat]:
    study = asked.study
    if not speeds and study.needs_road(asked.index):
        yield MarginCaveat(
            "The improvement at other speeds is not computed: the study has several speeds, or a quantile.",
            Severity.INFO.value,
        )
    for one in speeds:
        if one.message:
            yield MarginCaveat(f"The improvement at {one.short} is unreliable: {one.message.rstrip('.')}.")
        elif one.improvement_percent is not None and one.improvement_percent < 0.0:
            worse = Improvement(one.improvement_percent).words
            yield MarginCaveat(
                f"At {one.short} {asked.layout} is {worse} than {asked.baseline_layout} in {asked.words}."
            )
    _, neglected = nonlinear_elements(asked.design.mechanism(), speeds[0].method if speeds else asked.method)
    if speeds and neglected:
        yield MarginCaveat(f"Other speeds: {format_list(neglected)} neglected by {brief_words_of(speeds[0].method)}.")


def _scatter(asked: MarginRequest) -> tuple[ScatterMargin | None, list[MarginCaveat]]:
    """Distribution under the tolerances of the study, or assumed ones, and caveats."""
    given = asked.study.spread(asked.layout)
    spread = dict(given) or usual_tolerances(asked.design)
    own = {element.label: element for element in asked.design.mechanism().strut_elements()}
    gaps = [name for name in spread if name in own and own[name].acts and _needs_simulation(own[name])]
    caveats = []
    if gaps:  # a sample of simulations takes too long for a panel
        spread = {name: part for name, part in spread.items() if name not in gaps}
        caveats.append(
            MarginCaveat(f"The tolerance of {format_list(gaps)} is not included, since only simulation models it.")
        )
    if not spread:
        return None, caveats
    has_friction = any(name in own and own[name].acts for name in spread)
    method = _quick_method(asked, has_friction=has_friction)
    try:
        return _analyse(asked, spread, method, is_assumed=not given), caveats
    except FAILURES as error:
        return None, [*caveats, MarginCaveat(f"Tolerances are not analysed: {str(error).rstrip('.')}.")]


def _quick_method(asked: MarginRequest, *, has_friction: bool) -> str:
    """Method without random roads: one that models the friction of the design where that matters, if it can."""
    method = asked.method if not has_friction else method_that_models(asked, asked.design, gaps=False)
    return quick_method(replace(asked.study, evaluate=(method,)), asked.design)


def usual_tolerances(design: Vehicle) -> dict[str, float]:
    """Tolerances that are assumed where a study gives none: 20 % of dampings, 10 % of all other values."""
    return {
        element.label: USUAL.get(type(element), _USUAL)
        for element in design.mechanism().strut_elements()
        if element.value
    }


def _analyse(asked: MarginRequest, spread: Mapping[str, float], method: str, *, is_assumed: bool) -> ScatterMargin:
    study = asked.study
    index, by = study.over_conditions(asked.index), study.method(method)
    found = tolerance_analysis(
        asked.design,
        index,
        by,
        spread=spread,
        samples=_SAMPLES if is_blind(method) else _FEW,
        seed=study.seed,
    )
    base = evaluate(asked.baseline, index, by).value
    nominal = found.nominal.value
    status = found.status
    made = ScatterMargin(
        index=asked.index,
        unit=study.unit(asked.index),
        method=method,
        spread=spread,
        is_assumed=is_assumed,
        nominal=nominal,
        worst=found.worst,
        worst_percent=100.0 * (found.worst / nominal - 1.0) if nominal else nan,
        worst_improvement_percent=percent_below(found.worst, base),
        quantiles={str(share): found.quantile(share) for share in SHARES},
        status=status.kind.value,
        message=status.message,
        sentence="",
    )
    return replace(made, sentence=_scatter_sentence(asked, made, found.nominal.error_bound))


def _scatter_sentence(asked: MarginRequest, found: ScatterMargin, bound: float) -> str:
    """Sentence on the worst case and the 95th percentile, compared with the baseline at its nominal values.

    `bound` is the largest relative error of the values.
    """
    parts = format_list([f"{name} +- {format_share(part)}" for name, part in found.spread.items()])
    given = f"Tolerances {'(assumed, since the study has none) ' if found.is_assumed else ''}of {parts}"
    if not isfinite(found.worst):
        return f"{given}: the distribution of {asked.words} is not computed ({found.message.rstrip('.')})."
    quantile = format_quantity(found.quantiles[str(SHARES[-1])], found.unit, bound=bound)
    above = format_percent_size(found.worst_percent)
    versus = Improvement(found.worst_improvement_percent).than(asked.baseline_layout)
    doubt = f" Not certain: {found.message.rstrip('.')}." if found.status != StatusKind.OK else ""
    return (
        f"{given}: at worst {asked.words} of {asked.layout} is {above} above its nominal value, and {versus} at "
        f"nominal values; 95 % of designs are below {quantile}.{doubt}"
    )
