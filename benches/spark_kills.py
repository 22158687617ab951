"""kill -9 of an executor and of the driver, five times each, at random moments.

    python -m benches.spark_kills [--times 5] [--seed 1] [--only executor|driver|kafka]

Every time the findings of the restarted watch are compared with those of one machine. Into Parquet
none may be lost and none be there twice; into a Kafka topic (killed drivers) none may be lost, and
doubles are counted: by plant, id and state they are recognised.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from runglight.model import NominalModel, learn
from runglight.scale.spark import ParquetSink, watch
from tests.conftest import simulated
from tests.scale import feeding, killing, needed
from tests.scale.broker import running
from tests.scale.feeding import SECOND
from tests.scale.sessions import CLUSTER, end, new_session

PIECES = 14


def prepared(directory: Path, model: NominalModel) -> list[str]:
    """A broken cell's log as files; what one machine finds in it."""
    directory.mkdir()
    log = simulated(seed=2, fault=2)
    end_ns = feeding.last_ns(log) + 400 * SECOND
    pieces = feeding.cut(feeding.rows_of(log), PIECES)
    feeding.write(directory / "in", [*pieces, feeding.heartbeat(end_ns)])
    model.save(directory / "model")
    return feeding.by_one_machine(model, log, end_ns - 10 * SECOND)


def moment(chance: random.Random) -> tuple[int, float]:
    """After which micro-batch, and how far into the next one (seconds)."""
    return chance.randint(1, PIECES - 3), chance.uniform(0.0, 1.5)


def wait_for(checkpoint: Path, batch: int, seconds: float) -> None:
    """Waits for a micro-batch to end, and some seconds more."""
    killing.wait_until(lambda: killing.committed(checkpoint) >= batch, f"micro-batch {batch}")
    time.sleep(seconds)


def executors(times: int, chance: random.Random, root: Path, model: NominalModel) -> bool:
    """Kills one of two executors of a running watch."""
    session = new_session(CLUSTER, root / "session")
    sound = True
    try:
        for number in range(times):
            directory = root / f"executor-{number}"
            alone = prepared(directory, model)
            watching = watch(
                feeding.stream(session, directory / "in"),
                directory / "model",
                ParquetSink(str(directory / "out")),
                checkpoint=str(directory / "checkpoint"),
                ahead_s=None,
                until_here=True,
            )
            batch, seconds = moment(chance)
            wait_for(directory / "checkpoint", batch, seconds)
            there = killing.executors(session)
            killing.kill(chance.choice(there))
            watching.wait()
            found = feeding.found(session, directory / "out")
            sound &= told("executor", number, batch, seconds, found=found, alone=alone)
    finally:
        end(session)
    return sound


def drivers(
    times: int, chance: random.Random, root: Path, model: NominalModel, master: str
) -> bool:
    """Kills the driver's program, its Java machine and its executors."""
    reader = None
    sound = True
    for number in range(times):
        directory = root / f"driver-{number}"
        alone = prepared(directory, model)
        driver = killing.Driver(directory, master)
        batch, seconds = moment(chance)
        wait_for(directory / "checkpoint", batch, seconds)
        driver.kill()
        assert killing.Driver(directory, master).end() == 0
        if reader is None:
            reader = new_session("local[1]", root / "reader")
        found = feeding.found(reader, directory / "out")
        sound &= told("driver", number, batch, seconds, found=found, alone=alone)
    if reader is not None:
        end(reader)
    return sound


def drivers_into_kafka(
    times: int, chance: random.Random, root: Path, model: NominalModel, jars: list[Path]
) -> bool:
    """The same with findings into a topic."""
    sound = True
    with running(jars, root / "kafka") as broker:
        for number in range(times):
            directory, topic = root / f"topic-{number}", f"findings-{number}"
            alone = prepared(directory, model)
            broker.create(topic)
            driver = killing.Driver(directory, "local[2]", broker.servers, topic)
            batch, seconds = moment(chance)
            wait_for(directory / "checkpoint", batch, seconds)
            driver.kill()
            assert killing.Driver(directory, "local[2]", broker.servers, topic).end() == 0
            sent = [value.decode() for _, value in broker.received(topic)]
            once = sorted(set(sent))
            doubled = len(sent) - len(once)
            sound &= told(
                "driver, Kafka", number, batch, seconds, found=once, alone=alone, sent_again=doubled
            )
    return sound


def told(
    killed: str,
    number: int,
    batch: int,
    seconds: float,
    *,
    found: list[str],
    alone: list[str],
    sent_again: int = 0,
) -> bool:
    """Prints one kill; True where nothing was lost or doubled."""
    keys = Counter((each["id"], each["state"]) for each in map(json.loads, found))
    doubled = sum(count - 1 for count in keys.values())
    lost = len(set(alone) - set(found))
    other = len(set(found) - set(alone))
    print(
        f"{killed} {number + 1}: killed {seconds:.2f} s after micro-batch {batch} of {PIECES + 1}: "
        f"{len(found)} of {len(alone)} findings, {lost} lost, {other} others, {doubled} doubled"
        + (f" after de-duplication; {sent_again} were sent twice" if "Kafka" in killed else ""),
        flush=True,
    )
    return not (lost or doubled or other)


def main() -> int:
    """Runs all kills."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=["executor", "driver", "kafka"])
    parser.add_argument("--master", default=CLUSTER, help="of the drivers that are killed")
    options = parser.parse_args()
    chance = random.Random(options.seed)
    model = learn(simulated())
    with tempfile.TemporaryDirectory(prefix="runglight-kills-") as scratch:
        root = Path(scratch)
        kills = {
            "executor": lambda: executors(options.times, chance, root, model),
            "driver": lambda: drivers(options.times, chance, root, model, options.master),
            "kafka": lambda: drivers_into_kafka(
                options.times, chance, root, model, needed.jars("broker")
            ),
        }
        wanted = [options.only] if options.only else list(kills)
        sound = [kills[each]() for each in wanted]
    return 0 if all(sound) else 1


if __name__ == "__main__":
    sys.exit(main())
