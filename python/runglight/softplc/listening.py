"""Whether this computer can listen at an address, told in one sentence where it cannot."""

import errno
import socket

from runglight.errors import InputError
from runglight.softplc.serve_url import EXAMPLES, ServeUrl

IPV4 = socket.AF_INET


def check_free(url: ServeUrl, family: socket.AddressFamily = socket.AF_UNSPEC) -> str:
    """The numeric address to listen at; InputError where that is impossible.

    Asked before a protocol's own server is, because those hide the reason or share the port.
    """
    try:
        found = socket.getaddrinfo(url.host, url.port, family, socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        raise InputError(
            f"{url}: there is no address {url.host!r} to listen at; write {EXAMPLES[url.scheme]}"
        ) from None
    # `localhost` may be both: more clients write 127.0.0.1 than ::1.
    found_family, kind, protocol, _, address = min(found, key=lambda each: each[0] is not IPV4)
    with socket.socket(found_family, kind, protocol) as probe:
        # As servers do, so that a port whose last connections fade away counts as free.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
            probe.listen(1)
        except OSError as error:
            raise InputError(f"{url}: {_reason(error, url)}") from None
    return str(address[0])


def _reason(error: OSError, url: ServeUrl) -> str:
    match error.errno:
        case errno.EADDRINUSE:
            return (
                f"port {url.port} is taken by another program; choose another, or 0 for a free one"
            )
        case errno.EACCES | errno.EPERM:
            return (
                f"port {url.port} needs an administrator's rights; choose one from 1024 on, "
                f"for example {EXAMPLES[url.scheme]}"
            )
        case errno.EADDRNOTAVAIL:
            return f"this computer has no address {url.host}; 127.0.0.1 is always there"
        case _:
            return f"cannot listen there: {(error.strerror or str(error)).lower()}"
