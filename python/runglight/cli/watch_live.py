"""`runglight watch MODEL URL`: findings of a running machine, the moment they are made."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE, FINDINGS, INTERRUPTED
from runglight.cli.live_printing import LiveFormat, StatusLine, live_format
from runglight.errors import InputError
from runglight.findings.finding import decode_finding
from runglight.live.batch_watcher import BatchWatcher
from runglight.live.bounded_worker import BoundedWorker
from runglight.live.checkpoint import Checkpoint
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.live.signal_names import model_names
from runglight.log.symbols import names_by_address, read_symbols
from runglight.quantities import duration_s
from runglight.recording.recorder import Recorder
from runglight.taps import open_tap
from runglight.taps.named import NamedTap
from runglight.taps.split import SplitTap

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from runglight.configuration import Configuration
    from runglight.live.delivery import Receiver
    from runglight.live.metrics import Metrics
    from runglight.live.status import Status
    from runglight.model import NominalModel
    from runglight.taps.base import Tap

PRINTED_LATE_AT_MOST = 10_000
"""Prints that wait for a terminal or pipe that takes none; the oldest are left out, and counted."""
PRINTING_ENDS_WITHIN_S = 3.0


def watch_live(
    directory: Path, model: NominalModel, source: str, configuration: Configuration
) -> int:
    """Watches a live source until it ends, Ctrl-C, or `[watch] duration` has passed."""
    watch = configuration.watch
    with _findings_to(watch.output) as stream:
        printing = _Printing(
            live_format(watch.format, stream, notices=watch.notices),
            StatusLine(sys.stderr, time.time),
        )
        ending = _Ending(watch.fail_on)
        try:
            asyncio.run(_watched(directory, model, source, configuration, printing, ending))
        finally:
            printing.close()
    if printing.error is not None:
        raise printing.error
    return ending.code()


async def _watched(  # noqa: PLR0917
    directory: Path,
    model: NominalModel,
    source: str,
    configuration: Configuration,
    printing: _Printing,
    ending: _Ending,
) -> None:
    watch = configuration.watch
    duration = None if watch.duration is None else duration_s(watch.duration, "--for")
    replayed = source.lower().startswith("replay:")
    checkpoint = None if watch.state is None else Checkpoint(Path(watch.state))
    monitor, afresh = (model.monitor(), None) if checkpoint is None else checkpoint.restore(model)
    if afresh is not None:
        printing.say(afresh)
    metrics = _metrics(configuration)
    async with _named(
        open_tap(source, interval=configuration.source.interval), configuration
    ) as tap:
        name_of = model_names(model, configuration.symbols)
        session = Session(
            tap,
            BatchWatcher(model, monitor, tap.signals, name_of, goes_on=replayed),
            Keeper(directory, printing.say),
            tell=ending.heard(printing.tell),
            say=printing.say,
            show=printing.show,
            recording=_recorder(tap, configuration),
            checkpoint=checkpoint,
            checkpoint_every_s=watch.checkpoint_every_s,
            metrics=metrics,
            replayed=replayed,
        )
        ending.listen(session.stop)
        printing.failed = session.stop
        with _answering(metrics, configuration):
            await session.run(_receivers(configuration, session), duration_s=duration)


def _named(tap: Tap, configuration: Configuration) -> Tap:
    symbols = configuration.symbols
    if configuration.log.bits:
        tap = SplitTap(tap, configuration.log.bits)
    if symbols.table is None:
        return tap
    # So that a recording has the names too.
    return NamedTap(tap, names_by_address(read_symbols(Path(symbols.table)), symbols.naming))


def _recorder(tap: Tap, configuration: Configuration) -> Recorder | None:
    directory = configuration.watch.record
    if directory is None:
        return None
    reserve_bytes = round(configuration.record.reserve_mb * 1e6)
    return Recorder(Path(directory), tap, reserve_bytes=reserve_bytes)


class _Printing:
    """Prints in a thread of its own: a terminal that is held, or a slow pipe, delays nobody."""

    def __init__(self, format: LiveFormat, status_line: StatusLine) -> None:
        self._format = format
        self._status_line = status_line
        self.error: Exception | None = None
        self.failed: Callable[[], None] = lambda: None
        self._worker: BoundedWorker[Callable[[], None]] = BoundedWorker(
            "printing", lambda print_it: print_it(), self._fail, at_most=PRINTED_LATE_AT_MOST
        )
        self._loop: asyncio.AbstractEventLoop | None = None
        self._worker.put(format.begin)

    def tell(self, lines: list[str]) -> None:
        """Prints findings."""

        def print_it() -> None:
            self._status_line.clear()
            self._format.tell(lines)

        self._worker.put(print_it)

    def say(self, sentence: str) -> None:
        """A sentence beside the findings, on standard error."""

        def print_it() -> None:
            self._status_line.clear()
            terminal.note(sentence)

        self._worker.put(print_it)

    def show(self, status: Status) -> None:
        """Draws the status line."""
        self._loop = asyncio.get_running_loop()
        self._worker.put(lambda: self._status_line.draw(status))

    def close(self) -> None:
        """Prints what is left."""
        self._worker.put(self._status_line.clear)
        if not self._worker.close(PRINTING_ENDS_WITHIN_S) or self._worker.dropped:
            terminal.note(
                "findings could not be printed as fast as they came; all are kept in the model's "
                "findings.sqlite"
            )

    def _fail(self, error: Exception) -> None:
        self.error = error
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self.failed)


@dataclass
class _Ending:
    """Why watching ended, and which exit code that is."""

    fail_on: str | None
    interrupted: bool = False
    met: bool = field(default=False, init=False)

    def heard(self, tell: Callable[[list[str]], None]) -> Callable[[list[str]], None]:
        """`tell`, with an ear for what `--fail-on` is about."""
        alarming = {None: (), "fault": ("fault",), "anomaly": ("fault", "anomaly")}[self.fail_on]

        def told(lines: list[str]) -> None:
            tell(lines)
            if alarming and not self.met:
                self.met = any(decode_finding(line).severity in alarming for line in lines)

        return told

    def listen(self, stop: Callable[[], None]) -> None:
        """Ctrl-C and a service manager's SIGTERM end the session with everything kept."""

        def interrupt() -> None:
            self.interrupted = True
            stop()

        loop = asyncio.get_running_loop()
        # Where an event loop has no signal handlers (Windows), Ctrl-C ends it by an exception.
        with contextlib.suppress(NotImplementedError):
            loop.add_signal_handler(signal.SIGINT, interrupt)
            loop.add_signal_handler(signal.SIGTERM, stop)

    def code(self) -> int:
        """130 after Ctrl-C, 1 where `--fail-on` was met."""
        if self.interrupted:
            return INTERRUPTED
        return FINDINGS if self.met else DONE


def _receivers(configuration: Configuration, session: Session) -> list[Receiver]:
    receivers: list[Receiver] = []
    if configuration.watch.store is not None:
        with _needing("--store", "sql"):
            from runglight.live.database import DatabaseCopy  # noqa: PLC0415
        receivers.append(DatabaseCopy(configuration.watch.store))
    if configuration.notify.publish is not None:
        with _needing("--publish", "mqtt"):
            from runglight.live.mqtt import MqttPublisher  # noqa: PLC0415
        receivers.append(MqttPublisher(configuration.notify.publish, session.status))
    if configuration.notify.webhook is not None:
        from runglight.live.webhook import Webhook  # noqa: PLC0415

        receivers.append(Webhook(configuration.notify.webhook))
    return receivers


def _metrics(configuration: Configuration) -> Metrics | None:
    if configuration.server.metrics is None:
        return None
    with _needing("--metrics", "metrics"):
        from runglight.live.metrics import Metrics, parse_address  # noqa: PLC0415
    parse_address(configuration.server.metrics)
    return Metrics()


@contextlib.contextmanager
def _answering(metrics: Metrics | None, configuration: Configuration) -> Iterator[None]:
    if metrics is None or configuration.server.metrics is None:
        yield
        return
    server = metrics.serve(configuration.server.metrics)
    try:
        yield
    finally:
        server.stop()


@contextlib.contextmanager
def _needing(option: str, extra: str) -> Iterator[None]:
    try:
        yield
    except ModuleNotFoundError as missing:
        raise InputError(
            f'{option}: needs {missing.name}: pip install "runglight[{extra}]"'
        ) from None


@contextlib.contextmanager
def _findings_to(file: str | None) -> Iterator[TextIO]:
    if file is None or file == "-":
        yield sys.stdout
        return
    # Line by line, not whole at the end: there may be no end but a power cut.
    with Path(file).open("a", encoding="utf-8", newline="") as stream:
        yield stream
