"""Processes that were opened, and the jobs that open them."""

from __future__ import annotations

import asyncio
import secrets
from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runglight.errors import InputError, RunglightError
from runglight.server.catalogue import SOURCES
from runglight.server.process.work import Sources, Wanted, opened, opened_net
from runglight.server.workshop_of import kept_of

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight.server.catalogue import Item
    from runglight.server.process.opened import OpenedProcess
    from runglight.server.workshop import Workshop

PROCESSES_KEPT = 6
JOBS_KEPT = 20
JOBS_AT_ONCE = 3


@dataclass(slots=True)
class Job:
    """One process on its way."""

    id: str
    stage: str = "waiting for another one to end"
    done: bool = False
    process: str | None = None
    """Id of what it opened."""
    error: str | None = None


class Processes:
    """Of one server; lives in the event loop."""

    def __init__(self, workshop: Workshop) -> None:
        self._workshop = workshop
        self._kept: OrderedDict[str, OpenedProcess] = OrderedDict()
        self._jobs: OrderedDict[str, Job] = OrderedDict()
        self._turn = asyncio.Lock()
        self._working: set[asyncio.Task[None]] = set()

    def all(self) -> list[OpenedProcess]:
        """What was mined, the newest first."""
        return [each for each in reversed(self._kept.values()) if each.item is None]

    async def of(self, process_id: str) -> OpenedProcess:
        """A mined process, or a net of the directory; InputError where there is none."""
        kept = self._kept.get(process_id)
        if kept is not None and not await asyncio.to_thread(kept.is_stale):
            self._kept.move_to_end(process_id)
            return kept
        catalogue = self._workshop.catalogue
        try:
            item = await asyncio.to_thread(catalogue.item, process_id, "net")
        except InputError:
            raise InputError(
                "this net is not there any more; what was mined and not kept ends with the server"
            ) from None
        networks = await asyncio.to_thread(catalogue.items, "next")
        configuration = self._workshop.configuration
        return self._keep(
            await asyncio.to_thread(opened_net, item, networks, configuration, _nothing)
        )

    def job(self, job_id: str) -> Job:
        """How far it is; InputError where there is no such job."""
        if job_id not in self._jobs:
            raise InputError("there is no such work any more; begin it again")
        return self._jobs[job_id]

    async def begin(self, wanted: Wanted) -> Job:
        """Begins to open a process; InputError where what is wanted is not there."""
        if sum(not job.done for job in self._jobs.values()) >= JOBS_AT_ONCE:
            raise InputError("several nets are being mined already; wait until one is ready")
        catalogue = self._workshop.catalogue
        source = await asyncio.to_thread(catalogue.item, wanted.source, *SOURCES)
        net: Item | None = None
        if wanted.net is not None:
            net = await asyncio.to_thread(catalogue.item, wanted.net, "net")
        networks = await asyncio.to_thread(catalogue.items, "next")
        sources = Sources(source, net, networks, self._workshop.configuration)
        job = Job(secrets.token_hex(6))
        self._jobs[job.id] = job
        while len(self._jobs) > JOBS_KEPT:
            self._jobs.popitem(last=False)
        task = asyncio.create_task(self._work(job, wanted, sources))
        self._working.add(task)
        task.add_done_callback(self._working.discard)
        return job

    def replace(self, process: OpenedProcess) -> None:
        """Keeps what was changed about a process."""
        self._keep(process)

    async def _work(self, job: Job, wanted: Wanted, sources: Sources) -> None:
        def say(stage: str) -> None:
            job.stage = stage

        async with self._turn:
            try:
                process = await asyncio.to_thread(opened, wanted, sources, say)
            except (RunglightError, OSError) as error:
                job.error = str(error)
            else:
                job.process = self._keep(process).id
            job.done = True

    def _keep(self, process: OpenedProcess) -> OpenedProcess:
        signals = process.signals()
        found = self._workshop.log_signals(signals, self._addresses())
        process.places = dict(zip(signals, found, strict=True))
        self._kept[process.id] = process
        self._kept.move_to_end(process.id)
        while len(self._kept) > PROCESSES_KEPT:
            self._kept.popitem(last=False)
        return process

    def _addresses(self) -> dict[str, str]:
        """Where the live machine keeps its signals, by name."""
        feed = self._workshop.live.feed
        return {} if feed is None else {each.name: each.address for each in feed.tap.signals}


def _nothing(_stage: str) -> None:
    """Nobody waits for stages of what takes a moment."""


def processes_of(request: Request) -> Processes:
    """Of the server a request is answered by."""
    return kept_of(request, Processes)
