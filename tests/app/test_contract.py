"""What the interface promises: every request is described, answers, and says in a sentence what is wrong with it."""

from __future__ import annotations

import copy
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import page_numbers
import pytest
from app.conftest import DOCUMENT, ask, changed
from campaigns import sampled
from folders import EXAMPLES, ROOT, example_tables
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient

import inerter as it
from inerter.app.documents import problems, searched_study_from
from inerter.app.kinds import KINDS
from inerter.app.panels import PANELS
from inerter.app.requests import ENDPOINTS
from inerter.files.study.checking import search_plans
from inerter.files.study.places import places
from inerter.methods.registry import METHODS
from inerter.networks.elements import Free
from inerter.networks.elements.registry import ELEMENTS
from inerter.networks.parser import network, parse_expression, replace_in_expression
from inerter.units import parse_quantity

CSV = b"time [s],displacement [mm],force [N]\n" + b"".join(
    b"%g,%g,%g\n" % (i * 1e-3, i % 7, i % 11) for i in range(500)
)


def test_all_requests_are_described_and_told() -> None:
    text = (ROOT / "docs" / "workbench.md").read_text(encoding="utf-8")
    for endpoint in ENDPOINTS:
        path = endpoint.path.replace(":path", "").replace("/panel/{name}", "/panel/NAME")
        assert f"`{endpoint.verb} {path}" in text, path
    for name in (*PANELS, *KINDS):
        assert f"| `{name}` |" in text


def test_the_description_has_every_request(client: TestClient) -> None:
    told = client.get("/api/openapi.json").json()
    assert told["openapi"].startswith("3.1")
    described = {(verb.upper(), path) for path, verbs in told["paths"].items() for verb in verbs}
    assert described == {(e.verb, e.path.replace(":path", "")) for e in ENDPOINTS}
    references = re.findall(r'"#/components/schemas/(\w+)"', json.dumps(told))
    assert set(references) <= set(told["components"]["schemas"])


def test_about_tells_the_rows(client: TestClient) -> None:
    told = client.get("/api/about").json()
    assert [row["key"] for row in told["elements"]] == list(ELEMENTS)
    assert [row["symbol"] for row in told["indices"]] == list(it.INDICES)
    assert [row["name"] for row in told["methods"]] == list(it.METHODS)
    assert [row["key"] for row in told["vehicles"]] == list(it.VEHICLES)
    assert [row["key"] for row in told["panels"]] == list(PANELS)
    assert [row["key"] for row in told["work"]] == list(KINDS)
    assert [row["key"] for row in told["exports"]] == [key for key, kind in it.EXPORTS.items() if kind.is_file]
    classes = told["named_values"][next(row["unit"] for row in told["road"] if row["key"] == "roughness")]
    letters = {"very good": "A", "good": "B", "average": "C", "poor": "D", "very poor": "E"}
    for name, text in classes.items():
        letter = letters.get(name, name)
        assert parse_quantity(text, "m^3/cycle") == pytest.approx(it.Road.iso8608(letter, 25.0).roughness, rel=1e-12)
    assert len(classes) == 8 + len(letters)
    assert {"network", "springs_at_most", "bridges"} <= {row["key"] for row in told["free_networks"]}
    assert set(told["kernels"]) == {"ready", "title", "number", "total"}


def test_examples_are_studies(client: TestClient) -> None:
    """In the order of their questions, of which each heads one card, and one for each vehicle to begin with."""
    found = client.get("/api/examples").json()
    names = [row["name"] for row in found["examples"]]
    assert {"quarter-car", "half-car", "ball_screw", "stiffness-sweep"} <= set(names)
    headings = [row["heading"] for row in found["examples"]]
    assert len(set(headings)) == len(headings)
    assert headings.index("Which strut for a quarter car?") == 0
    assert found["examples"][names.index("limits")]["heading"] == "Quarter car: the best ride within limits"
    for row in found["examples"]:
        assert ask(client, "study/read", study=row["study"]) == {"study": row["study"], "kind": "run", "problems": []}
        assert set(row["kinds"]) == set(row["study"]["elements"])
    begins = {row["title"]: row["name"] for row in found["vehicles"]}
    assert begins["Half car"] == "half-car"
    assert all(name in names for name in begins.values())
    told = client.get("/api/examples/quarter-car").json()
    assert told["text"] == (EXAMPLES / "quarter-car.toml").read_text(encoding="utf-8")
    assert told["problems"] == []
    assert client.get("/api/examples/rig_fit").status_code == 404
    assert client.get("/api/examples/..%2fquarter-car").status_code == 404


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_file_becomes_a_document_and_a_file_again(client: TestClient, path: Path) -> None:
    first = ask(client, "study/read", text=path.read_text(encoding="utf-8"))
    text = ask(client, "study/write", study=first["study"])["text"]
    again = ask(client, "study/read", text=text)
    assert again == first
    assert ask(client, "study/read", study=first["study"]) == first


@pytest.mark.parametrize(
    ("tables", "place", "words"),
    [
        ({"elements": {"k": "20 kN"}}, ["layouts", "S1"], None),
        ({"elements": {"k": "20"}}, ["elements", "k"], "unit"),
        ({"elements": {"c": {"from": "3 kg", "to": "1 kg"}}}, ["elements", "c"], "Swap"),
        ({"layouts": {"S9": "k | zz"}}, ["layouts", "S9"], "zz"),
        ({"layouts": {"S9": "k | | c"}}, ["layouts", "S9"], "column 5"),
        ({"study": {"indices": ["J9"]}}, ["study", "indices"], "J9"),
        ({"study": {"colour": 1}}, ["study", "colour"], "unknown key"),
        ({"road": {"speed": "25 m"}}, ["road", "speed"], "m/s"),
    ],
)
def test_a_problem_has_its_place(client: TestClient, tables: Any, place: list[str], words: str | None) -> None:
    found = ask(client, "study/read", study=changed(**tables))["problems"]
    if words is None:  # a spring that became a friction is no mistake of the file
        assert found == []
        return
    assert [problem["place"][: len(place)] for problem in found] == [place]
    assert words in found[0]["sentence"]
    assert ask(client, "study/check", study=changed(**tables))["problems"] == found
    refused = client.post("/api/panel/indices", json={"study": changed(**tables)})
    assert refused.status_code == 400
    assert refused.json()["problems"] == found


@given(text=st.text(max_size=60) | st.text("kcbf |-()1_", max_size=40))
def test_any_text_is_a_network_or_has_a_sentence(client: TestClient, text: str) -> None:
    told = client.post(
        "/api/network/parse", json={"text": text.encode("utf-8", "replace").decode(), "elements": ["k", "c"]}
    )
    assert told.status_code == 200
    answer = told.json()
    if "sentence" in answer:
        begin, end = answer["at"]
        assert 0 <= begin < max(end, 1) <= max(len(text), begin + 1)
    else:
        assert set(answer["names"]) <= {"k", "c"}


_NETWORKS = st.recursive(
    st.sampled_from("abc"),
    lambda inner: st.lists(inner, min_size=2, max_size=3).flatmap(
        lambda parts: st.sampled_from([" | ", " - "]).map(lambda sign: "(" + sign.join(parts) + ")")
    ),
    max_leaves=8,
)


@given(text=_NETWORKS)
def test_parts_are_where_they_say(text: str) -> None:
    """The text of each part, parsed by itself, is that part."""
    elements = {"a": it.Spring(1.0), "b": it.Damper(1.0), "c": it.Inerter(1.0)}

    def check(part: Any) -> None:
        own = text[part.begin : part.end]
        if part.name:
            assert own == part.name
            return
        once = network(own, **elements)
        by_hand = [
            network(text[p.begin : p.end] if p.name else f"({text[p.begin : p.end]})", **elements) for p in part.parts
        ]
        joined = by_hand[0]
        for other in by_hand[1:]:
            joined = joined | other if part.sign == "|" else joined - other
        assert once == joined
        for p in part.parts:
            check(p)

    check(parse_expression(text))


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({"text": "120 N/mm"}, {"value": 120e3, "unit": "N/m", "key": "spring", "text": "120 kN/m"}),
        ({"text": "1 lbf", "unit": "N"}, {"value": 4.4482216152605, "unit": "N"}),
        ({"value": 7544.2, "unit": "N s/m"}, {"text": "7.544 kN s/m"}),
    ],
)
def test_quantities(client: TestClient, asked: Any, expected: Any) -> None:
    told = ask(client, "quantity", **asked)
    assert told["value"] == pytest.approx(expected.pop("value", told["value"]), rel=1e-15)
    assert {key: told[key] for key in expected} == expected
    assert ask(client, "quantities", items=[asked, {"text": "1 m/s/s/s"}])["items"][0] == told


@pytest.mark.parametrize(
    "asked",
    [
        *({}, {"text": "x", "value": 1.0}, {"text": "3 kg", "unit": "N/m"}, {"text": "3 blurbs"}),
        *({"text": "3 kg", "unit": unit} for unit in ("", "2", "nan", "((", "1e999 N/m", "-3 kg", "kg\0", "potato")),
    ],
)
def test_no_quantity_has_a_sentence(client: TestClient, asked: Any) -> None:
    assert ask(client, "quantity", **asked)["sentence"].endswith(".")


BAD: list[Any] = [
    ("/api/panel/indices", {}),
    ("/api/panel/indices", {"study": []}),
    ("/api/panel/indices", {"study": {}, "colour": 1}),
    ("/api/panel/indices", {"study": DOCUMENT, "designs": [{"layout": "S9"}]}),
    ("/api/panel/indices", {"study": DOCUMENT, "designs": [{"layout": "S1", "values": {"c": -1.0}}]}),
    ("/api/panel/indices", {"study": DOCUMENT, "designs": [{"layout": "S1", "values": {"c": 0.0}}]}),
    ("/api/panel/indices", {"study": DOCUMENT, "designs": [{"layout": "S1", "values": {"c": "3 kg"}}]}),
    ("/api/panel/indices", {"study": DOCUMENT, "designs": [{"layout": "S1", "values": {"zz": 1.0}}]}),
    ("/api/panel/indices", {"study": DOCUMENT, "indices": ["J9"]}),
    ("/api/panel/indices", {"study": DOCUMENT, "methods": ["magic"]}),
    ("/api/panel/indices", {"study": DOCUMENT, "sequence": "one"}),
    ("/api/panel/history", {"study": DOCUMENT, "duration": 1e6}),
    ("/api/panel/history", {"study": DOCUMENT, "outputs": ["nothing"], "duration": 0.1}),
    ("/api/panel/budget", {"study": DOCUMENT, "layout": "S3"}),
    ("/api/panel/budget", {"study": DOCUMENT, "layout": "S3", "index": "J1", "parameter": "zz"}),
    ("/api/panel/optimise", {"study": DOCUMENT, "layouts": ["S9"]}),
    ("/api/panel/optimise", {"study": DOCUMENT, "method": "magic"}),
    ("/api/work", {"kind": "magic", "study": DOCUMENT}),
    ("/api/work", {"study": DOCUMENT}),
    ("/api/study/read", {}),
    ("/api/study/read", {"text": "x = 1", "study": {}}),
    pytest.param("/api/figure", {"kind": "magic", "study": DOCUMENT}, marks=pytest.mark.campaign),
    ("/api/figure", {"kind": "networks", "study": DOCUMENT, "format": "exe"}),
    ("/api/export/csv", {"panel": "mechanism", "request": {"study": DOCUMENT}}),
]


@pytest.mark.parametrize(("path", "body"), BAD)
def test_a_wrong_request_gets_a_sentence(client: TestClient, path: str, body: Any) -> None:
    told = client.post(path, json=body)
    assert told.status_code == 400, told.text
    sentence = told.json()["sentence"]
    assert sentence.strip()
    assert sentence.strip().endswith((".", "?"))
    assert "Traceback" not in told.text


@pytest.mark.parametrize(
    "path", ["/api/nothing", "/api/panel/magic", "/api/work/0", "/api/work/0/result", "/nothing.js", "/api"]
)
def test_what_there_is_not(client: TestClient, path: str) -> None:
    told = client.get(path) if "panel" not in path else client.post(path, json={"study": DOCUMENT})
    assert told.status_code == 404
    assert told.json()["sentence"].endswith((".", "afresh."))


@pytest.mark.parametrize("body", [b"", b"{", b"nan", b'{"study": NaN}', b"[" * 5000, b"\xff\xfe", b"12"])
def test_a_body_that_is_no_json(client: TestClient, body: bytes) -> None:
    told = client.post("/api/panel/indices", content=body)
    assert told.status_code == 400
    assert told.json()["sentence"].endswith(".")


@given(data=st.data())
def test_a_document_with_one_entry_spoilt(client: TestClient, data: st.DataObject) -> None:
    """Whatever stands in the place of an entry, the document is a study or each problem has a place in it."""
    document = copy.deepcopy(DOCUMENT)
    table = document[data.draw(st.sampled_from(["vehicle", "road", "elements", "layouts", "study"]))]
    key = data.draw(st.sampled_from(sorted(table)))
    scalars = (
        st.none()
        | st.booleans()
        | st.integers(-9, 9)
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(max_size=5)
    )
    table[key] = data.draw(
        st.recursive(
            scalars,
            lambda i: st.lists(i, max_size=2) | st.dictionaries(st.text(max_size=3), i, max_size=2),
            max_leaves=4,
        )
    )
    told = client.post("/api/study/check", json={"study": document})
    assert told.status_code == 200
    for problem in told.json()["problems"]:
        assert problem["sentence"]
        assert problem["place"] == [] or problem["place"][0] in document


def test_a_record_is_read_and_forgotten(client: TestClient) -> None:
    told = client.post("/api/records", params={"name": "bench.csv"}, content=CSV)
    assert told.status_code == 201
    found = told.json()
    assert (found["name"], found["samples"], found["size"]) == ("bench.csv", 500, len(CSV))
    channels = {channel["name"]: channel["unit"] for channel in found["channels"]}
    assert channels == {"displacement": "m", "force": "N"}
    assert client.delete(f"/api/records/{found['id']}").status_code == 200
    assert client.delete(f"/api/records/{found['id']}").status_code == 404


@pytest.mark.parametrize(
    ("name", "body"), [("x.csv", b"nonsense"), ("x.exe", CSV), ("", CSV), ("x.tdms", CSV), ("x.mat", b"")]
)
def test_a_file_that_is_no_record_is_not_kept(client: TestClient, server: Any, name: str, body: bytes) -> None:
    told = client.post("/api/records", params={"name": name}, content=body)
    assert told.status_code == 400
    assert told.json()["sentence"].strip().endswith((".", "?"))
    assert server.records.known == {}
    assert list(server.records.root.iterdir()) == []


def test_several_designs_of_one_layout_have_names_of_their_own(client: TestClient) -> None:
    document = changed(layouts={"S1.2": "k | c | b"})
    designs = [{"layout": "S1", "values": {"c": c}} for c in (1e3, 2e3, 3e3)] + [{"layout": "S1.2"}]
    told = ask(client, "study/write", study=document, designs=designs)["study"]
    assert list(told["layouts"]) == ["S1", "S1.3", "S1.4", "S1.2"]
    assert ask(client, "study/check", study=told)["problems"] == []


@pytest.mark.parametrize("name", sampled(["limits", "full-car"], ["limits"]))
def test_each_place_that_is_told_can_be_swept(client: TestClient, name: str) -> None:
    """What `places` offers a sweep takes, and it offers all that is fixed, in and beyond elements."""
    document = example_tables(name)
    told = ask(client, "study/check", study=document)["places"]
    assert [row["place"] for row in told if takes(document, **row)] == [row["place"] for row in told]
    offered = {row["place"] for row in told}
    assert {"road.speed", "vehicle.sprung_mass"} <= offered
    for name, entry in document["elements"].items():
        assert (name in offered) == isinstance(entry, str)
    for row in told:
        assert parse_quantity(row["text"], row["unit"]) == pytest.approx(row["value"], rel=1e-3)
        ends = [parse_quantity(row[end], row["unit"]) for end in ("from", "to")]
        assert ends == pytest.approx(sorted((row["value"] / 2, row["value"] * 2)), rel=1e-3)
    beyond = ["." in row["place"] for row in told]
    assert beyond == sorted(beyond)


@pytest.mark.parametrize("name", ["absorber", "building_quake", "full-car"])
def test_each_quantity_that_is_told_can_be_limited(client: TestClient, name: str) -> None:
    """What `limitable` offers a constraint takes; where there is no road, nothing that is measured on one."""
    document = example_tables(name)
    told = {row["of"]: row for row in ask(client, "study/check", study=document)["limitable"]}
    assert ("J1" in told, "suspension-travel" in told) == ("road" in document,) * 2
    assert set(document.get("indices", {})) < set(told)
    assert any("static stiffness of" in row["words"] for row in told.values())
    assert {row["written"] for row in told.values() if row["unit"] == "m"} <= {"mm"}
    assert all(("99.7 %" in row["note"]) == (row["unit"] == "m") for row in told.values())
    assert all(row["words"].startswith("r.m.s.") for row in told.values() if row["note"])
    for of, row in told.items():
        limit = {"at_most": f"1 {row['written']}" if row["unit"] else 1.0}
        limits = {**document["study"].get("subject_to", {}), of: limit}
        assert problems({**document, "study": {**document["study"], "subject_to": limits}}) == []


def takes(document: dict[str, Any], place: str, value: float, unit: str, **_: Any) -> bool:
    """Whether a sweep of this place is accepted."""
    sweep = {place: {"from": f"{0.9 * value!r} {unit}", "to": f"{1.1 * value!r} {unit}", "points": 2}}
    return problems({**document, "study": {**document["study"], "sweep": sweep}}) == []


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_parts_of_a_document_are_those_of_its_study(client: TestClient, path: Path) -> None:
    """Each number has the text that its keys lead to, and the value of its place; networks are those of layouts."""
    document = tomllib.loads(path.read_text(encoding="utf-8"))
    if problems(document) or (study := it.load_study(path)).free_networks:
        return
    told = ask(client, "study/parts", study=document)
    known = places(study)
    for row in told["numbers"]:
        entry, number = entry_at(document, row["path"]), known[row["place"]]
        assert row["words"] == number.words
        if isinstance(entry, dict):
            assert set(entry) == {"from", "to"}
            assert isinstance(number.value, Free)
            assert (row["value"], row["name"], row["may_be_free"]) == (None, number.value.name, True)
        else:
            value = parse_quantity(entry, row["unit"]) if isinstance(entry, str) else entry
            assert row["value"] == value
            assert number.value == (parse_quantity(entry, number.unit) if isinstance(entry, str) else entry)
    given = {place for place, number in known.items() if number.value is not None}
    assert {row["place"] for row in told["numbers"]} >= given - {
        place for place in given if is_left_out(document, place)
    }
    for layout, row in told["layouts"].items():
        struts = " | ".join(study.layouts[layout].struts.values())
        assert set(row["elements"]) <= set(re.findall(r"\w+", struts))
        assert sorted(row["free"]) == sorted(study.design(layout).free_values())
    for row in told["networks"]:
        assert row["text"] == entry_at(document, row["path"])
        assert network(row["text"], **study.elements) == network(written(row["tree"]), **study.elements)
    assert {name: row["kind"] for name, row in told["elements"].items()} == {
        name: element.key for name, element in study.elements.items()
    }


def entry_at(document: Any, path: list[str]) -> Any:
    for key in path:
        document = document[key]
    return document


def is_left_out(document: Any, place: str) -> bool:
    """Whether a place is a bound, whose number stands for it, or has a default that the file does not say."""
    keys = place.split(".")
    if keys[-1] in {"from", "to"}:
        return True
    try:
        entry_at(document, keys if keys[1:] else ["elements", *keys])
    except KeyError:
        return keys[1] not in document.get("study", {}).get("subject_to", {})
    return False


def written(tree: Any) -> str:
    """A tree of an answer as an expression, with brackets around each group."""
    if tree["kind"] == "element":
        return str(tree["name"])
    return "(" + {"parallel": " | ", "series": " - "}[tree["kind"]].join(map(written, tree["parts"])) + ")"


def test_an_unfinished_document_has_parts(client: TestClient) -> None:
    """What is wrong keeps its number, without a value; a network that is being typed keeps the others."""
    document = changed(
        elements={"k": "120 parrots", "c": {"tied": "2 * cs"}, "cs": "1 kN s/m", "g": {"kind": "gap"}},
        layouts={"S9": "k | c - (", "S8": "k | zz"},
    )
    document["vehicle"] = {**document["vehicle"], "sprung_mass": "heavy"}
    told = ask(client, "study/parts", study=document)
    rows = {tuple(row["path"]): row for row in told["numbers"]}
    assert rows["elements", "k"]["value"] is None
    assert rows["elements", "c", "tied"]["value"] is None
    assert rows["elements", "g"]["value"] is None
    assert (rows["vehicle", "sprung_mass"]["value"], rows["vehicle", "sprung_mass"]["unit"]) == (None, "kg")
    assert rows["elements", "cs"]["value"] == 1000.0
    networks = {tuple(row["path"]): row for row in told["networks"]}
    assert "tree" not in networks["layouts", "S9"]
    assert networks["layouts", "S9"]["at"] == [9, 10]
    assert networks["layouts", "S8"]["names"] == ["k", "zz"]
    assert "zz" in networks["layouts", "S8"]["sentence"]
    assert told["layouts"]["S9"]["elements"] == ["k", "c"]
    assert told["elements"]["c"]["kind"] == "damper"
    assert "S9" in told["elements"]["cs"]["layouts"]


@given(data=st.data())
def test_parts_of_a_spoilt_document(client: TestClient, data: st.DataObject) -> None:
    """Whatever stands somewhere in a document, there is an answer, and its keys lead to entries."""
    document = copy.deepcopy(DOCUMENT)
    anything = st.recursive(
        st.none() | st.booleans() | st.integers(-9, 9) | st.text(max_size=5),
        lambda i: st.lists(i, max_size=2) | st.dictionaries(st.text(max_size=3), i, max_size=2),
        max_leaves=4,
    )
    section = data.draw(st.sampled_from(sorted(document)))
    if isinstance(document[section], dict) and data.draw(st.booleans()):
        document[section][data.draw(st.sampled_from(sorted(document[section])) | st.text(max_size=3))] = data.draw(
            anything
        )
    else:
        document[section] = data.draw(anything)
    told = client.post("/api/study/parts", json={"study": document})
    assert told.status_code == 200
    for row in [*told.json()["numbers"], *told.json()["networks"]]:
        entry_at(document, row["path"])
    renamed = ask(client, "study/rename", study=document, names={"k": "stiff"})["study"]
    assert ask(client, "study/rename", study=renamed, names={"stiff": "k"})["study"] == document


def test_elements_are_renamed_wherever_the_study_has_them(client: TestClient) -> None:
    document = {
        "vehicle": {"model": "quarter-car", "seat": {"mass": "70 kg", "network": "k | cs"}},
        "elements": {"k": "1 kN/m", "cs": {"tied": "0.5 * c"}, "c": "1 N s/m"},
        "layouts": {"S1": "k | (c", "S2": {"strut": "k - c2"}},
        "conditions": [{"k": "2 kN/m", "road.speed": "3 m/s", "name": "k"}],
        "study": {
            "sweep": {"elements.k": ["1 N/m", "2 N/m"]},
            "tolerance": {"elements": {"k": 0.1}, "c": 0.1},
            "budgets": ["c", "k"],
        },
    }
    told = ask(client, "study/rename", study=document, names={"k": "c", "c": "k"})["study"]
    assert told == {
        "vehicle": {"model": "quarter-car", "seat": {"mass": "70 kg", "network": "c | cs"}},
        "elements": {"c": "1 kN/m", "cs": {"tied": "0.5 * k"}, "k": "1 N s/m"},
        "layouts": {"S1": "c | (k", "S2": {"strut": "c - c2"}},
        "conditions": [{"c": "2 kN/m", "road.speed": "3 m/s", "name": "k"}],
        "study": {
            "sweep": {"elements.c": ["1 N/m", "2 N/m"]},
            "tolerance": {"elements": {"c": 0.1}, "k": 0.1},
            "budgets": ["k", "c"],
        },
    }
    assert list(told["elements"]) == ["c", "cs", "k"]


@pytest.mark.parametrize("name", ["c", "2k", "", "k-1", "layout"])
def test_a_name_that_an_element_cannot_have(client: TestClient, name: str) -> None:
    told = client.post("/api/study/rename", json={"study": DOCUMENT, "names": {"k": name}})
    assert told.status_code == 400
    assert told.json()["sentence"].endswith(".")


def test_the_page_knows_no_method_by_its_name() -> None:
    sources = list((EXAMPLES.parent / "web" / "src").rglob("*.js"))
    assert sources
    named = [(path.name, name) for path in sources for name in METHODS if f'"{name}"' in path.read_text()]
    assert named == []


def test_what_may_be_chosen_is_told_in_words(client: TestClient) -> None:
    told = client.get("/api/about").json()
    titles = {method["name"]: method["title"] for method in told["methods"]}
    assert titles["norm"] == "no friction or gaps (norm)"
    assert titles["statistical-linearisation"] == "with friction (statistical linearisation)"
    assert titles["expected-value"] == "with friction and gaps (expected value)"
    sides = {side["key"]: side["words"] for side in told["limit_sides"]}
    assert sides == {"at_most": "at most", "at_least": "at least", "equal": "equal"}
    assert [kind["key"] for kind in told["elements"] if kind["linear"] == "stiffness"] == ["spring"]
    assert [vehicle["key"] for vehicle in told["vehicles"] if vehicle["is_rig"]] == ["rig"]
    outlines = {vehicle["key"]: vehicle["outline"] for vehicle in told["vehicles"]}
    assert {key for key, outline in outlines.items() if outline == "car"} == {"half-car", "full-car"}


def test_a_free_network_to_begin_with_can_be_searched(client: TestClient) -> None:
    entry = client.get("/api/about").json()["new_free_network"]
    elements = {**DOCUMENT["elements"], "any": entry}
    document = {**DOCUMENT, "elements": elements, "layouts": {**DOCUMENT["layouts"], "free": "k | any"}}
    assert problems(document) == []
    (plan, *_) = search_plans(searched_study_from(document)).values()
    assert max(topology.size for topology in plan.topologies) == entry["network"] == 3
    assert {symbol for topology in plan.topologies for symbol in topology.kinds} == {"k", "c", "b"}


DEVICE = {"elements": {"b": "113 kg", "g": "0.1 mm", "c": "3 kN s/m"}, "layouts": {"rig": "(b | c) - g"}}


PARALLEL = "in parallel"


@pytest.mark.parametrize(
    ("network", "struts"),
    [
        ("k | c", {PARALLEL: "k | c | (b2 | c2) - g", "in series with c": "k | c - ((b2 | c2) - g)"}),
        ("k | c - b", {"in place of b": "k | c - ((b2 | c2) - g)"}),
        ("(k | f) - b", {"in place of b": "(k | f) - ((b2 | c2) - g)"}),
        ("k", {PARALLEL: "k | (b2 | c2) - g"}),
        ("", {PARALLEL: "(b2 | c2) - g"}),
        ("k | c - (", {PARALLEL: "k | c - ( | (b2 | c2) - g"}),  # as it is being typed
    ],
)
def test_a_device_joins_a_strut(client: TestClient, network: str, struts: dict[str, str]) -> None:
    """In place of an inerter, else in parallel, and in series with its first damper, as the networks of these texts."""
    told = ask(client, "study/device", study=DOCUMENT, network=network, device=DEVICE)
    assert told["elements"] == {"b2": "113 kg", "g": "0.1 mm", "c2": "3 kN s/m"}
    found = {one["words"]: one["network"] for one in told["struts"]}
    assert list(found) == list(struts)
    assert found.pop(PARALLEL, None) == struts.pop(PARALLEL, None)
    assert [replace_in_expression(one, {}) for one in found.values()] == [
        replace_in_expression(one, {}) for one in struts.values()
    ]


def test_a_device_keeps_names_of_equal_elements_and_avoids_those_of_others(client: TestClient) -> None:
    """A name is new in the study and in the device."""
    device = {"elements": {"k": "20 kN/m", "b": "1 kg", "b2": "2 kg"}, "layouts": {"rig": "k | b - b2"}}
    told = ask(client, "study/device", study=DOCUMENT, network="c", device=device)
    assert told["elements"] == {"k": "20 kN/m", "b3": "1 kg", "b2": "2 kg"}
    assert told["struts"][0]["network"] == "c | k | b3 - b2"


@pytest.mark.parametrize("device", [{}, {"elements": {"b": "1 kg"}}, {"layouts": {"rig": "b - ("}}, {"layouts": 5}])
def test_a_device_without_a_network_is_refused(client: TestClient, device: dict[str, Any]) -> None:
    body = {"study": DOCUMENT, "network": "k", "device": device}
    answer = client.post("/api/study/device", json=body)
    assert answer.status_code == 400
    assert "it has no network" in answer.json()["sentence"]


def test_tests_of_the_page_have_the_numbers_of_the_library() -> None:
    """Tests of the page that have no server compare what it writes with what `page_numbers` has written."""
    assert json.loads(page_numbers.FIXTURE.read_text(encoding="utf-8")) == page_numbers.fixture()
