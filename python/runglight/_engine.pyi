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

class TimingDiagram:
    """The changes of every signal, ready to be drawn at any scale; lanes are signal indices."""

    def __init__(self, log: ChangeLog | None = None) -> None: ...
    def append(self, time_ns: Any, signal_index: Any, value: Any) -> None:
        """Adds rows (int64, uint32, int64) that are no older than those before."""
    def forget_before(self, time_ns: int) -> None:
        """Forgets what was over before a time; the level each signal had then is kept."""
    @property
    def lanes(self) -> int: ...
    def changes(self, lane: int) -> int: ...
    def value_range(self, lane: int) -> tuple[int, int] | None:
        """Smallest and largest value a lane ever had."""
    def spans(
        self, lanes: Sequence[int], from_ns: int, until_ns: int, columns: int
    ) -> tuple[Any, Any, Any, Any, Any]:
        """What to draw: `(spans per lane uint32, start_ns int64, value int64, changes uint32, known uint8)` as numpy arrays. `changes` above 0: too close together to be drawn one by one."""
    def edges(
        self, lane: int, from_ns: int, until_ns: int, limit: int = 100_000
    ) -> list[tuple[int, int]]:
        """Time and value of the changes from `from_ns` up to `until_ns`, the oldest first."""
    def next_edge(self, lane: int, after_ns: int) -> tuple[int, int] | None: ...
    def previous_edge(self, lane: int, before_ns: int) -> tuple[int, int] | None: ...

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
