"""The compiled engine. Arrow in, Arrow out; the GIL is released while it works.

Every object with `__arrow_c_stream__` can be handed to pyarrow, polars, pandas or DuckDB.
Times are int64 nanoseconds since the Unix epoch, UTC.
"""

from collections.abc import Callable, Sequence
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
    def find_address(self, address: str) -> tuple[str, int | None] | None:
        """The signal an address is, or the word and the bit of it; None where there is neither."""
    def split_words(self, words: Sequence[str]) -> ChangeLog:
        """The same log with some of its words split into one signal per bit that is ever set."""
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
    def told(self) -> tuple[list[str], list[str], list[str], list[str]]:
        """The JSON, id, kind and severity of each finding."""

class Monitor:
    """Watches one plant; every split of a log into batches gives the same findings."""

    def observe(self, batch: Any) -> Findings:
        """Takes a ChangeLog (its gaps count as declared) or an Arrow table of changes in time order."""
    def bind(self, signals: Sequence[str]) -> None:
        """What the indices of the next two stand for, from now on; names are looked up here, once."""
    def observe_slice(self, log: ChangeLog, offset: int, length: int) -> Findings:
        """Takes rows of a log where they are; the same as to observe their slice."""
    def observe_rows(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes changes of bound signals: three numpy arrays (int64, uint32, int64), in time order."""
    def observe_image(self, time_ns: Any, signal_index: Any, value: Any) -> Findings:
        """Takes bound signals as they stand, after a start or a gap: nothing changed, so nothing is judged."""
    @property
    def now_ns(self) -> int | None:
        """The newest time observed or advanced to; rows before it are refused."""
    def begin(self, time_ns: int, image: bool) -> None:
        """The plant's rows begin at a time, or go on after a gap, whichever part they are of; before the next row."""
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

class Identification:
    """Signals, and bits of words, in the order in which they fit declared events."""

    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Columns `rank`, `address`, `name`, `score_in`, `score_out`, `changes`, `same_as`."""
    def summary_json(self) -> str:
        """`{start_ns, end_ns, windows: [{start_ns, end_ns, events}], areas_s, unrecorded_ns, changing}`."""
    def rows_json(self, limit: int | None = None) -> str:
        """The rows of the table, or the first of them, as a JSON list of objects keyed by column."""
    def moments(self, log: ChangeLog, limit: int) -> list[Any]:
        """When the first of the list changed: an int64 array of nanoseconds for each."""

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
    def knows(self, log: ChangeLog) -> bool:
        """True where every signal of the log is one of them, by its symbol."""
    def symbols_csv(self) -> str:
        """The symbol table in force, as `symbols.csv`."""
    @property
    def cycle(self) -> CycleModel | None:
        """The cycle machine, where one was learned."""
    def monitor(self, state: bytes | None = None) -> Monitor: ...
    @property
    def groups(self) -> list[str]:
        """Names of the groups, in the plant's order."""
    def groups_of(self, signals: Sequence[str]) -> list[str | None]:
        """The group of each signal of a log; None where the (whole) model has none."""
    def independent_groups(self) -> list[list[str]]:
        """Groups that must stay together, and need no others."""
    def part(self, groups: Sequence[str]) -> NominalModel:
        """Some groups, judged as in the whole model. Raises InputError."""
    @property
    def is_part(self) -> bool: ...
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

def log_columns(names: Sequence[str]) -> list[str | None]:
    """The names among these of the columns of times, signals and values, as readers know them."""

class LogSurvey:
    """What learning must know of a whole log; surveys of its pieces merge, in any order."""

    def __init__(self, gaps: Sequence[tuple[int, int]] = ()) -> None:
        """`gaps` are those of the whole log, (start, end) in nanoseconds, in time order."""
    def __len__(self) -> int:
        """Number of rows."""
    def add(self, batch: Any) -> None:
        """Takes an Arrow batch: `time` (int64 ns), `signal` (text), `value` (int64), and `place` (int64) where rows of one time have an order. Raises InputError."""
    def merge(self, state: bytes) -> None:
        """Takes what another survey's `state()` gave. Raises InputError."""
    def state(self) -> bytes: ...

class LearningContext:
    """What learning a group by itself must know of the plant and of the log."""

    @staticmethod
    def of(
        survey: LogSurvey, symbols_csv: str | None = None, parameters_json: str = "{}"
    ) -> LearningContext:
        """Of the survey of a whole log; table and parameters as for `learn`. Raises InputError."""
    @staticmethod
    def restore(state: bytes) -> LearningContext:
        """Raises InputError."""
    def state(self) -> bytes: ...
    @property
    def groups(self) -> list[str]:
        """Names of the groups, by number."""
    @property
    def rows_of_groups(self) -> list[int]:
        """Rows of each group."""
    @property
    def signals(self) -> list[tuple[str, int]]:
        """Name of each signal, by number, and the number of its group."""
    def learner(self) -> GroupLearner: ...
    def merge(self, lessons: Sequence[bytes], source: Sequence[str] = ()) -> NominalModel:
        """The model: lessons of all groups, in any order. Raises InputError where one is missing."""

class GroupLearner:
    """Learns one group after another; holds the rows of one."""

    def add(
        self,
        group: Any,
        time_ns: Any,
        signal_index: Any,
        value: Any,
        place: Any | None = None,
    ) -> list[bytes]:
        """Takes rows sorted by group, time and place: numpy arrays (int32, int64, int32, int64, int64). Gives the lessons of groups whose rows are all there. Raises InputError."""
    def finish(self) -> bytes | None:
        """The lesson of the last group."""

def identify(
    log: ChangeLog, events_ns: Any, settings_json: str = "{}", names: dict[str, str] = ...
) -> Identification:
    """Ranks signals by events (int64 array); settings `{tau_ns, view, share, words}`; `names` by address."""

def sweep_tau(
    log: ChangeLog, events_ns: Any, taus_ns: Sequence[int], settings_json: str = "{}"
) -> str:
    """`{suggested, steps: [{tau_ns, windows, met, lead, best: {address, score_in, score_out, changes}, next}]}`."""

def read_events(path: str, options_json: str = "{}") -> tuple[Any, list[str | None], str]:
    """Times (int64 array, in order), labels, and the report of an `events.csv`. Raises InputError."""

def bit_names(signals: Sequence[str], word: str, width: int) -> list[str]:
    """What the bits of a word are called, lowest first; `signals` tell whose addresses they are."""

def split_name(naming: str, name: str) -> tuple[str, str, str] | None:
    """Group, device and signal of a name by a naming rule; None where it does not fit."""

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

class Controller:
    """A learned controller in the place of the PLC's program (Theis 2019, Algorithm 2)."""

    def __init__(
        self,
        net: PetriNet,
        guards_json: str | None = None,
        next: NextActivity | None = None,
        safe: Sequence[tuple[str, int]] = (),
    ) -> None:
        """`safe` names the outputs of the safe state; others are 0 in it. Raises InputError."""
    @property
    def terminals(self) -> list[tuple[str, str]]:
        """Address and class (`input` or `output`) of every signal the net speaks of."""
    @property
    def safe(self) -> list[tuple[int, int]]:
        """Terminal and value of every output in the safe state."""
    @property
    def mode(self) -> str:
        """`starting`, `running` or `safe`."""
    @property
    def last(self) -> str:
        """The last activity."""
    def scan(
        self, now_ns: int, values: Sequence[int | None]
    ) -> tuple[list[tuple[int, int]], Findings]:
        """One scan: a value for each terminal. Gives what to write, in that order, and what departed."""

class Shadow:
    """A learned controller beside the real one: writes nothing, reports every disagreement."""

    def __init__(
        self,
        net: PetriNet,
        guards_json: str | None = None,
        next: NextActivity | None = None,
        patience_s: float = 0.5,
    ) -> None:
        """`patience_s` is how long the real controller may take to act. Raises InputError."""
    @property
    def terminals(self) -> list[tuple[str, str]]:
        """Address and class (`input` or `output`) of every signal the net speaks of."""
    @property
    def following(self) -> bool:
        """Whether it knows where the plant stands; else it waits for a run to open."""
    @property
    def last(self) -> str:
        """The last activity."""
    def scan(self, now_ns: int, values: Sequence[int | None]) -> Findings:
        """One scan: a value for each terminal."""
    def gap(self) -> None:
        """Nothing was seen for a while."""

def learn_guards(net: PetriNet, logs: Sequence[ChangeLog], reaction_s: float) -> str:
    """JSON `{guards, events, runs, departures}`. Raises InputError where the logs never follow the net."""

def structured_text_of(
    net: PetriNet,
    guards_json: str | None = None,
    safe: Sequence[tuple[str, int]] = (),
    name: str = "learned",
) -> str:
    """The learned controller as IEC 61131-3 Structured Text. Raises InputError."""

class NextActivity:
    """A network that foretells the next activity, and the net it was trained with."""

    @property
    def activities(self) -> list[str]: ...
    def training_json(self) -> str:
        """`{created, source, settings, events}`."""
    def save(self, path: str) -> None:
        """Replaces the directory as one."""
    def foretell(self, log: EventLog, traces: Sequence[int]) -> tuple[Any, Any, Any, Any, Any, Any]:
        """`(trace uint64, event uint64, expected uint32, came uint32, probability float32, right bool)` as numpy arrays."""

class NextMonitor:
    """Watches one machine with a network; all it tells are notices."""

    def __init__(
        self, next: NextActivity, reset: str, unlikely: float = 0.01, state: bytes | None = None
    ) -> None: ...
    def observe(self, batch: Any) -> Findings: ...
    def gap(self, start_ns: int, end_ns: int) -> Findings: ...
    def advance(self, now_ns: int) -> Findings: ...
    def finish(self) -> Findings: ...
    def state(self) -> bytes: ...

def train_next(
    log: EventLog,
    net: PetriNet,
    traces: Sequence[int],
    settings_json: str,
    source: Sequence[str],
    events_json: str,
    progress: Callable[[int, float, float | None], object] | None = None,
) -> NextActivity:
    """Trains on some traces; `progress(epoch, loss, held_out_loss)` is called after each epoch."""

def decay_samples(log: EventLog, net: PetriNet, traces: Sequence[int]) -> tuple[Any, Any]:
    """Features (float32, one row per sample: decay, counter and tokens of each place) and the activity that came (uint32)."""

def load_next(path: str, net: PetriNet, net_path: str = "") -> NextActivity:
    """Reads a trained network. Raises ModelError where it is damaged, or of another net."""

def markov_score(
    log: EventLog, train: Sequence[int], test: Sequence[int], order: int
) -> tuple[int, int]:
    """Events foretold rightly by what mostly followed the last `order` activities, and all events."""
