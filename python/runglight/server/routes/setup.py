"""Set-up: the configuration with its secrets hidden, and the symbol table."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
from starlette.routing import Route

from runglight.configuration import Configuration, parse_configuration
from runglight.errors import InputError
from runglight.replacing import replacing
from runglight.server.answers import body_of, json_answer
from runglight.server.secrets_in_text import hidden, restored
from runglight.server.symbol_rows import Row, parse_rows, rows_text
from runglight.server.workshop_of import workshop_of
from runglight.taps import is_live, open_tap

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from runglight.server.workshop import Workshop


class Text(msgspec.Struct):
    """The text of a configuration."""

    text: str


class Rows(msgspec.Struct):
    """The rows of a symbol table."""

    rows: list[Row]


async def get_configuration(request: Request) -> Response:
    """The file as it is, without its secrets."""
    workshop = workshop_of(request)
    return json_answer({"name": workshop.configuration_path.name, "text": hidden(_text(workshop))})


async def post_check(request: Request) -> Response:
    """Whether a text would be a configuration; never an error."""
    workshop = workshop_of(request)
    text = (await body_of(request, Text)).text
    try:
        _checked(workshop, text)
    except InputError as error:
        return json_answer({"error": str(error)})
    return json_answer({"error": None})


async def post_configuration(request: Request) -> Response:
    """Replaces the file, and begins anew with it."""
    workshop = workshop_of(request)
    text = _checked(workshop, (await body_of(request, Text)).text)
    _write(workshop.configuration_path, text)
    await workshop.reopen()
    return json_answer({"saved": workshop.configuration_path.name})


async def get_symbols(request: Request) -> Response:
    """The symbol table in force: the file, else what the model was learned with."""
    workshop = workshop_of(request)
    path = symbols_path(workshop)
    if path.is_file():
        text = await asyncio.to_thread(path.read_text, "utf-8-sig")
    elif workshop.model is not None:
        text = workshop.model.symbols()
    else:
        text = rows_text(
            [
                Row(address=place.address, signal=place.signal, type=place.type)
                for place in workshop.live_signals()
            ]
        )
    return json_answer({"name": path.name, "exists": path.is_file(), "rows": parse_rows(text)})


async def post_symbols(request: Request) -> Response:
    """Replaces the symbol table, and begins anew with it."""
    workshop = workshop_of(request)
    rows = (await body_of(request, Rows)).rows
    path = symbols_path(workshop)
    _write(path, rows_text(rows))
    await workshop.reopen()
    return json_answer({"saved": path.name})


def _text(workshop: Workshop) -> str:
    path = workshop.configuration_path
    return path.read_text("utf-8-sig") if path.is_file() else ""


def _checked(workshop: Workshop, text: str) -> str:
    """The text with its secrets, where it can be used; InputError otherwise."""
    whole = restored(text, _text(workshop))
    path = Path(workshop.configuration_path.name)
    configuration: Configuration = parse_configuration(whole, path)
    url = configuration.source.url
    if url is not None and is_live(url):
        # Opened without being entered, a tap looks at its address and touches nothing.
        open_tap(url, interval=configuration.source.interval)
    return whole


def symbols_path(workshop: Workshop) -> Path:
    """The symbol table, whether or not it is there yet."""
    table = workshop.configuration.symbols.table
    return Path(table) if table is not None else workshop.directory / "symbols.csv"


def _write(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


ROUTES = [
    Route("/api/configuration", get_configuration),
    Route("/api/configuration", post_configuration, methods=["POST"]),
    Route("/api/configuration/check", post_check, methods=["POST"]),
    Route("/api/symbols", get_symbols),
    Route("/api/symbols", post_symbols, methods=["POST"]),
]
