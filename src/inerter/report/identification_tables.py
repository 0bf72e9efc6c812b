"""Tables of an identification result, for its page and its text."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, isnan, log10

from inerter.files.identification.running import IdentificationResult
from inerter.formatting import (
    choose_scale,
    format_decimals,
    format_number,
    format_quantity,
    format_range,
    format_share,
    format_uncertain,
)
from inerter.identification.choice import Candidate
from inerter.identification.fit import Explanation
from inerter.report.identified_values import value_and_interval
from inerter.report.options import as_options
from inerter.table import Cell, Column, Row, Table, cells, columns

_LITTLE, _MOST_EXPLANATIONS = 0.25, 3  # of the misfit: what explains less is not shown, nor are more


def parameter_table(found: IdentificationResult) -> Table:
    """Identified values with their 95 % intervals, standard errors and bounds of the search."""
    rows = []
    for name, p in found.fit.parameters.items():
        value, interval = value_and_interval(found, name)
        bounds = found.bounds(name)
        sought = "" if bounds is None else format_range(*bounds, p.unit, 3)
        error = _standard_error(p.standard_error, p.best, p.unit) if found.fit.identifiable[name] else ""
        rows.append(Row(cells(name, value, interval, error, sought)))
    interval = "95 % interval" if found.explains else "Range"
    on_pages = (Column(heading, only_on_pages=True) for heading in ("Standard error", "Sought in"))
    return Table("Estimates", [*columns("Parameter", "Value", interval), *on_pages], rows)


def _standard_error(error: float, value: float, unit: str) -> str:
    """Standard error with two digits, in the unit of the value."""
    scale = choose_scale([value], unit)
    return f"{_two_digits(error * scale.factor)} {scale.unit}".rstrip()


def _two_digits(error: float) -> str:
    """A standard error, with a zero where that is its second digit.

    >>> _two_digits(0.0102), _two_digits(12.3), _two_digits(4321.0)
    ('0.010', '12', '4300')
    """
    places = 1 - floor(log10(error)) if error > 0.0 else 0
    return format_decimals(error, places) if 1e-4 < error < 99.0 else format_number(error, 2)


def correlation_table(found: IdentificationResult) -> Table:
    """Correlations of the estimates."""
    names = list(found.fit.parameters)
    rows = [
        Row([Cell(name), *(Cell(None if isnan(value) else format_decimals(value, 2, "+")) for value in row)])
        for name, row in zip(names, found.fit.correlation.tolist(), strict=True)
    ]
    return Table("Correlations of the estimates", columns("Parameter", *names), rows)


def candidate_table(found: IdentificationResult) -> Table:
    """Models compared by their loss on the part of the records that was kept for the check."""
    rows = []
    for c in found.candidates:
        chosen = c.name == found.name
        name, loss = f"{c.name} (chosen)" if chosen else c.name, format_number(c.loss, 4)
        rows.append(Row(cells(name, c.unknowns, loss, _loss_difference(c), str(c.status.kind)), strong=chosen))
    return Table("Models", columns("Model", "Unknowns", "Loss on check", "Over the best", "Status"), rows)


def _loss_difference(candidate: Candidate) -> str:
    """Validation loss of a model above that of the best one, with its standard error."""
    if candidate.behind == 0.0:
        return "best"
    known = format_uncertain(candidate.behind, candidate.error)
    return f"{known}, as good" if candidate.as_good else known


def goodness_table(found: IdentificationResult) -> Table:
    """Residual of the model for each record, in the fitted part and in the validation data."""
    heads = ("Record", "Part", "Samples", "Explained", "Residual, r.m.s.", "Sensor noise", "Offset of the load cell")
    rows = []
    for c in found.fit.comparisons:
        for check, mask in ((False, c.fitted), (True, c.checked)):
            if mask.any():
                explained = format_variance_share(c.variance_explained(check))
                sizes = format_quantity(c.rms(check), "N", 3), format_quantity(c.noise_level(check), "N", 3)
                offset = None if check else format_quantity(c.offset, "N", 3)
                part = "check" if check else "fitted"
                rows.append(Row(cells(c.record.source, part, int(mask.sum()), explained, *sizes, offset)))
    return Table("Fit of each record", columns(*heads), rows)


def format_variance_share(explained: float) -> str:
    """Share of the variance [%] as text, with two digits of its difference from 100 %.

    >>> format_variance_share(0.99998)
    '99.9980 %'
    """
    missing = 100.0 * (1.0 - explained)
    decimals = min(max(1 - floor(log10(missing)), 1), 5) if 0.0 < missing < 100.0 else 1
    return f"{format_decimals(100.0 * explained, decimals)} %"


def likely_explanations(found: IdentificationResult) -> list[Explanation]:
    """The first few hypotheses that explain a good part of the misfit, most likely first."""
    return [e for e in found.fit.explanations if e.explained >= _LITTLE][:_MOST_EXPLANATIONS]


def cause_texts(found: IdentificationResult) -> Iterator[tuple[str, str, str, str]]:
    """Possible causes of the residual, most likely first: sentence, share explained, estimates with it, and remedy."""
    units = {name: p.unit for name, p in found.fit.parameters.items()}
    for e in likely_explanations(found):
        values = ", ".join(
            f"{name} {format_quantity(value, units[name])} +- {format_quantity(error, units[name], 2)}"
            for name, (value, error) in e.estimates.items()
            if name in units and e.misfit.is_noise_limited
        )
        yield e.sentence, format_share(e.explained, 2), values, as_options(e.name.remedy(e.details))
