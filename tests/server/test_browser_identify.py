"""An identification in a real browser, by keyboard alone, from photos to the accepted name."""

import asyncio
import csv
import json
import shutil
from pathlib import Path

import pytest

from runglight.identification.events import read_events
from runglight.server.policy import policy
from runglight.server.running import PageServer, address_of, listen
from runglight.server.workshop import Workshop
from tests.identification.machine import conveyor_log
from tests.server.browser import GUARD_S, ROOT, Seen, missing
from tests.server.photographed import Photographed

pytest.importorskip("skimage")
pytestmark = pytest.mark.skipif(missing() is not None, reason=str(missing()))


async def visit(directory: Path, machine: Photographed) -> Seen:
    workshop = Workshop(directory, policy())
    listening = listen("127.0.0.1", 0)
    server = PageServer(workshop, listening)
    serving = asyncio.create_task(server.run())
    log = next(item for item in workshop.catalogue.items("log"))
    wanted = ",".join(str(machine.photo_after(seen_ns)) for seen_ns in machine.seen_ns)
    seen = Seen()
    try:
        await told(seen, address_of(listening), wanted, log.id)
    finally:
        server.stop()
        await serving
        listening.close()
    return seen


async def told(seen: Seen, *arguments: str) -> None:
    """Lets the script look at the page and keeps what it tells."""
    script = str(ROOT / "web/e2e/identify.mjs")
    piped = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(
        "node", script, *arguments, stdout=piped, stderr=piped
    )
    try:
        async with asyncio.timeout(GUARD_S):
            lines, errors = await process.communicate()
    finally:
        if process.returncode is None:
            process.terminate()
            await process.wait()
    seen.told += [json.loads(line) for line in lines.splitlines()]
    seen.errors = errors.decode()


@pytest.fixture(scope="module")
def directory(machine: Photographed, tmp_path_factory: pytest.TempPathFactory) -> Path:
    served = tmp_path_factory.mktemp("identified")
    shutil.copytree(machine.path, served / "line3")
    conveyor_log().write(served / "conveyor.csv")
    return served


@pytest.fixture(scope="module")
def seen(machine: Photographed, directory: Path) -> Seen:
    """One visit; the tests look at what it told."""
    return asyncio.run(visit(directory, machine))


def test_events_are_declared_by_stepping_through_photos(
    seen: Seen, machine: Photographed, directory: Path
) -> None:
    last = machine.photo_after(machine.seen_ns[-1])
    assert seen["place"].startswith(f"{last + 1}/{len(machine.photos_ns)} ")
    # Undone what was declared at the first photo, and gone to the first event.
    assert seen["back"].startswith(f"{machine.photo_after(machine.seen_ns[0]) + 1}/")
    assert seen["saved"] == f"events.csv: {len(machine.seen_ns)} events"
    saved = read_events(directory / "line3" / "events.csv")
    wanted = [machine.photos_ns[machine.photo_after(each)] for each in machine.seen_ns]
    # To the millisecond.
    assert [each // 10**6 for each in saved.time_ns.tolist()] == [each // 10**6 for each in wanted]


def test_the_ranking_follows_what_is_turned(seen: Seen) -> None:
    assert seen["tau"] == "2 s"
    # It rises at every second event.
    assert "%M30" not in seen["rising"]
    assert "%M30" in seen["narrower"]
    assert set(seen["first"]) == {"%M30", "%MW74.0", "%MW14.2", "%MW140.8"}
    assert "copies of one another" in seen["verdict"]


def test_a_name_is_accepted_and_shown_back(seen: Seen, directory: Path) -> None:
    assert seen["accepted"].startswith("symbols.csv: %M30 is Line3-Conveyor-Running")
    assert seen["shown"]
    with (directory / "symbols.csv").open(encoding="utf-8") as table:
        assert [(row["address"], row["signal"]) for row in csv.DictReader(table)] == [
            ("%M30", "Running")
        ]


def test_a_rectangle_proposes_and_a_log_needs_no_photos(seen: Seen) -> None:
    assert "events proposed" in seen["said"], seen.errors
    assert seen["proposed"] > 0
    assert seen["without_photos"] == 1


def test_the_browser_has_nothing_to_complain_about(seen: Seen) -> None:
    assert seen["complaints"] == []


def test_axe_is_content_and_nothing_sticks_out(seen: Seen) -> None:
    looked = [each for each in seen.told if "axe" in each]
    assert len(looked) == 4, seen.errors
    assert {each["axe"]: each["violations"] for each in looked if each["violations"]} == {}
    assert [each["axe"] for each in looked if each["sticks_out"]] == []
