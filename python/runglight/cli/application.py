"""All commands by name. Each is imported when it is called or its help is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cyclopts import App, Parameter

from runglight.cli.exit_codes import DONE

if TYPE_CHECKING:
    from collections.abc import Sequence

HELP = """\
Learns how a PLC-controlled machine behaves from its I/O logs, and says what departs from it,
where and why.

First steps: `runglight demo`, or `runglight learn nominal.csv -o cell.model` and
`runglight watch cell.model today.csv`.
"""


def _version() -> str:
    from runglight._engine import __version__  # noqa: PLC0415

    return __version__


app = App(
    name="runglight",
    help=HELP,
    version=_version,
    help_format="markdown",
    # No `--no-…` or `--empty-…` twins: one way to say one thing.
    default_parameter=Parameter(negative=""),
    result_action="return_value",
)

app.command("runglight.cli.demo:demo")
app.command("runglight.cli.learn:learn")
app.command("runglight.cli.show:show")
app.command("runglight.cli.watch:watch")
app.command("runglight.cli.confirm:confirm")
app.command("runglight.cli.import_log:import_log", name="import")
app.command("runglight.cli.export:export")
app.command("runglight.cli.simulate:simulate")


def run(arguments: Sequence[str]) -> int:
    """Parses the arguments and runs the command; raises what goes wrong."""
    code = app(list(arguments) or ["--help"], exit_on_error=False, print_error=False)
    return code if isinstance(code, int) else DONE
