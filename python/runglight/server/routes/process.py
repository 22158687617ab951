"""The process: nets, the runs that follow them, and the learned controller beside the machine."""

from __future__ import annotations

import asyncio
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from runglight.errors import InputError
from runglight.process.event_log import read_event_log
from runglight.process.openings import openings
from runglight.replacing import replacing
from runglight.server.answers import body_of, json_answer, number_of
from runglight.server.catalogue import NET_ENDING, SOURCES, free_name
from runglight.server.process.besides import besides_of
from runglight.server.process.jobs import processes_of
from runglight.server.process.work import GUARDS_ENDING, Wanted, read_source
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.requests import Request

    from runglight.server.process.opened import OpenedProcess

OPENINGS_TOLD = 200
STEPS_TOLD = 60


class Named(msgspec.Struct):
    """What a net shall be called."""

    name: str


async def get_processes(request: Request) -> Response:
    """What can be mined, and what is there already."""
    workshop = workshop_of(request)
    items = await asyncio.to_thread(workshop.catalogue.items)
    configured = workshop.configuration.process
    return json_answer(
        {
            "sources": [
                {"id": each.id, "name": each.name, "kind": each.kind}
                for each in items
                if each.kind in SOURCES
            ],
            "nets": [{"id": each.id, "name": each.name} for each in items if each.kind == "net"],
            "mined": [
                {"id": each.id, "name": each.title, "reset": each.reset}
                for each in processes_of(request).all()
            ],
            "configured": {
                "reset": configured.reset,
                "eta": configured.eta,
                "epsilon": configured.epsilon,
                "only": configured.only,
            },
        }
    )


async def get_openings(request: Request) -> Response:
    """Where the runs of a source may begin, the likeliest first, and its signals.

    `only` narrows it to some signals: names with line breaks between them.
    """
    workshop = workshop_of(request)
    item = await asyncio.to_thread(
        workshop.catalogue.item, request.query_params.get("source", ""), *SOURCES
    )
    only = [name for name in request.query_params.get("only", "").split("\n") if name]
    configuration = workshop.configuration

    def look() -> dict[str, Any]:
        if item.path.suffix.lower() == ".xes":
            runs = read_event_log(item.path)
            if runs.traces > 1:
                return {"runs": runs.traces, "activities": len(runs.activities)}
        log = read_source(item, configuration)
        table = configuration.symbols.table
        try:
            found, events = openings(
                log,
                symbols=None if table is None else Path(table),
                naming=configuration.symbols.naming,
                only=only,
            )
        except InputError as error:
            # A recording of a moment is no mistake of who looks through them.
            return {"signals": log.signals, "activities": 0, "openings": [], "why": str(error)}
        return {
            "signals": log.signals,
            "activities": len(events.activities),
            "events": len(events),
            "openings": found[:OPENINGS_TOLD],
            "left_out": max(len(found) - OPENINGS_TOLD, 0),
        }

    told = await asyncio.to_thread(look)
    if "signals" in told:
        told["signals"] = workshop.log_signals(told["signals"], {})
        changes = {each.change.rpartition("=")[0] for each in told["openings"]}
        told["places"] = {each.name: each for each in told["signals"] if each.name in changes}
    return json_answer(told)


async def post_mine(request: Request) -> Response:
    """Begins to mine a source, or to hold it against a net; `GET` the job to see how far it is."""
    wanted = await body_of(request, Wanted)
    if not (0 <= wanted.eta <= 1 and 0 <= wanted.epsilon <= 1):
        raise InputError("eta and epsilon: expected numbers from 0 to 1")
    return json_answer(await processes_of(request).begin(wanted))


async def get_job(request: Request) -> Response:
    """How far it is."""
    return json_answer(processes_of(request).job(request.path_params["job"]))


async def get_process(request: Request) -> Response:
    """The net, how good it is, and its runs."""
    process = await processes_of(request).of(request.path_params["process"])
    return json_answer(await asyncio.to_thread(_picture, process))


async def get_run(request: Request) -> Response:
    """One run, event by event, with the tokens."""
    process = await processes_of(request).of(request.path_params["process"])
    return json_answer(await asyncio.to_thread(process.run, request.path_params["run"]))


async def get_live(request: Request) -> Response:
    """The net beside the live machine, as it is now; steps that came `after` a number."""
    process = await processes_of(request).of(request.path_params["process"])
    beside = besides_of(request).beside(process)
    after = number_of(request, "after", 0)
    now = beside.now()
    found = await asyncio.to_thread(beside.chances)
    workshop = workshop_of(request)
    return json_answer(
        {
            "state": workshop.live.watching.state,
            "at_ms": beside.feed.until_ns / 1e6,
            "since_ms": (beside.since_ns or 0) / 1e6,
            "missing": beside.missing,
            "given_up": beside.given_up,
            "sure": beside.sure and not beside.given_up,
            "runs": beside.runs,
            "marking": beside.marking(),
            "steps": [each for each in beside.steps if each.number > after][-STEPS_TOLD:],
            "now": now,
            "outputs": beside.outputs(now),
            "problem": beside.problem,
            "follows": beside.follows,
            "told": beside.told,
            "disagreements": [msgspec.Raw(line.encode()) for line in beside.disagreements],
            "chances": found[:8],
        }
    )


async def post_keep(request: Request) -> Response:
    """Writes a mined net into the directory, and its guards beside it."""
    processes = processes_of(request)
    process = await processes.of(request.path_params["process"])
    named = await body_of(request, Named)
    target = free_name(workshop_of(request).directory, named.name or process.title, NET_ENDING)

    def keep() -> None:
        process.net.write(target)
        if process.guards is not None:
            with replacing(target.with_suffix(GUARDS_ENDING)) as temporary:
                temporary.write_text(process.guards, encoding="utf-8")

    await asyncio.to_thread(keep)
    item = workshop_of(request).catalogue.of_path(target)
    return json_answer({"id": None if item is None else item.id, "name": target.name})


async def get_file(request: Request) -> Response:
    """`net.pnml`, `net.bpmn`, `runs.xes`, `program.st` or `guards.json`."""
    process = await processes_of(request).of(request.path_params["process"])
    name = request.path_params["file"]
    if name == "program.st":
        if process.no_controller is not None:
            raise InputError(process.no_controller)
        body = (await asyncio.to_thread(process.structured_text)).encode()
    elif name == "guards.json" and process.guards is not None:
        body = process.guards.encode()
    else:
        write = _writer(process, name)
        if write is None:
            raise InputError("there is no such file; download what the page offers")
        body = await asyncio.to_thread(_written, write, name)
    answer = Response(body, media_type="application/octet-stream")
    answer.headers["content-disposition"] = f'attachment; filename="{name}"'
    return answer


def _writer(process: OpenedProcess, name: str) -> Callable[[Path], None] | None:
    if name == "net.pnml":
        return process.net.write
    if name == "net.bpmn" and process.mined is not None:
        return process.mined.write_bpmn
    if name == "runs.xes" and process.runs is not None:
        return process.runs.log.write
    return None


def _written(write: Callable[[Path], None], name: str) -> bytes:
    """The engine writes files only."""
    with tempfile.TemporaryDirectory(prefix="runglight-") as directory:
        path = Path(directory) / name
        write(path)
        return path.read_bytes()


def _picture(process: OpenedProcess) -> dict[str, Any]:
    net, runs = process.net, process.runs
    return {
        "id": process.id,
        "title": process.title,
        "kept": process.item is not None,
        "reset": process.reset,
        "signals": process.places,
        "net": {
            "places": [
                {"id": name, "first": first, "last": last}
                for name, first, last in zip(net.places, net.initial, net.last, strict=True)
            ],
            "transitions": [
                {
                    "id": each.id,
                    "label": each.label,
                    "signal_class": each.signal_class,
                    "inputs": each.inputs,
                    "outputs": each.outputs,
                }
                for each in net.transitions
            ],
        },
        "soundness": process.soundness,
        "epsilon": None if process.mined is None else process.mined.epsilon,
        "runs": None
        if runs is None
        else {
            "source": runs.source,
            "count": runs.log.traces,
            "events": len(runs.log),
            "activities": len(runs.log.activities),
            "fitness": runs.fitness.fitness,
            "fitting": runs.fitness.fitting,
            "precision": runs.precision,
            "variants": runs.variants,
            "different": runs.different,
        },
        "guards": process.guards_in_words(),
        "no_controller": process.no_controller,
        "network": process.network_name,
        "disagreements": [msgspec.Raw(line.encode()) for line in process.disagreements],
        "files": [
            name
            for name in ("net.pnml", "net.bpmn", "runs.xes")
            if _writer(process, name) is not None
        ]
        + ([] if process.no_controller else ["program.st"])
        + ([] if process.guards is None else ["guards.json"]),
    }


ROUTES = [
    Route("/api/process", get_processes),
    Route("/api/process/openings", get_openings),
    Route("/api/process/mine", post_mine, methods=["POST"]),
    Route("/api/process/jobs/{job}", get_job),
    Route("/api/process/{process}", get_process),
    Route("/api/process/{process}/runs/{run:int}", get_run),
    Route("/api/process/{process}/live", get_live),
    Route("/api/process/{process}/keep", post_keep, methods=["POST"]),
    Route("/api/process/{process}/files/{file}", get_file),
]
