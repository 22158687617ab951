"""Incidents: one in full, what operators do about them, and the list for a spreadsheet."""

from __future__ import annotations

import asyncio
import csv
import datetime
import io
import json
from typing import TYPE_CHECKING

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from runglight.errors import InputError
from runglight.findings.acceptance import may_be_accepted, refuse_without_path
from runglight.server.answers import body_of, json_answer
from runglight.server.context import source_around
from runglight.server.ghosts import ghosts_of, time_ns
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight.server.incidents import Incident, Summary
    from runglight.server.workshop import Workshop

LONGEST_SHELF_MIN = 7 * 24 * 60
_COLUMNS = (
    "id",
    "time",
    "state",
    "severity",
    "kind",
    "place",
    "message",
    "look_first",
    "findings",
    "acknowledged_by",
    "acknowledged_at",
    "shelved_by",
    "shelved_until",
)


class Chosen(msgspec.Struct):
    """Some incidents, and who does something about them."""

    ids: list[str]
    who: str
    minutes: int | None = None
    """Of shelving."""


class Accepting(msgspec.Struct):
    """A finding whose path shall be nominal from now on."""

    finding: str
    who: str


async def get_incident(request: Request) -> Response:
    """Everything about one incident."""
    workshop = workshop_of(request)
    incident = _incident(workshop, request.path_params["incident"])
    leading = incident.leading
    findings = sorted(incident.findings.values(), key=lambda each: each.time)
    snapshot_ids = [each.snapshot_id for each in (leading, *findings) if each.snapshot_id]
    snapshots = await workshop.with_store(
        lambda store: [text for each in snapshot_ids[:1] if (text := store.snapshot(each))]
    )
    rules = []
    if workshop.model is not None and leading.group is not None:
        device = leading.device if leading.model == "device" else None
        rules = json.loads(workshop.model.rules_json(leading.group, device))
    at_ns = time_ns(leading.time)
    return json_answer(
        {
            "summary": workshop.incidents.summary(incident),
            "leading": leading,
            "findings": findings,
            "acceptable": [each.id for each in findings if may_be_accepted(each)],
            "at_ns": str(at_ns),
            "source": await source_around(workshop, at_ns),
            "ghosts": ghosts_of(leading, rules),
            "rules": rules,
            "snapshot": json.loads(snapshots[0]) if snapshots else None,
        }
    )


async def post_acknowledge(request: Request) -> Response:
    """Somebody has seen them."""
    chosen = await body_of(request, Chosen)
    await workshop_of(request).act("acknowledge", chosen.ids, chosen.who)
    return json_answer({"done": len(chosen.ids)})


async def post_shelve(request: Request) -> Response:
    """Quiet for some minutes; `minutes` 0 takes them off the shelf."""
    chosen = await body_of(request, Chosen)
    minutes = chosen.minutes if chosen.minutes is not None else 60
    if not 0 <= minutes <= LONGEST_SHELF_MIN:
        raise InputError(f"minutes: shelve for up to {LONGEST_SHELF_MIN:,} (a week)")
    workshop = workshop_of(request)
    if minutes == 0:
        await workshop.act("unshelve", chosen.ids, chosen.who)
    else:
        until = datetime.datetime.now(datetime.UTC) + datetime.timedelta(minutes=minutes)
        text = until.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        await workshop.act("shelve", chosen.ids, chosen.who, text)
    return json_answer({"done": len(chosen.ids)})


async def post_accept(request: Request) -> Response:
    """The path of a finding becomes part of the model, and watching goes on with it."""
    workshop = workshop_of(request)
    accepting = await body_of(request, Accepting)
    incident = workshop.incidents.of_finding(accepting.finding)
    if incident is None or workshop.model is None or workshop.model_item is None:
        raise InputError("there is no such finding any more; look at the list again")
    finding = incident.findings[accepting.finding]
    refuse_without_path(finding)
    if not accepting.who.strip():
        raise InputError("say who you are first: it is kept with what you do")
    model, path = workshop.model, workshop.model_item.path
    new = await asyncio.to_thread(model.confirm, msgspec.json.encode(finding).decode())
    if new:
        await asyncio.to_thread(model.save, path)
    await workshop.act("accept", [incident.id], accepting.who)
    await workshop.act("acknowledge", [incident.id], accepting.who)
    if new:
        await workshop.reopen()
    return json_answer({"new_transitions": new})


async def get_csv(request: Request) -> Response:
    """The list for a spreadsheet: all of it, or the chosen `ids`."""
    workshop = workshop_of(request)
    wanted = {each for each in request.query_params.get("ids", "").split(",") if each}
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for summary in workshop.incidents.summaries():
        if not wanted or summary.id in wanted:
            writer.writerow(map(_harmless, _row(summary)))
    answer = Response(text.getvalue(), media_type="text/csv; charset=utf-8")
    answer.headers["content-disposition"] = 'attachment; filename="incidents.csv"'
    return answer


def _row(summary: Summary) -> list[str]:
    acknowledged, shelved = summary.acknowledged, summary.shelved
    return [
        summary.id,
        summary.time,
        summary.state,
        summary.severity,
        summary.kind,
        summary.place,
        summary.message,
        summary.look_first,
        str(summary.findings),
        acknowledged.who if acknowledged else "",
        acknowledged.time if acknowledged else "",
        shelved.who if shelved else "",
        (shelved.until or "") if shelved else "",
    ]


def _harmless(cell: str) -> str:
    """A spreadsheet takes what begins like this for a formula."""
    return f"'{cell}" if cell.startswith(("=", "+", "-", "@", "\t")) else cell


def _incident(workshop: Workshop, incident_id: str) -> Incident:
    incident = workshop.incidents.get(incident_id)
    if incident is None:
        raise InputError("there is no such incident any more; look at the list again")
    return incident


ROUTES = [
    Route("/api/incidents.csv", get_csv),
    Route("/api/incidents/acknowledge", post_acknowledge, methods=["POST"]),
    Route("/api/incidents/shelve", post_shelve, methods=["POST"]),
    Route("/api/incidents/accept", post_accept, methods=["POST"]),
    Route("/api/incidents/{incident}", get_incident),
]
