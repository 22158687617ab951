"""Where a soft PLC may listen, and the sentence where it cannot."""

import asyncio
import errno
import socket

import pytest

from runglight.errors import InputError
from runglight.softplc import ServeUrl, parse_serve_url, serve
from tests.softplc.plants import CountingPlant, Steered, word


@pytest.mark.parametrize(
    ("text", "expected", "is_loopback"),
    [
        ("modbus://127.0.0.1:5020", ServeUrl("modbus", "127.0.0.1", 5020), True),
        ("MODBUS://localhost", ServeUrl("modbus", "localhost", 502), True),
        ("s7://127.0.0.1:0", ServeUrl("s7", "127.0.0.1", 0), True),
        ("s7://0.0.0.0", ServeUrl("s7", "0.0.0.0", 102), False),
        ("modbus://[::1]:7/", ServeUrl("modbus", "::1", 7), True),
        ("modbus://plc.example:7", ServeUrl("modbus", "plc.example", 7), False),
    ],
)
def test_what_may_be_written(text: str, expected: ServeUrl, is_loopback: bool) -> None:
    url = parse_serve_url(text)
    assert url == expected
    assert url.is_loopback is is_loopback
    assert parse_serve_url(str(url)) == url


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("modbs://127.0.0.1", "did you mean modbus?"),
        ("opcua://127.0.0.1:1", "there are: modbus, s7"),
        ("modbus://:5020", "names no address to listen at; write modbus://127.0.0.1:5020"),
        ("s7:127.0.0.1", "names no address"),
        ("modbus://127.0.0.1:99999", "write modbus://127.0.0.1:5020"),
        ("modbus://127.0.0.1:5020?coils=0-9", "takes nothing but host and port"),
        ("modbus://127.0.0.1/x", "takes nothing but host and port"),
        ("", "there are: modbus, s7"),
    ],
)
def test_what_may_not(text: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_serve_url(text)
    assert message in str(refused.value)


def start(url: str, *words: str) -> None:
    async def work() -> None:
        plant = CountingPlant(0, tuple(word(address, "memory") for address in words))
        async with serve(plant, url, Steered(0)):
            pass

    asyncio.run(work())


@pytest.mark.parametrize("scheme", ["modbus", "s7"])
def test_where_it_cannot_listen_it_says_why(scheme: str, monkeypatch: pytest.MonkeyPatch) -> None:
    start(f"{scheme}://127.0.0.1:0")
    with socket.create_server(("127.0.0.1", 0), reuse_port=True) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} is taken by another program"):
            start(f"{scheme}://127.0.0.1:{port}")
    with pytest.raises(InputError, match=r"this computer has no address 192\.0\.2\.1"):
        start(f"{scheme}://192.0.2.1:5020")
    with pytest.raises(InputError, match="there is no address 'nowhere"):
        start(f"{scheme}://nowhere.invalid:5020")

    def forbidden(*_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(socket.socket, "bind", forbidden)
    with pytest.raises(InputError, match="port 502 needs an administrator's rights"):
        start(f"{scheme}://127.0.0.1:502")


def test_a_signal_without_a_place_is_named() -> None:
    for address in ("%MX3.1", "%MD4", "DB1.DBW0", "%MW1024"):
        with pytest.raises(InputError, match=f"Modbus has no place for {address}"):
            start("modbus://127.0.0.1:0", address)
    start("s7://127.0.0.1:0", "%MX3.1", "%MD4", "DB1.DBW0", "%MW1024")
    for address in ("40001", "%MW4.1", "%IX3", "Z1.0"):
        with pytest.raises(InputError, match=f"'{address}' is no address of a PLC"):
            start("s7://127.0.0.1:0", address)


def test_it_listens_by_ipv6_and_by_name_too() -> None:
    async def work(url: str) -> str:
        async with serve(CountingPlant(0), url, Steered(0)) as plc:
            host = plc.url.host
            _, writer = await asyncio.open_connection(
                "127.0.0.1" if host == "localhost" else host, plc.url.port
            )
            writer.close()
            await writer.wait_closed()
            return plc.tap_url

    if socket.has_ipv6 and _has_ipv6_loopback():
        assert asyncio.run(work("modbus://[::1]:0")).startswith("modbus://[::1]:")
    assert asyncio.run(work("modbus://localhost:0")).startswith("modbus://localhost:")
    assert asyncio.run(work("s7://localhost:0")).startswith("s7://localhost:")


def _has_ipv6_loopback() -> bool:
    try:
        with socket.create_server(("::1", 0), family=socket.AF_INET6):
            return True
    except OSError:
        return False
