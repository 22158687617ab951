"""The compiled engine. Arrow in, Arrow out; the GIL is released while it works.

Every object with `__arrow_c_stream__` can be handed to pyarrow, polars, pandas or DuckDB.
Times are int64 nanoseconds since the Unix epoch, UTC.
"""

from collections.abc import Sequence
from typing import Any

__version__: str

class RunglightError(Exception):
    """Base of everything the engine raises; its text is one sentence for the user."""

class InputError(RunglightError):
    """A log, table or parameter cannot be used: names the file, the row and the mend."""

class ModelError(RunglightError):
    """A model directory is missing, older than this version, or damaged."""

class ChangeLog:
    """A change log in memory: `time`, `signal`, `value`, with its gaps and scan interval."""

    @staticmethod
    def from_arrow(table: Any, reorder_s: float = 1.0) -> ChangeLog:
        """From anything with `__arrow_c_stream__`: columns `time`, `signal`, `value`."""
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    @property
    def signals(self) -> list[str]: ...
    @property
    def start_ns(self) -> int | None: ...
    @property
    def end_ns(self) -> int | None: ...
    @property
    def scan_interval_ns(self) -> int | None: ...
    @property
    def gaps(self) -> list[tuple[int, int]]: ...
    @property
    def report_json(self) -> str:
        """What reading did: `{format, rows, bad_rows, bad: [{row, reason}], left_out: [{column, reason}], notes: []}`."""
    def slice(self, offset: int, length: int | None = None) -> ChangeLog:
        """Some of the rows; the gaps among them are kept."""
    def with_signals(self, signals: Sequence[str]) -> ChangeLog:
        """The same rows, gaps and report under other names of the signals."""
    def columns(self) -> tuple[Any, Any, Any]:
        """`(time_ns int64, signal index uint32, value int64)` as numpy arrays."""

def log_from_columns(
    time_ns: Any,
    signal_index: Any,
    value: Any,
    signals: Sequence[str],
    scan_interval_ns: int | None = None,
    gaps: Sequence[tuple[int, int]] = (),
) -> ChangeLog:
    """From three numpy arrays (int64, uint32, int64), the names the indices stand for, and gaps (start, end) in nanoseconds."""

def read_log(path: str, options_json: str = "{}") -> ChangeLog:
    """Reads CSV, Parquet, XES or VCD; options as in `runglight.log.ReadOptions`. Raises InputError."""

def write_log(log: ChangeLog, path: str, format: str | None = None) -> int:
    """Writes a log (format by name or by the file's ending); returns rows written. Raises InputError."""

class Findings:
    """Findings in the order they were made."""

    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def json_lines(self) -> list[str]:
        """One JSON text per finding, as the published schema describes it."""

class Monitor:
    """Watches one plant; every split of a log into batches gives the same findings."""

    def observe(self, batch: Any) -> Findings:
        """Takes a ChangeLog (its gaps count as declared) or an Arrow table of changes in time order."""
    def bind(self, signals: Sequence[str]) -> None:
        """What the indices of the next two stand for, from now on; names are looked up here, once."""
    def observe_rows(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes changes of bound signals: three numpy arrays (int64, uint32, int64), in time order."""
    def observe_image(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes bound signals as they stand, after a start or a gap: nothing changed, so nothing is judged."""
    @property
    def now_ns(self) -> int | None:
        """The newest time observed or advanced to; rows before it are refused."""
    def gap(self, start_ns: int, end_ns: int) -> Findings:
        """Nothing was recorded between two times: resynchronise instead of alarming."""
    def advance(self, now_ns: int) -> Findings:
        """Time went on without a change: closes the running scan, finds stalls."""
    def finish(self) -> Findings:
        """The log has ended: closes the running scan; open alarm paths stay `suspected`."""
    def state(self) -> bytes: ...
    def take_snapshots(self) -> list[str]:
        """Snapshots made since the last call, JSON: `{id, time, devices: {...}, groups: {...}}`."""

class CycleModel:
    """The cycle machine of a plant (Guim & Dias 2023): regions, and an automaton per phase."""

    def summary_json(self) -> str:
        """`{mode, parameters, work_complete, sequences: {work, setup}, left_out, longest_s, regions: [{region, bits, work: {states, initial, final, transitions, either_order}, setup}]}`."""
    def machine_json(self, region: str, phase: str) -> str:
        """`{region, phase, states: [{word, initial, final}], transitions: [{from, to, weight, longest_stay_s}]}`."""
    def candidates_json(self, region: str, phase: str, at: str, seen: str) -> str:
        """What could have followed the word `at` where `seen` came, best first: `[{word, weight, popularity, similarity, score, differing}]`."""
    def dot(self, region: str, phase: str) -> str:
        """Graphviz text of one region in phase `work` or `setup`."""
    def monitor(self, state: bytes | None = None) -> Monitor:
        """Watches the cycle machine alone."""

class NominalModel:
    """What was learned of a plant."""

    def rules(self) -> Any:
        """The transition rules, an object with `__arrow_c_stream__` (columns of `rules.parquet`)."""
    def rules_json(self, group: str | None = None, device: str | None = None) -> str:
        """The rows of `rules()` as a JSON list of objects keyed by column; of one group, or one device."""
    def save(self, directory: str) -> None:
        """Replaces the model's own files as one; `findings.sqlite` in the directory stays."""
    def summary_json(self) -> str:
        """`{created, format, timing, signals, devices, groups, rules, events, duration_s, scan_interval_s, unnamed: [...], group_list: [{group, start, devices: [{device, start, signals, rules}]}]}`."""
    def dot(self, group: str, device: str | None = None) -> str:
        """Graphviz text of one device's model, or of the group's where `device` is None."""
    @property
    def signals(self) -> list[str]:
        """Names of the signals as the learned logs call them."""
    def symbols_csv(self) -> str:
        """The symbol table in force, as `symbols.csv`."""
    @property
    def cycle(self) -> CycleModel | None:
        """The cycle machine, where one was learned."""
    def monitor(self, state: bytes | None = None) -> Monitor: ...
    def confirm(self, finding_json: str) -> int:
        """Folds a finding's path into the model; returns the number of new transitions."""

def learn(
    logs: Sequence[ChangeLog],
    symbols_csv: str | None = None,
    parameters_json: str = "{}",
    source: Sequence[str] = (),
    cycle_json: str | None = None,
) -> NominalModel:
    """Learns from fault-free logs. `symbols_csv` is the text of a symbol table; `source` says where they are from; `cycle_json` holds `modes`, `regions` and `cycle` where a cycle machine is wanted."""

def learn_cycle(
    logs: Sequence[ChangeLog],
    settings_json: str,
    symbols_csv: str | None = None,
    naming: str = "{group}-{device}-{signal}",
) -> CycleModel:
    """Learns the cycle machine alone."""

def load_model(directory: str) -> NominalModel: ...

class EventLog:
    """The runs of a machine: traces of activities."""

    @staticmethod
    def from_traces(traces: Sequence[Sequence[str]]) -> EventLog:
        """From names; the events of a trace are one second apart."""
    @staticmethod
    def read_xes(path: str) -> EventLog:
        """Reads XES, trace by trace. Raises InputError."""
    def write_xes(self, path: str) -> None:
        """Writes XES; the file appears whole or not at all."""
    def __len__(self) -> int:
        """Number of events."""
    @property
    def traces(self) -> int:
        """Number of traces."""
    @property
    def activities(self) -> list[tuple[str, str | None]]:
        """Name and class (`input`, `output` or None) of each activity."""
    @property
    def names(self) -> list[str]:
        """Name of each trace."""
    def columns(self) -> tuple[Any, Any, Any]:
        """`(activity uint32, time_ns int64, bounds uint64)` as numpy arrays; trace `n` is `bounds[n]:bounds[n + 1]`."""
    def select(self, traces: Sequence[int]) -> EventLog:
        """Some of the traces; activities keep their numbers."""

def event_log(
    log: ChangeLog,
    reset: str,
    symbols_csv: str | None = None,
    naming: str | None = None,
    keep_partial: bool = False,
    only: Sequence[str] = (),
) -> EventLog:
    """Cuts an I/O log into runs at the activities that contain `reset` (`%IX0.1=0`). Raises InputError."""

class PetriNet:
    """A labelled Petri net with its initial and final marking."""

    @staticmethod
    def read_pnml(path: str) -> PetriNet:
        """Raises InputError."""
    def write_pnml(self, path: str) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def places(self) -> list[str]:
        """Identifiers of the places."""
    @property
    def initial(self) -> list[int]:
        """Tokens of each place before the first event."""
    @property
    def last(self) -> list[int]:
        """Tokens of each place after the last event."""
    def transitions(self) -> list[tuple[str, str | None, str | None, list[int], list[int]]]:
        """`(id, label, class, input places, output places)`; silent ones have no label."""
    def dot(self) -> str:
        """Graphviz text: the first place green, the last one red, classes by colour."""
    def soundness_json(self) -> str:
        """`{sound: bool or null, problems: [sentence], markings}`."""
    def fitness_json(self, log: EventLog) -> str:
        """`{fitness, fitting, traces, produced, consumed, missing, remaining}`: token replay."""
    def precision(self, log: EventLog) -> float:
        """Escaping edges: 1 where the net allows nothing that was not seen."""

class Mined:
    """What was mined of an event log."""

    @property
    def net(self) -> PetriNet: ...
    @property
    def epsilon(self) -> float:
        """The ε in force: another than asked for where that gave a net that is not sound."""
    def write_bpmn(self, path: str) -> None:
        """Writes BPMN 2.0; the file appears whole or not at all."""

def mine(log: EventLog, parameters_json: str = "{}") -> Mined:
    """Split Miner; parameters `eta` and `epsilon`. Raises InputError."""
