"""From record batches to parts and back: a whole stream without Spark."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from runglight.log.changelog import Log
from runglight.model import NominalModel
from runglight.scale.spark import aside
from runglight.scale.spark.frames import FrameReader
from runglight.scale.spark.opening import Opening
from runglight.scale.spark.packing import Packer
from runglight.scale.spark.part_watcher import MS, PartState, PartWatcher
from runglight.scale.spark.shipped_model import ShippedModels, ship
from runglight.scale.wire import GAP
from tests.scale import feeding
from tests.scale.feeding import SECOND

DELAY_NS = 10 * SECOND


@pytest.fixture(scope="module")
def shop() -> tuple[NominalModel, Log]:
    return feeding.body_shop()


def found(models: ShippedModels, batches: list[list[pa.Table]]) -> list[str]:
    """Each batch is read by some tasks; what the parts of the plant find."""
    packer = Packer(models, FrameReader(), None)
    model = models.of("")
    assert model is not None
    states: dict[str, PartState] = {}
    lines: list[str] = []
    newest_us = 0
    for tasks in [*batches, [], []]:
        watermark_ns = max(0, newest_us * 1000 - DELAY_NS) // MS * MS
        of_part: dict[str, list[dict[str, Any]]] = defaultdict(list)
        for rows in tasks:
            for packed in packer(rows.to_batches()):
                for row in packed.to_pylist():
                    newest_us = max(newest_us, int(row["latest"].timestamp() * 1_000_000))
                    of_part[row["part"]].append(row)
        of_part.pop(aside.PART, None)
        due = [part for part, state in states.items() if state.wake_ms * MS <= watermark_ns]
        for part in {*of_part, *due}:
            watcher = PartWatcher("", part, model.fingerprint, model.parts(), 30 * SECOND)
            rows_of_part = sorted(of_part[part], key=lambda row: (row["partition"], row["offset"]))
            told, states[part] = watcher.step(
                states.get(part),
                [row["rows"] for row in rows_of_part if row["rows"] is not None],
                watermark_ns,
                [Opening(row["opens_ns"], row["opens_image"]) for row in rows_of_part],
            )
            lines += told.lines
    assert len(states) == len(model.parts().names)
    return sorted(lines)


@pytest.mark.parametrize("by_s", [0.0, 5.0])
def test_parts_of_a_plant_find_what_one_machine_finds(
    shop: tuple[NominalModel, Log], by_s: float
) -> None:
    model, log = shop
    models = ship(model)
    shipped = models.of("")
    assert shipped is not None
    assert len(shipped.parts().names) == 2
    end_ns = feeding.last_ns(log) + 400 * SECOND
    rows = feeding.disordered(feeding.rows_of(log), by_s)
    batches = [[piece] for piece in feeding.cut(rows, 7)]
    alone = feeding.by_one_machine(model, log, end_ns - DELAY_NS)
    assert len(alone) > 10
    assert found(models, [*batches, [feeding.heartbeat(end_ns)]]) == alone


def test_a_group_that_has_stopped_before_the_stream_begins(
    shop: tuple[NominalModel, Log],
) -> None:
    model, log = shop
    stopped = model.groups[1]
    time_ns, index, value = log.columns()
    moving = np.array([group != stopped for group in model.groups_of(log.signals)])[index]
    half = Log.from_columns(time_ns[moving], index[moving], value[moving], log.signals)
    end_ns = feeding.last_ns(half) + 400 * SECOND
    batches = [[piece] for piece in feeding.cut(feeding.rows_of(half), 4)]
    alone = feeding.by_one_machine(model, half, end_ns - DELAY_NS)
    assert found(ship(model), [*batches, [feeding.heartbeat(end_ns)]]) == alone


def test_a_gap_is_told_once_and_resynchronises_every_part(
    shop: tuple[NominalModel, Log],
) -> None:
    model, log = shop
    time_ns = log.columns()[0]
    last, first = len(log) // 3, len(log) // 2
    first = int(np.searchsorted(time_ns, time_ns[first]))
    before, after = log.slice(0, last), log.slice(first)
    start_ns, end_ns = int(time_ns[last - 1]), int(time_ns[first])
    gap = feeding.heartbeat(end_ns)
    gap = gap.set_column(1, "signal", pa.array([GAP])).set_column(
        2, "value", pa.array([start_ns], pa.int64())
    )
    rows = [*feeding.cut(feeding.rows_of(before), 2)]
    rows += [
        pa.concat_tables([gap, piece]) if not number else piece
        for number, piece in enumerate(feeding.cut(feeding.rows_of(after), 2))
    ]
    until_ns = feeding.last_ns(log) + 400 * SECOND
    monitor = model.monitor()
    alone = monitor.observe(before).json_lines() + monitor.gap(start_ns, end_ns).json_lines()
    alone += monitor.observe(after).json_lines()
    alone += monitor.advance(until_ns - DELAY_NS - 1).json_lines()
    assert sum('"kind":"gap"' in line for line in alone) == 1
    told = found(ship(model), [*([piece] for piece in rows), [feeding.heartbeat(until_ns)]])
    assert told == sorted(alone)


def test_what_cannot_be_read_travels_aside(nominal_model: NominalModel) -> None:
    rows = feeding.heartbeat(5 * SECOND)
    broken = rows.set_column(0, "time", pa.array([None], pa.int64()))
    packer = Packer(ship(nominal_model), FrameReader(), None)
    [packed] = packer(pa.concat_tables([rows, broken]).to_batches())
    [row] = packed.to_pylist()
    assert row["part"] == aside.PART
    [told] = aside.told([row["rows"]])
    assert "1 message could not be read" in told


def test_a_time_that_lies_ahead_is_not_believed(nominal_model: NominalModel) -> None:
    # The year 2100.
    rows = feeding.heartbeat(4_102_444_800 * SECOND)
    packer = Packer(ship(nominal_model), FrameReader(), 86_400 * SECOND)
    [packed] = packer(rows.to_batches())
    [row] = packed.to_pylist()
    assert row["latest"].year == 1970
    assert "lies ahead" in aside.told([row["rows"]])[0]
