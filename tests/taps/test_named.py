import asyncio

import pytest

from runglight.errors import InputError
from runglight.log.symbols import names_by_address
from runglight.taps import open_tap
from runglight.taps.base import Batch, ConnectionState
from runglight.taps.named import NamedTap
from tests.taps.benches.modbus import ModbusBench

SYMBOLS = """address,group,device,signal
00004,Line1,Clamp,CLOSE
10001,Line1,Clamp,OPEN
49999,Line1,Elsewhere,UNUSED
"""


def test_signals_are_called_by_the_names_of_the_table() -> None:
    async def test() -> tuple[list[str], list[str], Batch]:
        bench = ModbusBench()
        await bench.start()
        try:
            names = names_by_address(SYMBOLS, "{group}-{device}-{signal}")
            async with NamedTap(open_tap(bench.url), names) as tap:
                first = await anext(aiter(tap))
                assert tap.connection.state is ConnectionState.CONNECTED
                signals = [signal.name for signal in tap.signals]
                addresses = [signal.address for signal in tap.signals]
                assert tap.signals is tap.signals
                answers = await tap.check()
                assert [answer.signal.name for answer in answers] == signals
            assert tap.connection.state is ConnectionState.CLOSED
            assert addresses == list(bench.signals)
            return signals, addresses, first
        finally:
            await bench.kill()

    signals, addresses, first = asyncio.run(test())
    renamed = {
        address: name for address, name in zip(addresses, signals, strict=True) if address != name
    }
    assert renamed == {"00004": "Line1-Clamp-CLOSE", "10001": "Line1-Clamp-OPEN"}
    assert first.signal_index.tolist() == list(range(len(signals)))


@pytest.mark.parametrize("names", [{"00001": "A", "00002": "A"}, {"00001": "00002"}])
def test_two_signals_of_one_name_are_refused(names: dict[str, str]) -> None:
    tap = NamedTap(open_tap("modbus://127.0.0.1?coils=0-3"), names)
    with pytest.raises(InputError, match=r"gives two signals of modbus://127\.0\.0\.1"):
        _ = tap.signals


def test_a_german_table_names_the_signals_of_an_s7() -> None:
    names = {"E5.0": "Clamp-OPEN", "%A1.2": "Clamp-CLOSE", "DB1.DBX0.0": "Step", "nonsense": "X"}
    tap = NamedTap(open_tap("s7://127.0.0.1?pe=5&pa=1&db1=0"), names)
    named = {signal.address: signal.name for signal in tap.signals}
    assert named["I5.0"] == "Clamp-OPEN"
    assert named["Q1.2"] == "Clamp-CLOSE"
    assert named["DB1.DBX0.0"] == "Step"
    assert named["I5.1"] == "I5.1"
