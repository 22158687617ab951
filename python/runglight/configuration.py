"""One file describes a machine: `runglight.toml`. What the command line can say has a key here."""

import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct, field

from runglight.errors import InputError
from runglight.log.options import ReadOptions
from runglight.nearest import suggestion
from runglight.strictly import convert, known_keys

DEFAULT_FILE = Path("runglight.toml")
DEFAULT_NAMING = "{group}-{device}-{signal}"

Positive = Annotated[float, Meta(gt=0)]


class SignalState(Struct, forbid_unknown_fields=True, frozen=True):
    """`[signal_state]`: how signal-state models are learned and watched."""

    timing: Literal["adaptive", "plat"] = "adaptive"
    """How limits of time are learned: `adaptive`, or `plat` as published (Ghosh 2016)."""
    false_alarms_per_day: Positive = 1.0
    """Budget of false alarms; what it cannot pay for is a notice."""
    k: Annotated[int, Meta(ge=2)] = 5
    """`plat`: clusters that CSk-means starts with."""
    epsilon: Positive = 20.0
    """`plat`: ε of the relative gap by which CSk-means places its first clusters."""
    single_cluster_span_s: Annotated[float, Meta(ge=0)] = 3.0
    """`plat`: times that span no more than this are one cluster."""
    merge_distance_s: Annotated[float, Meta(ge=0)] = 3.0
    """`plat`: clusters whose centres are nearer than this are merged."""
    minimum_support: Annotated[float, Meta(ge=0, lt=1)] = 0.08
    """`plat`: clusters with no larger share of the instances are dropped."""
    allowance_s: Positive | None = None
    """`plat`: one allowance over the maximum time instead of 1.5, 3 and 4 s by its length."""
    return_within_s: Positive = 60.0
    """A device back on known transitions within this time has returned from an alarm path."""
    stall_after_s: Positive = 180.0
    """A group without an event for this long has stalled."""
    stall_learned: bool = False
    """Stall after the longest nominal pause times 1.5 instead of `stall_after_s`."""
    check_every: Annotated[int, Meta(ge=1, le=1_000_000)] = 30
    """Group cycles between two checks of probabilities and average times."""
    significant_change: Positive = 0.15
    """Smallest change of a probability, or relative change of an average time, that counts."""
    scan_interval_s: Positive | None = None
    """Time between two scans of the PLC, where the log does not tell."""
    starting: dict[str, str] = {}
    """Starting signal of a device: `{ "Group-Device" = "Signal" }`."""


class Parameters(SignalState, frozen=True):
    """Everything `runglight.learn` takes beside logs and symbols."""

    naming: str = DEFAULT_NAMING
    """How a signal's name splits into group, device and signal."""

    def __post_init__(self) -> None:
        check_naming(self.naming)

    def to_json(self) -> str:
        """The parameters as the engine takes them."""
        return msgspec.json.encode(self).decode()


class Symbols(Struct, forbid_unknown_fields=True):
    """`[symbols]`: what the signals are called."""

    table: str | None = None
    """Symbol table (`symbols.csv`), relative to the configuration file."""
    naming: str = DEFAULT_NAMING
    """How a signal's name splits into group, device and signal."""

    def __post_init__(self) -> None:
        check_naming(self.naming)


class Source(Struct, forbid_unknown_fields=True):
    """`[source]`: where the machine is."""

    url: str | None = None
    """Live address or log file that `watch` reads if none is named."""
    interval: str | None = None
    """Time between two scans: `10ms`."""


class Modes(Struct, forbid_unknown_fields=True, frozen=True):
    """`[modes]`: which bits say what the machine is about; `"M10.3=0"` says it when OFF."""

    work_complete: str | None = None
    """ON while the machine works, OFF while it is set up; with it a cycle machine is learned."""
    manual: str | list[str] = []
    """ON while an operator moves the machine by hand; one bit or several."""
    alarm: str | list[str] = []
    """ON while the machine has stopped with an alarm; one bit or several."""
    setup: str | None = None
    """ON during set-up, where that is not simply the rest of the time."""

    def __post_init__(self) -> None:
        if self.work_complete is None and (self.manual or self.alarm or self.setup):
            raise ValueError("work_complete is missing: the bit that is ON while the machine works")


class Cycle(Struct, forbid_unknown_fields=True, frozen=True):
    """`[cycle]`: how the cycle machine is learned and watched (Guim & Dias 2023)."""

    mode: Literal["element", "word"] = "element"
    """`element` follows the bit that changed; `word` compares whole words as published."""
    alarm_within_s: Positive = 60.0
    """An alarm within this time makes a finding of class 3 one of class 1."""
    never_ends_factor: Annotated[float, Meta(gt=1)] = 2.0
    """A sequence that takes this many times the longest learned one never ends."""
    rate_window: Annotated[int, Meta(ge=1, le=1_000_000)] = 100
    """Sequences looked back on for a rising rate of class 3 and 4 findings."""
    rate_significance: Annotated[float, Meta(gt=0, lt=1)] = 0.01
    """Chance that a rate called rising is not, for all addresses and all time together."""
    known_stops: Annotated[int, Meta(ge=0, le=1_000_000)] = 3
    """A stop with the alarm bit ON that learning saw so often is no failure; 0: every one is."""
    auto_bits: Annotated[int, Meta(ge=1, le=128)] = 8
    """Most bits of a region that is proposed."""
    together_s: Positive = 1.0
    """Bits that often change within this time of one another are proposed as one region."""


Regions = dict[str, str | list[str]]
"""`[regions]`: bits watched as one word, by name: a range (`"I0.0-I7.7"`, `"I8-I20 by byte"`) or a
list of addresses or names. None, or `regions = "auto"`: proposed from the log."""


class Mining(Struct, forbid_unknown_fields=True, frozen=True):
    """What Split Miner takes."""

    eta: Annotated[float, Meta(ge=0, le=1)] = 0.0
    """η: share of the best edges whose frequency an edge must reach; 0 filters nothing."""
    epsilon: Annotated[float, Meta(ge=0, le=1)] = 0.5
    """ε: imbalance of two orders from which on they are not concurrent."""


class Process(Mining, frozen=True):
    """`[process]`: how a log is cut into runs, and how the net is mined (Theis 2019)."""

    reset: str | None = None
    """The change that opens a run: `"%IX0.1=0"`, several at one time joined by `&`."""
    keep_partial: bool = False
    """Keep runs that did not begin with the reset or did not end with the next one."""
    only: list[str] = []
    """Signals that take part; none: all of them."""


class Watch(Struct, forbid_unknown_fields=True):
    """`[watch]`: how findings are told."""

    format: Literal["table", "jsonl", "csv"] = "table"
    """`table` for people, `jsonl` for programs, `csv` for spreadsheets."""
    output: str | None = None
    """File to write instead of standard output."""
    fail_on: Literal["fault", "anomaly"] | None = None
    """Exit with code 1 where there is a fault (`anomaly`: a fault or an anomaly)."""
    notices: bool = False
    """Show notices in the table too."""
    state: str | None = None
    """File that keeps the monitor's state from one log, or one start, to the next."""
    checkpoint_every_s: Positive = 10.0
    """Live: time between two writings of `state`."""
    record: str | None = None
    """Live: directory of the recording that is made meanwhile."""
    store: str | None = None
    """Live: database that findings are copied to: `postgresql://user@host/database`."""
    duration: str | None = None
    """Live: end after this time: `10m` (`--for`)."""


class Notify(Struct, forbid_unknown_fields=True):
    """`[notify]`: who is told of findings while live watching."""

    publish: str | None = None
    """MQTT broker and topic: `mqtt://host/topic` (`mqtts:` with TLS)."""
    webhook: str | None = None
    """Address that every finding is posted to as JSON."""


class Server(Struct, forbid_unknown_fields=True):
    """`[server]`: what runglight answers to others."""

    metrics: str | None = None
    """Live: `HOST:PORT` for Prometheus; a port alone is on loopback."""
    host: str = "127.0.0.1"
    """Page: address to listen at; any but loopback needs `--token`."""
    port: Annotated[int, Meta(ge=0, le=65535)] = 8470
    """Page: port to listen at; 0 takes a free one."""
    read_only: bool = False
    """Page: it shows, and changes nothing."""
    upload_mb: Positive = 500.0
    """Page: largest file that may be uploaded."""
    model: str | None = None
    """Page: model to watch with, relative to the served directory; default: the newest there."""


class Record(Struct, forbid_unknown_fields=True):
    """`[record]`: where and how the machine is recorded."""

    to: str | None = None
    """Directory of the recording."""
    camera: str | None = None
    """Folder of images, camera device (`/dev/video0`) or address (`rtsp://HOST/STREAM`)."""
    photo_interval: str = "1s"
    """Time between two photos of a camera."""
    reserve_mb: Annotated[float, Meta(ge=0)] = 100.0
    """Recording stops before less than this is free on the disk."""


class Identify(Struct, forbid_unknown_fields=True):
    """`[identify]`: how addresses are identified by declared events (Cadiou 2019)."""

    events: str | None = None
    """Declared events, `events.csv`; of a recording, those in its directory if not named."""
    label: str | None = None
    """Which events, where the file holds several kinds."""
    tau: str = "4s"
    """A change lies at most this far from its event; `sweep` finds out."""
    view: Literal["all", "rising", "falling", "increments"] = "all"
    """Which changes count."""
    share: Annotated[float, Meta(gt=0, le=1)] = 0.2
    """Share of the changing signals that is kept."""
    words: list[str] = []
    """Signals that are words although only 0 and 1 were seen of them."""
    order: Literal["scores", "agreement"] = "scores"
    """By the paper's scores, or by how well changes fit events one by one at one lag."""
    rows: Annotated[int, Meta(ge=1)] = 20
    """Rows of the table; other formats have all."""
    format: Literal["table", "csv", "json"] = "table"
    """`table` for people, `csv` for spreadsheets, `json` for programs."""


class Show(Struct, forbid_unknown_fields=True):
    """`[show]`: how a model is shown."""

    format: Literal["table", "csv", "dot", "svg", "json"] | None = None
    """Default: by the ending of the output file, else `table`."""


class Control(Struct, forbid_unknown_fields=True):
    """`[control]`: the learned controller at a plant; permission to write has no key."""

    net: str | None = None
    """The net, as `runglight mine` writes it (PNML)."""
    guards: str | None = None
    """Counters and timers that decide where the net cannot."""
    next: str | None = None
    """Network that decides where the net cannot."""
    plant: str | None = None
    """Modbus device that holds the sensors and actuators: `modbus://HOST:502`."""
    safe: dict[str, int] = {}
    """Outputs of the safe state: `{ "%QX0.1" = 1 }`; others are 0 in it."""
    interval: str = "100ms"
    """Time between two scans."""
    patience_s: Annotated[float, Meta(ge=0)] = 0.5
    """How long the real controller may take to act before its shadow calls it late."""
    reaction_s: Annotated[float, Meta(ge=0)] = 0.3
    """`control learn`: a PLC that acts within this time acts at once; longer is a timer."""
    format: Literal["table", "jsonl"] = "table"
    """Findings as sentences, or as JSON lines."""
    duration: str | None = None
    """End after this time: `10m` (`--for`)."""


class Configuration(Struct, forbid_unknown_fields=True):
    """The whole of `runglight.toml`."""

    source: Source = field(default_factory=Source)
    symbols: Symbols = field(default_factory=Symbols)
    log: ReadOptions = field(default_factory=ReadOptions)
    signal_state: SignalState = field(default_factory=SignalState)
    modes: Modes = field(default_factory=Modes)
    regions: Regions = field(default_factory=dict)
    cycle: Cycle = field(default_factory=Cycle)
    process: Process = field(default_factory=Process)
    record: Record = field(default_factory=Record)
    watch: Watch = field(default_factory=Watch)
    notify: Notify = field(default_factory=Notify)
    server: Server = field(default_factory=Server)
    identify: Identify = field(default_factory=Identify)
    control: Control = field(default_factory=Control)
    show: Show = field(default_factory=Show)

    def cycle_json(self) -> str | None:
        """What the engine needs for a cycle machine; None where `[modes]` asks for none."""
        if self.modes.work_complete is None:
            return None
        return cycle_json(self.modes, self.regions, self.cycle)


def cycle_json(modes: Modes, regions: Regions, cycle: Cycle) -> str:
    """The settings of a cycle machine as the engine takes them."""
    several = {key: [bits] if isinstance(bits, str) else bits for key, bits in _bits(modes)}
    named = {"work_complete": modes.work_complete or "", "setup": modes.setup, **several}
    settings = {"modes": named, "regions": regions, "cycle": cycle}
    return msgspec.json.encode(settings).decode()


def _bits(modes: Modes) -> tuple[tuple[str, str | list[str]], ...]:
    return ("manual", modes.manual), ("alarm", modes.alarm)


def check_naming(naming: str) -> None:
    """A naming rule must say where the signal is, and name nothing else than the three parts."""
    rest = naming
    for part in ("{group}", "{device}", "{signal}"):
        if rest.count(part) > 1:
            raise ValueError(f"the naming rule {naming!r} has {part} twice")
        rest = rest.replace(part, "")
    if "{signal}" not in naming or "{" in rest or "}" in rest:
        raise ValueError(
            f"the naming rule {naming!r} must be made of {{group}}, {{device}} and {{signal}} "
            f"(and {{signal}} must be in it), like {DEFAULT_NAMING}"
        )


def load_configuration(path: Path | None = None) -> Configuration:
    """The configuration in `path`; without one `./runglight.toml` if present, else the defaults."""
    if path is None:
        if not DEFAULT_FILE.is_file():
            return Configuration()
        path = DEFAULT_FILE
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    return parse_configuration(text, path)


def parse_configuration(text: str, path: Path) -> Configuration:
    """The configuration of a text that is, or shall be, in `path`; InputError if it is none."""
    # Loaded where there is a configuration.
    import tomllib  # noqa: PLC0415

    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {_lowered(str(error))}") from None
    configuration = _converted(tables, path)
    # Paths in the file are seen from the file, not from where the command is run.
    for owner, key in (
        (configuration.symbols, "table"),
        (configuration.record, "to"),
        (configuration.watch, "output"),
        (configuration.watch, "state"),
        (configuration.watch, "record"),
        (configuration.identify, "events"),
        (configuration.control, "net"),
        (configuration.control, "guards"),
        (configuration.control, "next"),
    ):
        if (value := getattr(owner, key)) is not None:
            setattr(owner, key, str(path.parent / value))
    if configuration.log.sql is not None:
        configuration.log.sql = _seen_from(path.parent, configuration.log.sql)
    if configuration.watch.store is not None:
        configuration.watch.store = _seen_from(path.parent, configuration.watch.store)
    camera = configuration.record.camera
    if camera is not None and "://" not in camera:
        configuration.record.camera = str(path.parent / camera)
    url = configuration.source.url
    if url is not None and "://" not in url and not url.startswith("replay:"):
        configuration.source.url = str(path.parent / url)
    return configuration


def _seen_from(directory: Path, sql: str) -> str:
    scheme, separator, file = sql.partition(":///")
    memory_or_uri = not file or file.startswith((":memory:", "file:"))
    if not separator or not scheme.startswith("sqlite") or memory_or_uri:
        return sql
    return f"{scheme}:///{directory / file}"


def _converted(tables: dict[str, Any], path: Path) -> Configuration:
    rooms = {field.name: field.type for field in msgspec.structs.fields(Configuration)}
    if tables.get("regions") == "auto":
        tables["regions"] = {}
    for name, table in tables.items():
        if name not in rooms:
            settled = {room: of for room, of in rooms.items() if room != "regions"}
            homes = [room for room, settings in settled.items() if name in known_keys(settings)]
            near = suggestion(name, rooms) or (f" (it belongs in [{homes[0]}])" if homes else "")
            raise InputError(f"{path}: unknown table [{name}]{near or _known(rooms)}")
        if not isinstance(table, dict):
            raise InputError(f"{path}: {name} must be a table: [{name}]")
    # TOML has dates of its own: `date = 2026-01-31` needs no quotes.
    day = tables.get("log", {}).get("date")
    if isinstance(day, datetime.date):
        tables["log"]["date"] = day.isoformat()[:10]
    read: dict[str, Any] = {
        name: convert(table, rooms[name], f"{path}: [{name}]")
        for name, table in tables.items()
        if name != "regions"
    }
    read["regions"] = _regions(tables.get("regions", {}), path)
    return Configuration(**read)


def _regions(table: dict[str, Any], path: Path) -> Regions:
    """`[regions]` has keys of the user's own."""
    for name, bits in table.items():
        of_text = isinstance(bits, list) and all(isinstance(bit, str) for bit in bits)
        if not (isinstance(bits, str) or of_text):
            raise InputError(
                f'{path}: [regions] {name}: expected a range like "I0.0-I7.7" or a list of '
                f"addresses, found {bits!r}"
            )
    return table


def _known(rooms: dict[str, Any]) -> str:
    return "; known: " + ", ".join(f"[{room}]" for room in rooms)


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]
