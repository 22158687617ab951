"""Modbus TCP, read by pymodbus' own client."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ConnectionException

from runglight.plants.cell import RunningCell
from runglight.softplc import SoftPlc
from tests.softplc.plants import SCAN_NS, CountingPlant, Racing, Steered, served, word

S = 1_000_000_000
START_NS = 1_767_592_800 * S
URL = "modbus://127.0.0.1:0"
WORDS = (word("%IW5", "input"), word("%QW7", "output"), word("%MW0", "memory"))


@contextmanager
def client_of(plc: SoftPlc) -> Iterator[ModbusTcpClient]:
    client = ModbusTcpClient("127.0.0.1", port=plc.url.port, timeout=10, retries=0)
    assert client.connect()
    try:
        yield client
    finally:
        client.close()


def number(bits: list[bool]) -> int:
    return sum(bit << position for position, bit in enumerate(bits[:16]))


def test_every_signal_lies_where_openplc_has_it() -> None:
    cell, clock = RunningCell(START_NS), Steered(START_NS)
    watched = RunningCell(START_NS)
    with served(cell, URL, clock) as (plc, _), client_of(plc) as client:
        for second in range(0, 240, 3):
            clock.time_ns = START_NS + second * S
            watched.advance(clock.time_ns)
            image = watched.image()
            assert client.read_discrete_inputs(0, count=16).bits == list(image.inputs)
            assert client.read_coils(0, count=13).bits[:13] == list(image.outputs)
        assert cell.cycles == watched.cycles > 1
    assert plc.tap_url == (
        f"modbus://127.0.0.1:{plc.url.port}?inputs=0-15&coils=0-12&names=openplc&interval=10ms"
    )
    assert plc.symbols == cell.symbols


def test_words_and_bits_side_by_side() -> None:
    plant, clock = CountingPlant(START_NS, WORDS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, _), client_of(plc) as client:
        clock.time_ns = START_NS + 12_345 * SCAN_NS
        assert number(client.read_discrete_inputs(0, count=16).bits) == 12_345
        assert client.read_discrete_inputs(3, count=5).bits[:5] == [
            bool(12_345 >> bit & 1) for bit in range(3, 8)
        ]
        assert client.read_input_registers(4, count=3).registers == [0, 12_345, 0]
        assert client.read_holding_registers(6, count=2).registers == [0, 12_345]
        assert client.read_holding_registers(1024, count=1).registers == [12_345]
        assert client.read_holding_registers(0, count=1, device_id=77).registers == [0]
        assert "input_registers=5&coils=0-15&holding=7,1024&names=openplc" in plc.tap_url
        assert [symbol.address for symbol in plc.symbols[-3:]] == ["%IW5", "%QW7", "%MW0"]


def test_an_answer_shows_one_scan() -> None:
    """The clock moves on at every look: an answer put together from two would show it."""
    words = tuple(word(f"%QW{register}", "output") for register in range(100))
    plant = CountingPlant(START_NS, words)
    with served(plant, URL, Racing(START_NS)) as (plc, _), client_of(plc) as client:
        last = 0
        for _ in range(50):
            registers = client.read_holding_registers(0, count=100).registers
            assert len(set(registers)) == 1
            assert registers[0] > last
            last = number(client.read_coils(0, count=16).bits)
            assert last > registers[0]


def test_a_client_can_write_nothing() -> None:
    plant, clock = CountingPlant(START_NS, WORDS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, _), client_of(plc) as client:
        for refused in (
            client.write_coil(0, True),
            client.write_coils(0, [True] * 8),
            client.write_register(7, 5),
            client.write_registers(7, [5, 6]),
            client.mask_write_register(address=7),
            client.readwrite_registers(read_address=7, read_count=1, address=7, values=[5]),
        ):
            assert refused.isError()
            assert refused.exception_code == 1
        assert number(client.read_coils(0, count=16).bits) == 0
        assert client.read_holding_registers(7, count=1).registers == [0]


@pytest.mark.parametrize(("address", "count"), [(800, 1), (799, 2), (60_000, 8)])
def test_what_is_not_there_is_refused_by_its_modbus_code(address: int, count: int) -> None:
    with (
        served(CountingPlant(START_NS), URL, Steered(START_NS)) as (plc, _),
        client_of(plc) as client,
    ):
        assert not client.read_coils(799, count=1).isError()
        assert client.read_coils(address, count=count).exception_code == 2
        assert client.read_holding_registers(2048, count=1).exception_code == 2


def test_it_dies_and_comes_back_at_the_same_port_while_the_machine_works_on() -> None:
    plant, clock = CountingPlant(START_NS), Steered(START_NS)
    with served(plant, URL, clock) as (plc, call), client_of(plc) as client:
        port = plc.url.port
        assert number(client.read_coils(0, count=16).bits) == 0
        assert plc.clients == 1
        call(plc.stop)
        call(plc.stop)
        assert not plc.serving
        with pytest.raises(ConnectionException):
            client.read_coils(0, count=16)
        assert not client.connect()
        assert plc.clients == 0
        clock.time_ns += 99 * SCAN_NS
        call(plc.start)
        call(plc.start)
        assert plc.url.port == port
        assert client.connect()
        assert number(client.read_coils(0, count=16).bits) == 99
