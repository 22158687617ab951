"""Secrets in a configuration's text: hidden from the page, and put back when it is saved."""

from __future__ import annotations

import re

from runglight.errors import InputError

HIDDEN = "••••••"
_IN_ADDRESS = re.compile(
    r"(?P<before>[a-z0-9+]+://[^\s:/@\"']*:)(?P<secret>[^\s@\"']+)(?P<after>@)"
)
_IN_KEY = re.compile(
    r"(?P<before>(?:password|token|secret|authorization|key)\s*=\s*[\"'])"
    r"(?P<secret>[^\"'\n]+)(?P<after>[\"'])",
    re.IGNORECASE,
)
_IN_QUERY = re.compile(
    r"(?P<before>[?&](?:password|token|secret|key|sig|signature)=)(?P<secret>[^&\s\"']+)(?P<after>)",
    re.IGNORECASE,
)
_PATTERNS = (_IN_ADDRESS, _IN_KEY, _IN_QUERY)


def hidden(text: str) -> str:
    """The text with its secrets hidden."""
    for pattern in _PATTERNS:
        text = pattern.sub(lambda found: f"{found['before']}{HIDDEN}{found['after']}", text)
    return text


def restored(text: str, before: str) -> str:
    """A text that came from the page with the secrets of the one before it put back.

    InputError where it hides one that was not there: it would be lost.
    """
    for pattern in _PATTERNS:
        known: dict[str, list[str]] = {}
        for found in pattern.finditer(before):
            known.setdefault(found["before"], []).append(found["secret"])

        def put_back(found: re.Match[str], known: dict[str, list[str]] = known) -> str:
            secret = found["secret"]
            if secret == HIDDEN and known.get(found["before"]):
                secret = known[found["before"]].pop(0)
            return f"{found['before']}{secret}{found['after']}"

        text = pattern.sub(put_back, text)
    if HIDDEN in text:
        line = text[: text.index(HIDDEN)].count("\n") + 1
        raise InputError(f"line {line}: a hidden password cannot be moved; write it out")
    return text
