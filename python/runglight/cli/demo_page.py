"""The end of the demo: the page, open on the cell that was broken and works on."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from runglight.cli import terminal
from runglight.cli.serve import run_page
from runglight.errors import InputError
from runglight.server.policy import policy
from runglight.server.running import PageServer, address_of, listen
from runglight.server.workshop import Workshop

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.cli.demo_machine import DemoMachine


async def show_page(machine: DemoMachine, directory: Path, port: int) -> None:
    """Serves the demo's directory, watching its machine, until Ctrl-C."""
    chosen = policy()
    try:
        listening = listen(chosen.host, port)
    except InputError:
        # A demo does not fail because another one shows its page.
        listening = listen(chosen.host, 0)
    machine.run_on()
    workshop = Workshop(
        directory,
        chosen,
        source=machine.url,
        model=directory / "cell.model",
        clock=machine.clock,
    )
    with contextlib.closing(listening):
        terminal.results().print()
        terminal.results().print("See it: the broken cell works on. Ctrl-C ends it.")
        await run_page(PageServer(workshop, listening), address_of(listening))
