"""`runglight show`."""

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.cli.model_tables import COLUMNS
from runglight.drawing import graphviz_program
from tests.conftest import Command


def test_the_overview_names_every_device(runglight: Command, cell: Path) -> None:
    shown = runglight("show", cell / "cell.model")
    assert shown.returncode == 0, shown.stderr
    for name in ("Group1", "PrtLDR", "DCLAMP", "RBT1", "DCHA", "RBT2"):
        assert name in shown.stdout
    assert shown.stderr == ""


@pytest.mark.parametrize("name", ["PrtLDR", "Group1-PrtLDR"])
def test_a_device_as_in_table_2(runglight: Command, cell: Path, name: str) -> None:
    shown = runglight("show", cell / "cell.model", "--device", name)
    lines = [line.split() for line in shown.stdout.splitlines()]
    heading = ["Current", "Next", "Count", "TP", "ATT", "Min", "Max", "TTP"]
    assert [*heading, "Waits", "for"] in lines
    row = next(line for line in lines if line[:2] == ["ADV_OFF", "RET_ON"])
    assert row[2:4] == ["20", "1.00"]
    # The loader takes its part back when the clamp that holds it has closed.
    waiting = next(line for line in lines if line[:2] == ["PRT_CHK_OFF", "BACKWARD_ON"])
    assert waiting[-3:] == ["DCLAMP-ClsSen2_ON", "+", "0.01"]


def test_a_transition_with_two_times_has_two_rows(runglight: Command, cell: Path) -> None:
    shown = runglight("show", cell / "cell.model", "--device", "PrtLDR", "--format", "json")
    rows = [
        row
        for row in json.loads(shown.stdout)["transition_rules"]
        if row["current"].endswith("BACKWARD_OFF") and row["next"].endswith("PRT_CHK_ON")
    ]
    assert [round(row["average_s"], -1) for row in rows] == [30, 60]
    assert [row["time_probability"] for row in rows] == pytest.approx([0.47, 0.52], abs=0.03)


def test_csv_has_the_columns_of_the_rules(runglight: Command, cell: Path) -> None:
    shown = runglight("show", cell / "cell.model", "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(shown.stdout)))
    assert tuple(rows[0]) == COLUMNS
    assert {row["model"] for row in rows} == {"device", "group"}
    assert {row["device"] for row in rows if row["model"] == "device"} == {
        "PrtLDR",
        "DCLAMP",
        "RBT1",
        "DCHA",
        "RBT2",
    }


def test_the_group_is_a_chain_of_starting_signals(runglight: Command, cell: Path) -> None:
    shown = runglight("show", cell / "cell.model", "--group", "Group1", "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(shown.stdout)))
    assert rows
    assert {row["model"] for row in rows} == {"group"}


def test_dot(runglight: Command, cell: Path) -> None:
    shown = runglight("show", cell / "cell.model", "--device", "PrtLDR", "--format", "dot")
    assert shown.stdout.startswith("digraph")
    assert "ADV_OFF" in shown.stdout
    whole = runglight("show", cell / "cell.model", "--format", "dot")
    assert whole.stdout.startswith("digraph")


@pytest.mark.skipif(graphviz_program() is None, reason="no Graphviz here")
def test_svg_by_the_ending(runglight: Command, cell: Path, tmp_path: Path) -> None:
    shown = runglight("show", cell / "cell.model", "--device", "PrtLDR", "-o", "loader.svg")
    assert shown.returncode == 0, shown.stderr
    assert "<svg" in (tmp_path / "loader.svg").read_text(encoding="utf-8")
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


def test_svg_without_graphviz_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from runglight import drawing  # noqa: PLC0415
    from runglight.errors import InputError  # noqa: PLC0415

    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(drawing.sys, "executable", str(tmp_path / "python"))
    with pytest.raises(InputError, match="apt install graphviz") as raised:
        drawing.draw_svg("digraph {}")
    assert "--format dot works without" in str(raised.value)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--device", "PrtLDX"], "did you mean Group1-PrtLDR"),
        (["--device", "Group2-PrtLDR"], "did you mean Group1-PrtLDR"),
        (["--group", "Grup1"], "did you mean Group1?"),
        (["--device", "zzz"], "its devices: Group1-"),
    ],
)
def test_unknown_names(
    refused: Callable[..., str], cell: Path, arguments: list[str], sentence: str
) -> None:
    assert sentence in refused("show", cell / "cell.model", *arguments)


def test_a_device_of_several_groups_must_be_said_in_full(
    runglight: Command, refused: Callable[..., str], tmp_path: Path
) -> None:
    rows = [
        f"2026-01-01T00:00:{second:02}Z,{group}-Lift-UP,{value}"
        for second, (group, value) in enumerate([("A", 1), ("B", 1), ("A", 0), ("B", 0)] * 8)
    ]
    text = "time,signal,value\n" + "\n".join(rows) + "\n"
    (tmp_path / "lifts.csv").write_text(text, encoding="utf-8")
    assert runglight("learn", "lifts.csv", "-o", "lifts.model").returncode == 0
    assert "A-Lift or B-Lift" in refused("show", "lifts.model", "--device", "Lift")
    assert "--device or --group" in refused("show", "lifts.model", "--format", "dot")
    assert runglight("show", "lifts.model", "--device", "Lift", "--group", "A").returncode == 0
