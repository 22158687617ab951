"""`runglight simulate faults`: faults put into any log, and the truth about them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.cli.learn import LearningOptions, parameters_of, say_unnamed
from runglight.cli.output import output
from runglight.cli.reader_options import ReaderOptions, read
from runglight.errors import InputError
from runglight.log.changelog import FORMATS
from runglight.log.symbols import read_symbols
from runglight.nearest import suggestion
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from runglight.injection import InjectionKind, InjectionLabel, InjectionPlan


@Parameter(name="*", group="What to inject")
@dataclass(frozen=True, kw_only=True)
class InjectionOptions:
    """How much of what. Distributions are `normal:LEAST:MOST`, `uniform:LEAST:MOST` or `constant:S`
    in seconds; the normal one has its mean in the middle of the range, a sixth of the range as
    standard deviation, and nothing outside.
    """  # noqa: D205

    faults: int = 0
    "Faults of order, spread evenly over `--kinds`."
    kinds: tuple[str, ...] = ()
    "`stuck-on`, `stuck-off`, `missing-edge`, `spurious-pulse`, `swapped-order` (default: all)."
    stuck: str | None = None
    "How long signals are stuck: switching cycles `1:3` (default), or a distribution."
    late: int = 0
    "Transitions that take longer than ever."
    late_over: str | None = None
    "By how much over their true maximum (default: `normal:1.0:2.5`)."
    early: int = 0
    "Transitions that take less time than ever."
    early_under: str | None = None
    "By how much under their true minimum (default: `normal:1.0:2.5`)."
    longest: str | None = None
    "Transitions that ever took longer than this stay as they are (default: `60s`)."
    stalls: int = 0
    "Silences of a whole group; what it does later comes that much later."
    stall_over: str | None = None
    "By how much over the group's longest silence (default: `constant:240`)."
    branch_shifts: int = 0
    "Periods in which a device takes a branch more often."
    time_shifts: int = 0
    "Periods in which a transition that has several times takes one of them more often."
    shift_passes: int | None = None
    "Passes of the branch or transition in such a period (default: 100)."
    shift_by: float | None = None
    "By how much its share grows (default: 0.4)."
    seed: int = 1
    "The same seed gives the same faults."
    start: Annotated[str | None, Parameter(name="--from")] = None
    "Leave the log clean before this time (ISO 8601, UTC unless it says otherwise)."
    after: float | None = None
    "Leave this share of the log's time clean at its start (default: 0.1)."
    spacing: str | None = None
    "Least time between two faults of one group (default: `10s`)."

    def plan(self) -> InjectionPlan:
        """The plan these options make."""
        # Injection needs numpy: not before it is asked for.
        from runglight.injection import InjectionPlan, distribution  # noqa: PLC0415

        if self.start is not None and self.after is not None:
            raise InputError("--from and --after: give one of them")
        said: dict[str, object] = {
            "shift_passes": self.shift_passes,
            "shift_by": self.shift_by,
            "after": self.after,
            "from_ns": None if self.start is None else _time_ns(self.start),
            "kinds": _kinds(self.kinds) or None,
        }
        for name in ("late_over", "early_under", "stall_over"):
            text = getattr(self, name)
            said[name] = text and distribution(text, f"--{name.replace('_', '-')}")
        if self.longest is not None:
            said["longest_s"] = duration_s(self.longest, "--longest")
        if self.spacing is not None:
            said["spacing_s"] = duration_s(self.spacing, "--spacing")
        if self.stuck is not None:
            cycles = _cycles(self.stuck)
            said["stuck_cycles"] = cycles
            said["stuck_for"] = None if cycles else distribution(self.stuck, "--stuck")
        plan: dict[str, object] = {name: value for name, value in said.items() if value is not None}
        return InjectionPlan(
            faults=self.faults,
            late=self.late,
            early=self.early,
            stalls=self.stalls,
            branch_shifts=self.branch_shifts,
            time_shifts=self.time_shifts,
            seed=self.seed,
            **plan,  # type: ignore[arg-type]
        )


def simulate_faults(
    log: Path | None = None,
    /,
    *,
    to: Path,
    labels: Path | None = None,
    reference: tuple[Path, ...] = (),
    injection: InjectionOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Put labelled faults into a fault-free log, simulated or real.

    Every fault departs from all the log does elsewhere: a fault of order makes a transition its
    device never makes, a late one takes longer than the longest. Devices are found as
    `runglight learn` finds them.

    Parameters
    ----------
    log: Path
        Log of fault-free operation; none where `--sql` says what to read.
    to: Path
        The faulty log to write: `.csv`, `.parquet`, `.xes` or `.vcd`.
    labels: Path
        Write the truth as JSON: time, kind, group, device, signal, transition, size.
    reference: tuple[Path, ...]
        A further fault-free log of the machine: what happens there is nominal too. Repeat it for
        several.

    """
    if to.suffix.removeprefix(".").lower() not in FORMATS:
        endings = ", ".join(f".{known}" for known in FORMATS)
        raise InputError(f"{to}: cannot tell the format from the ending; use one of {endings}")
    plan = (injection or InjectionOptions()).plan()
    if not any(
        (plan.faults, plan.late, plan.early, plan.stalls, plan.branch_shifts, plan.time_shifts)
    ):
        raise InputError("nothing to inject: give --faults, --late, --early or --stalls a number")
    from runglight.injection import inject_with  # noqa: PLC0415
    from runglight.injection.labels import labels_json  # noqa: PLC0415
    from runglight.model import learn_with  # noqa: PLC0415

    options = options or ReaderOptions()
    configuration = options.configuration()
    sources = options.sources(
        [] if log is None else [log], configuration.log, "into what shall faults be put?"
    )
    table = configuration.symbols.table
    logs = [read(path, configuration.log) for path in (*sources, *reference)]
    with terminal.working("Injecting"):
        model = learn_with(
            logs,
            None if table is None else read_symbols(Path(table)),
            parameters_of(configuration, LearningOptions()),
        )
        injected = inject_with(logs[0], plan, model, logs[1:])
    say_unnamed(model.summary())
    for sentence in injected.shortfalls:
        terminal.note(sentence)
    if logs[0].gaps:
        terminal.note(
            f"{to}: the {counted(len(logs[0].gaps), 'gap')} of {logs[0].path} are not marked in it"
        )
    rows = injected.log.write(to)
    console = terminal.results()
    console.print(_table(injected.labels))
    console.print(Text(f"{to}: {counted(rows, 'row')}"), soft_wrap=True)
    if labels is not None:
        with output(labels) as stream:
            stream.write(labels_json(injected.labels))
        console.print(Text(f"{labels}: {counted(len(injected.labels), 'fault')}"), soft_wrap=True)
    return DONE


def _table(labels: list[InjectionLabel]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("Kind", no_wrap=True)
    table.add_column("Count", justify="right")
    table.add_column("Devices", justify="right")
    for kind, count in sorted(Counter(label.kind for label in labels).items()):
        devices = {(label.group, label.device) for label in labels if label.kind is kind}
        table.add_row(str(kind), f"{count:,}", f"{len(devices):,}")
    return table


def _kinds(texts: tuple[str, ...]) -> tuple[InjectionKind, ...]:
    from runglight.injection.kinds import SEQUENCE_KINDS  # noqa: PLC0415

    known = {str(kind): kind for kind in SEQUENCE_KINDS}
    names = [part.strip().lower() for text in texts for part in text.split(",") if part.strip()]
    for name in names:
        if name not in known:
            near = suggestion(name, known) or f"; there are {', '.join(known)}"
            raise InputError(f"--kinds: there is no kind {name!r}{near}")
    return tuple(known[name] for name in dict.fromkeys(names))


def _cycles(text: str) -> tuple[int, int] | None:
    parts = text.split(":")
    if len(parts) > 2 or not all(part.isdecimal() for part in parts):
        return None
    return int(parts[0]), int(parts[-1])


def _time_ns(text: str) -> int:
    from datetime import UTC, datetime, timedelta  # noqa: PLC0415

    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        raise InputError(
            f"--from: {text!r} is no time; write it like 2026-01-05T06:00:00Z"
        ) from None
    time = time.replace(tzinfo=UTC) if time.tzinfo is None else time
    return (time - datetime(1970, 1, 1, tzinfo=UTC)) // timedelta(microseconds=1) * 1000
