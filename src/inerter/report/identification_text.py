"""Identification result as text for a terminal of 80 columns."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap

from inerter.files.identification.running import IdentificationResult, Reading, model_title
from inerter.formatting import format_decimals, format_number, format_quantity
from inerter.identification.fit import RecordFit
from inerter.report.identification_tables import candidate_table, cause_texts, goodness_table, parameter_table
from inerter.report.identified_values import elements_block
from inerter.report.options import as_options
from inerter.report.text import WIDTH, table_lines
from inerter.statements import Severity, by_severity

INDEPENDENT = 1e-3  # a p-value above is that of residuals without pattern


def identification_text(found: IdentificationResult) -> str:
    """Reliability, records, estimates, goodness, the next experiment, elements.

    ASCII but for names and titles, 80 columns.
    """
    blocks = (
        _warning_lines(found),
        _record_lines(found),
        _candidate_lines(found),
        _estimate_lines(found),
        _identifiability_lines(found),
        _goodness_lines(found),
        _experiment_lines(found),
        iter(elements_block(found).splitlines()),
        iter(wrap(f"Status: {found.fit.status}", WIDTH)),
    )
    return "\n\n".join("\n".join(block) for block in map(list, blocks) if block)


def _warning_lines(found: IdentificationResult) -> Iterator[str]:
    """Warning of a wrong model or sensor, with possible causes, most likely first."""
    if found.fit.status.ok:
        return
    yield from wrap(f"Unreliable estimates: {unreliability_reason(found)}.", WIDTH)
    for place in found.fit.localisations:
        of = f" of {place.source}" if len(found.fit.localisations) > 1 else ""
        yield from wrap(f"Where{of}: {place.sentence}.", WIDTH)
    said = list(cause_texts(found))
    if said:
        yield ""
        yield "Possible causes, most likely first"
    for number, (sentence, share, values, remedy) in enumerate(said, 1):
        yield from wrap(
            f"{sentence}: explains {share}.",
            WIDTH,
            initial_indent=f"  {number}. ",
            subsequent_indent="     ",
        )
        for line in (f"With it {values}." if values else "", f"Remedy: {remedy}." if remedy else ""):
            yield from wrap(line, WIDTH, initial_indent="     ", subsequent_indent="       ", break_on_hyphens=False)


def unreliability_reason(found: IdentificationResult) -> str:
    """Reason why the estimates of a fit are unreliable; empty if they are reliable.

    Where no hypothesis accounts for the residual, the warnings about the records are named first.
    """
    status = found.fit.status
    if status.ok:
        return ""
    warned = [r.used.source for r in found.readings if Severity.WARNING in by_severity(r.findings)]
    doubt = found.fit.reliability_warning
    if not warned or doubt is None or doubt.numbers.get("likeliest") is not None:
        return status.message
    return f"{status.message}. Begin with the warning about {' and '.join(warned)} below, which may name the cause"


def misfit_sentence(found: IdentificationResult) -> str:
    """Sentence on the normalised residual: r.m.s. residual over sensor noise, of fitted and validation data."""
    m = found.fit.misfit
    sizes = {"fitted": m.fitted, "checked": m.checked}
    parts = [f"{format_decimals(size, 2)} ({part})" for part, size in sizes.items() if size == size]
    return f"Residual over the expected sensor noise: {' and '.join(parts)} (r.m.s., whitened)."


def sampling_summary(reading: Reading) -> str:
    """Samples, length and rate of a record."""
    record = reading.used
    duration, rate = format_number(record.duration), format_number(1.0 / record.interval)
    return f"{record.time.size} samples over {duration} s at {rate} Hz"


def processing_notes(reading: Reading, comparison: RecordFit) -> Iterator[str]:
    """Sentences on the processing of a record."""
    yield from reading.used.notes
    yield from comparison.record.notes[len(reading.used.notes) :]
    motion = comparison.experiment.motion
    smoothed, highest = format_quantity(motion.bandwidth, "Hz"), format_quantity(motion.highest, "Hz")
    yield f"The displacement was smoothed to {smoothed}; it shows motion up to {highest}."
    fitted, checked = int(comparison.fitted.sum()), int(comparison.checked.sum())
    left = reading.used.time.size - fitted - checked
    lead = f", among them the first {format_quantity(comparison.lead, 's', 3)}" if comparison.lead else ""
    unused = f"; {left} are left out{lead}" if left else ""
    yield f"{fitted} samples were fitted, and {checked} kept to check the fit{unused}."


def _record_lines(found: IdentificationResult) -> Iterator[str]:
    yield from wrap(f"{found.title}: {model_title(found)}", WIDTH)
    yield ""
    yield "Records"
    for reading, comparison in zip(found.readings, found.fit.comparisons, strict=True):
        yield from wrap(f"  {reading.used.source}: {sampling_summary(reading)}", WIDTH, subsequent_indent="    ")
        for sentence in processing_notes(reading, comparison):
            yield from wrap(sentence, WIDTH, initial_indent="    ", subsequent_indent="    ")
        for warning in by_severity(reading.findings).get(Severity.WARNING, ()):
            said = f"Warning: {as_options(warning.text)}"
            yield from wrap(said, WIDTH, initial_indent="    ", subsequent_indent="    ")


def _candidate_lines(found: IdentificationResult) -> Iterator[str]:
    if found.candidates:
        yield from table_lines(candidate_table(found))
    for finding in found.choice if found.candidates else ():
        yield from wrap(as_options(finding.text), WIDTH, initial_indent="  ", subsequent_indent="  ")


def _estimate_lines(found: IdentificationResult) -> Iterator[str]:
    yield from table_lines(parameter_table(found))
    for remark in limitation_sentences(found):
        yield from wrap(remark, WIDTH, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def limitation_sentences(found: IdentificationResult) -> Iterator[str]:
    """Sentences on limitations of the estimates."""
    yield from (as_options(finding.text) for finding in found.fit.findings)


def _identifiability_lines(found: IdentificationResult) -> Iterator[str]:
    said = [verdict.sentence for verdict in found.fit.identifiable.values() if not verdict.plain]
    if said:
        yield "Identifiability"
    for sentence in said:
        yield from wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="    ")


def _goodness_lines(found: IdentificationResult) -> Iterator[str]:
    yield from table_lines(goodness_table(found))
    for c in found.fit.comparisons:
        of = f"{c.record.source}: " if len(found.fit.comparisons) > 1 else ""
        yield from wrap(f"{of}{whiteness_sentence(c)}", WIDTH, initial_indent="  ", subsequent_indent="  ")
    yield from wrap(misfit_sentence(found), WIDTH, initial_indent="  ", subsequent_indent="  ")


def whiteness_sentence(comparison: RecordFit) -> str:
    """Sentence on the whiteness test of the residuals."""
    p = comparison.whiteness
    size = f"p = {format_number(p, 1)}" if p > 1e-16 else "p < 1e-16"
    if p >= INDEPENDENT:
        return f"The residual is no more autocorrelated than sensor noise (p = {format_number(p, 2)})."
    return (
        f"The residual is more autocorrelated than sensor noise ({size}): part of it is not noise. "
        f"Intervals are widened for it."
    )


def _experiment_lines(found: IdentificationResult) -> Iterator[str]:
    if found.fit.next_experiment:
        yield "Next experiment"
    for sentence in found.fit.next_experiment:
        yield from wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="    ")
