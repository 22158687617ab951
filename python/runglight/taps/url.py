"""Source URLs: `modbus://HOST[:PORT]/PATH?option=value&…`, taken apart and checked."""

from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote, urlsplit

from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.taps.registry import SCHEMES

EVERYWHERE = ("interval",)
"""Options every tap has."""


@dataclass(frozen=True, slots=True)
class SourceUrl:
    """A source URL in its parts; `text` has no password in it."""

    text: str
    scheme: str
    host: str
    port: int
    path: str
    options: dict[str, str]
    username: str | None = None
    password: str | None = None


def is_live(source: str) -> bool:
    """Whether a source is a live address (or a replay) and not the name of a file."""
    scheme, separator, _ = source.partition(":")
    return bool(separator) and scheme.lower() in SCHEMES


def parse_source(source: str) -> SourceUrl:
    """Takes a source URL apart; InputError for a scheme, port or option that does not exist."""
    scheme, separator, rest = source.partition(":")
    scheme = scheme.lower()
    if not separator or scheme not in SCHEMES:
        near = suggestion(scheme, SCHEMES) or f"; there are: {', '.join(SCHEMES)}"
        raise InputError(f"{source}: no live source is called {scheme!r}{near}")
    description = SCHEMES[scheme]
    if description.takes_file:
        file, _, query = rest.partition("?")
        return SourceUrl(source, scheme, "", 0, file, _options(source, scheme, query))
    try:
        # A topic filter ends in `#`, and options may follow it: it begins no fragment here.
        parts = urlsplit(source.replace("#", "%23"))
        port = parts.port or description.port
    except ValueError as error:
        raise InputError(f"{source}: {error}; write {description.example}") from None
    if not parts.hostname:
        raise InputError(f"{source}: names no host; write {description.example}")
    hidden = parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()
    hidden = hidden.replace("%23", "#")
    return SourceUrl(
        text=hidden,
        scheme=scheme,
        host=parts.hostname,
        port=port,
        path=unquote(parts.path.removeprefix("/")),
        options=_options(hidden, scheme, parts.query),
        username=None if parts.username is None else unquote(parts.username),
        password=None if parts.password is None else unquote(parts.password),
    )


def _options(source: str, scheme: str, query: str) -> dict[str, str]:
    known = (*EVERYWHERE, *SCHEMES[scheme].options)
    options: dict[str, str] = {}
    for key, value in parse_qsl(query, keep_blank_values=True):
        if not any(_is_option(key, option) for option in known):
            near = suggestion(key, known) or f"; {scheme} knows: {', '.join(known)}"
            raise InputError(f"{source}: unknown option {key!r}{near}")
        if key in options:
            raise InputError(f"{source}: {key} is given twice; give it once")
        options[key] = value
    return options


def _is_option(key: str, option: str) -> bool:
    """`db*` stands for `db1`, `db2` and so on."""
    if option.endswith("*"):
        number = key.removeprefix(option[:-1])
        return number != key and number.isascii() and number.isdigit()
    return key == option
