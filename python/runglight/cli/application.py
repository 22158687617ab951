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


# In the order in which one needs them. The sentences are those of the commands' own help.
COMMANDS = {
    "demo": ("demo:demo", "Break a simulated machine and have the fault named."),
    "init": ("init:init", "Write a commented configuration for a machine."),
    "check": ("check:check", "Say which signals of a machine answer."),
    "record": ("record:record", "Record a live machine, so that nothing is lost."),
    "learn": ("learn:learn", "Learn what nominal looks like from fault-free logs."),
    "show": ("show:show", "Show what a model knows: devices, rules, drawings."),
    "watch": ("watch:watch", "Say what departs from the nominal model."),
    "confirm": ("confirm:confirm", "Accept a finding's path: from now on it is nominal."),
    "serve": ("serve:serve", "Show the machine in a browser."),
    "identify": ("identify:identify", "Find the address that declared events mean."),
    "mine": ("mine:mine", "Mine the net that the runs of a machine follow."),
    "predict": ("predict:application", "Foretell what comes next in a run: train, evaluate."),
    "control": ("control:application", "Run the learned controller, or beside the real one."),
    "spark": ("spark:application", "More than one machine can: the same engine on Spark."),
    "import": ("import_log:import_log", "Turn any log into a change log."),
    "export": ("export:export", "Write a log for another tool: CSV, Parquet, XES, VCD."),
    "simulate": ("simulate:application", "Write the log of a simulated plant, sound or broken."),
}


def application(*, overview: bool = False) -> App:
    """The command line; with `overview`, every command is described by its one sentence.

    Otherwise a command's help is its own docstring, and no command is imported but the one called.
    """
    app = App(
        name="runglight",
        help=HELP,
        version=_version,
        help_format="markdown",
        # No `--no-…` or `--empty-…` twins: one way to say one thing.
        default_parameter=Parameter(negative="", show_default=False),
        result_action="return_value",
        # `main` says that a command was interrupted.
        suppress_keyboard_interrupt=False,
    )
    for position, (command, (home, sentence)) in enumerate(COMMANDS.items()):
        app.command(
            f"runglight.cli.{home}",
            name=command,
            sort_key=position,
            help=sentence if overview else None,
        )
    return app


def run(arguments: Sequence[str]) -> int:
    """Parses the arguments and runs the command; raises what goes wrong."""
    overview = not arguments or arguments[0] in {"-h", "--help"}
    code = application(overview=overview)(
        list(arguments) or ["--help"], exit_on_error=False, print_error=False
    )
    return code if isinstance(code, int) else DONE
