"""Which doors a server may open."""

import pytest

from runglight.errors import InputError
from runglight.server.policy import policy


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.0.7", "plc-box"])
def test_other_computers_need_a_token(host: str) -> None:
    with pytest.raises(InputError, match="--token"):
        policy(host)
    assert policy(host, token="long-enough-token").token


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1.2.3", "::1", "localhost"])
def test_loopback_needs_none(host: str) -> None:
    assert policy(host).is_loopback


def test_a_short_token_is_refused() -> None:
    with pytest.raises(InputError, match="guessed"):
        policy(token="secret")


def test_addresses_cannot_be_rebound_but_names_can() -> None:
    open_door = policy("0.0.0.0", token="long-enough-token")
    assert open_door.knows_host("192.168.0.7")
    assert open_door.knows_host("fe80::1")
    assert not open_door.knows_host("evil.example")


def test_the_secret_is_not_shown() -> None:
    chosen = policy()
    assert chosen.secret.hex() not in repr(chosen)
    assert repr(chosen.secret) not in repr(chosen)
