"""Siemens S7: `s7://HOST:102?rack=0&slot=2&pe=0-26&pa=0-3&mk=0-9&db1=0-99`."""

from runglight.errors import InputError
from runglight.taps.blocking import Beside, Blocking
from runglight.taps.clock import Clock
from runglight.taps.device import Device
from runglight.taps.polled import PolledTap, timeout_s
from runglight.taps.ranges import parse_ranges
from runglight.taps.s7_address import MOST_BYTE, MOST_DB, S7Area
from runglight.taps.s7_connection import S7Endpoint
from runglight.taps.s7_device import S7Device
from runglight.taps.s7_reads import Item
from runglight.taps.url import SourceUrl

_AREAS = {"pe": S7Area.INPUT, "pa": S7Area.OUTPUT, "mk": S7Area.MEMORY}
RACK, SLOT = "0", "2"
_MOST_RACK, _MOST_SLOT = 7, 31


class S7Tap(PolledTap):
    """Reads the process images, memory and data blocks; never writes."""

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        self._source = url
        self._timeout_s = timeout_s(url)
        self._rack = _number(url, "rack", RACK, _MOST_RACK)
        self._slot = _number(url, "slot", SLOT, _MOST_SLOT)
        self._items = _items(url)
        super().__init__(url, clock, self._blocking_device().signals)

    def device(self, *, own_thread: bool) -> Device:
        """A new device. snap7 blocks, and one connection serves one thread."""
        device = self._blocking_device()
        return Blocking(device) if own_thread else Beside(device)

    def _blocking_device(self) -> S7Device:
        return S7Device(
            self._source.text,
            S7Endpoint(
                self._source.host, self._source.port, self._rack, self._slot, self._timeout_s
            ),
            self._items,
        )


def _items(url: SourceUrl) -> list[Item]:
    blocks = sorted(
        (int(option.removeprefix("db")), option)
        for option in url.options
        if option.startswith("db")
    )
    for number, option in blocks:
        if not 1 <= number <= MOST_DB:
            raise InputError(f"{url.text}: {option}: data blocks are numbered from 1 to {MOST_DB}")
    wanted = [(area, 0, option) for option, area in _AREAS.items() if option in url.options]
    wanted += [(S7Area.DATA, number, option) for number, option in blocks]
    if not wanted:
        raise InputError(
            f"{url.text}: says nothing to read; "
            "add pe=, pa=, mk= or db1= with the bytes, for example pe=0-26"
        )
    return [
        Item(area, db, part.start, len(part))
        for area, db, option in wanted
        for part in parse_ranges(url.options[option], f"{url.text}: {option}", MOST_BYTE)
    ]


def _number(url: SourceUrl, option: str, default: str, most: int) -> int:
    text = url.options.get(option, default)
    if not (text.isascii() and text.isdigit() and int(text) <= most):
        raise InputError(f"{url.text}: {option}={text} is none; write a number from 0 to {most}")
    return int(text)
