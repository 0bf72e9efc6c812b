"""Statements: their severity and groups, exit codes, and a sentence for every kind."""

from __future__ import annotations

import json
import pickle
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from importlib import import_module
from inspect import isclass
from math import nan
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import get_args

import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from inerter import errors
from inerter.cli.main import call
from inerter.errors import OK, InerterError, RecordError, Status, StatusKind, StudyError, WorkError, worst_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.study.running import StudyResult
from inerter.identification import statements as of_identification
from inerter.identification.fit import Explanation, Localisation
from inerter.identification.statements import friction
from inerter.identification.statements.causes import Suspect
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.identification.statements.patterns import MisfitPattern
from inerter.methods.notes import Note
from inerter.records import finding_texts
from inerter.records.finding import Finding, FindingKind
from inerter.records.finding_texts import RecordFinding
from inerter.records.remedy import Action, Remedy
from inerter.report.options import _OPTIONS
from inerter.statements import Severity, Statement, by_severity, exit_code

UNRELIABLE = Status(StatusKind.INACCURATE, "the residual is 3 times the sensor noise")
COMPLETE, ONE_INDEX_WITHOUT = (
    StudyResult(Path(), None, xr.Dataset({"value": (("layout", "index"), v)}, {"index": ["J1", "J3"]}), 4)  # type: ignore[arg-type]
    for v in ([[nan, 600.0], [1.0, nan]], [[nan, 600.0], [nan, nan]])
)
MISSING = replace(COMPLETE, failed=True)
NOTES = [Note("friction taken as a damper of ", 1234.5, " N s/m"), Finding(RecordFinding.SIGN), OK]
ENTRY = at(["elements", "k"], got='"600"', fault="no unit", expected="a stiffness", hint="Write 600 N/m.")
CATALOGUES = [
    finding_texts,
    *(import_module(f"{of_identification.__name__}.{m.name}") for m in iter_modules(of_identification.__path__)),
]


@pytest.mark.parametrize(
    ("statements", "code"),
    [
        ([], 0),
        (NOTES, 0),
        ([COMPLETE.status], 0),
        ([Identifiability("f", Verdict.BELOW, "N", (0.0, 3.0))], 0),
        ([ONE_INDEX_WITHOUT.status], 1),
        ([UNRELIABLE], 1),
        ([*NOTES, UNRELIABLE], 1),
        ([Identifiability("f", Verdict.WITHHELD)], 1),
        ([COMPLETE.status, MISSING.status], 1),
        ([WorkError("the disk is full")], 1),
        ([ENTRY], 2),
        ([RecordError("bench.csv: ", Remedy(Action.TRIM))], 2),
        ([refusal(Path("car.toml"), [ENTRY])], 2),
        ([UNRELIABLE, StudyError("no such layout")], 2),
    ],
)
def test_the_exit_code_is_that_of_the_most_severe_statement(
    statements: list[Statement], code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert exit_code(statements) == code

    def command(*arguments: object, **options: object) -> tuple[Statement, ...]:
        for error in statements:
            if isinstance(error, InerterError):
                raise error
        return tuple(statements)

    monkeypatch.setattr("inerter.cli.main.app", command)
    assert call([]) == code


@pytest.mark.parametrize("error", [one for one in vars(errors).values() if isclass(one) and issubclass(one, Exception)])
def test_errors_are_statements_and_only_failed_work_is_not_invalid_input(error: type[InerterError]) -> None:
    raised = error("what is wrong")
    assert isinstance(raised, Statement)
    assert raised.sentence == "what is wrong"
    assert exit_code([raised]) == (1 if error is WorkError else 2)


@given(st.lists(st.sampled_from(Severity)))
def test_groups_keep_the_order_and_the_most_severe_come_first(severities: list[Severity]) -> None:
    found = [Finding(RecordFinding.SIGN, severity, str(i)) for i, severity in enumerate(severities)]
    groups = by_severity(found)
    order = [Severity.ERROR, Severity.WARNING, Severity.INFO]
    assert list(groups) == [severity for severity in order if severity in severities]
    assert all(groups[s] == [finding for finding in found if finding.severity == s] for s in groups)
    codes = [exit_code(group) for group in groups.values()]
    assert codes == sorted(codes, reverse=True)
    assert exit_code(found) == max(codes, default=0)


@given(st.sampled_from(Severity), st.sampled_from(Severity))
def test_severities_compare_in_their_order(one: Severity, other: Severity) -> None:
    i, j = (list(Severity).index(severity) for severity in (one, other))
    assert (one < other, one <= other, one > other, one >= other) == (i < j, i <= j, i > j, i >= j)
    assert list(Severity) == ["info", "warning", "error"]


def test_every_kind_of_status_has_a_severity() -> None:
    for kind in StatusKind:
        answers = Status(kind).ok or kind is StatusKind.UNBOUNDED  # which says that one is better at every value
        assert (kind.severity is Severity.INFO) == answers
        assert Status(kind).severity is kind.severity


@given(st.lists(st.builds(Status, st.sampled_from(StatusKind)), min_size=1))
def test_no_status_is_more_severe_than_the_worst(statuses: list[Status]) -> None:
    worst = worst_of(statuses)
    assert worst in statuses
    assert worst.severity is next(iter(by_severity(statuses)))


@pytest.mark.parametrize("catalogue", CATALOGUES, ids=lambda module: module.__name__.removeprefix("inerter."))
def test_every_kind_of_every_catalogue_has_a_sentence(catalogue: ModuleType) -> None:
    """A kind that is added without its sentence does not pass."""
    there = [value for name, value in vars(catalogue).items() if not name.startswith("__")]
    tables = [value for value in there if isinstance(value, Mapping)]
    enums = [one for one in there if isclass(one) and issubclass(one, StrEnum) and one.__module__ == catalogue.__name__]
    for kinds in enums:
        own = [table for table in tables if isinstance(next(iter(table)), kinds)]
        stated = [
            kind for kind in kinds if callable(said := getattr(kind, "words", getattr(kind, "_sentence", ""))) or said
        ]
        assert own or stated == [*kinds]
        assert all(set(table) == set(kinds) for table in own)
    assert enums or catalogue is friction  # whose kinds are a literal type


@pytest.mark.parametrize("kinds", [RecordFinding, FitFinding, MisfitPattern, Suspect, Action, Verdict])
def test_a_kind_is_its_key(kinds: type[StrEnum]) -> None:
    for kind in kinds:
        assert kinds(str(kind)) is kind
        assert pickle.loads(pickle.dumps(kind)) is kind
        assert json.loads(json.dumps(kind)) == kind.value == kind


def test_a_kind_without_its_sentence_is_refused() -> None:
    with pytest.raises(TypeError, match="words"):

        class _Kinds(FindingKind):
            SILENT = "silent"


def test_every_friction_law_has_a_sentence() -> None:
    assert set(friction._SENTENCES) == set(get_args(friction.Law))


def test_every_verdict_and_every_remedy_has_its_words() -> None:
    for verdict in Verdict:
        found = Identifiability("b", verdict, "kg", (1.0, 2.0))
        assert found.sentence.startswith("b: ")
        assert found.sentence.endswith(".")
        assert found.about == "b"
    assert set(Action) == set(_OPTIONS)
    assert str(Remedy(Action.GAPS, 0.05)) == "gaps=0.05"


def test_statements_name_their_subject_and_their_remedy() -> None:
    assert ENTRY.sentence == str(ENTRY) == 'elements.k: got "600": no unit; expected a stiffness. Write 600 N/m.'
    assert (ENTRY.about, ENTRY.remedy) == ("elements.k", "Write 600 N/m.")
    assert Problem(said="Empty file.").about == ""
    drift = {"change": 2.0, "range": 10.0}
    found = Finding(RecordFinding.FORCE_DRIFT, Severity.WARNING, "force", drift)
    assert found.remedy == "detrend(record)"
    assert found.remedy in found.sentence
    assert Finding(FitFinding.OFFSET, about="bench.csv", numbers={"offset": 1.0}).remedy == ""
    assert NOTES[0].sentence == "friction taken as a damper of 1234 N s/m"
    assert (UNRELIABLE.sentence, UNRELIABLE.about) == (UNRELIABLE.message, "")
    assert Localisation("bench.csv").about == "bench.csv"
    assert issubclass(Explanation, Statement)


def test_a_statement_without_more_is_an_information() -> None:
    @dataclass(frozen=True)
    class Remark(Statement):
        text: str

        def __str__(self) -> str:
            return self.text

    remark = Remark("nothing to do")
    assert (remark.severity, remark.about, remark.sentence, remark.remedy) == (Severity.INFO, "", "nothing to do", "")
