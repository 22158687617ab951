"""A Kafka topic as the command line names it.

`kafka://HOST:PORT[,HOST:PORT…]/TOPIC[?option=value]`
"""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote, urlsplit

from runglight.errors import InputError

SCHEME = "kafka://"


@dataclass(frozen=True)
class Topic:
    """Where a topic is, and what a client shall know beside."""

    servers: str
    name: str
    options: dict[str, str]


def topic_of(place: str) -> Topic:
    """Takes an address apart; raises InputError."""
    url = urlsplit(place)
    name = unquote(url.path.strip("/"))
    if url.scheme != "kafka" or not url.netloc or not name:
        raise InputError(f"{place}: write it like {SCHEME}broker:9092/topic")
    return Topic(unquote(url.netloc), name, dict(parse_qsl(url.query)))
