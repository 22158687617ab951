"""`runglight serve`: the page, and its HTTP API."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from runglight import environment
from runglight.cli import terminal
from runglight.cli.exit_codes import INTERRUPTED
from runglight.configuration import load_configuration
from runglight.errors import InputError

if TYPE_CHECKING:
    from runglight.server.running import PageServer


def serve(
    directory: Path = Path(),
    /,
    *,
    source: str | None = None,
    model: Path | None = None,
    host: str | None = None,
    port: int | None = None,
    token: str | None = None,
    read_only: bool = False,
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None,
) -> int:
    """Show the machine in a browser: live, in timing diagrams, as a model.

    Serves what lies in one directory: recordings, logs, models, `runglight.toml`. Where a live
    source is configured, it is watched with the model. Ctrl-C ends it.

    Parameters
    ----------
    directory: Path
        What to serve (default: the present directory).
    source: str
        Live source to watch (default: `[source] url` of the configuration).
    model: Path
        Model to watch with (default: the newest in the directory).
    host: str
        Address to listen at (default: `127.0.0.1`, this computer alone).
    port: int
        Port to listen at (default: 8470; 0 takes a free one).
    token: str
        What others must type in before they see anything; needed with any `--host` but loopback.
        Better given as the environment variable RUNGLIGHT_TOKEN, which no process list shows.
    read_only: bool
        Show, and change nothing: nobody can acknowledge, record, upload or configure.
    config: Path
        Configuration file (default: `runglight.toml` in the directory, if there is one).

    """
    if not directory.is_dir():
        raise InputError(f"{directory}: is no directory; name the one with recordings and models")
    path = config if config is not None else directory / "runglight.toml"
    settings = load_configuration(path) if config is not None or path.is_file() else None
    # Loaded here: the server is no business of the other commands.
    from runglight.configuration import Server  # noqa: PLC0415
    from runglight.server.policy import policy  # noqa: PLC0415
    from runglight.server.running import PageServer, address_of, listen  # noqa: PLC0415
    from runglight.server.workshop import Workshop  # noqa: PLC0415

    server = settings.server if settings is not None else Server()
    chosen = policy(
        host if host is not None else server.host,
        token=token or environment.page_token(),
        read_only=read_only or server.read_only,
        upload_mb=server.upload_mb,
    )
    listening = listen(chosen.host, port if port is not None else server.port)
    workshop = Workshop(directory, chosen, configuration_path=path, source=source, model=model)
    with contextlib.closing(listening):
        page = PageServer(workshop, listening)
        asyncio.run(run_page(page, address_of(listening)))
    return INTERRUPTED


async def run_page(page: PageServer, address: str) -> None:
    """Serves until Ctrl-C or SIGTERM, and says where."""
    from runglight.server.running import served  # noqa: PLC0415

    stopping = asyncio.Event()
    loop = asyncio.get_running_loop()
    handled = (signal.SIGINT, signal.SIGTERM)
    with contextlib.suppress(NotImplementedError):
        for each in handled:
            loop.add_signal_handler(each, stopping.set)
    console = terminal.results()
    console.print(f"page at {address}", markup=False, soft_wrap=True)
    console.file.flush()
    try:
        await served(page, stopping)
    finally:
        with contextlib.suppress(NotImplementedError):
            for each in handled:
                loop.remove_signal_handler(each)
