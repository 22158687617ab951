"""`runglight.toml`: its keys, its errors, and that the command line beats it."""

import json
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from runglight.cli.learn import LearningOptions, parameters_of
from runglight.cli.reader_options import ReaderOptions
from runglight.configuration import Parameters, load_configuration
from runglight.errors import InputError
from tests.conftest import Command


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "[signal_state]\ntimming = 'plat'",
            "[signal_state]: unknown key 'timming' (did you mean timing?)",
        ),
        ("[signal_stat]", "unknown table [signal_stat] (did you mean signal_state?)"),
        ("k = 5", "unknown table [k] (it belongs in [signal_state])"),
        ("[signal_state]\nk = 'five'", "[signal_state]: k: expected int, got str"),
        ("[signal_state]\nk = 0", "[signal_state]: k: expected int >= 2"),
        ("[signal_state]\nfalse_alarms_per_day = 0", "false_alarms_per_day: expected float > 0"),
        ("[log]\non_error = 'ignore'", "[log]: on_error: invalid enum value 'ignore'"),
        ("[log]\nanalog = { Level = 'high' }", "[log]: analog"),
        ("[symbols]\nnaming = '{device}'", "[symbols]: the naming rule '{device}' must be made of"),
        ("symbols = 3", "symbols must be a table: [symbols]"),
        ("[signal_state", "not valid TOML"),
    ],
)
def test_errors_name_file_key_and_mend(tmp_path: Path, text: str, sentence: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError) as raised:
        load_configuration(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert sentence in str(raised.value)


def test_without_a_file_the_defaults_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    configuration = load_configuration()
    assert parameters_of(configuration, LearningOptions()) == Parameters()


def test_the_defaults_are_the_published_ones() -> None:
    assert json.loads(Parameters().to_json()) == {
        "timing": "adaptive",
        "false_alarms_per_day": 1.0,
        "k": 5,
        "epsilon": 20.0,
        "single_cluster_span_s": 3.0,
        "merge_distance_s": 3.0,
        "minimum_support": 0.08,
        "allowance_s": None,
        "return_within_s": 60.0,
        "stall_after_s": 180.0,
        "stall_learned": False,
        "check_every": 30,
        "significant_change": 0.15,
        "scan_interval_s": None,
        "starting": {},
        "naming": "{group}-{device}-{signal}",
    }


def test_the_command_line_beats_the_file(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        """
        [source]
        interval = "20ms"
        [symbols]
        naming = "{device}.{signal}"
        [signal_state]
        timing = "plat"
        k = 7
        stall_learned = true
        starting = { "A-B" = "C" }
        [log]
        delimiter = ";"
        date = 2026-01-31
        bits = ["STEP"]
        analog = { Level = [1, 2.5], Flow = 3 }
        """,
    )
    options = ReaderOptions(config=path, delimiter="tab", naming="{signal}", reorder="3s")
    configuration = options.configuration()
    learning = LearningOptions(
        timing="adaptive", stall_after="5m", false_alarms="2/week", starting=("D-E=F",)
    )
    parameters = parameters_of(configuration, learning)
    assert parameters.timing == "adaptive"
    assert parameters.k == 7
    assert parameters.stall_after_s == 300
    assert parameters.stall_learned is False
    assert parameters.false_alarms_per_day == pytest.approx(2 / 7)
    assert parameters.scan_interval_s == pytest.approx(0.02)
    assert parameters.starting == {"A-B": "C", "D-E": "F"}
    assert parameters.naming == "{signal}"
    assert json.loads(configuration.log.to_json()) == {
        "delimiter": "\t",
        "date": "2026-01-31",
        "bits": ["STEP"],
        "analog": [["Level", 1.0], ["Level", 2.5], ["Flow", 3.0]],
        "reorder_s": 3.0,
    }


def test_paths_are_seen_from_the_file(tmp_path: Path) -> None:
    (tmp_path / "machine").mkdir()
    path = tmp_path / "machine" / "runglight.toml"
    path.write_text("[symbols]\ntable = 'symbols.csv'\n[source]\nurl = 'log.csv'\n")
    configuration = load_configuration(path)
    assert configuration.symbols.table == str(tmp_path / "machine" / "symbols.csv")
    assert configuration.source.url == str(tmp_path / "machine" / "log.csv")


@pytest.mark.parametrize(
    ("written_url", "seen"),
    [
        ("sqlite:///plant.db?timeout=5", "sqlite:///{directory}/plant.db?timeout=5"),
        ("sqlite:////srv/plant.db", "sqlite:////srv/plant.db"),
        ("sqlite:///:memory:", "sqlite:///:memory:"),
        ("sqlite://", "sqlite://"),
        ("postgresql:///plant", "postgresql:///plant"),
    ],
)
def test_databases_are_seen_from_the_file(tmp_path: Path, written_url: str, seen: str) -> None:
    path = written(tmp_path, f"[log]\nsql = '{written_url}'\ntable = 'events'\n")
    log = load_configuration(path).log
    assert log.sql == seen.format(directory=tmp_path)
    assert log.table == "events"
    assert log.to_json() == "{}"


def test_every_option_of_the_machine_has_its_key() -> None:
    keys = {
        field.name
        for table in msgspec.structs.fields(type(load_configuration()))
        if table.name != "regions"  # its keys are the user's own
        for field in msgspec.structs.fields(table.type)
    }
    renamed = {
        "signal_column": "signal_columns",
        "reorder": "reorder_s",
        "symbols": "table",
        "false_alarms": "false_alarms_per_day",
        "stall_after": "stall_after_s",
        "return_within": "return_within_s",
        "scan_interval": "scan_interval_s",
    }
    options = {
        field
        for options in (ReaderOptions, LearningOptions)
        for field in options.__dataclass_fields__
        if field != "config"
    }
    assert len(options) > 15
    assert {renamed.get(option, option) for option in options} <= keys


def test_the_file_of_the_directory_is_taken(runglight: Command, cell: Path, tmp_path: Path) -> None:
    (tmp_path / "runglight.toml").write_text(
        f"[source]\nurl = '{cell / 'faulty.csv'}'\n[watch]\nformat = 'jsonl'\nfail_on = 'fault'\n",
        encoding="utf-8",
    )
    watched = runglight("watch", cell / "cell.model")
    assert watched.returncode == 1, watched.stderr
    assert json.loads(watched.stdout.splitlines()[0])["kind"] == "transition"


def test_the_example_is_right() -> None:
    example = Path(__file__).parent.parent / "examples" / "runglight.toml"
    configuration = load_configuration(example)
    assert configuration.signal_state.starting == {"Line1-Clamp": "OPEN"}
    assert configuration.log.bits == ["STATUS_WORD"]


def test_an_error_in_it_is_one_line(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "runglight.toml").write_text("[watch]\nformat = 'xml'\n", encoding="utf-8")
    assert "runglight.toml: [watch]: format: " in refused("watch", "cell.model", "log.csv")


PRESS = """
[modes]
work_complete = "M0.0"
manual = "M0.1"

[regions]
checks = "I0.0-I7.7"
clamps = ["I12.0", "I12.2"]

[cycle]
mode = "word"
"""


def test_a_cycle_machine_is_asked_for_by_its_mode_bits(tmp_path: Path) -> None:
    file = tmp_path / "press.toml"
    file.write_text(PRESS, encoding="utf-8")
    settings = json.loads(load_configuration(file).cycle_json() or "")
    assert settings["modes"]["manual"] == ["M0.1"]
    assert settings["regions"] == {"checks": "I0.0-I7.7", "clamps": ["I12.0", "I12.2"]}
    assert settings["cycle"]["mode"] == "word"
    file.write_text('regions = "auto"\n[modes]\nwork_complete = "M0.0"\n', encoding="utf-8")
    assert json.loads(load_configuration(file).cycle_json() or "")["regions"] == {}
    file.write_text("", encoding="utf-8")
    assert load_configuration(file).cycle_json() is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[modes]\nmanual = 'M0.1'\n", "work_complete is missing"),
        ("[regions]\nx = 3\n", r"\[regions\] x: expected a range"),
        ("[cycle]\nmode = 'bit'\n", r"\[cycle\]: mode"),
        ("[cycle]\nnever_ends_factor = 1.0\n", r"\[cycle\]: never_ends_factor"),
    ],
)
def test_a_cycle_machine_is_refused_with_a_sentence(
    tmp_path: Path, text: str, sentence: str
) -> None:
    file = tmp_path / "press.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        load_configuration(file)
