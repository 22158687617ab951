"""Who may ask for what: decided once, when the server starts."""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass, field

from runglight.errors import InputError

LOOPBACK = "127.0.0.1"
SHORTEST_TOKEN = 12
"""Characters. What is shorter is tried out in no time."""
_LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


@dataclass(frozen=True, slots=True)
class Policy:
    """What the guard goes by. Made with `policy`."""

    host: str = LOOPBACK
    token: str | None = None
    read_only: bool = False
    upload_bytes: int = 500_000_000
    names: frozenset[str] = _LOOPBACK_NAMES
    """Names under which requests may ask for this server."""
    secret: bytes = field(default_factory=lambda: secrets.token_bytes(32), repr=False)
    """Of this run alone: sessions end with the server."""

    @property
    def is_loopback(self) -> bool:
        """Whether only this computer reaches it."""
        return is_loopback(self.host)

    def knows_host(self, name: str) -> bool:
        """Whether a request for this host name is meant for us.

        A page of somebody else's can have its own name point to this computer (DNS rebinding),
        and the browser then takes our answers for its own. It cannot have an address do that.
        """
        if name.lower() in self.names:
            return True
        return not self.is_loopback and _is_address(name)

    def takes_token(self, offered: str) -> bool:
        """Whether this is the token; takes equally long for every wrong one."""
        return self.token is not None and hmac.compare_digest(offered.encode(), self.token.encode())

    def session(self) -> str:
        """What a browser is given instead of the token, so that the token need not be kept."""
        return hmac.new(self.secret, b"session", "sha256").hexdigest()

    def takes_session(self, offered: str) -> bool:
        """Whether this is what `session` gave."""
        return hmac.compare_digest(offered.encode(), self.session().encode())


def policy(
    host: str = LOOPBACK,
    *,
    token: str | None = None,
    read_only: bool = False,
    upload_mb: float = 500.0,
) -> Policy:
    """The policy of a server at `host`; InputError where that would be an open door."""
    if token is not None and len(token) < SHORTEST_TOKEN:
        raise InputError(
            f"--token: {len(token)} characters are guessed too easily; take at least "
            f"{SHORTEST_TOKEN}, like {secrets.token_urlsafe(12)}"
        )
    if not is_loopback(host) and token is None:
        raise InputError(
            f"--host {host}: other computers could open the page; say who may with --token, like "
            f"--token {secrets.token_urlsafe(12)}, or leave --host out"
        )
    names = set(_LOOPBACK_NAMES)
    if not is_loopback(host):
        own = socket.gethostname().lower()
        names |= {host.lower(), own, own.partition(".")[0], f"{own.partition('.')[0]}.local"}
    return Policy(
        host=host,
        token=token,
        read_only=read_only,
        upload_bytes=round(upload_mb * 1e6),
        names=frozenset(names),
    )


def is_loopback(host: str) -> bool:
    """Whether only this computer reaches a server that listens there."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
