"""`runglight simulate faults`."""

from collections.abc import Callable
from pathlib import Path

from runglight.injection import read_labels
from runglight.log.changelog import read_log
from tests.conftest import Command


def test_a_faulty_log_and_its_labels(runglight: Command, cell: Path, tmp_path: Path) -> None:
    done = runglight(
        *["simulate", "faults", cell / "nominal.csv", "--to", "faulty.csv"],
        *["--labels", "labels.json", "--faults", "5", "--kinds", "stuck-on,missing-edge"],
        *["--late", "4", "--late-over", "uniform:1:3", "--spacing", "5s", "--seed", "3"],
    )
    assert done.returncode == 0, done.stderr
    labels = read_labels(tmp_path / "labels.json")
    assert len(labels) == 9
    assert {str(label.kind) for label in labels} == {"stuck-on", "missing-edge", "late"}
    assert "labels.json: 9 faults" in done.stdout
    assert len(read_log(tmp_path / "faulty.csv")) < len(read_log(cell / "nominal.csv"))


def test_a_symbol_table_names_the_devices(runglight: Command, cell: Path, tmp_path: Path) -> None:
    done = runglight(
        *["simulate", "faults", cell / "nominal.csv", "--to", "faulty.csv"],
        *["--labels", "labels.json", "--faults", "2", "--symbols", cell / "symbols.csv"],
        *["--from", "2026-01-05T06:10:00Z"],
    )
    assert done.returncode == 0, done.stderr
    labels = read_labels(tmp_path / "labels.json")
    assert all(label.time >= "2026-01-05T06:10:00Z" for label in labels)
    assert all(label.group == "Group1" for label in labels)


def test_what_did_not_fit_is_said(runglight: Command, cell: Path) -> None:
    done = runglight(
        "simulate", "faults", cell / "nominal.csv", "--to", "faulty.csv", "--faults", "2000"
    )
    assert done.returncode == 0, done.stderr
    assert "note: the log has room for " in done.stderr


def test_wrong_use_ends_in_a_sentence(refused: Callable[..., str], cell: Path) -> None:
    log = cell / "nominal.csv"

    def wrong(*options: str) -> str:
        return refused("simulate", "faults", log, "--to", "faulty.csv", *options)

    assert "nothing to inject" in wrong()
    assert "did you mean stuck-on?" in wrong("--faults", "1", "--kinds", "stuk-on")
    assert "--late-over: 'normal:2' is no distribution" in wrong(
        "--late", "1", "--late-over", "normal:2"
    )
    assert "--from: 'tomorrow' is no time" in wrong("--late", "1", "--from", "tomorrow")
    assert "below zero" in wrong("--late", "-1")
    assert "the log ends at" in wrong("--late", "1", "--from", "2030-01-01")
    assert "ending" in refused("simulate", "faults", log, "--to", "faulty.txt", "--late", "1")
