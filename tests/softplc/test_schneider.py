"""The bottling machine's memory, where a Schneider PLC has it."""

import pytest

from runglight.errors import InputError
from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling import SYMBOLS, RunningBottling
from runglight.softplc.modbus_layout import ModbusLayout
from tests.softplc.plants import Steered, served, word
from tests.softplc.test_modbus_server import START_NS, client_of

URL = "modbus://127.0.0.1:0"


def test_bits_are_coils_and_words_holding_registers_from_zero() -> None:
    plant, clock = RunningBottling(START_NS), Steered(START_NS)
    watched = RunningBottling(START_NS)
    with served(plant, URL, clock) as (plc, _), client_of(plc) as client:
        assert plc.tap_url.endswith("?coils=0-99&holding=0-299&names=iec&interval=10ms")
        assert plc.symbols == SYMBOLS
        for second in range(0, 60, 5):
            clock.time_ns = START_NS + second * NS_PER_S
            watched.advance(clock.time_ns)
            memory = watched.image().memory
            assert client.read_coils(0, count=100).bits[:100] == [bool(v) for v in memory[:100]]
            words = client.read_holding_registers(0, count=120).registers
            assert words == list(memory[100:220])
    assert watched.cycles > 2


@pytest.mark.parametrize("address", ["%M800", "%MW2048", "%MX0.1", "%IW3", "MW3"])
def test_an_address_it_has_not_is_one_sentence(address: str) -> None:
    bit = word("%M5", "memory")
    with pytest.raises(InputError, match="PLC"):
        ModbusLayout([bit, word(address, "memory")])
