"""`runglight learn`: a nominal model from fault-free logs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.cycle_tables import mode_bits_text, print_cycle
from runglight.cli.exit_codes import DONE
from runglight.cli.model_tables import print_summary
from runglight.cli.reader_options import ReaderOptions, read
from runglight.configuration import Parameters, SignalState, Source
from runglight.errors import InputError
from runglight.log.symbols import read_symbols
from runglight.model import NominalModel, learn_with
from runglight.quantities import duration_s, rate_per_day
from runglight.replacing import replacing
from runglight.strictly import convert

if TYPE_CHECKING:
    from runglight.configuration import Configuration


SYMBOLS = "symbols.csv"
"""The symbol table in force, written beside the model: what a user corrects and gives back."""


@Parameter(name="*", group="Learning")
@dataclass(frozen=True, kw_only=True)
class LearningOptions:
    """How the model is learned. The rest of the parameters are keys of `[signal_state]`."""

    timing: Literal["adaptive", "plat"] | None = None
    "How limits of time are learned (default: adaptive); `plat` is the method of Ghosh 2016."
    false_alarms: str | None = None
    "Budget of false alarms (default: `1/day`): `2/week`, `0.5/h`."
    stall_after: str | None = None
    "A silent group has stalled (default: `180s`); `learned`: 1.5 times the longest pause."
    return_within: str | None = None
    "A device back on known transitions within this time has returned (default: `60s`)."
    check_every: int | None = None
    "Group cycles between two checks of probabilities and average times (default: 30)."
    significant_change: float | None = None
    "Smallest change of a probability or (relative) average time that counts (default: 0.15)."
    scan_interval: str | None = None
    "Time between two scans of the PLC (`10ms`), where the log does not tell."
    starting: tuple[str, ...] = ()
    "`GROUP-DEVICE=SIGNAL`: the signal a device's cycle starts with (default: the first one seen)."

    def over(self, file: SignalState, source: Source) -> dict[str, Any]:
        """The parameters of the file with these options laid over them."""
        written: dict[str, Any] = msgspec.to_builtins(file)
        if written["scan_interval_s"] is None and source.interval is not None:
            written["scan_interval_s"] = duration_s(source.interval, "[source] interval")
        said: dict[str, Any] = {
            "timing": self.timing,
            "check_every": self.check_every,
            "significant_change": self.significant_change,
        }
        if self.false_alarms is not None:
            said["false_alarms_per_day"] = rate_per_day(self.false_alarms)
        if self.stall_after == "learned":
            said["stall_learned"] = True
        elif self.stall_after is not None:
            said["stall_learned"] = False
            said["stall_after_s"] = duration_s(self.stall_after, "--stall-after")
        if self.return_within is not None:
            said["return_within_s"] = duration_s(self.return_within, "--return-within")
        if self.scan_interval is not None:
            said["scan_interval_s"] = duration_s(self.scan_interval, "--scan-interval")
        if self.starting:
            said["starting"] = written["starting"] | dict(map(_starting, self.starting))
        return written | {key: value for key, value in said.items() if value is not None}


def learn(
    log: list[Path] | None = None,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    learning: LearningOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Learn what nominal looks like from logs of a machine that ran without faults.

    Twenty cycles are a start; more make tighter limits. Several logs are learned as separate runs
    of one machine.

    Parameters
    ----------
    log: list[Path]
        Logs of fault-free operation: CSV, Parquet, XES or VCD; none where `--sql` says what to
        read.
    output: Path
        Directory to write the model to; a model that is there is replaced.

    """
    options = options or ReaderOptions()
    configuration = options.configuration()
    sources = options.sources(log or [], configuration.log, "what shall be learned from?")
    parameters = parameters_of(configuration, learning or LearningOptions())
    table = configuration.symbols.table
    symbols_csv = None if table is None else read_symbols(Path(table))
    logs = [read(path, configuration.log) for path in sources]
    with terminal.working("Learning"):
        model = learn_with(logs, symbols_csv, parameters, configuration.cycle_json())
        save_learned(model, output)
    say_learned(model, output)
    if model.cycle is not None:
        machine = model.cycle.summary()
        terminal.note(mode_bits_text(machine))
        print_cycle(terminal.results(), str(output), machine)
    return DONE


def parameters_of(configuration: Configuration, learning: LearningOptions) -> Parameters:
    """What learning takes, from file and options."""
    written = learning.over(configuration.signal_state, configuration.source)
    return convert(written | {"naming": configuration.symbols.naming}, Parameters, "learn")


def save_learned(model: NominalModel, output: Path) -> None:
    """Saves a model, and beside it the symbol table that learning proposes."""
    model.save(output)
    with replacing(output / SYMBOLS) as path:
        path.write_text(model.symbols(), encoding="utf-8")


def say_learned(model: NominalModel, output: Path) -> None:
    """Says what a saved model has learned."""
    summary = model.summary()
    say_unnamed(summary, output / SYMBOLS)
    print_summary(terminal.results(), str(output), summary)


def say_unnamed(summary: dict[str, Any], proposal: Path | None = None) -> None:
    """Signals that fit no naming rule are counted and named."""
    unnamed: list[str] = summary.get("unnamed") or []
    if unnamed:
        shown = ", ".join(unnamed[:8]) + (", …" if len(unnamed) > 8 else "")
        signals = "1 signal fits" if len(unnamed) == 1 else f"{len(unnamed):,} signals fit"
        terminal.note(
            f"{signals} no naming rule, grouped by how their names begin under 'plant': {shown}; "
            + (f"edit {proposal} and give it as --symbols" if proposal else "give --symbols")
            + ", or give --naming"
        )


def _starting(text: str) -> tuple[str, str]:
    device, separator, signal = text.partition("=")
    if not (separator and device and signal):
        raise InputError(f"--starting: {text!r} must be GROUP-DEVICE=SIGNAL")
    return device, signal
