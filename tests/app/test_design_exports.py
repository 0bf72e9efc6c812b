"""Exports of the page: the bytes that `export` of the library makes of the same design."""

from __future__ import annotations

from typing import Any

import pytest
from app.conftest import DOCUMENT, changed
from campaigns import sampled
from starlette.testclient import TestClient

import inerter as it
from inerter.app.designs import design_of
from inerter.app.documents import study_from

VALUES = {"c": "2345 N s/m", "b": 123.0}
LINEAR = changed(layouts={"S3": "k | c - b"})
FILES = [(key, suffix) for key, kind in it.EXPORTS.items() if not kind.requires for suffix in kind.suffixes]


def _export(client: TestClient, document: dict[str, Any], **more: Any) -> Any:
    design = {"layout": "S3", "values": VALUES, "name": "mine"}
    return client.post("/api/export/design", json={"study": document, "design": design, **more})


@pytest.mark.parametrize(("kind", "suffix"), sampled(FILES, always=FILES[:1]))
def test_an_export_is_that_of_the_library(client: TestClient, kind: str, suffix: str, tmp_path: Any) -> None:
    study = study_from(LINEAR)
    path = tmp_path / f"design{suffix}"
    indices = {"indices": {"J3": study.index("J3")}} if "indices" in it.EXPORTS[kind].takes else {}
    it.export(design_of(study, "S3", VALUES).vehicle, kind, path, **indices, title="A car, mine")
    answer = _export(client, LINEAR, kind=kind, suffix=suffix, index="J3")
    assert answer.status_code == 200
    assert answer.content == path.read_bytes()


def test_friction_is_left_out_on_purpose_only(client: TestClient) -> None:
    refused = _export(client, DOCUMENT, kind="matlab")
    assert refused.status_code == 400
    assert "friction" in refused.json()["sentence"]
    assert _export(client, DOCUMENT, kind="matlab", linear=True).status_code == 200


@pytest.mark.parametrize("asked", [{"kind": "scipy"}, {"kind": "nothing"}, {"kind": "matlab", "suffix": ".svg"}])
def test_what_is_no_file_is_refused_in_a_sentence(client: TestClient, asked: dict[str, str]) -> None:
    refused = _export(client, LINEAR, **asked)
    assert refused.status_code == 400
    assert any(text in refused.json()["sentence"] for text in asked.values())
