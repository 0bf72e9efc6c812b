"""Implementation of `inerter identify`."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from inerter.cli.cluster import workers
from inerter.cli.interrupts import interruptible
from inerter.cli.options import Cluster
from inerter.cli.progress import fraction
from inerter.cli.quantity_options import positive_option
from inerter.cli.reading import time_interval
from inerter.cli.streams import say
from inerter.errors import RecordError, StudyError, UnitError
from inerter.files.common.folder import REPORT, WriteMode, open_results
from inerter.files.common.toml import check_measurements
from inerter.files.identification.loading import IdentificationRequest, load_identification
from inerter.files.identification.running import FIT, read, run_identification
from inerter.files.identification.sections import RecordRequest, channel_units, gap_treatment
from inerter.records.finding_texts import QUESTIONABLE
from inerter.records.uncertain import Uncertain, parse_uncertain
from inerter.report.identification import RESULT_NAMES, write_fit, write_identification
from inerter.report.identification_data import identification_data
from inerter.report.identification_text import identification_text
from inerter.report.options import as_options
from inerter.statements import Statement

_CHANNELS = {"displacement": "displacement", "force_channel": "force", "time": "time"}  # by the option
_QUANTITIES = {
    "interval": "s",
    "resample": "s",
    "period": "s",
    "force_range": "N",
    "force_bandwidth": "Hz",
    "force_noise": "N",
    "displacement_noise": "m",
}
_SCALES = ("force_scale", "displacement_scale")


def identify(
    paths: Sequence[Path],
    model: str | None,
    config: Path | None,
    output: Path | None,
    options: Mapping[str, Any],
    settings: Mapping[str, int | str | None],
    cluster: Cluster,
    *,
    force: bool,
    as_json: bool,
) -> tuple[Statement, ...]:
    """Identify a device from records into a folder; returns the status of the fit."""
    for path in paths:
        check_measurements(path)
    request = _request(paths, model, config, options, settings)
    readings = []
    for path in paths:
        try:
            with fraction(f"reading {path.name}") as callback:
                readings.append(read(path, request.record, callback))
        except RecordError as error:
            raise RecordError(as_options(error.args)) from None
    for reading in readings:
        for finding in reading.findings:
            if finding.kind in QUESTIONABLE:
                say(f"{reading.used.source}: {as_options(finding.text)}")
    folder = output or Path(f"{paths[0].stem}-results")
    inputs = (*paths, *(() if config is None else (config,)))
    intent = WriteMode(folder, "identify", RESULT_NAMES, inputs, force=force)
    kept = [" before there was a fit."]
    try:
        with interruptible(lambda: kept[-1]), workers(cluster) as executor, open_results(intent) as results:
            with fraction(f"fitting {request.name or 'the model'}") as callback:
                found = run_identification(readings, request, callback, executor)
            write_fit(found, results.draft)
            results.publish()
            kept.append(f"; {folder / FIT} is complete." if results.place == folder else f"; {folder} is unchanged.")
            print(json.dumps(identification_data(found), indent=2) if as_json else identification_text(found))
            sys.stdout.flush()
            with fraction("drawing") as callback:
                write_identification(found, results.draft, callback)
    except RecordError as error:
        raise RecordError(as_options(error.args)) from None
    say(f"report: {folder / REPORT}")
    if not found.fit.status.ok:
        say(f"{found.title}: {found.fit.status}")
    return (found.fit.status,)


def _request(
    paths: Sequence[Path],
    model: str | None,
    config: Path | None,
    options: Mapping[str, Any],
    settings: Mapping[str, int | str | None],
) -> IdentificationRequest:
    """Configuration in which command-line options take precedence over the file."""
    if not paths:
        raise StudyError("Give a file of measurements, such as: inerter identify bench.csv --model ball-screw")
    request = IdentificationRequest() if config is None else load_identification(config)
    if model is not None and request.layout is not None:
        raise StudyError(f"Got --model {model} and a layout in [model] of {config}: give one of them.")
    given: dict[str, Any] = {
        name: _uncertain(name, value) if name in _SCALES else value
        for name, value in settings.items()
        if value is not None
    }
    if given.get("seed", 0) < 0:
        raise StudyError(f"--seed must be a non-negative integer, got {given['seed']}.")
    request = replace(
        request,
        name=model or request.name,
        record=_record(request.record, options),
        settings={**request.settings, **given},
    )
    request.models()
    return request


def _record(asked: RecordRequest, options: Mapping[str, Any]) -> RecordRequest:
    given = {name: value for name, value in options.items() if value is not None}
    changes: dict[str, Any] = {}
    channels = {
        role: int(name) if name.isdigit() else name
        for option, role in _CHANNELS.items()
        if (name := given.get(option)) is not None
    }
    changes["channels"] = {**asked.channels, **channels}
    changes["units"] = {**asked.units, **_units(given.get("unit", ()))}
    for name, unit in _QUANTITIES.items():
        if name in given:
            changes[name] = positive_option(name, given[name], unit)
    if "fixture_mass" in given:
        changes["fixture_mass"] = _uncertain("fixture_mass", given["fixture_mass"], "kg")
    if "trim" in given:
        changes["start"], changes["stop"] = time_interval("--trim", given["trim"])
    if "gaps" in given:
        try:
            changes["gaps"] = gap_treatment(given["gaps"])
        except ValueError as error:
            raise StudyError(f"--gaps: {error}") from None
    return replace(asked, **changes)


def _units(pairs: Sequence[str]) -> dict[str, str]:
    units = {}
    for pair in pairs:
        role, equals, unit = pair.partition("=")
        if not equals or not unit.strip():
            raise StudyError(f'Got --unit "{pair}"; expected a channel and its unit, such as --unit force=kgf.')
        units[role.strip()] = unit.strip()
    try:
        return channel_units(units)
    except ValueError as error:
        raise StudyError(f"--unit: {error}") from None


def _uncertain(name: str, text: object, unit: str = "") -> Uncertain:
    try:
        return parse_uncertain(text, unit)
    except UnitError as error:
        raise StudyError(f"--{name.replace('_', '-')}: {error}") from None
