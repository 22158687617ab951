"""S7, read by python-snap7's own client."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from snap7.client import Client
from snap7.type import Area

from runglight.plants import Symbol
from runglight.plants.cell import RunningCell
from runglight.softplc import SoftPlc
from tests.softplc.plants import SCAN_NS, CountingPlant, Racing, Steered, served, word

S = 1_000_000_000
START_NS = 1_767_592_800 * S
URL = "s7://127.0.0.1:0"
WORDS = (
    word("%MW4", "memory"),
    word("MB9", "memory"),
    word("DB3.DBW2", "memory"),
    word("DB3.DBD10", "memory"),
    Symbol("DB3.DBX1.5", "G", "Count", "Bit", "memory", "a bit"),
)


@contextmanager
def client_of(plc: SoftPlc) -> Iterator[Client]:
    client = Client()
    client.connect("127.0.0.1", 0, 2, tcp_port=plc.url.port)
    try:
        yield client
    finally:
        client.disconnect()


def bits(values: tuple[int, ...]) -> int:
    return sum(bool(value) << position for position, value in enumerate(values))


def test_every_signal_lies_in_its_process_image() -> None:
    cell, clock = RunningCell(START_NS), Steered(START_NS)
    watched = RunningCell(START_NS)
    with served(cell, URL, clock) as (plc, _), client_of(plc) as client:
        for second in range(0, 240, 3):
            clock.time_ns = START_NS + second * S
            watched.advance(clock.time_ns)
            image = watched.image()
            inputs = client.read_area(Area.PE, 0, 0, 2)
            outputs = client.read_area(Area.PA, 0, 0, 2)
            assert int.from_bytes(inputs, "little") == bits(image.inputs)
            assert int.from_bytes(outputs, "little") == bits(image.outputs)
        assert cell.cycles == watched.cycles > 1
    assert plc.tap_url == f"s7://127.0.0.1:{plc.url.port}?pe=0-1&pa=0-1&interval=10ms"
    addresses = [symbol.address for symbol in plc.symbols]
    assert addresses[:3] == ["I0.0", "I0.1", "I0.2"]
    assert addresses[-1] == "Q1.4"
    assert [symbol.name for symbol in plc.symbols] == [symbol.name for symbol in cell.symbols]


def test_words_lie_with_their_high_byte_first() -> None:
    plant, clock = CountingPlant(START_NS, WORDS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, _), client_of(plc) as client:
        clock.time_ns = START_NS + 0x1234 * SCAN_NS
        assert client.read_area(Area.MK, 0, 3, 4) == b"\0\x12\x34\0"
        assert client.read_area(Area.MK, 0, 9, 1) == b"\x34"
        assert client.db_read(3, 0, 14) == (
            b"\0" + bytes([1 << 5]) + b"\x12\x34" + bytes(6) + b"\0\0\x12\x34"
        )
        assert "mk=4-5,9&db3=1-3,10-13" in plc.tap_url
        assert [symbol.address for symbol in plc.symbols[-5:]] == [
            *("MW4", "MB9", "DB3.DBW2", "DB3.DBD10", "DB3.DBX1.5")
        ]


def test_an_answer_shows_one_scan() -> None:
    """The clock moves on at every look: an answer put together from two would show it."""
    plant = CountingPlant(START_NS, WORDS)
    with served(plant, URL, Racing(START_NS)) as (plc, _), client_of(plc) as client:
        last = -1
        for _ in range(50):
            items = [
                {"area": area, "db_number": block, "start": start, "size": 2}
                for area, block, start in (
                    (Area.PE, 0, 0),
                    (Area.PA, 0, 0),
                    (Area.MK, 0, 4),
                    (Area.DB, 3, 2),
                )
            ]
            code, (inputs, outputs, memory, block) = client.read_multi_vars(items)
            assert code == 0
            scan = int.from_bytes(inputs, "little")
            assert int.from_bytes(outputs, "little") == scan
            assert int.from_bytes(memory, "big") == int.from_bytes(block, "big") == scan
            assert scan > last
            last = scan


def test_a_client_can_write_nothing() -> None:
    plant, clock = CountingPlant(START_NS, WORDS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, _), client_of(plc) as client:
        for area, block in ((Area.PE, 0), (Area.PA, 0), (Area.MK, 0), (Area.DB, 3)):
            with pytest.raises(Exception, match=r"."):
                client.write_area(area, block, 0, bytearray(b"\xff\xff"))
            assert client.read_area(area, block, 0, 2) == bytes(2)


def test_what_is_not_there_is_refused() -> None:
    with (
        served(CountingPlant(START_NS), URL, Steered(START_NS)) as (plc, _),
        client_of(plc) as client,
    ):
        assert len(client.read_area(Area.PE, 0, 0, 128)) == 128
        with pytest.raises(Exception, match=r"."):
            client.read_area(Area.PE, 0, 127, 2)
        with pytest.raises(Exception, match=r"."):
            client.db_read(3, 0, 1)


def test_it_dies_and_comes_back_at_the_same_port_while_the_machine_works_on() -> None:
    plant, clock = CountingPlant(START_NS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, call):
        port = plc.url.port
        with client_of(plc) as client:
            assert client.read_area(Area.PA, 0, 0, 2) == bytes(2)
            assert plc.clients == 1
            call(plc.stop)
            with pytest.raises(Exception, match=r"."):
                client.read_area(Area.PA, 0, 0, 2)
        assert plc.clients == 0
        with pytest.raises(Exception, match=r"."), client_of(plc):
            pass
        clock.time_ns += 99 * SCAN_NS
        call(plc.start)
        assert plc.url.port == port
        with client_of(plc) as client:
            assert client.read_area(Area.PA, 0, 0, 2) == b"\x63\0"


def test_several_clients_at_once() -> None:
    plant, clock = CountingPlant(START_NS), Steered(START_NS + 7 * SCAN_NS)
    with (
        served(plant, URL, clock) as (plc, _),
        client_of(plc) as one,
        client_of(plc) as other,
    ):
        for client in (one, other, one):
            assert client.read_area(Area.PE, 0, 0, 1) == b"\x07"
        assert plc.clients == 2
