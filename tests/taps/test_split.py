"""Words of a live source as bits, as learning from its recording splits them."""

import asyncio

import pytest

from runglight.errors import InputError
from runglight.log.symbols import names_by_address
from runglight.taps.base import Batch, TapSignal
from runglight.taps.named import NamedTap
from runglight.taps.split import SplitTap
from tests.recording.doubles import DoubleTap, batch

SIGNALS = [TapSignal("%M1", "%M1"), TapSignal("%MW74", "%MW74", "UINT", "memory")]


def tapped(words: list[str], given: list[Batch]) -> tuple[SplitTap, list[list[tuple[str, int]]]]:
    double = DoubleTap(given)
    double.signals = list(SIGNALS)
    tap = SplitTap(double, words)

    async def read() -> list[list[tuple[str, int]]]:
        async with tap:
            return [
                [
                    (tap.signals[index].name, value)
                    for index, value in zip(each.signal_index, each.value.tolist(), strict=True)
                ]
                async for each in tap
            ]

    return tap, asyncio.run(read())


def test_an_image_tells_all_bits_and_a_change_those_that_changed() -> None:
    given = [
        batch(0, [(0, 0, 1), (0, 1, 0b101)], image=True),
        batch(1, [(1, 1, 0b110), (1, 0, 0)]),
        batch(2, []),
        batch(3, [(3, 0, 0), (3, 1, 0b110)], image=True),
    ]
    tap, rows = tapped(["%MW74"], given)
    assert [signal.name for signal in tap.signals] == [
        "%M1",
        *(f"%MW74.{bit}" for bit in range(16)),
    ]
    assert tap.signals[1].type == "BOOL"
    image = {"%M1": 1, "%MW74.0": 1, "%MW74.2": 1}
    assert dict(rows[0]) == {signal.name: image.get(signal.name, 0) for signal in tap.signals}
    assert rows[1] == [("%MW74.0", 0), ("%MW74.1", 1), ("%M1", 0)]
    assert rows[2] == []
    assert len(rows[3]) == 17


def test_bits_are_named_by_the_table() -> None:
    table = "address,group,device,signal\n%MW74.0,Line1,Conveyor,Running\n"
    double = DoubleTap([])
    double.signals = list(SIGNALS)
    named = NamedTap(
        SplitTap(double, ["%MW74"]), names_by_address(table, "{group}-{device}-{signal}")
    )
    assert [signal.name for signal in named.signals][:3] == [
        *("%M1", "Line1-Conveyor-Running", "%MW74.1")
    ]


def test_an_unknown_word_is_refused() -> None:
    with pytest.raises(InputError, match=r"no signal '%MW75' \(did you mean %MW74"):
        tapped(["%MW75"], [])
