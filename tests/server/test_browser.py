"""A real browser on the page of a real (simulated) machine over real Modbus."""

import asyncio
import csv
import io
import os
import shutil
from pathlib import Path

import pytest

from runglight.log.changelog import read_log
from runglight.model import learn
from tests.server.browser import Seen, look, missing

pytestmark = pytest.mark.skipif(missing() is not None, reason=str(missing()))


@pytest.fixture(scope="module")
def seen(cell: Path, tmp_path_factory: pytest.TempPathFactory) -> Seen:
    """One visit, by keyboard alone; the tests look at what it told."""
    directory = tmp_path_factory.mktemp("page")
    shutil.copytree(cell / "cell.model", directory / "cell.model")
    # An older model of a machine that did something else once: the newest one is watched with.
    learn(read_log(cell / "faulty.csv"), symbols=cell / "symbols.csv").save(directory / "old.model")
    os.utime(directory / "old.model" / "manifest.json", (0, 0))
    for name in ("symbols.csv", "nominal.csv"):
        shutil.copy(cell / name, directory)
    # Of another machine, and before the cell's own in every list.
    (directory / "another.csv").write_text(
        "time,signal,value\n2026-01-01T00:00:00Z,Line9-Press-DOWN,1\n", encoding="utf-8"
    )
    return asyncio.run(look(directory, "prt-chk-on-while-returning", "page.mjs"))


def test_a_fault_appears_by_itself(seen: Seen) -> None:
    # How soon is measured by benches/live_page.py: here, a busy machine may take its time.
    assert seen["appeared_ms"] >= seen.shown_ms - 50
    print(f"on the page {seen['appeared_ms'] - seen.shown_ms:.0f} ms after the change in the PLC")


def test_it_is_opened_and_understood(seen: Seen) -> None:
    assert "PRT_CHK (%IX0.2)" in seen["sentence"]
    assert seen["suspect"].startswith("%IX0.2")
    assert seen["red_nodes"] > 0
    assert seen["devices"] > 0


def test_it_is_acknowledged_and_exported(seen: Seen) -> None:
    assert seen["acknowledged"]
    rows = csv.DictReader(io.StringIO(seen["exported"]))
    # The fault stays switched on: on a slow computer the machine has met it again by now.
    acknowledged = [row for row in rows if row["acknowledged_by"]]
    assert [(row["severity"], row["acknowledged_by"]) for row in acknowledged] == [("fault", "Ada")]


def test_every_view_is_worked_by_keyboard(seen: Seen) -> None:
    assert "Δt" in seen["measured"]
    before, after = seen["folded"]
    assert 1 <= after < before
    assert "nominal.csv" in seen["golden"]
    assert "not in here" not in seen["golden"]
    assert seen["charts"] == 2
    assert seen["times_of"] == "nominal.csv"
    assert seen["recorded"]
    assert seen["validated"]


def test_two_models_are_compared(seen: Seen) -> None:
    assert "3 differ" in seen["differing"]
    assert "only in the other" in seen["first"]
    assert seen["red"] == 3
    assert "left out" in seen["hidden"]


def test_a_net_is_mined_played_and_followed(seen: Seen) -> None:
    assert "PRT_CHK ON" in seen["opening"]
    assert "FORWARD ON" in seen["played"]
    assert "sound" in seen["quality"]
    assert "19 recorded runs" in seen["quality"]
    assert seen["outputs"] > 5
    assert "<pnml" in seen["pnml"]


def test_the_browser_has_nothing_to_complain_about(seen: Seen) -> None:
    assert seen["complaints"] == []


def test_axe_is_content_and_nothing_sticks_out(seen: Seen) -> None:
    looked = [each for each in seen.told if "axe" in each]
    assert len(looked) == 3 * seen["views"], seen.errors
    assert {each["axe"]: each["violations"] for each in looked if each["violations"]} == {}
    assert [each["axe"] for each in looked if each["sticks_out"]] == []
