"""The nominal model: learned once, then watched with."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runglight import _engine
from runglight.configuration import Cycle, Modes, Parameters, cycle_json
from runglight.cycle_model import CycleModel
from runglight.errors import InputError
from runglight.findings.batch import Findings
from runglight.log.changelog import Log, as_log
from runglight.log.symbols import read_symbols
from runglight.moments import nanoseconds
from runglight.monitoring import MonitorVerbs
from runglight.strictly import convert

if TYPE_CHECKING:
    from datetime import datetime
    from os import PathLike

ROWS_AT_ONCE = 1 << 20
"""Rows of a log whose findings are told together: what many of them share is said once."""


class Monitor(MonitorVerbs[_engine.Monitor]):
    """Watches one plant. Every split of a log into batches gives the same findings."""

    def bind(self, signals: Sequence[str]) -> None:
        """Names what the indices of `observe_rows` and `observe_image` stand for, from now on."""
        self._engine.bind(signals)

    def observe_slice(self, log: Log, offset: int, length: int) -> Findings:
        """Takes some rows of a log: the same as `observe(log.slice(offset, length))`, uncopied."""
        return Findings(self._engine.observe_slice(log.engine, offset, length))

    def observe_rows(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes changes of bound signals: numpy arrays (int64, uint32, int64) in time order.

        The same as `observe`, without a look-up of names: for the small batches of a live source.
        """
        return Findings(self._engine.observe_rows(time_ns, signal_index, value))

    def observe_image(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes bound signals as they stand after a start or a gap; nothing is judged by it."""
        return Findings(self._engine.observe_image(time_ns, signal_index, value))

    def begin(self, time: datetime | int, *, image: bool) -> None:
        """The plant's rows begin at a time, or go on there after a gap: said to a part of a model.

        The rows at the very first time of a log are an image of the plant where any of them is 0
        (`image`), and else events. A monitor finds that in the first rows it sees; those of a part
        may come later than the plant's. Say it before the first row of the log, and after
        `gap` (where `image` means nothing) before the next row, with the time of the first row of
        any part (aware datetime, or nanoseconds since 1970).
        """
        self._engine.begin(nanoseconds(time), image)

    @property
    def now_ns(self) -> int | None:
        """The newest time observed or advanced to (nanoseconds since 1970); None at the start."""
        return self._engine.now_ns

    def take_snapshots(self) -> list[str]:
        """Snapshots made since the last call, as JSON."""
        return self._engine.take_snapshots()


class NominalModel:
    """What was learned of a plant."""

    def __init__(self, engine_model: _engine.NominalModel) -> None:
        self._engine = engine_model

    def rules(self) -> Any:
        """The transition rules as an Arrow stream: the columns of `rules.parquet`."""
        return self._engine.rules()

    def rules_json(self, group: str | None = None, device: str | None = None) -> str:
        """The transition rules of everything, one group's own, or one device, as JSON."""
        return self._engine.rules_json(group, device)

    def summary(self) -> dict[str, Any]:
        """Groups, devices, signals, counts, and how the model was learned."""
        summary: dict[str, Any] = json.loads(self._engine.summary_json())
        return summary

    @property
    def signals(self) -> list[str]:
        """Names of the signals, as the learned logs call them."""
        return self._engine.signals

    def knows(self, log: Log) -> bool:
        """True where the model knows every signal of a log by the name it has there."""
        return self._engine.knows(log.engine)

    def symbols(self) -> str:
        """The symbol table in force, as the text of a `symbols.csv`."""
        return self._engine.symbols_csv()

    def dot(self, group: str, device: str | None = None) -> str:
        """Graphviz text of a device's model, or of the group's own."""
        return self._engine.dot(group, device)

    @property
    def cycle(self) -> CycleModel | None:
        """The cycle machine; None where the model was learned without mode bits."""
        cycle = self._engine.cycle
        return None if cycle is None else CycleModel(cycle)

    def save(self, directory: str | PathLike[str]) -> None:
        """Writes the model directory: to a temporary name, then renamed."""
        target = Path(directory)
        if target.is_file() or (
            target.is_dir() and any(target.iterdir()) and not (target / "manifest.json").exists()
        ):
            raise InputError(f"{target}: exists and is no model; choose another name or remove it")
        self._engine.save(os.fspath(target))

    def monitor(self, state: bytes | None = None) -> Monitor:
        """A monitor at its start, or where another one's `state()` left off."""
        return Monitor(self._engine.monitor(state))

    @property
    def groups(self) -> list[str]:
        """Names of the groups, in the plant's order."""
        return self._engine.groups

    def groups_of(self, signals: Sequence[str]) -> list[str | None]:
        """The group of each signal of a log, by its name there; None where no signal is called so.

        What no group knows is told by the part that holds the plant's first group.
        """
        return self._engine.groups_of(list(signals))

    def parts(self) -> list[list[str]]:
        """Groups that can be watched apart: lists of those that must stay together.

        One list per group, but for groups whose transitions wait for another's events; all groups
        in one list where the model has a cycle machine, which watches the whole plant.
        """
        return self._engine.independent_groups()

    def part(self, groups: Sequence[str]) -> NominalModel:
        """Some of the groups as a model of their own, to be watched somewhere else.

        It judges as the whole model does: what all monitors of a plant's parts tell, put together,
        is what one monitor of the whole model tells of the same rows. Each needs the rows of its
        own groups only (those of others are passed over); `begin`, where the log's first row may be
        another part's; `advance`, to learn how far time has come, at the end and before a gap; and
        `gap`, where nothing was recorded: told by several parts, it is one finding with one id.
        Where there is a scan interval, the rows of one scan must bear one time, as taps write them:
        else a part may see other scans than the whole plant. A snapshot shows the part alone.

        A part is watched with, not saved or changed. Raises InputError for a group that is not
        there, for groups that `parts()` keeps together, and for a model with a cycle machine.
        """
        names = [groups] if isinstance(groups, str) else list(groups)
        return NominalModel(self._engine.part(names))

    @property
    def is_part(self) -> bool:
        """True for what `part` gives."""
        return self._engine.is_part

    def watch(self, log: Log | Any) -> Iterator[dict[str, Any]]:
        """The findings of a whole log, or of an Arrow table of one, one dictionary each."""
        log = as_log(log)
        monitor = self.monitor()
        for offset in range(0, len(log), ROWS_AT_ONCE):
            yield from monitor.observe_slice(log, offset, ROWS_AT_ONCE)
        yield from monitor.finish()

    def confirm(self, finding: str | Mapping[str, Any]) -> int:
        """Folds a finding's path into the model; returns the number of new transitions."""
        text = finding if isinstance(finding, str) else json.dumps(dict(finding))
        return self._engine.confirm(text)


def learn(
    log: Log | Any | Iterable[Log | Any],
    symbols: str | PathLike[str] | None = None,
    **parameters: Any,
) -> NominalModel:
    """Learns from one or several fault-free logs.

    `symbols` is the path of a symbol table; `parameters` are the fields of
    `runglight.Parameters`. Logs may be Arrow tables.
    """
    table = None if symbols is None else read_symbols(Path(symbols))
    return learn_with(_logs(log), table, convert(parameters, Parameters, "learn"))


def learn_with(
    logs: list[Log],
    symbols_csv: str | None,
    parameters: Parameters,
    cycle_settings: str | None = None,
) -> NominalModel:
    """Learns with parameters that are already checked; with a cycle machine where one is set."""
    engine_logs = [log.engine for log in logs]
    source = [log.path for log in logs if log.path is not None]
    return NominalModel(
        _engine.learn(engine_logs, symbols_csv, parameters.to_json(), source, cycle_settings)
    )


def learn_cycle(
    log: Log | Any | Iterable[Log | Any],
    modes: Mapping[str, Any],
    regions: Mapping[str, str | list[str]] | None = None,
    symbols: str | PathLike[str] | None = None,
    **parameters: Any,
) -> CycleModel:
    """Learns the cycle machine alone, from one or several fault-free logs.

    `modes` are the keys of `[modes]`, `regions` those of `[regions]` (None: proposed from the
    logs), `parameters` those of `[cycle]`.
    """
    table = None if symbols is None else read_symbols(Path(symbols))
    settings = cycle_json(
        convert(modes, Modes, "modes"),
        dict(regions or {}),
        convert(parameters, Cycle, "learn_cycle"),
    )
    logs = [each.engine for each in _logs(log)]
    return CycleModel(_engine.learn_cycle(logs, settings, table))


def load_model(directory: str | PathLike[str]) -> NominalModel:
    """Loads a model directory; raises ModelError where it is older or damaged."""
    return NominalModel(_engine.load_model(os.fspath(directory)))


def _logs(logs: Any) -> list[Log]:
    if hasattr(logs, "__arrow_c_stream__"):
        return [as_log(logs)]
    return [as_log(log) for log in logs]
