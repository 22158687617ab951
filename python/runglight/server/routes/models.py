"""Models: what they know, how long their transitions took, learning a new one."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from runglight.configuration import Parameters
from runglight.errors import InputError
from runglight.log.changelog import read_log_with
from runglight.log.symbols import names_by_address, read_symbols, renamed
from runglight.model import NominalModel, learn_with, load_model
from runglight.server.answers import body_of, json_answer
from runglight.server.catalogue import free_name
from runglight.server.places import state_parts
from runglight.server.routes.timing import source_of
from runglight.server.transition_times import transition_times
from runglight.server.workshop_of import workshop_of
from runglight.strictly import convert

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight.server.workshop import Workshop


class Lesson(msgspec.Struct):
    """What to learn from, and what to call it."""

    sources: list[str]
    name: str


async def get_models(request: Request) -> Response:
    """The models there are; `watching` is the one in use."""
    workshop = workshop_of(request)
    items = await asyncio.to_thread(workshop.catalogue.items, "model")
    watching = workshop.model_item
    return json_answer(
        [
            {
                "id": item.id,
                "name": item.name,
                "watching": watching is not None and item.id == watching.id,
            }
            for item in items
        ]
    )


async def get_model(request: Request) -> Response:
    """Groups, devices, and how it was learned."""
    model, name = await _model(workshop_of(request), request.path_params["model"])
    return json_answer({"name": name, **await asyncio.to_thread(model.summary)})


async def get_rules(request: Request) -> Response:
    """The rules of one device (`group`, `device`), of a group's chain (`group` alone), or `all`."""
    model, _ = await _model(workshop_of(request), request.path_params["model"])
    if request.query_params.get("all"):
        return Response(await asyncio.to_thread(model.rules_json), media_type="application/json")
    group = request.query_params.get("group")
    device = request.query_params.get("device") or None
    text = await asyncio.to_thread(model.rules_json, group, device)
    if device is None:
        rows: list[dict[str, Any]] = json.loads(text)
        return json_answer([row for row in rows if row["model"] == "group"])
    return Response(text, media_type="application/json")


async def get_times(request: Request) -> Response:
    """Every time one transition was seen in a source: `current`, `next`, `group`, `device`.

    `known` says whether the source has its signals at all: it may be of another machine.
    """
    workshop = workshop_of(request)
    model, _ = await _model(workshop, request.path_params["model"])
    source = await source_of(workshop, request.query_params.get("source", "live"))
    query = request.query_params
    group, device = query.get("group", ""), query.get("device") or None
    current, following = query.get("current", ""), query.get("next", "")
    starts = _starting_signals(model, group)
    lanes = {
        lane: place.full
        for lane, place in enumerate(source.places)
        if (place.group == group and place.device == device if device else place.full in starts)
    }
    (current_signal, current_value), (next_signal, next_value) = map(
        state_parts, (current, following)
    )
    if current_value is None or next_value is None:
        raise InputError("current and next: expected two signal-states, like Group1-PrtLDR-RET_ON")
    times = await asyncio.to_thread(
        transition_times,
        source.diagram,
        lanes,
        current=(current_signal, current_value),
        following=(next_signal, next_value),
        start_ns=source.origin_ns,
        until_ns=source.until_ns + 1,
    )
    known = {current_signal, next_signal} <= set(lanes.values())
    return json_answer({"source": source.name, "known": known, "times": times})


async def post_learn(request: Request) -> Response:
    """Learns a model from recordings and logs, and watches with it."""
    workshop = workshop_of(request)
    lesson = await body_of(request, Lesson)
    if not lesson.sources:
        raise InputError("choose what to learn from first: a recording of the sound machine")
    items = [workshop.catalogue.item(each, "recording", "log") for each in lesson.sources]
    target = free_name(workshop.directory, lesson.name, ".model")
    configuration = workshop.configuration

    def learn() -> dict[str, Any]:
        logs = [read_log_with(item.path, configuration.log) for item in items]
        table = configuration.symbols.table
        symbols = None if table is None else read_symbols(Path(table))
        naming = configuration.symbols.naming
        if symbols is not None:
            logs = [renamed(log, names_by_address(symbols, naming)) for log in logs]
        written = msgspec.to_builtins(configuration.signal_state) | {"naming": naming}
        parameters = convert(written, Parameters, "learn")
        model = learn_with(logs, symbols, parameters, configuration.cycle_json())
        model.save(target)
        return model.summary()

    summary = await asyncio.to_thread(learn)
    await workshop.reopen()
    item = workshop.catalogue.of_path(target)
    return json_answer(
        {"id": None if item is None else item.id, "name": target.name, "rules": summary["rules"]}
    )


async def _model(workshop: Workshop, model_id: str) -> tuple[NominalModel, str]:
    item = workshop.model_item
    if item is not None and workshop.model is not None and item.id == model_id:
        return workshop.model, item.name
    item = workshop.catalogue.item(model_id, "model")
    return await asyncio.to_thread(load_model, item.path), item.name


def _starting_signals(model: NominalModel, group: str) -> set[str]:
    return {
        f"{entry['group']}-{device['device']}-{device['start']}"
        for entry in model.summary()["group_list"]
        if entry["group"] == group
        for device in entry["devices"]
    }


ROUTES = [
    Route("/api/models", get_models),
    Route("/api/models/learn", post_learn, methods=["POST"]),
    Route("/api/models/{model}", get_model),
    Route("/api/models/{model}/rules", get_rules),
    Route("/api/models/{model}/times", get_times),
]
