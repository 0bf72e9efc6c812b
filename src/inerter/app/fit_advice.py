"""Advice of an identification as requests: what a page can do about a possible cause or a note with one button."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from inerter.files.identification.running import IdentificationResult
from inerter.files.identification.sections import CHOOSE
from inerter.identification.fit import Explanation
from inerter.identification.models import MODELS
from inerter.records.remedy import Action, Remedy
from inerter.report.identification_tables import likely_explanations
from inerter.report.options import as_options

Offer = dict[str, Any]


def causes(found: IdentificationResult) -> list[dict[str, Any]]:
    """Possible causes of a misfit, most likely first: sentence, share explained, remedy in words, and offers."""
    return [] if found.explains else [_cause(e) for e in likely_explanations(found)]


def further_offers(found: IdentificationResult) -> list[Offer]:
    """Offers that notes on the estimates advise, each once; for unreliable estimates also to choose another model."""
    offered = [offer for finding in found.fit.findings for offer in _offers(finding.text)]
    if not found.explains and not found.candidates:
        offered.insert(0, {"label": "Compare all models, and choose one", "model": CHOOSE})
    return [offer for i, offer in enumerate(offered) if offer not in offered[:i]]


def findings(found: IdentificationResult) -> list[str]:
    """Findings on the estimates in sentences that name the offers of the page in place of options."""
    return ["".join(map(_as_offer, finding.text)) for finding in found.fit.findings]


def _as_offer(part: str | Remedy) -> str:
    return f"“{next(_offers([part]))['label']}”" if _needs_options([part]) else as_options([part])


def _cause(explanation: Explanation) -> dict[str, Any]:
    remedy = explanation.name.remedy(explanation.details)
    named = str(explanation.details.get("model", "")).split(" or ")
    models = [{"label": f"Fit the model {name}", "model": name} for name in named if name in MODELS]
    return {
        "sentence": explanation.sentence,
        "explained": explanation.explained,
        "remedy": as_options(remedy) if not _needs_options(remedy) else "",
        "offers": [*models, *_offers(remedy)],
    }


def _needs_options(text: Iterable[str | Remedy]) -> bool:
    """Whether a sentence names an option of the command line, in place of which there is an offer."""
    return any(isinstance(part, Remedy) and part.action in _OFFERS for part in text)


def _offers(text: Iterable[str | Remedy]) -> Iterator[Offer]:
    for part in text:
        if isinstance(part, Remedy) and part.action in _OFFERS:
            yield _OFFERS[part.action](part.value)


def _setting(label: str, section: str, key: str, example: str) -> Callable[[Any], Offer]:
    """Offer of a value that is asked for, with its key in the configuration."""
    return lambda value: {"label": label, "ask": {"section": section, "key": key, "example": example}}


def _switch(label: str, section: str, key: str) -> Callable[[Any], Offer]:
    """Offer of a setting that has one value."""
    return lambda value: {"label": label, "config": {section: {key: True if value is None else value}}}


_OFFERS: Mapping[Action, Callable[[Any], Offer]] = {
    Action.FIT_DELAY: _switch("Estimate the delay too", "fit", "delay"),
    Action.FIT_OFFSET: _switch("Estimate the offset too", "fit", "offset"),
    Action.FIT_QUADRATIC: _switch("Estimate the quadratic damping too", "fit", "quadratic_damping"),
    Action.DETREND: _switch("Remove the drift", "record", "detrend"),
    Action.GAPS: _switch("Interpolate the missing samples", "record", "gaps"),
    Action.REPAIR: _switch("Repair the record", "record", "repair"),
    Action.FORCE_BANDWIDTH: _setting("Bandwidth of the load cell", "record", "force_bandwidth", "300 Hz"),
    Action.FIXTURE_MASS: _setting("Fixture mass", "record", "fixture_mass", "0.3 kg"),
    Action.FORCE_SCALE: _setting("Scale of the force", "fit", "force_scale", "1 +- 1 %"),
    Action.DISPLACEMENT_SCALE: _setting("Scale of the displacement", "fit", "displacement_scale", "1 +- 1 %"),
}
