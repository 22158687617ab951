"""Where a soft PLC listens: `modbus://127.0.0.1:5020`, `s7://127.0.0.1:0` (any free port)."""

import ipaddress
from dataclasses import dataclass
from urllib.parse import urlsplit

from runglight.errors import InputError
from runglight.nearest import suggestion

EXAMPLES = {"modbus": "modbus://127.0.0.1:5020", "s7": "s7://127.0.0.1:1102"}
_PORTS = {"modbus": 502, "s7": 102}


@dataclass(frozen=True, slots=True)
class ServeUrl:
    """A protocol, and the address of this computer to listen at."""

    scheme: str
    host: str
    port: int

    def __str__(self) -> str:
        """As it is written; an IPv6 address in brackets."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}://{host}:{self.port}"

    @property
    def is_loopback(self) -> bool:
        """Whether only this computer reaches it."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


def parse_serve_url(text: str) -> ServeUrl:
    """Takes it apart; InputError for a protocol no soft PLC speaks, and for a URL without host.

    No host is ever assumed: whoever wants the whole network to read types `0.0.0.0`.
    """
    scheme = text.partition(":")[0].lower()
    if scheme not in EXAMPLES:
        near = suggestion(scheme, EXAMPLES) or f"; there are: {', '.join(EXAMPLES)}"
        raise InputError(f"--serve {text}: nothing is served over {scheme!r}{near}")
    example = EXAMPLES[scheme]
    try:
        parts = urlsplit(text)
        port = _PORTS[scheme] if parts.port is None else parts.port
    except ValueError as error:
        raise InputError(f"--serve {text}: {error}; write {example}") from None
    if not parts.hostname:
        raise InputError(f"--serve {text}: names no address to listen at; write {example}")
    if parts.path.strip("/") or parts.query or parts.fragment or parts.username is not None:
        raise InputError(f"--serve {text}: takes nothing but host and port; write {example}")
    return ServeUrl(scheme, parts.hostname, port)
