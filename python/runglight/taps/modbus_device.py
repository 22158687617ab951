"""A Modbus device as a scanner sees it: few requests, one image, signals in order."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from runglight.errors import InputError
from runglight.taps.base import Answer
from runglight.taps.device import DeviceLostError
from runglight.taps.modbus_connection import (
    ILLEGAL_ADDRESS,
    ILLEGAL_FUNCTION,
    ILLEGAL_VALUE,
    ModbusConnection,
    ModbusEndpoint,
    RefusedError,
)
from runglight.taps.modbus_frame import Request
from runglight.taps.modbus_names import IS_BITS, Area, signal_at
from runglight.taps.ranges import spelled, split

MOST_BITS = 2_000
MOST_REGISTERS = 125
"""Largest reads, Modbus Application Protocol V1.1b3, 6.1 and 6.3."""

_NEVER_WORKS = {ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE}


@dataclass(slots=True)
class _Fitted:
    """The requests a device answers, and the addresses it refuses."""

    requests: list[Request] = field(default_factory=list)
    refused: dict[tuple[Area, int], str] = field(default_factory=dict)


class ModbusDevice:
    """See `runglight.taps.device.Device`."""

    def __init__(
        self,
        source: str,
        endpoint: ModbusEndpoint,
        areas: Mapping[Area, list[range]],
        names: str,
    ) -> None:
        self._source = source
        self._endpoint = endpoint
        self._areas = {area: areas[area] for area in Area if area in areas}
        self.signals = [
            signal_at(area, number, names)
            for area, ranges in self._areas.items()
            for numbers in ranges
            for number in numbers
        ]
        self._most = {area: MOST_BITS if area in IS_BITS else MOST_REGISTERS for area in Area}
        self._connection: ModbusConnection | None = None
        self._requests: list[Request] = []

    async def connect(self) -> None:
        """Connects; the first time, finds out which requests the device answers."""
        await self._open()
        if self._requests:
            return
        fitted = await self._fit()
        if fitted.refused:
            raise InputError(self._refusal(fitted.refused))
        self._requests = fitted.requests

    async def read(self) -> bytes:
        """All replies, one after the other: inputs come before outputs and memory."""
        connection = self._connection
        if connection is None:
            raise DeviceLostError("not connected")
        if len(self._requests) == 1:
            return await connection.read(self._requests[0])
        return b"".join([await connection.read(request) for request in self._requests])

    def values(self, image: bytes) -> npt.NDArray[np.int64]:
        """The value of every signal."""
        return _values(image, self._requests)

    async def check(self) -> list[Answer]:
        """Asks for every signal once."""
        await self._open()
        fitted = await self._fit()
        self._requests = fitted.requests
        values = iter(self.values(await self.read() if fitted.requests else b"").tolist())
        places = [
            (area, at) for area, ranges in self._areas.items() for run in ranges for at in run
        ]
        return [
            Answer(signal, None, fitted.refused[place])
            if place in fitted.refused
            else Answer(signal, next(values))
            for signal, place in zip(self.signals, places, strict=True)
        ]

    async def close(self) -> None:
        """Lets go of the connection."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    async def _open(self) -> None:
        await self.close()
        self._connection = ModbusConnection(self._endpoint)
        await self._connection.open()

    async def _fit(self) -> _Fitted:
        fitted = _Fitted()
        for area, ranges in self._areas.items():
            for whole in ranges:
                start = whole.start
                while start < whole.stop:
                    # The limit may shrink while the device is asked.
                    part = next(split([range(start, whole.stop)], self._most[area]))
                    await self._fit_part(Request(area, part.start, len(part)), fitted)
                    start = part.stop
        return fitted

    async def _fit_part(self, request: Request, fitted: _Fitted) -> None:
        refusal = await self._refusal_of(request)
        if refusal is None:
            fitted.requests.append(request)
            return
        area, start, count = request.area, request.start, request.count
        if (
            count == 1
            or refusal.code == ILLEGAL_FUNCTION
            or (refusal.code == ILLEGAL_ADDRESS and await self._has_neither_end(request))
        ):
            for number in range(start, start + count):
                fitted.refused[area, number] = str(
                    RefusedError(Request(area, number, 1), refusal.code)
                )
            return
        half = count // 2
        if refusal.code == ILLEGAL_VALUE:
            self._most[area] = min(self._most[area], count - half)
        await self._fit_part(Request(area, start, half), fitted)
        await self._fit_part(Request(area, start + half, count - half), fitted)

    async def _has_neither_end(self, request: Request) -> bool:
        last = request.start + request.count - 1
        for number in (request.start, last):
            if await self._refusal_of(Request(request.area, number, 1)) is None:
                return False
        return True

    async def _refusal_of(self, request: Request) -> RefusedError | None:
        assert self._connection is not None
        try:
            await self._connection.read(request)
        except RefusedError as refused:
            if refused.code in _NEVER_WORKS:
                return refused
            raise
        return None

    def _refusal(self, refused: Mapping[tuple[Area, int], str]) -> str:
        missing: list[str] = []
        mend: list[str] = []
        for area, ranges in self._areas.items():
            numbers = [number for numbers in ranges for number in numbers]
            gone = [number for number in numbers if (area, number) in refused]
            if gone:
                rest = spelled(number for number in numbers if (area, number) not in refused)
                missing.append(f"{area.value} {spelled(gone)}")
                mend.append(f"write {area.value}={rest}" if rest else f"leave out {area.value}")
        return (
            f"{self._source}: the device has no {' and no '.join(missing)} "
            f"({next(iter(refused.values()))}); {' and '.join(mend)}"
        )


def _values(image: bytes, requests: list[Request]) -> npt.NDArray[np.int64]:
    parts: list[npt.NDArray[np.int64]] = [np.empty(0, np.int64)]
    offset = 0
    for request in requests:
        data = image[offset : offset + request.reply_bytes]
        offset += request.reply_bytes
        if request.area in IS_BITS:
            bits = np.unpackbits(
                np.frombuffer(data, np.uint8), count=request.count, bitorder="little"
            )
            parts.append(bits.astype(np.int64))
        else:
            parts.append(np.frombuffer(data, ">u2").astype(np.int64))
    return np.concatenate(parts)
