"""The requests that there are, and what answers each."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import Any

from starlette.requests import Request
from starlette.responses import FileResponse, Response

from inerter.app import about, bodies, documents, parts, study_parts
from inerter.app.api_description import Endpoint, openapi
from inerter.app.calls import panel
from inerter.app.designs import designs_of
from inerter.app.examples import example_cards
from inerter.app.fixed_designs import with_fixed_values
from inerter.app.jobs import Job, as_event, result_of, with_result
from inerter.app.kinds import KINDS
from inerter.app.panels import PANELS, at_once
from inerter.app.responses import as_events, as_json, media_type
from inerter.app.server import Server
from inerter.app.start import to_document
from inerter.app.wire import Refusal, decode_json, encode_json
from inerter.files.common.toml import as_toml


def _about(server: Server, request: Request) -> dict[str, Any]:
    return {**about.about(), "kernels": server.warming.to_dict()}


async def _ready(server: Server, request: Request) -> Response:
    return as_events(as_event(number, event) async for number, event in server.warming.events())


def _example(server: Server, request: Request) -> dict[str, Any]:
    found = about.examples()
    name = request.path_params["name"]
    if name not in found:
        raise Refusal(404, f"Unknown example; available: {', '.join(found)}.")
    return to_document(f"{name}.toml", found[name].read_text(encoding="utf-8"))


def _read(server: Server, request: Request, body: bodies.ReadStudy) -> dict[str, Any]:
    if (body.text is None) == (body.study is None):
        raise Refusal(400, "Give either the text of a study file or a study document.")
    if body.text is not None:
        return documents.read(body.text, body.name)
    study = body.study or {}
    return {"study": study, "kind": documents.command_of(study), "problems": documents.problems(study)}


async def _check(server: Server, request: Request, body: bodies.CheckStudy) -> Response:
    return as_json(await server.check(body.study))


def _write(server: Server, request: Request, body: bodies.WriteStudy) -> dict[str, Any]:
    if not body.designs:
        return {"text": as_toml(body.study)}
    study = documents.study_from(body.study)
    document = with_fixed_values(body.study, study, designs_of(study, body.model_dump()))
    return {"text": as_toml(document), "study": document}


async def _panel(server: Server, request: Request, body: bodies.PanelRequest) -> Response:
    key = request.path_params["name"]
    if key not in PANELS:
        raise Refusal(404, f"Unknown panel {key!r}; available: {', '.join(PANELS)}.")
    asked = body.model_dump(exclude_unset=True)
    lane = "quick" if at_once(key, asked) else "slow"
    if lane == "slow" or key == "optimise":
        await server.warming.wait()
    asking = panel, "inerter.app.answers:answer_panel", key, asked
    found = await server.newest.ask(server.lanes[lane], (body.client, key), body.sequence, asking)
    return as_json(found)


async def _add_work(server: Server, request: Request, body: bodies.WorkRequest) -> Response:
    if body.kind not in KINDS:
        raise Refusal(400, f"Unknown kind of job {body.kind!r}; available: {', '.join(KINDS)}.")
    asked = body.model_dump(exclude_unset=True, exclude={"wait", "title", "kind"})
    asked["records"] = [str(server.records.get(record)) for record in body.records]
    job = server.jobs.add(body.kind, asked, body.title)
    if body.wait:
        with suppress(TimeoutError):
            await asyncio.wait_for(job.over.wait(), body.wait)
    return as_json(with_result(job), 201)


async def _all_work(server: Server, request: Request) -> dict[str, Any]:
    return {"work": [job.to_dict() for job in server.jobs.known.values()]}


async def _one_work(server: Server, request: Request) -> dict[str, Any]:
    return _job(server, request).to_dict()


async def _work_events(server: Server, request: Request) -> Response:
    job, last = _job(server, request), request.headers.get("last-event-id", "0")
    start = int(last) if last.isascii() and last.isdigit() and len(last) < 16 else 0
    return as_events(as_event(number, event) async for number, event in server.jobs.events(job, start))


async def _stop_work(server: Server, request: Request) -> dict[str, Any]:
    job = _job(server, request)
    if job.over.is_set():
        server.jobs.forget(job)
        return {"id": job.id, "state": "forgotten"}
    server.jobs.stop(job)
    return job.to_dict()


async def _resume_work(server: Server, request: Request) -> dict[str, Any]:
    job = _job(server, request)
    server.jobs.resume(job)
    return job.to_dict()


async def _work_result(server: Server, request: Request) -> Response:
    return as_json(result_of(_job(server, request)))


async def _work_files(server: Server, request: Request) -> dict[str, Any]:
    files = _job(server, request).files()
    return {"files": [{"name": name, "size": path.stat().st_size} for name, path in files.items()]}


async def _work_file(server: Server, request: Request) -> Response:
    files, name = _job(server, request).files(), request.path_params["name"]
    if name not in files:
        raise Refusal(404, "Unknown file of this job.")
    return FileResponse(files[name], media_type=media_type(name), filename=files[name].name)


def _job(server: Server, request: Request) -> Job:
    return server.jobs.get(request.path_params["id"])


async def _take_record(server: Server, request: Request) -> Response:
    number = await server.records.take(request.query_params.get("name", ""), request.stream())
    path = server.records.get(number)
    try:
        found = await server.aside("inerter.app.record_findings:found_in", str(path))
    except Refusal:
        server.records.forget(number)
        raise
    return as_json(encode_json({"id": number, "size": path.stat().st_size})[:-1] + b", " + found[1:], 201)


async def _forget_record(server: Server, request: Request) -> dict[str, Any]:
    server.records.forget(request.path_params["id"])
    return {"id": request.path_params["id"], "state": "forgotten"}


async def _figure(server: Server, request: Request, body: bodies.FigureRequest) -> Response:
    await server.warming.wait()
    found = await server.aside("inerter.app.pictures:picture", body.model_dump())
    return Response(found, media_type=media_type(f".{body.format}"))


async def _csv(server: Server, request: Request, body: bodies.ExportRequest) -> Response:
    await server.warming.wait()
    found = await server.aside("inerter.app.tables:as_csv", body.panel, body.request.model_dump(exclude_unset=True))
    return Response(decode_json(found), media_type="text/csv; charset=utf-8")


async def _export(server: Server, request: Request, body: bodies.DesignExport) -> Response:
    found = await server.aside("inerter.app.design_exports:export_design", body.model_dump())
    return Response(found, media_type="application/octet-stream")


ENDPOINTS: tuple[Endpoint, ...] = (
    Endpoint("GET", "/api/openapi.json", "This description", lambda server, request: openapi(ENDPOINTS)),
    Endpoint("GET", "/api/about", "Available vehicles, indices, methods, panels and jobs", _about),
    Endpoint("GET", "/api/ready", "Progress of the compilation of kernels", _ready, media="text/event-stream"),
    Endpoint("GET", "/api/start", "The study of the command line", lambda server, request: server.start.to_dict()),
    Endpoint("GET", "/api/start/stamp", "Whether its file has changed", lambda server, request: server.start.stamp()),
    Endpoint("GET", "/api/examples", "Examples of the package", lambda server, request: example_cards()),
    Endpoint("GET", "/api/examples/{name}", "An example", _example),
    Endpoint("POST", "/api/study/read", "The document of a study file, and its problems", _read, bodies.ReadStudy),
    Endpoint(
        "POST",
        "/api/study/check",
        "Problems and notes of a study, its layouts and key paths",
        _check,
        bodies.CheckStudy,
    ),
    Endpoint(
        "POST",
        "/api/study/parts",
        "Networks, elements and numbers",
        lambda server, request, body: study_parts.parts_of_document(body.study),
        bodies.StudyParts,
    ),
    Endpoint(
        "POST",
        "/api/study/rename",
        "Other names of elements",
        lambda server, request, body: study_parts.renamed_document(body.study, body.names),
        bodies.RenameElements,
    ),
    Endpoint(
        "POST",
        "/api/study/device",
        "A strut with a device in it",
        lambda server, request, body: study_parts.struts_with_device(body.study, body.network, body.device),
        bodies.DeviceInStrut,
    ),
    Endpoint("POST", "/api/study/write", "A document as a study file", _write, bodies.WriteStudy),
    Endpoint(
        "POST",
        "/api/network/parse",
        "A network as a tree with places",
        lambda server, request, body: parts.parse_network(body.text, body.elements),
        bodies.ParseNetwork,
    ),
    Endpoint(
        "POST",
        "/api/quantity",
        "A quantity read or written",
        lambda server, request, body: parts.quantity(body.model_dump()),
        bodies.QuantityBody,
    ),
    Endpoint(
        "POST",
        "/api/quantities",
        "Several quantities read or written",
        lambda server, request, body: {"items": [parts.quantity(one.model_dump()) for one in body.items]},
        bodies.Quantities,
    ),
    Endpoint(
        "POST", "/api/panel/{name}", "A fast response; a newer request supersedes it", _panel, bodies.PanelRequest
    ),
    Endpoint("POST", "/api/work", "Start a job", _add_work, bodies.WorkRequest),
    Endpoint("GET", "/api/work", "All jobs", _all_work),
    Endpoint("GET", "/api/work/{id}", "State of a job", _one_work),
    Endpoint("GET", "/api/work/{id}/events", "Progress of a job", _work_events, media="text/event-stream"),
    Endpoint("DELETE", "/api/work/{id}", "Stop a job, or delete one that has ended", _stop_work),
    Endpoint("POST", "/api/work/{id}/resume", "Resume a stopped job", _resume_work),
    Endpoint("GET", "/api/work/{id}/result", "Result of a job", _work_result),
    Endpoint("GET", "/api/work/{id}/files", "Result files of a job", _work_files),
    Endpoint("GET", "/api/work/{id}/files/{name:path}", "A result file", _work_file, media="application/octet-stream"),
    Endpoint(
        "POST",
        "/api/records",
        "Upload a measured record; returns its findings",
        _take_record,
        accepts="application/octet-stream",
        query=("name",),
    ),
    Endpoint("DELETE", "/api/records/{id}", "Delete a record", _forget_record),
    Endpoint("POST", "/api/figure", "A picture", _figure, bodies.FigureRequest, media="image/svg+xml"),
    Endpoint(
        "POST",
        "/api/export/design",
        "A design in the format of another program",
        _export,
        bodies.DesignExport,
        media="application/octet-stream",
    ),
    Endpoint("POST", "/api/export/csv", "The numbers of a panel as a table", _csv, bodies.ExportRequest, "text/csv"),
)
