"""Answers of the API: JSON, and errors as one sentence."""

from __future__ import annotations

import sqlite3
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
from starlette.responses import JSONResponse, Response

from runglight import environment
from runglight.errors import InputError, RunglightError

if TYPE_CHECKING:
    from starlette.requests import Request

Body = TypeVar("Body")
FARTHEST = 2 * 10**18
"""Nanoseconds: two of them still fit into 64 bits."""
_encoder = msgspec.json.Encoder()


def json_answer(content: object, status: int = 200) -> Response:
    """Anything msgspec encodes."""
    return Response(_encoder.encode(content), status, media_type="application/json")


async def body_of(request: Request, kind: type[Body]) -> Body:
    """The request's JSON as a struct; InputError where it is none."""
    try:
        return msgspec.json.decode(await request.body(), type=kind)
    except msgspec.DecodeError as error:
        raise InputError(f"this is no request of that kind: {error}") from None


def number_of(request: Request, name: str, default: int | None = None) -> int:
    """A whole number of the query; InputError where it is none."""
    text = request.query_params.get(name)
    if text is None and default is not None:
        return default
    digits = (text or "").removeprefix("-")
    if not digits.isdecimal() or len(digits) > 19 or int(digits) > FARTHEST:
        raise InputError(f"{name}: expected a whole number, found {text!r}")
    return int(text or "")


async def say_error(request: Request, error: Exception) -> Response:
    """An error as the user reads it."""
    if isinstance(error, RunglightError):
        return JSONResponse({"error": str(error)}, 400)
    if isinstance(error, sqlite3.Error):
        return JSONResponse({"error": f"the findings cannot be read ({error})"}, 500)
    if isinstance(error, OSError):
        place = f"{error.filename}: " if error.filename else ""
        return JSONResponse({"error": f"{place}{error.strerror or error}"}, 500)
    if environment.debug():
        raise error
    sentence = f"this is a defect of runglight, please report it: {type(error).__name__}"
    return JSONResponse({"error": sentence}, 500)


HANDLERS: dict[Any, Any] = {
    RunglightError: say_error,
    OSError: say_error,
    sqlite3.Error: say_error,
    Exception: say_error,
}
