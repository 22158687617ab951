"""The stateful processor that Spark runs: one key is one part of one plant."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pyspark.sql.streaming import StatefulProcessor, StatefulProcessorHandle

from runglight.scale.spark import aside, chunk, found, notices
from runglight.scale.spark.opening import Opening
from runglight.scale.spark.part_watcher import MS, PartState, PartWatcher, Told

if TYPE_CHECKING:
    from runglight.scale.spark.shipped_model import Models

STATE = (
    "model string, monitor binary, waiting binary, wake_ms bigint, "
    "opens_ns bigint, opens_image boolean"
)
READ = ("partition", "offset", "rows", "opens_ns", "opens_image")
NO_MODEL = ""


class PartProcessor(StatefulProcessor):  # type: ignore[misc]
    """Gives each key's chunks to its part's watcher, and keeps what that knows."""

    def __init__(self, models: Models, quiet_ns: int) -> None:
        self._models = models
        self._quiet_ns = quiet_ns

    def init(self, handle: StatefulProcessorHandle) -> None:
        """Names the state; Spark calls it once on the driver, and in every task."""
        self._handle = handle
        self._state = handle.getValueState("part", STATE)

    def handleInputRows(self, key: Any, rows: Iterator[Any], timerValues: Any) -> Iterator[Any]:  # noqa: N802, N803
        """New chunks of one part."""
        plant, part = key
        pieces = [
            piece
            for each in rows
            for piece in zip(*(each[name].tolist() for name in READ), strict=True)
        ]
        # Spark hands them over in any order; by partition and offset they are as they were sent.
        pieces.sort(key=lambda piece: piece[:2])
        chunks = [bytes(piece[2]) for piece in pieces if piece[2] is not None]
        openings = [Opening(piece[3], piece[4]) for piece in pieces]
        yield from self._step(plant, part, chunks, openings, timerValues, expired_ms=None)

    def handleExpiredTimer(  # noqa: N802
        self,
        key: Any,
        timerValues: Any,  # noqa: N803
        expiredTimerInfo: Any,  # noqa: N803
    ) -> Iterator[Any]:
        """The watermark has passed the time that a part wanted to be woken at."""
        plant, part = key
        expired_ms = expiredTimerInfo.getExpiryTimeInMs()
        yield from self._step(plant, part, [], [], timerValues, expired_ms=expired_ms)

    def close(self) -> None:
        """Nothing is held."""

    def _step(
        self,
        plant: str,
        part: str,
        chunks: list[bytes],
        openings: list[Opening],
        timer: Any,
        *,
        expired_ms: int | None,
    ) -> Iterator[Any]:
        if part == aside.PART:
            told = Told(aside.told(chunks))
        elif (model := self._models.of(plant)) is None:
            told = self._homeless(plant, chunks)
        else:
            saved = self._state.get() if self._state.exists() else None
            state = None if saved is None else _restored(saved)
            watcher = PartWatcher(plant, part, model.fingerprint, model.parts(), self._quiet_ns)
            watermark_ns = max(0, timer.getCurrentWatermarkInMs()) * MS
            told, after = watcher.step(state, chunks, watermark_ns, openings)
            if after is not state:
                self._keep(state, after, expired_ms)
        if told.lines:
            yield found.frame(plant, told)

    def _keep(self, before: PartState | None, after: PartState, expired_ms: int | None) -> None:
        opens_ns, image = (None, None) if after.opening is None else after.opening
        self._state.update(
            (after.model, after.monitor, after.waiting, after.wake_ms, opens_ns, image)
        )
        if before is not None and before.wake_ms == after.wake_ms:
            return
        if before is not None and before.wake_ms and before.wake_ms != expired_ms:
            self._handle.deleteTimer(before.wake_ms)
        if after.wake_ms:
            self._handle.registerTimer(after.wake_ms)

    def _homeless(self, plant: str, chunks: list[bytes]) -> Told:
        if self._state.exists() or not chunks:
            return Told()
        self._state.update((NO_MODEL, None, None, 0, None, None))
        time_ns = chunk.times_ns(chunk.unpack(chunks))
        return Told([notices.homeless(plant, len(time_ns), int(time_ns.max()))])


def _restored(saved: Any) -> PartState | None:
    model, monitor, waiting, wake_ms, opens_ns, image = saved
    if model == NO_MODEL:
        return None
    return PartState(
        model,
        _bytes(monitor),
        _bytes(waiting),
        int(wake_ms),
        None if opens_ns is None else Opening(int(opens_ns), bool(image)),
    )


def _bytes(content: Any) -> bytes | None:
    return None if content is None else bytes(content)
