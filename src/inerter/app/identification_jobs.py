"""Long work on records: what a measured device is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from inerter.app.documents import PATH
from inerter.app.fit_advice import causes, findings, further_offers
from inerter.app.kinds import RESULTS, Tell
from inerter.app.wire import typeset_sentences
from inerter.errors import RecordError
from inerter.files.common.folder import WriteMode, open_results
from inerter.files.identification.loading import identification_of
from inerter.files.identification.running import read, run_identification
from inerter.formatting import printed_text
from inerter.report.identification import RESULT_NAMES, write_fit, write_identification
from inerter.report.identification_data import identification_data
from inerter.report.identification_text import misfit_sentence, unreliability_reason, whiteness_sentence
from inerter.report.identified_values import device_tables, value_and_interval

Body = Mapping[str, Any]


def identify(body: Body, folder: Path, tell: Tell) -> Any:
    records = [Path(record) for record in body.get("records") or ()]
    if not records:
        raise RecordError("Records missing. Send their files to /api/records, and give the ids as `records`.")
    request = identification_of({"model": {}, **(body.get("config") or {})}, PATH)
    request = replace(request, name=body.get("model") or request.name)
    request.models()
    readings = []
    for number, path in enumerate(records):
        tell(number, len(records), f"reading {path.name}")
        readings.append(read(path, request.record))
    with open_results(WriteMode(folder / RESULTS, "identify", RESULT_NAMES, tuple(records))) as results:
        found = run_identification(readings, request, lambda part: tell(round(900.0 * part), 1000, ""))
        write_fit(found, results.draft)
        results.publish()
        write_identification(found, results.draft, lambda part: tell(round(900.0 + 100.0 * part), 1000, "drawing"))
    answer: dict[str, Any] = typeset_sentences(
        {
            **identification_data(found),
            "reason": unreliability_reason(found),
            "causes": causes(found),
            "findings": findings(found),
            "residual": [misfit_sentence(found), *map(whiteness_sentence, found.fit.comparisons)],
        }
    )
    return {
        **answer,
        "shown": {name: [*map(printed_text, value_and_interval(found, name))] for name in found.fit.parameters},
        "offers": further_offers(found),
        "asked": {"model": body.get("model"), "config": body.get("config") or {}},
        "device": device_tables(found) if found.explains else None,  # withheld values are not handed on
    }
