"""`identify --order agreement`: a counter before what only has the right numbers."""

import csv
import json
from pathlib import Path

import pytest

from tests.conftest import Command

GROUPS = 5
EVERY_S = 40.0
LAGS_S = (-7.0, -1.0, 4.0, 12.0)
"""Of the impostor's changes, from the first bottle of a group."""


@pytest.fixture
def line(tmp_path: Path) -> Path:
    """Bottles in groups of four, one of them not declared, and a word that changes as often."""
    rows = [(0.0, "Counter", 0), (0.0, "Impostor", 0)]
    events = []
    for group in range(GROUPS):
        first_s = 20.0 + group * EVERY_S
        bottles = [first_s + 3.0 * place for place in range(4)]
        rows += [(at, "Counter", 4 * group + place + 1) for place, at in enumerate(bottles)]
        lags = LAGS_S[: 3 if group == 1 else 4]
        rows += [(first_s + lag, "Impostor", round(first_s + lag)) for lag in lags]
        rows += [(first_s + 25.0, "Impostor", -1)]
        events += [at + 0.5 for at in bottles[: 3 if group == 1 else 4]]
    with (tmp_path / "log.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "signal", "value"])
        writer.writerows(sorted(rows, key=lambda row: row[0]))
    (tmp_path / "events.csv").write_text("time\n" + "".join(f"{at}\n" for at in events))
    return tmp_path


def test_what_agrees_one_by_one_comes_first(runglight: Command, line: Path) -> None:
    asked = ("identify", "log.csv", "--events", "events.csv", "--tau", "8s", "--share", "1")
    by_scores = runglight(*asked, "--format", "json")
    assert by_scores.returncode == 0, by_scores.stderr
    first, *_ = json.loads(by_scores.stdout)["candidates"]
    assert first["address"] == "Impostor"
    assert first["agreement"] is None
    agreed = runglight(*asked, "--order", "agreement", "--format", "json")
    counter, *others = json.loads(agreed.stdout)["candidates"]
    assert (counter["address"], counter["rank"]) == ("Counter", 1)
    assert counter["agreement"] == pytest.approx(2 * 19 / 39)
    assert all(each["agreement"] < counter["agreement"] for each in others if each["rank"] > 1)
    table = runglight(*asked, "--order", "agreement")
    assert "Agrees" in table.stdout
    assert "0.9744" in table.stdout
    assert table.stdout.index("Counter") < table.stdout.index("Impostor")
