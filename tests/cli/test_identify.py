"""`runglight identify`, from declared events to a model that knows the name."""

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.taps.base import TapSignal
from tests.conftest import Command
from tests.identification.machine import EVENTS, conveyor_log, recorded

Refused = Callable[..., str]


@pytest.fixture
def line(tmp_path: Path) -> Path:
    """`line.csv` and `events.csv`: starts and stops, up to half a second late."""
    conveyor_log().write(tmp_path / "line.csv")
    times = [f"{event / 1e9 + 0.1 * at:.1f}" for at, event in enumerate(EVENTS)]
    (tmp_path / "events.csv").write_text("time\n" + "\n".join(times) + "\n", encoding="utf-8")
    return tmp_path


def test_the_table(runglight: Command, line: Path) -> None:
    found = runglight("identify", "line.csv", "--events", "events.csv", "--share", "1")
    assert found.returncode == 0, found.stderr
    assert "6 events in 6 windows of ±4 s; 10 signals and bits change, the best 10:" in found.stdout
    rows = [text.split() for text in found.stdout.splitlines() if "0.0000" in text]
    assert rows[0][:4] == ["1", "0.0000", "0.0000", "%M25"]
    assert rows[1][:6] == ["1", "0.0000", "0.0000", "%MW74.0", "=", "%M25"]
    assert "▔▔" in found.stdout
    assert "best: %M25, %MW74.0: they change at the same moments" in found.stdout
    assert (line / "line.csv").exists()


def test_csv_and_json(runglight: Command, line: Path) -> None:
    arguments = ("identify", "line.csv", "--events", "events.csv", "--tau", "2s")
    rows = list(csv.DictReader(io.StringIO(runglight(*arguments, "--format", "csv").stdout)))
    assert [row["address"] for row in rows] == ["%M25", "%MW74.0", "%MW74"]
    assert rows[0]["score_in"] == "0.0000"
    ended = runglight(*arguments, "-o", "found.json")
    assert ended.returncode == 0, ended.stderr
    told = json.loads((line / "found.json").read_text(encoding="utf-8"))
    assert [each["address"] for each in told["candidates"]] == ["%M25", "%MW74.0", "%MW74"]
    assert len(told["windows"]) == 6
    assert told["tau_s"] == 2


def test_a_sweep_is_explained(runglight: Command, line: Path) -> None:
    swept = runglight("identify", "line.csv", "--events", "events.csv", "--tau", "sweep")
    assert swept.returncode == 0, swept.stderr
    assert "Several tau" in swept.stdout
    assert "%M25 meets 6.0 of 6 windows" in swept.stdout
    assert (line / "line.csv").exists()


def test_keys_of_the_configuration(runglight: Command, line: Path) -> None:
    (line / "runglight.toml").write_text(
        "[identify]\nevents = 'events.csv'\ntau = '1s'\nview = 'rising'\nformat = 'json'\n"
        "share = 1.0\n",
        encoding="utf-8",
    )
    told = json.loads(runglight("identify", "line.csv").stdout)
    assert (told["tau_s"], told["view"]) == (1, "rising")


def test_an_accepted_bit_is_known_when_learning_and_watching(
    runglight: Command, line: Path
) -> None:
    accepted = runglight(
        *("identify", "line.csv", "--name", "Line1-Conveyor-Running", "--accept", "%MW74.0")
    )
    assert accepted.returncode == 0, accepted.stderr
    assert "symbols.csv: %MW74.0 is Line1-Conveyor-Running" in accepted.stdout
    assert "--bits %MW74 " in accepted.stdout
    with_bits = ("--symbols", "symbols.csv", "--bits", "%MW74")
    learned = runglight("learn", "line.csv", *with_bits, "-o", "line.model")
    assert learned.returncode == 0, learned.stderr
    shown = runglight("show", "line.model", "--device", "Line1-Conveyor")
    assert "Running" in shown.stdout, shown.stderr
    watched = runglight("watch", "line.model", "line.csv", *with_bits)
    assert watched.returncode == 0, watched.stderr
    found = runglight("identify", "line.csv", "--events", "events.csv", *with_bits[:2])
    assert "Line1-Conveyor-Running" in found.stdout
    assert (line / "symbols.csv").exists()


def test_a_recording_of_words_is_learned_bit_by_bit(runglight: Command, tmp_path: Path) -> None:
    # The word was recorded under a name; its bits are called by its address.
    signals = [TapSignal("Line1-Display-Word", "%MW74", "UINT", "memory")]
    recorded(tmp_path / "line1", signals, EVENTS)
    (tmp_path / "symbols.csv").write_text(
        "address,group,device,signal\n%MW74.0,Line1,Conveyor,Running\n", encoding="utf-8"
    )
    for word in ("%MW74", "Line1-Display-Word"):
        learned = runglight(
            *("learn", "line1", "--symbols", "symbols.csv", "--bits", word, "-o", "line.model")
        )
        assert learned.returncode == 0, learned.stderr
        assert "Conveyor" in learned.stdout


def test_proposed_events_are_identified_without_a_human(runglight: Command, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("skimage")
    from runglight.recording.photos import name_of  # noqa: PLC0415

    directory = recorded(tmp_path / "line1", [TapSignal("%M25", "%M25")], EVENTS)
    (directory / "photos").mkdir()
    for second in range(-19, 175):
        time_ns = EVENTS[0] + second * 1_000_000_000
        lamp = image.new("RGB", (64, 48), (90, 90, 90))
        if sum(event <= time_ns for event in EVENTS) % 2:
            lamp.paste((40, 220, 60), (20, 10, 36, 26))
        lamp.save(directory / "photos" / name_of(time_ns, ".png"))
    proposed = runglight("identify", "line1", "--propose", "16,8,24,20")
    assert proposed.returncode == 0, proposed.stderr
    assert "events.csv: 6 events (3 away, 3 back)" in proposed.stdout
    found = runglight("identify", "line1", "--label", "any", "--tau", "1")
    assert "best: %M25" in found.stdout, found.stderr
    again = runglight("identify", "line1", "--propose", "16,8,24,20")
    assert again.returncode == 2
    assert "is there already" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["identify"], "what shall be searched?"),
        (["identify", "line.csv"], "which events?"),
        (["identify", "line.csv", "--events", "no.csv"], "no.csv"),
        (["identify", "line.csv", "--events", "events.csv", "--tau", "soon"], "--tau: 'soon'"),
        (["identify", "line.csv", "--events", "events.csv", "--share", "0"], "--share: 0 must"),
        (["identify", "line.csv", "--events", "events.csv", "--rows", "0"], "--rows: 0 must"),
        (["identify", "line.csv", "--accept", "%MW74.0"], "--accept: say with --name"),
        (["identify", "line.csv", "--name", "A-B-C"], "--name: say with --accept"),
        (
            ["identify", "line.csv", "--name", "A-B-C", "--accept", "%MW75.0"],
            "no address '%MW75.0' (did you mean %MW7",
        ),
        (["identify", "line.csv", "--propose", "1,2,3,4"], "line.csv is no recording"),
        (["learn", "line.csv", "-o", "m", "--bits", "%MW7"], "bits: the log has no signal '%MW7'"),
    ],
)
def test_wrong_use_is_one_line(
    refused: Refused, line: Path, arguments: list[str], sentence: str
) -> None:
    assert (line / "line.csv").exists()
    assert sentence in refused(*arguments)
