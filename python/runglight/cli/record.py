"""`runglight record`: a live machine to a recording."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE, INTERRUPTED
from runglight.configuration import check_naming, load_configuration
from runglight.errors import InputError
from runglight.log.symbols import names_by_address, read_symbols
from runglight.quantities import duration_s
from runglight.taps import is_live, open_tap

if TYPE_CHECKING:
    from collections.abc import Callable

    from runglight.cli.record_status import RecordStatus
    from runglight.configuration import Configuration
    from runglight.taps.base import Tap
    from runglight.taps.clock import Clock


def record(
    source: str | None = None,
    /,
    *,
    to: Path | None = None,
    duration: Annotated[str | None, Parameter(name="--for")] = None,
    interval: str | None = None,
    camera: str | None = None,
    photo_interval: str | None = None,
    reserve_mb: float | None = None,
    naming: str | None = None,
    symbols: Path | None = None,
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None,
) -> int:
    """Record a live machine, so that nothing is lost.

    What was recorded is on the disk a fifth of a second later, and stays readable whatever happens
    to this computer. Ctrl-C ends the recording; recording to the same directory again goes on
    after a gap. `learn`, `watch` and `export` take the directory as they take a log.

    Parameters
    ----------
    source: str
        Where to tap: `modbus://HOST?coils=0-99`, `s7://HOST?pe=0-26`, … (default: `[source] url`
        of the configuration).
    to: Path
        Directory to record to.
    duration: str
        Stop after this time: `3m`, `8h` (default: go on until Ctrl-C).
    interval: str
        Time between two scans: `10ms`.
    camera: str
        Photos beside the signals: a folder that fills with images, a camera device, or
        `rtsp://HOST/STREAM`.
    photo_interval: str
        Time between two photos of a camera (default: `1s`).
    reserve_mb: float
        Stop before less than this is free on the disk (default: 100).
    naming: str
        How names are made from group, device and signal (default: `{group}-{device}-{signal}`).
    symbols: Path
        Symbol table: `address,group,device,signal,class,type,description`.
    config: Path
        Configuration file (default: `runglight.toml`, if there is one).

    """
    configuration = load_configuration(config)
    settings = configuration.record
    url = source if source is not None else configuration.source.url
    if url is None:
        raise InputError("what shall be recorded? name a source like modbus://HOST?coils=0-99")
    if not is_live(url):
        raise InputError(f"{url}: is no live source; runglight import turns a log into another")
    to = to or (Path(settings.to) if settings.to else None)
    if to is None:
        raise InputError(f"where to? runglight record {url} --to DIRECTORY")
    photos_s = duration_s(photo_interval or settings.photo_interval, "--photo-interval")
    reserve = settings.reserve_mb if reserve_mb is None else reserve_mb
    names = _names(configuration, symbols, naming)
    run = _Run(
        tap=lambda clock: _named(
            open_tap(url, interval=interval or configuration.source.interval, clock=clock), names
        ),
        directory=to,
        for_s=None if duration is None else duration_s(duration, "--for"),
        camera=camera if camera is not None else settings.camera,
        photos_s=photos_s,
        reserve_bytes=round(reserve * 1e6),
    )
    return run()


class _Run:
    def __init__(
        self,
        *,
        tap: Callable[[Clock], Tap],
        directory: Path,
        for_s: float | None,
        camera: str | None,
        photos_s: float,
        reserve_bytes: int,
    ) -> None:
        self._tap = tap
        self._directory = directory
        self._for_s = for_s
        self._camera = camera
        self._photos_s = photos_s
        self._reserve_bytes = reserve_bytes
        self._status: RecordStatus | None = None

    def __call__(self) -> int:
        interrupted = False
        try:
            asyncio.run(self._record())
        except (KeyboardInterrupt, asyncio.CancelledError):
            interrupted = True
        finally:
            # Also where the disk stopped it: what is kept is said before what went wrong.
            if self._status is not None:
                line = self._status.summary()
                terminal.results().print(line, markup=False, soft_wrap=True)
        return INTERRUPTED if interrupted else DONE

    async def _record(self) -> None:
        # Loaded when something is recorded: NumPy and SQLite.
        from runglight.cli.record_status import RecordStatus  # noqa: PLC0415
        from runglight.recording.cameras import camera_of  # noqa: PLC0415
        from runglight.recording.meter import Meter  # noqa: PLC0415
        from runglight.recording.recorder import Recorder  # noqa: PLC0415
        from runglight.recording.run import record as run  # noqa: PLC0415
        from runglight.taps.clock import SteadyClock  # noqa: PLC0415

        _end_at_sigterm()
        clock = SteadyClock()
        camera = None
        if self._camera is not None:
            camera = camera_of(self._camera, self._directory, clock, self._photos_s)
        async with self._tap(clock) as tap:
            with Recorder(self._directory, tap, reserve_bytes=self._reserve_bytes) as recorder:
                status = RecordStatus(tap, recorder, Meter(tap.interval_ns), camera)
                self._status = status
                with status:
                    await run(
                        tap,
                        recorder,
                        meter=status.meter,
                        camera=camera,
                        for_s=self._for_s,
                        tick=status.tick,
                    )


def _end_at_sigterm() -> None:
    """A service that is stopped ends its recording as Ctrl-C does."""
    task = asyncio.current_task()
    assert task is not None
    with contextlib.suppress(NotImplementedError):
        asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, task.cancel)


def _names(
    configuration: Configuration, symbols: Path | None, naming: str | None
) -> dict[str, str]:
    """Names by address, from the symbol table."""
    table = symbols if symbols is not None else configuration.symbols.table
    if naming is not None:
        try:
            check_naming(naming)
        except ValueError as error:
            raise InputError(f"--naming: {error}") from None
    if table is None:
        return {}
    return names_by_address(
        read_symbols(Path(table)), naming if naming is not None else configuration.symbols.naming
    )


def _named(tap: Tap, names: dict[str, str]) -> Tap:
    if not names:
        return tap
    from runglight.taps.named import NamedTap  # noqa: PLC0415

    return NamedTap(tap, names)
