"""Identification result as data for JSON and as a table of residuals, in SI units."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from inerter.atomic_io import atomic_write
from inerter.files.identification.running import IdentificationResult, Reading, Responses
from inerter.identification.fit import RecordFit
from inerter.networks.parser import format_expression
from inerter.records.result import Response
from inerter.records.uncertain import Uncertain
from inerter.report.identified_values import elements_block
from inerter.report.json_data import json_data
from inerter.work.origin import versions


def identification_data(found: IdentificationResult) -> dict[str, Any]:
    """All numbers of a fit but its residuals; infinite ones are text, those that are not identifiable null."""
    fit = found.fit
    data = {
        "title": found.title,
        "model": found.name,
        "layout": format_expression(found.model, [e.label for e in found.model.elements()]),
        "status": str(fit.status),
        "doubt": None if fit.reliability_warning is None else str(fit.reliability_warning.kind),
        "explained": fit.variance_explained,
        "parameters": {
            name: {
                "value": p.value,
                "unit": p.unit,
                "interval": p.interval,
                "best": p.best,
                "standard_error": p.standard_error,
                "bounds": found.bounds(name),
                "identified": bool(fit.identifiable[name]),
                "verdict": fit.identifiable[name].verdict,
                "told": bool(fit.identifiable[name]),  # the old name of "identified", for this version
                "sentence": fit.identifiable[name].sentence,
                "profile": p.profile,
            }
            for name, p in fit.parameters.items()
        },
        "correlation": fit.correlation.tolist(),
        "covariance": fit.covariance.tolist(),
        "records": [_record(r, c) for r, c in zip(found.readings, fit.comparisons, strict=True)],
        "next_experiment": fit.next_experiment,
        "advice": [{"parameter": f.about, "kind": f.kind, **f.numbers} for f in fit.suggestions],
        "notes": fit.notes,
        "criterion": fit.criterion,
        "costs": fit.costs,
        "simulations": fit.simulations,
        "predicted": fit.predicted,
        "misfit": vars(fit.misfit),
        "explanations": [
            {**vars(e), "misfit": vars(e.misfit), "sentence": e.sentence, "remedy": e.remedy} for e in fit.explanations
        ],
        "localisations": [
            {
                "source": place.source,
                "sentence": place.sentence,
                "changes": place.changes,
                "patterns": [{**vars(pattern), "sentence": pattern.sentence} for pattern in place.patterns],
            }
            for place in fit.localisations
        ],
        "candidates": [{**vars(c), "status": str(c.status)} for c in found.candidates],
        "choice": [finding.sentence for finding in found.choice],
        "settings": {
            n: str(v) if isinstance(v, Uncertain) else v for n, v in {**found.settings, **fit.settings}.items()
        },
        "elements": elements_block(found),
        "versions": versions(),
    }
    plain: dict[str, Any] = json_data(data)
    return plain


def response_data(found: Responses) -> dict[str, Any]:
    """The frequency responses: measured, and of the model at the same frequencies."""
    curves = {"measured": found.measured, "model": found.model}
    data = {name: _response(curve) for name, curve in curves.items() if curve is not None}
    plain: dict[str, Any] = json_data({**data, "notes": found.notes})
    return plain


def write_residuals(found: IdentificationResult, path: Path) -> None:
    """Write one row per sample of every record: measured and predicted force, and use of the sample."""
    with atomic_write(path) as draft, draft.open("w", encoding="utf-8", newline="\n") as file:
        file.write("record,time [s],displacement [m],force [N],model [N],residual [N],part\n")
        for number, c in enumerate(found.fit.comparisons):
            parts = np.where(c.fitted, "fit", np.where(c.checked, "check", "left out"))
            columns = (c.record.time, c.record.displacement, c.record.force, c.model, c.residual)
            for row, part in zip(np.column_stack(columns).tolist(), parts.tolist(), strict=True):
                file.write(f"{number},{','.join(map(repr, row))},{part}\n")


def _record(reading: Reading, comparison: RecordFit) -> dict[str, Any]:
    record, motion = comparison.record, comparison.experiment.motion
    return {
        "source": record.source,
        "samples": record.time.size,
        "interval": record.interval,
        "duration": record.duration,
        "notes": record.notes,
        "findings": [{**vars(finding), "sentence": finding.sentence} for finding in reading.findings],
        "bandwidth": motion.bandwidth,
        "highest": motion.highest,
        "lead": comparison.lead,
        "offset": comparison.offset,
        **{
            part: {
                "samples": int(mask.sum()),
                "rms": comparison.rms(check),
                "sound": comparison.noise_level(check),
                "explained": comparison.variance_explained(check),
            }
            for part, check, mask in (("fitted", False, comparison.fitted), ("checked", True, comparison.checked))
        },
        "whiteness": comparison.whiteness,
        "openings": dict(comparison.openings),
    }


def _response(response: Response) -> dict[str, Any]:
    columns = {name: values.tolist() for name, values in response.columns().items()}
    return {"frequency": response.frequency.tolist(), **columns}
