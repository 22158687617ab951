"""A session from outside: what it tells, keeps and passes on, and what cannot hold it up."""

import asyncio
import json
from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.findings.store import FindingStore
from runglight.live.checkpoint import Checkpoint
from runglight.live.delivery import RefusedError
from runglight.live.status import Status
from runglight.log.changelog import Log
from runglight.model import NominalModel
from runglight.taps.base import Batch, Connection, ConnectionState
from tests.live.double_tap import batch_of
from tests.live.receivers import DoubleReceiver
from tests.live.running import Watching, until


def kept(directory: Path) -> list[str]:
    with FindingStore(directory, create=False) as store:
        return [each.line for each in store.after(0, 10_000)]


def test_everybody_is_told_everything(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty)
        receivers = [DoubleReceiver("one"), DoubleReceiver("two")]
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        watching.tap.end()
        await watching.session.run(receivers)
        assert watching.told == offline
        assert not watching.said
        assert all(receiver.taken == offline and receiver.closed for receiver in receivers)

    asyncio.run(main())
    assert kept(model_directory) == offline


def test_receivers_that_hang_or_fail_delay_nothing_and_catch_up(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty)
        hanging, failing, sound = (DoubleReceiver(name) for name in ("hanging", "failing", "sound"))
        hanging.hanging = True
        failing.failure = ConnectionError("gone for lunch")
        run = asyncio.create_task(watching.session.run([hanging, failing, sound]))
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await until(lambda: sound.taken == offline)
        await until(lambda: hanging.calls > 1 and failing.calls > 1)
        assert watching.told == offline
        assert not hanging.taken
        assert not failing.taken
        # Said once each, not at every try.
        assert len(watching.said) == 2
        assert any("failing" in each and "gone for lunch" in each for each in watching.said)
        assert any("hanging" in each and "no answer within 0.2 s" in each for each in watching.said)
        hanging.hanging, failing.failure = False, None
        await until(lambda: hanging.taken == failing.taken == offline)
        watching.session.stop()
        await run

    asyncio.run(main())


def test_what_was_not_delivered_is_delivered_by_the_next_start(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    async def main(receiver: DoubleReceiver, log: Log | None) -> list[str]:
        watching = Watching(nominal_model, model_directory, faulty)
        run = asyncio.create_task(watching.session.run([receiver]))
        if log is not None:
            watching.tap.feed(batch_of(log, 0, len(log)))
            await until(lambda: bool(receiver.calls))
        else:
            await until(lambda: receiver.taken == offline)
        watching.session.stop()
        await run
        return watching.said

    away = DoubleReceiver()
    away.failure = ConnectionError("no route")
    said = asyncio.run(main(away, faulty))
    assert f"double: {len(offline)} findings wait for the next start" in said
    back = DoubleReceiver()
    assert not asyncio.run(main(back, None))
    assert back.taken == offline
    # Nothing is given twice to one that has had all of it.
    again = DoubleReceiver()
    asyncio.run(_idle(Watching, nominal_model, model_directory, faulty, again))
    assert not again.taken


async def _idle(
    watching_of: type[Watching],
    model: NominalModel,
    directory: Path,
    log: Log,
    receiver: DoubleReceiver,
) -> None:
    watching = watching_of(model, directory, log)
    await watching.session.run([receiver], duration_s=0.3)


def test_a_finding_that_is_refused_does_not_hold_up_the_others(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    class Picky(DoubleReceiver):
        at_once = 1

        async def deliver(self, findings):  # type: ignore[no-untyped-def]
            if self.calls == 0:
                self.calls = 1
                raise RefusedError("it answered 413")
            await super().deliver(findings)

    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty)
        picky = Picky()
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        watching.tap.end()
        await watching.session.run([picky])
        assert picky.taken == offline[1:]
        assert any("413" in each for each in watching.said)

    asyncio.run(main())


def test_a_lost_connection_is_said_and_ends_the_scan_that_waits(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    fault_ns = _time_of(offline[0], faulty)
    end = int((faulty.columns()[0] <= fault_ns).sum())

    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty)
        run = asyncio.create_task(watching.session.run())
        # Its end is not known yet: more of the same time may come.
        watching.tap.feed(batch_of(faulty, 0, end, until_ns=fault_ns - 1))
        await asyncio.sleep(0.3)
        assert not watching.told
        watching.tap.connection = Connection(ConnectionState.RETRYING, 0, "no answer for 0.5 s")
        await until(lambda: bool(watching.told))
        assert watching.told == offline[:1]
        watching.tap.connection = Connection(ConnectionState.CONNECTED, 1)
        await until(lambda: len(watching.said) == 2)
        watching.session.stop()
        await run
        assert "connection lost: no answer for 0.5 s" in watching.said[0]
        assert "connected again" in watching.said[1]
        assert watching.session.status().reconnects == 1

    asyncio.run(main())


def _time_of(line: str, log: Log) -> int:
    import datetime  # noqa: PLC0415

    moment = datetime.datetime.fromisoformat(json.loads(line)["time"])
    since = moment - datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
    nanoseconds = since // datetime.timedelta(microseconds=1) * 1000
    assert nanoseconds in log.columns()[0]
    return nanoseconds


def test_a_recording_that_stops_does_not_stop_watching(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    class FullDisk:
        appended = 0

        def append(self, batch: Batch) -> None:
            self.appended += 1
            raise InputError("rec: the disk is full")

        def close(self) -> None:
            raise InputError("rec: the disk is full")

    async def main() -> None:
        recording = FullDisk()
        watching = Watching(nominal_model, model_directory, faulty, recording=recording)
        half = len(faulty) // 2
        while faulty.columns()[0][half] == faulty.columns()[0][half - 1]:
            half += 1
        watching.tap.feed(batch_of(faulty, 0, half), batch_of(faulty, half, len(faulty)))
        watching.tap.end()
        await watching.session.run()
        assert watching.told == offline
        assert watching.said == ["rec: the disk is full; watching goes on"]
        assert recording.appended == 1

    asyncio.run(main())


def test_what_a_tap_can_never_do_ends_the_session(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty)
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        watching.tap.end(InputError("double://tap: has no coil 99"))
        with pytest.raises(InputError, match="has no coil 99"):
            await watching.session.run()

    asyncio.run(main())
    # What was found until then is kept.
    assert kept(model_directory) == offline


def test_the_state_is_kept_now_and_then_and_at_the_end(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, tmp_path: Path
) -> None:
    async def main() -> None:
        checkpoint = Checkpoint(tmp_path / "cell.state")
        watching = Watching(
            nominal_model,
            model_directory,
            faulty,
            checkpoint=checkpoint,
            checkpoint_every_s=0.01,
        )
        run = asyncio.create_task(watching.session.run())
        watching.tap.feed(batch_of(faulty, 0, 50))
        await until(checkpoint.path.exists)
        watching.tap.feed(batch_of(faulty, 50, 100))
        watching.session.stop()
        await run
        monitor, afresh = checkpoint.restore(nominal_model)
        assert afresh is None
        assert monitor.now_ns == int(faulty.columns()[0][99]) + 1

    asyncio.run(main())


def test_the_status_counts(
    nominal_model: NominalModel, model_directory: Path, faulty: Log, offline: list[str]
) -> None:
    shown: list[Status] = []

    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty, show=shown.append)
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await watching.session.run(duration_s=0.6)

    asyncio.run(main())
    status = shown[-1]
    first = {json.loads(line)["id"]: json.loads(line)["severity"] for line in reversed(offline)}
    assert sum(status.findings.values()) == len(first)
    assert status.state == "connected"
    assert status.changes == len(faulty)
    assert status.last_change is not None
    assert status.source == "double://tap"
