"""Nets beside the live machine: followed from the first look on, also while nobody looks."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from typing import TYPE_CHECKING

from runglight.errors import InputError
from runglight.log.symbols import names_by_address, read_symbols
from runglight.server.process.beside import Beside
from runglight.server.workshop_of import kept_of

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight.server.process.opened import OpenedProcess
    from runglight.server.workshop import Workshop

FOLLOWED_AT_ONCE = 3


class Besides:
    """Of one server; lives in the event loop."""

    def __init__(self, workshop: Workshop) -> None:
        self._workshop = workshop
        self._following: OrderedDict[str, Beside] = OrderedDict()

    def beside(self, process: OpenedProcess) -> Beside:
        """A process beside the machine; InputError where nothing comes from it."""
        feed = self._workshop.live.feed
        if feed is None or feed.start_ns is None:
            raise InputError("nothing has come from the machine yet; check the connection")
        known = self._following.get(process.id)
        if known is None or known.feed is not feed or known.process is not process:
            if known is not None:
                known.feed.forget_listener(known.take)
            known = self._following[process.id] = Beside(process, feed, self._names())
            feed.listeners.append(known.take)
        self._following.move_to_end(process.id)
        while len(self._following) > FOLLOWED_AT_ONCE:
            _, oldest = self._following.popitem(last=False)
            oldest.feed.forget_listener(oldest.take)
        return known

    def _names(self) -> dict[str, str]:
        """Names of addresses and addresses of names, as the symbols say."""
        symbols, model = self._workshop.configuration.symbols, self._workshop.model
        tables = []
        if symbols.table is not None:
            tables.append(names_by_address(read_symbols(Path(symbols.table)), symbols.naming))
        if model is not None:
            tables.append(names_by_address(model.symbols(), symbols.naming))
        found: dict[str, str] = {}
        for table in tables:
            for address, name in table.items():
                found.setdefault(address, name)
                found.setdefault(name, address)
        return found


def besides_of(request: Request) -> Besides:
    """Of the server a request is answered by."""
    return kept_of(request, Besides)
