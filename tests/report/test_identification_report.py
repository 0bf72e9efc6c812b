"""The report of an identification holds every number, needs no other file, and bears what is filled in."""

from __future__ import annotations

import ast
import inspect
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from report_pages import Page

import inerter as it
from inerter.errors import OK, Status, StatusKind
from inerter.files.identification.running import IdentificationResult, Reading, Responses, responses
from inerter.formatting import format_quantity
from inerter.identification.choice import Candidate
from inerter.identification.fit import Explanation, Localisation, NormalisedResidual
from inerter.identification.friction_models import law_hypotheses
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.initial_estimate import chain_of
from inerter.identification.statements.causes import Suspect
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.identification.statements.patterns import MisfitPattern
from inerter.networks.elements.roles import LinearRole
from inerter.networks.parser import format_expression
from inerter.records.channel_selection import ROLES
from inerter.records.finding import Finding
from inerter.records.finding_texts import RecordFinding
from inerter.records.remedy import Action, Remedy, in_python
from inerter.report.identification import identification_page, write_fit, write_identification
from inerter.report.identification_data import identification_data
from inerter.report.identification_figures import figures, last_periods
from inerter.report.identification_tables import format_variance_share
from inerter.report.identification_text import identification_text, unreliability_reason
from inerter.report.identified_values import elements_block, value_and_interval
from inerter.report.options import as_options

SHAFT = it.Spring(1e6, name="ks") | it.Damper(3200.0, name="cs")
MODEL = SHAFT - (it.Inerter(it.free(1.0, 500.0), name="b") | it.Friction(it.free(0.0, 100.0), name="f"))


@pytest.fixture(scope="session")
def found() -> IdentificationResult:
    rig = it.VirtualRig(SHAFT - (it.Inerter(113.0) | it.Friction(10.0)), seed=1, sampling=400.0)
    record = rig.run(it.cosine(amplitude=1e-3, frequency=4.0), duration=1.0)
    fit = it.identify(record, MODEL, seed=0, starts=8)
    warned = Finding(RecordFinding.HUM, "warning", "force", {"amplitude": 0.3, "frequency": -50.0})
    reading = Reading(record, record, (warned,))
    return IdentificationResult("a <b>", "custom", it.Rig(MODEL).device, fit.device, (reading,), fit, {"seed": 0})


def without(found: IdentificationResult, name: str, interval: tuple[float, float]) -> IdentificationResult:
    fit = found.fit
    changed = replace(fit.parameters[name], value=math.nan, interval=interval)
    verdict = Identifiability(name, Verdict.BELOW, "N", (0.0, 3.0), role=LinearRole.OPEN)
    verdicts = {**fit.identifiable, name: verdict}
    return replace(found, fit=replace(fit, parameters={**fit.parameters, name: changed}, identifiable=verdicts))


def test_the_page_holds_the_numbers_and_every_figure(found: IdentificationResult, tmp_path) -> None:
    write_fit(found, tmp_path)
    done: list[float] = []
    write_identification(found, tmp_path, done.append)
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    for name in ("b", "f"):
        value, interval = value_and_interval(found, name)
        assert value in page.text
        assert interval in page.text
    assert "a <b>" in page.text
    assert "mains hum: 0.3 N at −50 Hz" in page.text
    assert elements_block(found).replace("\n", " ").replace("  ", " ")[:60] in page.text.replace("  ", " ")
    assert page.tags.count("svg") == len(list((tmp_path / "figures").glob("*.svg"))) == 7
    assert all(link.startswith("#") for link in page.links())
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1.0)
    assert {path.name for path in tmp_path.iterdir()} == {
        "fit.json",
        "residuals.csv",
        "response.json",
        "report.html",
        "figures",
    }
    assert "measured" in json.loads((tmp_path / "response.json").read_text())


def test_data_are_json_to_the_last_number(found: IdentificationResult) -> None:
    data = json.loads(json.dumps(identification_data(without(found, "f", (0.0, 3.0))), allow_nan=False))
    assert data["parameters"]["f"]["value"] is None
    assert data["parameters"]["b"]["value"] == found.fit.parameters["b"].value
    assert data["parameters"]["b"]["bounds"] == [1.0, 500.0]
    assert data["records"][0]["findings"][0]["kind"] == "hum"


def test_what_is_not_identifiable_is_said_everywhere(found: IdentificationResult) -> None:
    less = without(found, "f", (0.0, 3.0))
    assert value_and_interval(less, "f") == ("not identifiable", "below 3 N")
    assert value_and_interval(without(found, "f", (2.0, 100.0)), "f") == ("not identifiable", "above 2 N")
    assert "# not identifiable: below 3 N" in elements_block(less)
    text = identification_text(less)
    assert "f: not identifiable: only an upper bound, 3 N, is known (search from 0 N)." in " ".join(text.split())
    assert "b: identified." not in text


def test_a_model_that_explains_nothing_has_no_intervals(found: IdentificationResult) -> None:
    fit = found.fit
    verdicts = {name: Identifiability(name, Verdict.WITHHELD) for name in fit.parameters}
    parameters = {name: replace(p, value=math.nan) for name, p in fit.parameters.items()}
    status = Status(StatusKind.INACCURATE, "the model explains 3 % of the force only")
    poor = replace(found, fit=replace(fit, status=status, identifiable=verdicts, parameters=parameters))
    assert value_and_interval(poor, "b") == ("withheld", "113 to 113 kg over the possible causes")
    assert "unreliable estimates" in elements_block(poor)


@pytest.mark.parametrize("verdict", [Verdict.WITHHELD, Verdict.CONDITIONAL, Verdict.UNPREDICTABLE])
def test_a_warned_fit_shows_no_value_as_a_result(found: IdentificationResult, verdict: Verdict) -> None:
    """Neither in text, JSON, the block of elements, the page nor a figure, and nothing of confidence."""
    fit, ends = found.fit, {"b": (101.25, 131.5), "f": (7.125, 12.75)}
    within = ends if verdict is Verdict.CONDITIONAL else dict.fromkeys(ends, (math.nan, math.nan))
    parameters = {
        n: replace(p, value=math.nan, interval=within[n], standard_error=math.nan, profile=())
        for n, p in fit.parameters.items()
    }
    verdicts = {n: Identifiability(n, verdict, p.unit, within[n]) for n, p in fit.parameters.items()}
    bad = Status(StatusKind.INACCURATE, "the model leaves 5 times what the errors of the sensors leave")
    warned = replace(found, fit=replace(fit, status=bad, parameters=parameters, identifiable=verdicts, suggestions=()))
    page = Page(identification_page(warned, {})).text
    text = " ".join(identification_text(warned).split())
    data = identification_data(warned)
    shown = [value_and_interval(found, name) for name in ends]
    for said in (text, page, elements_block(warned)):
        assert not any(part in said for value in shown for part in value), said
        assert "confidence" not in said
    assert "95 % interval" not in text
    assert "95 % interval" not in page
    assert "withheld" in text
    assert "withheld" in page
    assert ("131.5 kg over the possible causes" in text.replace("132", "131.5")) == (verdict is Verdict.CONDITIONAL)
    assert next(iter(figures(warned, Responses(None)))).section != "profiles"
    assert "[elements]" not in data["elements"]
    assert data["next_experiment"] == []
    for p in data["parameters"].values():
        assert (p["value"], p["standard_error"], p["profile"], p["identified"]) == (None, None, [], False)


def test_several_models_are_listed_best_first(found: IdentificationResult) -> None:
    rows = (
        Candidate("friction", 2, 1.01, 0.0, 0.0, True, OK),
        Candidate("custom", 1, 1.02, 0.01, 0.02, True, OK),
        Candidate("ideal", 1, 7.5, 6.5, 0.3, False, Status(StatusKind.INACCURATE, "it explains little")),
    )
    clear = Finding(FitFinding.NOT_REACHED, "warning", "ideal", {"other": "friction"})
    text = identification_text(replace(found, candidates=rows, choice=(clear,)))
    assert text.index("friction ") < text.index("custom (chosen) ") < text.index("ideal ")
    for words in ("best", "0.010 +- 0.020, as good", "6.50 +- 0.30             inaccurate", "ideal: not converged"):
        assert words in text
    assert max(map(len, text.splitlines())) <= 80


def test_digits_are_those_that_the_interval_bears(found: IdentificationResult) -> None:
    fit = found.fit
    p = replace(fit.parameters["b"], value=113.0271, best=113.0271, interval=(112.9, 113.16))
    one = replace(found, fit=replace(fit, parameters={**fit.parameters, "b": p}))
    assert value_and_interval(one, "b") == ("113.03 kg", "112.90 to 113.16 kg")


def test_single_values_and_shares() -> None:
    assert format_quantity(9.5e-9, "m") == "0.0095 um"
    assert format_quantity(0.0021, "s") == "2.1 ms"
    assert format_quantity(5000.0, "kg") == "5000 kg"
    assert format_variance_share(0.5) == "50.0 %"
    assert format_variance_share(1.0) == "100.0 %"


@pytest.mark.parametrize("text", ["b", "k | c", "(ks | cs) - gap - (b | f)", "k | c - (a - b | f)", "(a | b) - c | d"])
def test_expressions_are_read_back_as_they_were(text: str) -> None:
    parts = {name: it.Damper(1.0 + i) for i, name in enumerate(("a", "b", "c", "d", "k", "f", "gap", "ks", "cs"))}
    device = it.network(text, **parts)
    again = format_expression(device, [element.label for element in device.elements()])
    assert it.network(again, **parts) == device


def test_the_window_is_a_few_periods_of_what_was_fitted(found: IdentificationResult) -> None:
    (comparison,) = found.fit.comparisons
    first, last = last_periods(comparison)
    assert comparison.fitted[last]
    assert last - first <= 1.2 * 400


def test_the_response_is_of_the_force_without_its_offset(found: IdentificationResult) -> None:
    answered = responses(found)
    assert answered.measured is not None
    assert answered.model is not None
    assert abs(answered.model.value / answered.measured.value - 1.0).max() < 0.05


def middle(hypothesis: Hypothesis) -> dict[str, float]:
    """A value for each unknown of a hypothesis, and those of the model."""
    return {"b": 113.0, "f": 10.0} | {u.name: 0.5 * (u.lower + u.upper) for u in hypothesis.unknowns}


@pytest.mark.parametrize("sound", [True, False])
def test_nothing_is_said_of_values_that_are_not_there(found: IdentificationResult, sound: bool) -> None:
    """Whatever law explains a misfit, "what to do" holds whether its values are shown or not."""
    chain = chain_of(it.Rig(MODEL).device)
    assert chain is not None
    left = NormalisedResidual(1.0 if sound else 3.0, 1.0 if sound else 3.0, (1.2, 1.2))
    proposed = [
        Explanation(h.name, 0.9, left, {}, {"b": (113.0, 0.1), "f": (10.0, 0.1)}, h.details(middle(h)))
        for h in law_hypotheses(chain, 0.02, 1e-3)
        if h.device is None
    ]
    status = Status(StatusKind.INACCURATE, "the model leaves 3 times what the errors of the sensors would leave")
    for one in proposed:
        doubted = replace(found, fit=replace(found.fit, status=status, explanations=(one,)))
        for text in (identification_text(doubted), Page(identification_page(doubted, {})).text):
            told = " ".join(text.split())
            assert ("113 kg" in told.partition("Estimates Parameter")[0].partition("Parameters")[0]) == sound
            assert ("estimate it too" if one.name is Suspect.QUADRATIC else "use the values under this") in told
            assert "above" not in told.partition("records")[0]
    assert len(proposed) == 6


def test_all_is_found_only_in_a_fit_that_can_be_relied_on(found: IdentificationResult) -> None:
    status = Status(StatusKind.INACCURATE, "the model leaves 3 times what the errors of the sensors would leave")
    doubted = replace(found, fit=replace(found.fit, status=status))
    good, poor = (Page(identification_page(each, {})).text for each in (found, doubted))
    assert good.count("Identified: b, f. That is all there was to find.") == 1
    assert poor.count("Identified: b, f.") == 1
    assert "That is all" not in poor


VALUES = {
    Action.CHANNEL: ("force", "Load"),
    Action.UNIT: ("force", "kgf"),
    Action.UNITS: [("force", "kgf"), ("displacement", "mm")],
    Action.INTERVAL: 1e-3,
    Action.GAPS: "fill",
    Action.SHIFT_FORCE: 1e-3,
}


@pytest.mark.parametrize(
    "action", [one for one in Action if one is not Action.COLUMN]
)  # a column of a profile is a key of files alone
def test_no_remedy_reaches_a_terminal_with_the_words_of_python(action: Action) -> None:
    """Every step on a record is a call in Python, and an option or a key of a configuration for the command line."""
    text = ("What to do: ", Remedy(action, VALUES.get(action)), ".")
    unquoted = re.sub(r'"[^"]*"', "", as_options(text))
    assert re.search(r"\(record|(?<![-\w])[a-z_]+=", unquoted) is None
    assert action is Action.REVERSE_FORCE or in_python(text) != as_options(text)


def test_the_library_knows_steps_on_records_as_data_alone() -> None:
    """No text of the package for records writes a call or an argument out: that is done in one place."""
    words = rf"\b({'|'.join((*ROLES, *inspect.signature(it.read_record).parameters))})=\S"
    folder = Path(inspect.getfile(it.Record)).parent
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in folder.glob("*.py") if path.stem != "remedy"]
    docs = {id(n.value) for tree in trees for n in ast.walk(tree) if isinstance(n, ast.Expr)}
    texts = [n for tree in trees for n in ast.walk(tree) if isinstance(n, ast.Constant) and id(n) not in docs]
    assert len(texts) > 100
    assert [n.value for n in texts if isinstance(n.value, str) and re.search(words, n.value)] == []


@pytest.mark.campaign
def test_a_misfit_is_shown_where_it_is(found: IdentificationResult, tmp_path: Path) -> None:
    """One sentence in text, page and data, and one figure more."""
    pattern = Finding(
        MisfitPattern.BEGINS, "info", "", {"time": 0.5, "before": 1.0, "after": 9.0, "share": 0.8, "p": 0.006}
    )
    status = Status(StatusKind.INACCURATE, "the model leaves 3 times what the errors of the sensors would leave")
    places = tuple(Localisation(c.record.source, (pattern,)) for c in found.fit.comparisons)
    doubted = replace(found, fit=replace(found.fit, status=status, localisations=places))
    done: list[float] = []
    write_fit(doubted, tmp_path)
    write_identification(doubted, tmp_path, done.append)
    assert done[-1] == pytest.approx(1.0)
    assert list((tmp_path / "figures").glob("misfit*.svg"))
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    sentence = "misfit begins at 0.5 s"
    assert sentence in page.text
    assert sentence in " ".join(identification_text(doubted).split())
    told, *_ = json.loads((tmp_path / "fit.json").read_text())["localisations"]
    assert sentence in told["sentence"]
    assert told["changes"] == [0.5]
    assert told["patterns"][0]["kind"] == "begins"


@pytest.mark.parametrize(
    ("likeliest", "severity", "is_named"), [(None, "warning", True), (None, "info", False), ("x", "warning", False)]
)
def test_a_misfit_that_nothing_explains_begins_with_what_records_were_warned_of(likeliest, severity, is_named):
    readings = [
        SimpleNamespace(used=SimpleNamespace(source=name), findings=[SimpleNamespace(severity=one)])
        for name, one in (("a.csv", "info"), ("b.csv", severity))
    ]
    fit = SimpleNamespace(
        status=Status(StatusKind.INACCURATE, "it leaves much"),
        reliability_warning=SimpleNamespace(numbers={"likeliest": likeliest}),
    )
    said = unreliability_reason(SimpleNamespace(readings=readings, fit=fit))
    assert said.startswith("it leaves much")
    assert ("Begin with the warning about b.csv below" in said) == is_named
    assert unreliability_reason(SimpleNamespace(readings=readings, fit=SimpleNamespace(status=OK))) == ""
