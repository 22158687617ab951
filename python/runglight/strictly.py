"""Turns what a user wrote (a table of a file, keyword arguments) into a settings struct."""

import re
from collections.abc import Mapping
from typing import Any, TypeVar

import msgspec

from runglight.errors import InputError
from runglight.nearest import suggestion

Settings = TypeVar("Settings", bound=msgspec.Struct)


def known_keys(settings: type[msgspec.Struct]) -> list[str]:
    """The keys a table may hold."""
    return [field.encode_name for field in msgspec.structs.fields(settings)]


def convert(written: Mapping[str, Any], settings: type[Settings], where: str) -> Settings:
    """The settings, or an InputError that names `where`, the key, and what was expected."""
    known = known_keys(settings)
    for key in written:
        if key not in known:
            near = suggestion(key, known)
            raise InputError(
                f"{where}: unknown key {key!r}{near or '; known keys: ' + ', '.join(known)}"
            )
    try:
        return msgspec.convert(dict(written), settings)
    except msgspec.ValidationError as error:
        problem, _, path = str(error).partition(" - at ")
        key = path.strip("`").removeprefix("$").removeprefix(".")
        problem = re.sub(r"`(\w+)`", r"\1", problem)
        problem = problem[:1].lower() + problem[1:]
        raise InputError(f"{where}: {key + ': ' if key else ''}{problem}") from None
