"""Findings are kept: on disk, or in memory until the disk takes them."""

import asyncio
import json
import shutil
from pathlib import Path

import pytest

from runglight.findings.store import FindingStore
from runglight.live import keeper as keeper_module
from runglight.live.keeper import Keeper
from tests.live.receivers import DoubleReceiver


def line(number: int, snapshot_id: str | None = None) -> str:
    return json.dumps({"id": f"f-{number}", "state": "suspected", "snapshot_id": snapshot_id})


def test_a_snapshot_goes_with_its_finding(tmp_path: Path) -> None:
    async def main() -> None:
        keeper = Keeper(tmp_path, pytest.fail)
        await keeper.open([DoubleReceiver("new")])
        snapshot = json.dumps({"id": "s-1"})
        keeper.put([line(1, "s-1"), line(2)], [snapshot])
        await keeper.flush()
        found = await keeper.next("new", 10)
        assert [(each.line, each.snapshot) for each in found] == [
            (line(1, "s-1"), snapshot),
            (line(2), None),
        ]
        await keeper.close()

    asyncio.run(main())


def test_a_new_receiver_begins_now_or_with_everything(tmp_path: Path) -> None:
    with FindingStore(tmp_path) as store:
        store.append([line(1), line(2)])
    later, all_of_it = DoubleReceiver("later"), DoubleReceiver("all")
    all_of_it.from_the_start = True

    async def main() -> None:
        keeper = Keeper(tmp_path, pytest.fail)
        await keeper.open([later, all_of_it])
        assert await keeper.behind("later") == 0
        assert [each.line for each in await keeper.next("all", 10)] == [line(1), line(2)]
        await keeper.close()

    asyncio.run(main())


def test_a_disk_that_takes_nothing_holds_up_no_alarm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keeper_module, "RETRY_DISK_S", 0.0)
    said: list[str] = []
    # A directory in the place of the file: unwritable for root too.
    (tmp_path / "findings.sqlite").mkdir()

    async def main() -> None:
        keeper = Keeper(tmp_path, said.append)
        await keeper.open([DoubleReceiver("mail")])
        assert not keeper.on_disk
        keeper.put([line(1)], [])
        await keeper.flush()
        assert [each.line for each in await keeper.next("mail", 10)] == [line(1)]
        shutil.rmtree(tmp_path / "findings.sqlite")
        keeper.put([line(2)], [])
        await keeper.flush()
        assert keeper.on_disk
        await keeper.close()

    asyncio.run(main())
    assert len(said) == 2
    assert "held in memory" in said[0]
    assert "on disk again" in said[1]
    with FindingStore(tmp_path, create=False) as store:
        assert [each.line for each in store.after(0, 10)] == [line(1), line(2)]


def test_memory_is_bounded_and_losses_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keeper_module, "LINES_IN_MEMORY", 10)
    (tmp_path / "findings.sqlite").mkdir()

    async def main() -> None:
        keeper = Keeper(tmp_path, lambda _said: None)
        await keeper.open()
        for number in range(25):
            keeper.put([line(number)], [])
            await keeper.flush()
        assert keeper.dropped == 15
        newest = await keeper.next("mail", 100)
        assert [each.line for each in newest] == [line(number) for number in range(15, 25)]
        await keeper.close()

    asyncio.run(main())
