"""A part from batch to batch, without Spark: order, lateness, silence, another model."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runglight.model import NominalModel
from runglight.scale.spark import chunk
from runglight.scale.spark.opening import Opening
from runglight.scale.spark.part_watcher import MS, PartState, PartWatcher
from runglight.scale.spark.plant_parts import PlantParts
from tests.conftest import simulated
from tests.scale.feeding import SECOND, by_one_machine, cut, disordered, last_ns, rows_of

QUIET_NS = 30 * SECOND
SILENCE_NS = 400 * SECOND


def packed(rows: pa.Table) -> bytes:
    return chunk.pack(
        chunk.table_of(
            rows["time"].to_numpy(),
            rows["signal"].combine_chunks().dictionary_encode(),
            rows["value"].to_numpy(),
            rows["partition"].to_numpy(),
        )
    )


class Stream:
    """What Spark does for one key: the watermark, the timer, the state."""

    def __init__(self, model: NominalModel, delay_s: float = 10.0) -> None:
        self.state: PartState | None = None
        self.lines: list[str] = []
        self.watermark_ns = 0
        self._newest_ns = 0
        self._delay_ns = round(delay_s * SECOND)
        self.use(model, "first")

    def use(self, model: NominalModel, fingerprint: str) -> None:
        self._watcher = PartWatcher("", "", fingerprint, PlantParts(model), QUIET_NS)

    def batch(self, pieces: Sequence[pa.Table], newest_ns: int = 0) -> None:
        self.watermark_ns = max(0, (self._newest_ns - self._delay_ns) // MS * MS)
        pieces = [piece for piece in pieces if len(piece)]
        due = self.state is not None and self.state.wake_ms * MS <= self.watermark_ns
        if pieces or due:
            openings = [Opening(int(piece["time"].to_numpy().min()), True) for piece in pieces]
            told, self.state = self._watcher.step(
                self.state, [packed(piece) for piece in pieces], self.watermark_ns, openings
            )
            self.lines += told.lines
            assert self.state.wake_ms * MS > self.watermark_ns
        for piece in pieces:
            self._newest_ns = max(self._newest_ns, int(piece["time"].to_numpy().max()))
        self._newest_ns = max(self._newest_ns, newest_ns)

    def end(self, time_ns: int) -> list[str]:
        self.batch([], time_ns)
        for _ in range(20):
            self.batch([])
        return sorted(self.lines)


@pytest.mark.parametrize("fault", [1, 2, 5, 9])
@settings(
    max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(pieces=st.integers(1, 40), by_s=st.sampled_from([0.0, 0.5, 9.9]), seed=st.integers(0, 99))
def test_disorder_within_the_delay_changes_nothing(
    nominal_model: NominalModel, fault: int, pieces: int, by_s: float, seed: int
) -> None:
    log = simulated(seed=2, fault=fault)
    stream = Stream(nominal_model)
    for piece in cut(disordered(rows_of(log), by_s, seed), pieces):
        stream.batch(cut(piece, 2))
    end_ns = last_ns(log) + SILENCE_NS
    alone = by_one_machine(nominal_model, log, end_ns - 10 * SECOND)
    assert alone
    assert stream.end(end_ns) == alone


def test_rows_of_one_time_stand_by_partition(nominal_model: NominalModel) -> None:
    log = simulated(seed=2, fault=1)
    rows = rows_of(log)
    partition = np.arange(len(rows), dtype=np.int32) % 3
    rows = rows.set_column(4, "partition", pa.array(partition))
    by_partition = [rows.filter(pa.array(partition == number)) for number in (2, 0, 1)]
    together, apart = Stream(nominal_model), Stream(nominal_model)
    together.batch(by_partition)
    for piece in by_partition:
        apart.batch([piece], newest_ns=0)
        apart._newest_ns = 0
    end_ns = last_ns(log) + SILENCE_NS
    assert together.end(end_ns) == apart.end(end_ns)


def test_what_comes_too_late_is_told(nominal_model: NominalModel) -> None:
    log = simulated(seed=2)
    early, held_back, rest = cut(rows_of(log), 3)
    stream = Stream(nominal_model)
    for piece in (early, rest, rest.slice(0, 0), held_back):
        stream.batch([piece])
    told = [json.loads(line) for line in stream.end(last_ns(log) + SECOND)]
    [late] = [finding for finding in told if "too late" in finding["message"]]
    assert f"{len(held_back)} changes came too late" in late["message"]
    assert (late["kind"], late["severity"]) == ("gap", "notice")


def test_a_plant_that_lags_behind_the_others_is_judged(nominal_model: NominalModel) -> None:
    log = simulated(seed=2, fault=2)
    stream = Stream(nominal_model)
    for piece in cut(rows_of(log), 100):
        # Others are 35 s ahead, 25 s more than the delay.
        stream.batch([piece], newest_ns=int(piece["time"].to_numpy().max()) + 35 * SECOND)
    end_ns = last_ns(log) + SILENCE_NS
    assert stream.end(end_ns) == by_one_machine(nominal_model, log, end_ns - 10 * SECOND)


def test_another_model_starts_afresh_and_judges_what_waited(
    nominal_model: NominalModel,
) -> None:
    log = simulated(seed=2, fault=2)
    pieces = cut(rows_of(log), 4)
    stream = Stream(nominal_model)
    for piece in pieces[:2]:
        stream.batch([piece])
    judged = int(np.searchsorted(rows_of(log)["time"].to_numpy(), stream.watermark_ns))
    stream.use(nominal_model, "second")
    for piece in pieces[2:]:
        stream.batch([piece])
    end_ns = last_ns(log) + SILENCE_NS
    told = stream.end(end_ns)
    [replaced] = [line for line in told if "another model watches" in line]
    assert json.loads(replaced)["severity"] == "notice"
    told.remove(replaced)
    before = nominal_model.monitor().observe(log.slice(0, judged)).json_lines()
    after = by_one_machine(nominal_model, log.slice(judged), end_ns - 10 * SECOND)
    assert before
    assert after
    assert told == sorted(before + after)


def test_a_signal_that_the_model_does_not_know(nominal_model: NominalModel) -> None:
    log = simulated(seed=2)
    rows = rows_of(log)
    stranger = rows.slice(50, 1).set_column(1, "signal", pa.array(["Group9-New-Sensor"]))
    stream = Stream(nominal_model)
    stream.batch([rows.slice(0, 51), stranger, rows.slice(51)])
    told = [json.loads(line) for line in stream.end(last_ns(log) + SECOND)]
    [unknown] = [finding for finding in told if finding["kind"] == "unknown_signal"]
    assert unknown["signal"] == "Group9-New-Sensor"
