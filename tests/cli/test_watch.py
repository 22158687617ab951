"""`runglight watch` and `runglight confirm`."""

import csv
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import runglight as rl
from runglight.configuration import DEFAULT_NAMING
from runglight.findings.schema import KEYS
from runglight.log.symbols import names_by_address
from tests.conftest import Command, simulated


@pytest.fixture
def model(cell: Path, tmp_path: Path) -> Path:
    """A copy of the learned cell that a test may change."""
    kept = shutil.ignore_patterns("findings.sqlite*")
    return Path(shutil.copytree(cell / "cell.model", tmp_path / "cell.model", ignore=kept))


def findings(text: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in text.splitlines()]


def test_the_table_names_the_fault(runglight: Command, cell: Path, model: Path) -> None:
    watched = runglight("watch", model, cell / "faulty.csv")
    assert watched.returncode == 0, watched.stderr
    assert "Group1-PrtLDR" in watched.stdout
    assert "PRT_CHK" in watched.stdout
    last = watched.stdout.splitlines()[-1]
    assert "fault" in last
    assert "events" in last
    assert "events/s" in last


def test_a_sound_machine_has_no_findings(runglight: Command, cell: Path, model: Path) -> None:
    watched = runglight("watch", model, cell / "nominal.csv")
    assert watched.stdout.startswith("No findings · ")
    assert len(watched.stdout.splitlines()) == 1


def test_a_stalled_line_says_where_to_look_first(
    runglight: Command, model: Path, tmp_path: Path
) -> None:
    simulated(seed=2, fault=5).write(tmp_path / "stalled.csv")
    watched = runglight("watch", model, "stalled.csv")
    told = " ".join(watched.stdout.split())
    assert "Look first at Group1-PrtLDR" in told
    assert "FORWARD" in told
    assert "%QX" in told


def test_jsonl_and_csv_tell_the_same(runglight: Command, cell: Path, model: Path) -> None:
    lines = findings(runglight("watch", model, cell / "faulty.csv", "--format", "jsonl").stdout)
    text = runglight("watch", model, cell / "faulty.csv", "--format", "csv").stdout
    rows = list(csv.DictReader(io.StringIO(text)))
    assert tuple(rows[0]) == KEYS
    assert [row["id"] for row in rows] == [line["id"] for line in lines]
    assert [json.loads(row["expected"]) for row in rows] == [line["expected"] for line in lines]


def test_output_file(runglight: Command, cell: Path, model: Path, tmp_path: Path) -> None:
    arguments = ["watch", model, cell / "faulty.csv", "--format", "jsonl"]
    printed = runglight(*arguments)
    written = runglight(*arguments, "-o", "findings.jsonl")
    assert written.stdout == ""
    assert (tmp_path / "findings.jsonl").read_text(encoding="utf-8") == printed.stdout
    assert printed.stdout


def test_the_same_log_gives_the_same_lines(runglight: Command, cell: Path, model: Path) -> None:
    arguments = ["watch", model, cell / "faulty.csv", "--format", "jsonl"]
    assert runglight(*arguments).stdout == runglight(*arguments).stdout


def test_state_goes_on_where_the_last_log_ended(
    runglight: Command, cell: Path, model: Path, tmp_path: Path
) -> None:
    log = simulated(seed=2, fault=1)
    cut = len(log) // 5
    log.slice(0, cut).write(tmp_path / "morning.csv")
    log.slice(cut).write(tmp_path / "evening.csv")
    whole = runglight("watch", model, cell / "faulty.csv", "--format", "jsonl").stdout
    parts = ""
    for name in ("morning.csv", "evening.csv"):
        watched = runglight("watch", model, name, "--format", "jsonl", "--state", "cell.state")
        assert watched.returncode == 0, watched.stderr
        parts += watched.stdout
    assert parts == whole


def test_a_damaged_state_is_refused(
    refused: Callable[..., str], cell: Path, model: Path, tmp_path: Path
) -> None:
    (tmp_path / "cell.state").write_bytes(b"junk")
    refused("watch", model, cell / "faulty.csv", "--state", "cell.state")


def test_findings_are_kept_beside_the_model(runglight: Command, cell: Path, model: Path) -> None:
    from runglight.findings.store import FindingStore  # noqa: PLC0415

    lines = runglight("watch", model, cell / "faulty.csv", "--format", "jsonl").stdout.splitlines()
    with FindingStore(model) as store:
        for line in lines:
            newest = store.newest(json.loads(line)["id"])
            assert newest in lines
            snapshot_id = json.loads(line)["snapshot_id"]
            assert snapshot_id is None or store.snapshot(snapshot_id) is not None


def test_a_model_that_cannot_be_written_is_a_note(
    runglight: Command, cell: Path, model: Path
) -> None:
    # A directory in the place of the file: unwritable for root too.
    (model / "findings.sqlite").mkdir()
    watched = runglight("watch", model, cell / "faulty.csv")
    assert watched.returncode == 0
    assert "Group1-PrtLDR" in watched.stdout
    assert watched.stderr.startswith("note: ")
    assert "cannot be kept" in watched.stderr


def confirmable(runglight: Command, cell: Path, model: Path) -> str:
    lines = findings(runglight("watch", model, cell / "faulty.csv", "--format", "jsonl").stdout)
    return next(
        str(line["id"])
        for line in reversed(lines)
        if line["kind"] == "alarm_path" or (line["kind"] == "transition" and line["path"])
    )


def test_confirm_makes_a_path_nominal(runglight: Command, cell: Path, model: Path) -> None:
    chosen = confirmable(runglight, cell, model)
    confirmed = runglight("confirm", model, chosen)
    assert confirmed.returncode == 0, confirmed.stderr
    assert "new transition" in confirmed.stdout
    assert "Group1-PrtLDR-PRT_CHK_ON" in confirmed.stdout
    again = runglight("confirm", model, chosen)
    assert again.returncode == 0, again.stderr
    assert "already known (0 new)" in again.stdout
    watched = runglight("watch", model, cell / "faulty.csv", "--format", "jsonl").stdout
    faults = [
        finding
        for finding in findings(watched)
        if finding["kind"] == "transition" and finding["to"] == "Group1-PrtLDR-PRT_CHK_ON"
    ]
    assert not faults


def test_confirm_before_watching(refused: Callable[..., str], model: Path) -> None:
    assert "run runglight watch" in refused("confirm", model, "f-1")


def test_confirm_of_an_unknown_id(
    runglight: Command, refused: Callable[..., str], cell: Path, model: Path
) -> None:
    known = confirmable(runglight, cell, model)
    line = refused("confirm", model, known[:-1])
    assert known in line


def test_confirm_of_a_kind_without_a_path(
    runglight: Command, refused: Callable[..., str], model: Path, tmp_path: Path
) -> None:
    simulated(seed=2, fault=5).write(tmp_path / "stalled.csv")
    lines = findings(runglight("watch", model, "stalled.csv", "--format", "jsonl").stdout)
    stall = next(str(line["id"]) for line in lines if line["kind"] == "stall")
    line = refused("confirm", model, stall)
    assert "kind stall" in line
    assert "has no path" in line


def test_a_model_of_addresses_knows_a_log_of_names(
    runglight: Command, tmp_path: Path, cell: Path
) -> None:
    table = names_by_address((cell / "symbols.csv").read_text(encoding="utf-8"), DEFAULT_NAMING)
    addresses = {name: address for address, name in table.items()}
    for log in ("nominal", "faulty"):
        read = rl.read_log(cell / f"{log}.csv")
        read.renamed([addresses[name] for name in read.signals]).write(tmp_path / f"{log}.csv")
    learned = runglight("learn", "nominal.csv", "-o", "m", "--symbols", cell / "symbols.csv")
    assert learned.returncode == 0, learned.stderr
    told = [
        runglight("watch", "m", log, "--format", "jsonl").stdout
        for log in ("faulty.csv", cell / "faulty.csv")
    ]
    assert told[0] == told[1]
    assert '"severity":"fault"' in told[0]
