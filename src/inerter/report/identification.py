"""The report of an identification: numbers, residuals, figures and one HTML page that needs no other file."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from inerter.atomic_io import write_text
from inerter.figures.identification import draw
from inerter.files.common.folder import FIGURES, REPORT
from inerter.files.identification.loading import CUSTOM
from inerter.files.identification.running import FIT, RESIDUALS, IdentificationResult, responses
from inerter.formatting import format_decimals
from inerter.networks.parser import format_expression
from inerter.report.identification_data import identification_data, response_data, write_residuals
from inerter.report.identification_figures import figures
from inerter.report.identification_tables import (
    candidate_table,
    cause_texts,
    correlation_table,
    format_variance_share,
    goodness_table,
    parameter_table,
)
from inerter.report.identification_text import (
    limitation_sentences,
    misfit_sentence,
    processing_notes,
    sampling_summary,
    unreliability_reason,
    whiteness_sentence,
)
from inerter.report.identified_values import ResultKind, elements_block, result_kind, value_and_interval
from inerter.report.options import as_options
from inerter.report.page import PageFigure, environment, page_figures
from inerter.statements import Severity, by_severity
from inerter.work.origin import versions

RESPONSE = "response.json"
RESULT_NAMES = (FIT, RESIDUALS, RESPONSE, f"{FIGURES}/", REPORT)
_HEADINGS = {Severity.ERROR: "Errors", Severity.WARNING: "Warnings", Severity.INFO: "Good to know"}
_MOST_FIGURES = 5  # of one record, and two of all


@dataclass(frozen=True)
class RecordText:
    """Texts on a record: its processing, and its findings by severity."""

    source: str
    about: str
    done: list[str]
    findings: dict[str, list[str]]
    number: int


def write_fit(found: IdentificationResult, folder: Path) -> None:
    """Write the numbers and the residuals, which is what took time to find, into `folder`."""
    write_text(folder / FIT, json.dumps(identification_data(found), indent=2) + "\n")
    write_residuals(found, folder / RESIDUALS)


def write_identification(found: IdentificationResult, folder: Path, progress: Callable[[float], None]) -> None:
    """Write the frequency responses, the figures (SVG), and a page that shows all of it, into `folder`."""
    answered = responses(found)
    write_text(folder / RESPONSE, json.dumps(response_data(answered), indent=2) + "\n")
    drawn: dict[str, list[PageFigure]] = {}
    for count, figure in enumerate(figures(found, answered), 1):
        draw(figure.figure, folder / FIGURES, figure.name, print_too=False)
        drawn.setdefault(figure.section, []).extend(page_figures(folder / FIGURES, figure.name, figure.caption))
        progress(count / (_MOST_FIGURES * len(found.readings) + len(found.fit.localisations) + 2))
    write_text(folder / REPORT, identification_page(found, drawn, answered.notes))
    progress(1.0)


def identification_page(
    found: IdentificationResult, drawn: dict[str, list[PageFigure]], notes: tuple[str, ...] = ()
) -> str:
    """The page as text, with these figures by their section; `notes` are those of the frequency response."""
    fit = found.fit
    return (
        environment()
        .get_template("identification.html")
        .render(
            title=found.title,
            model="that of the configuration" if found.name == CUSTOM else found.name,
            layout=format_expression(found.model, [e.label for e in found.model.elements()]),
            status=unreliability_reason(found),
            headlines=list(_answers(found)),
            parameters=parameter_table(found),
            identified=[name for name, verdict in fit.identifiable.items() if verdict.plain],
            sentences=[verdict.sentence for verdict in fit.identifiable.values() if not verdict.plain],
            correlations=correlation_table(found) if len(fit.parameters) > 1 and found.explains else None,
            next_experiment=fit.next_experiment,
            elements=elements_block(found),
            records=list(_records(found)),
            goodness=goodness_table(found),
            whiteness=[(c.record.source, whiteness_sentence(c)) for c in fit.comparisons],
            misfit=misfit_sentence(found),
            remarks=list(limitation_sentences(found)),
            explanations=list(cause_texts(found)),
            places=[(place.source, place.sentence) for place in fit.localisations],
            candidates=candidate_table(found) if found.candidates else None,
            choice=[as_options(finding.text) for finding in found.choice],
            pictured=drawn,
            notes=notes,
            computation=_computation(found),
            versions=", ".join(f"{name} {version}" for name, version in versions().items()),
        )
    )


def _answers(found: IdentificationResult) -> Iterator[str]:
    for name in found.fit.parameters if found.explains else ():
        value, interval = value_and_interval(found, name)
        if result_kind(found, name) is not ResultKind.VALUE:
            yield f"{name} {value}: {interval}." if interval else f"{name} {value}."
        else:
            yield f"{name} = {value}, with 95 % confidence {interval}."
    parts = [c.variance_explained(bool(c.checked.any())) for c in found.fit.comparisons]
    where = "of the force that was kept for the check" if found.fit.comparisons[0].checked.any() else "of the force"
    yield f"The model explains {' and '.join(format_variance_share(part) for part in parts)} {where}."


def _records(found: IdentificationResult) -> Iterator[RecordText]:
    for number, (reading, comparison) in enumerate(zip(found.readings, found.fit.comparisons, strict=True)):
        yield RecordText(
            reading.used.source,
            sampling_summary(reading),
            list(processing_notes(reading, comparison)),
            {
                _HEADINGS[severity]: [as_options(finding.text) for finding in group]
                for severity, group in by_severity(reading.findings).items()
            },
            number,
        )


def _computation(found: IdentificationResult) -> str:
    fit = found.fit
    settings = ", ".join(f"{name} {value}" for name, value in {**fit.settings, **found.settings}.items())
    ended = f"{len(fit.costs)} different fits" if len(fit.costs) > 1 else "one and the same fit"
    starts = f" On half of the records the best starts came to {ended}."
    return (
        f"The model was moved as the displacement was, smoothed, and its force compared with the measured one; no "
        f"measured motion was differentiated twice. Least squares from many starts, with residuals weighted and "
        f"whitened; {fit.simulations} simulations.{starts} Intervals of 95 % are from profile likelihoods and "
        f"from a parametric bootstrap. Settings: {settings}. Schwarz's criterion (lower is better): "
        f"{format_decimals(fit.criterion, 1)}."
    )
