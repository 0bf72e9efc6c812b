"""What an identification found, as text for a terminal of 80 columns."""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import floor, log10
from textwrap import wrap

from inerter.figures.labels import measured
from inerter.identification.fit import Comparison, Told
from inerter.report.identified_values import elements_block, single, value_and_interval
from inerter.report.text import WIDTH
from inerter.study.identification_run import Candidate, Identified, Reading, model_title

INDEPENDENT = 1e-3  # a p-value above tells residuals without pattern
# What the library calls by the names of Python's arguments, in the words of the command line.
_AS_OPTIONS = (
    (r"units=\{'(\w+)': '([^']+)'\}", r'--unit "\1=\2"'),
    (r"\bforce=(?=['\d])", "--force-channel "),
    (r"\bgaps='(\w+)'", r"--gaps \1"),
    (r"\binterval=1e-3(?: in s)?", '--interval "1 ms"'),
    (r"\binterval=([\d.e-]+)", r'--interval "\1 s"'),
    (r"\binterval=", "--interval"),
    (r"\b(time|displacement)=(?=['\d])", r"--\1 "),
    (r"resample\(record\)", '--resample, such as --resample "1 ms"'),
    (r"remove_offset\(record\)|detrend\(record\)", "detrend = true in [record] of a --config"),
    (r" Use reverse_force\(record\)\.", ""),
    (r"fill_gaps\(record, longest\)", "--resample"),
    (r"\btrim\b(?=[ .])", "--trim"),
)


def as_options(sentence: str) -> str:
    """A sentence of the library with the options of the command line in the place of Python's arguments.

    >>> as_options("Name the unit, units={'force': 'N'}, or give interval=1e-3 in s.")
    'Name the unit, --unit "force=N", or give --interval "1 ms".'
    """
    for pattern, replacement in _AS_OPTIONS:
        sentence = re.sub(pattern, replacement, sentence)
    return sentence


def identification_text(found: Identified) -> str:
    """Records, estimates, what cannot be told, goodness, the next experiment and the elements: ASCII, 80 columns."""
    blocks = (
        _records(found),
        _candidates(found),
        _estimates(found),
        _untold(found),
        _goodness(found),
        _next(found),
        iter(elements_block(found).splitlines()),
        iter(wrap(f"Status: {found.fit.status}", WIDTH)),
    )
    text = "\n\n".join("\n".join(block) for block in map(list, blocks) if block)
    return text.encode("ascii", "replace").decode()


def about(reading: Reading) -> str:
    """Samples, length and rate of a record."""
    record = reading.used
    return f"{record.time.size} samples over {record.duration:.6g} s at {1.0 / record.interval:.6g} Hz"


def done(found: Identified, reading: Reading, comparison: Comparison) -> Iterator[str]:
    """What was done to a record, in sentences."""
    yield from reading.used.notes
    yield from (note for note in comparison.record.notes if note not in reading.used.notes)
    motion = comparison.experiment.motion
    yield f"The displacement was smoothed to {motion.bandwidth:.4g} Hz; it shows motion up to {motion.highest:.4g} Hz."
    fitted, checked = int(comparison.fitted.sum()), int(comparison.checked.sum())
    left = reading.used.time.size - fitted - checked
    lead = f", among them the first {single(comparison.lead, 's')}" if comparison.lead else ""
    unused = f"; {left} are left out{lead}" if left else ""
    yield f"Fitted were {fitted} samples, and {checked} kept to check the fit{unused}."


def _records(found: Identified) -> Iterator[str]:
    yield from wrap(f"{found.title}: {model_title(found)}", WIDTH)
    yield ""
    yield "records"
    for reading, comparison in zip(found.readings, found.fit.comparisons, strict=True):
        yield from wrap(f"  {reading.used.source}: {about(reading)}", WIDTH, subsequent_indent="    ")
        for sentence in done(found, reading, comparison):
            yield from wrap(sentence, WIDTH, initial_indent="    ", subsequent_indent="    ")
        for finding in reading.findings:
            if finding.severity == "warning":
                said = f"Warning: {as_options(finding.sentence)}"
                yield from wrap(said, WIDTH, initial_indent="    ", subsequent_indent="    ")


def _candidates(found: Identified) -> Iterator[str]:
    if not found.candidates:
        return
    width = max(len(c.name) for c in found.candidates)
    yield f"{'models':<{width + 2}}  unknowns  loss on check  over the best"
    for c in found.candidates:
        mark = "*" if c.name == found.name else " "
        state = "" if c.status == "ok" else f"  {c.status.partition(':')[0]}"
        yield f"{mark} {c.name:<{width}}  {c.unknowns:>8}  {c.loss:>13.4g}  {behind(c)}{state}"
    for sentence in found.choice:
        yield from wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="  ")


def behind(candidate: Candidate) -> str:
    """How much worse a model predicts than the best one, with the standard error of that."""
    if candidate.behind == 0.0:
        return "best"
    known = measured(candidate.behind, candidate.error)
    return f"{known}, as good" if candidate.as_good else known


def _estimates(found: Identified) -> Iterator[str]:
    rows = [(name, *value_and_interval(found, name)) for name in found.fit.parameters]
    names, values = (max(len(row[i]) for row in [("estimat", "value"), *rows]) for i in (0, 1))
    yield f"{'estimates':<{names + 2}}  {'value':<{values}}  interval of 95 %"
    for name, value, interval in rows:
        yield f"  {name:<{names}}  {value:<{values}}  {interval}".rstrip()
    for c in found.fit.comparisons:
        of = f" of {c.record.source}" if len(found.fit.comparisons) > 1 else ""
        yield from wrap(f"  Offset of the load cell{of}: {single(c.offset, 'N')}", WIDTH, subsequent_indent="    ")


def _untold(found: Identified) -> Iterator[str]:
    said = [told.sentence for told in found.fit.identifiable.values() if not plainly(told)]
    if said:
        yield "what the records do not tell"
    for sentence in said:
        yield from wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="    ")


def plainly(told: Told) -> bool:
    """Whether a parameter is told, and nothing needs saying about it."""
    return bool(told) and told.sentence.endswith(": told.")


def _goodness(found: Identified) -> Iterator[str]:
    yield "goodness"
    for c in found.fit.comparisons:
        yield f"  {c.record.source}"
        yield f"    fitted   {share(c.explained())} explained, residual {single(c.rms(), 'N')} r.m.s."
        if c.checked.any():
            explained = f"{share(c.explained(True))} explained"
            yield f"    checked  {explained}, residual {single(c.rms(True), 'N')} r.m.s."
        yield from wrap(whiteness(c), WIDTH, initial_indent="    ", subsequent_indent="    ")


def share(explained: float) -> str:
    """A part of the variance in per cent, with two digits of what is missing to all of it.

    >>> share(0.99998)
    '99.9980 %'
    """
    missing = 100.0 * (1.0 - explained)
    decimals = min(max(1 - floor(log10(missing)), 1), 5) if 0.0 < missing < 100.0 else 1
    return f"{100.0 * explained:.{decimals}f} %"


def whiteness(comparison: Comparison) -> str:
    """What the test of the residuals says."""
    p = comparison.whiteness
    if p >= INDEPENDENT:
        return f"What is left has no pattern in time once whitened (p = {p:.2g})."
    return (
        f"What is left hangs together in time even when whitened (p = {p:.1g}): the model lacks something, or an error "
        f"of the sensors. Intervals are widened for it."
    )


def _next(found: Identified) -> Iterator[str]:
    if found.fit.next_experiment:
        yield "next experiment"
    for sentence in found.fit.next_experiment:
        yield from wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="    ")
