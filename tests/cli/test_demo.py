"""`runglight demo` and `runglight simulate`."""

import json
from pathlib import Path

from tests.conftest import Command


def test_the_demo_names_the_fault_and_ends_by_itself(runglight: Command, tmp_path: Path) -> None:
    shown = runglight("demo")
    assert shown.returncode == 0, shown.stderr
    told = " ".join(shown.stdout.split())
    assert "modbus://127.0.0.1:" in told
    assert "ms after the change in the PLC" in told
    assert "FAULT: TRANSITION" in told
    assert "Group1-PrtLDR" in told
    assert "PRT_CHK" in told
    assert "%IX" in told
    written = {path.name for path in (tmp_path / "demo-out").iterdir()}
    assert {"nominal.csv", "faulty.csv", "symbols.csv", "cell.model", "findings.jsonl"} <= written
    assert {"nominal", "watched"} <= written
    assert {"Group1.dot", "Group1-PrtLDR.dot"} <= written


def test_the_commands_the_demo_ends_with_work(runglight: Command) -> None:
    shown = runglight("demo", "--to", "shown here", "--fault", "5")
    assert shown.returncode == 0, shown.stderr
    assert runglight("show", "shown here/cell.model", "--device", "PrtLDR").returncode == 0
    for log in ("faulty.csv", "watched"):
        watched = runglight("watch", "shown here/cell.model", f"shown here/{log}")
        assert "Look first at Group1-PrtLDR" in " ".join(watched.stdout.split())


def test_simulate_writes_log_labels_and_symbols(runglight: Command, tmp_path: Path) -> None:
    ended = runglight(
        *["simulate", "cell", "--log", "cell.parquet", "--fault", "3", "--fault", "9"],
        *["--labels", "labels.json", "--symbols", "symbols.csv", "--cycles", "8"],
    )
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "cell.parquet").read_bytes().startswith(b"PAR1")
    labels = json.loads((tmp_path / "labels.json").read_text(encoding="utf-8"))
    assert [label["number"] for label in labels] == [3, 9]
    assert labels[0]["device"] == "DCLAMP"
    header = (tmp_path / "symbols.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header == "address,group,device,signal,class,type,description"


def test_the_same_seed_gives_the_same_log(runglight: Command, tmp_path: Path) -> None:
    for name, seed in (("a", 7), ("b", 7), ("c", 8)):
        command = ["simulate", "cell", "--cycles", "3", "--seed", str(seed)]
        assert runglight(*command, "--log", f"{name}.csv").returncode == 0
    a, b, c = ((tmp_path / f"{name}.csv").read_bytes() for name in "abc")
    assert a == b != c


def test_the_list_names_all_twelve_faults(runglight: Command) -> None:
    listed = runglight("simulate", "cell", "--list")
    assert listed.returncode == 0
    numbers = [line.split()[0] for line in listed.stdout.splitlines() if line.split()]
    assert [number for number in numbers if number.isdecimal()] == [str(n) for n in range(1, 13)]
