"""What has to be said before anything is written to a machine."""

import ipaddress
import socket

from runglight.errors import InputError


def is_loopback(host: str) -> bool:
    """Whether every address of a host is this computer's own."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return False
    return bool(found) and all(
        ipaddress.ip_address(str(address[0]).partition("%")[0]).is_loopback for *_, address in found
    )


def check_permission(url: str, host: str, *, allow_writes: bool, moves_machinery: bool) -> None:
    """InputError unless the user has allowed it, for this kind of address."""
    if not allow_writes:
        raise InputError(
            f"{url}: to control a plant is to write its outputs; add --allow-writes, or --shadow "
            "to write nothing and report where the learned controller would do otherwise"
        )
    if not moves_machinery and not is_loopback(host):
        raise InputError(
            f"{url}: this is another computer, and its outputs may move machinery; make sure that "
            "nobody can be hurt, and add --i-know-this-moves-machinery"
        )
