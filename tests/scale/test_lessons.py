"""A model learned group by group is the model of the whole log, byte for byte."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants import write_symbols
from runglight.plants.bodyshop import simulate_bodyshop
from tests.conftest import simulated

BATCH_ROWS = 1000


def batches(log: Log) -> list[pa.RecordBatch]:
    """The log in pieces, backwards, as they may lie in a cluster."""
    time_ns, signal, value = log.columns()
    table = pa.table(
        {
            "time": time_ns,
            "signal": pa.array(np.array(log.signals, object)[signal]),
            "value": value,
            "place": np.arange(len(log)),
        }
    )
    return table.to_batches(max_chunksize=BATCH_ROWS)[::-1]


def as_read(log: Log) -> Log:
    """The log with its signals in the order of their first rows, as files have them."""
    table = pa.Table.from_batches(batches(log)[::-1]).drop_columns("place")
    times = table["time"].cast(pa.timestamp("ns", "UTC"))
    return Log.from_arrow(table.set_column(0, "time", times))


def survey(log: Log) -> _engine.LogSurvey:
    """Of every piece by itself, merged."""
    whole = _engine.LogSurvey(log.engine.gaps)
    for batch in batches(log):
        piece = _engine.LogSurvey(log.engine.gaps)
        piece.add(batch)
        whole.merge(piece.state())
    assert len(whole) == len(log)
    return whole


def in_parts(log: Log, symbols: Path | None, parameters: dict[str, Any]) -> NominalModel:
    """Learned as a cluster does it."""
    context = _engine.LearningContext.of(
        survey(log), symbols.read_text() if symbols else None, json.dumps(parameters)
    )
    number = {name: index for index, (name, _) in enumerate(context.signals)}
    group_of = np.array([group for _, group in context.signals], np.int32)
    time_ns, signal, value = log.columns()
    signal = np.array([number[name] for name in log.signals], np.int32)[signal]
    rows = np.lexsort((np.arange(len(log)), time_ns, group_of[signal]))
    assert np.bincount(group_of[signal]).tolist() == context.rows_of_groups
    learner = _engine.LearningContext.restore(context.state()).learner()
    lessons: list[bytes] = []
    for start in range(0, len(rows), BATCH_ROWS):
        at = rows[start : start + BATCH_ROWS]
        lessons += learner.add(group_of[signal[at]], time_ns[at], signal[at], value[at], at)
    last = learner.finish()
    assert last is not None
    return NominalModel(context.merge([last, *lessons]))


def same_directories(one: NominalModel, other: NominalModel, into: Path) -> None:
    """Equal but for when they were learned and of what."""
    for model, name in ((one, "one"), (other, "other")):
        model.save(into / name)
    rules = [(into / name / "rules.parquet").read_bytes() for name in ("one", "other")]
    assert rules[0] == rules[1]
    manifests = [
        json.loads((into / name / "manifest.json").read_text()) for name in ("one", "other")
    ]
    for manifest in manifests:
        del manifest["created"], manifest["source"]
    assert manifests[0] == manifests[1]


@pytest.mark.parametrize("timing", ["adaptive", "plat"])
def test_a_body_shop(timing: str, tmp_path: Path) -> None:
    run = simulate_bodyshop("tiny", learn_events=20_000, watch_events=1_000).learn
    log = as_read(Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals))
    whole = learn(log, timing=timing)
    assert len(whole.groups) == 2
    if timing == "adaptive":
        assert '"trigger": "' in whole.rules_json().replace('":"', '": "')
    same_directories(whole, in_parts(log, None, {"timing": timing}), tmp_path)


def test_a_table_words_and_gaps(tmp_path: Path) -> None:
    log = simulated()
    time_ns, signal, value = log.columns()
    silent = (int(time_ns[500]), int(time_ns[600]))
    kept = (time_ns <= silent[0]) | (time_ns >= silent[1])
    # A word that counts, in a group that names tell, and one that no rule places.
    word = np.arange(kept.sum()) % 5
    columns = np.repeat(time_ns[kept], 2), np.repeat(signal[kept], 2), np.repeat(value[kept], 2)
    columns[1][1::2] = len(log.signals) + word % 2
    columns[2][1::2] = word * 7
    names = [*log.signals, "Other-Counter-STEP", "loose"]
    named = as_read(Log.from_columns(*columns, names))
    log = Log.from_columns(*named.columns(), named.signals, gaps=[silent])
    write_symbols(simulated_symbols(), tmp_path / "symbols.csv")
    whole = learn(log, symbols=tmp_path / "symbols.csv")
    assert whole.summary()["unnamed"] == ["loose"]
    assert len(whole.groups) > 2
    same_directories(whole, in_parts(log, tmp_path / "symbols.csv", {}), tmp_path)


def simulated_symbols() -> Any:
    from runglight.plants import PLANTS  # noqa: PLC0415

    return PLANTS["cell"].symbols


def test_what_is_missing_is_said() -> None:
    log = simulated(cycles=2)
    with pytest.raises(InputError, match="no change of any signal"):
        _engine.LearningContext.of(_engine.LogSurvey())
    context = _engine.LearningContext.of(survey(log))
    with pytest.raises(InputError, match=f"nobody learned group '{context.groups[0]}'"):
        context.merge([])
    with pytest.raises(InputError, match="damaged"):
        context.merge([b"lesson"])
    with pytest.raises(InputError, match="survey the log anew"):
        _engine.LearningContext.restore(b"context")
    with pytest.raises(InputError, match="same gaps"):
        _engine.LogSurvey([(0, 1)]).merge(survey(log).state())
    with pytest.raises(InputError, match="no column 'time'"):
        _engine.LogSurvey().add(pa.record_batch({"signal": ["A"], "value": [1]}))
    with pytest.raises(InputError, match="column 'value' has no value in 1 rows"):
        _engine.LogSurvey().add(
            pa.record_batch({"time": [1], "signal": ["A"], "value": pa.array([None], pa.int64())})
        )


def test_columns_are_known_by_their_names() -> None:
    assert _engine.log_columns(["id", "Time stamp", "Symbol name", "Status"]) == [
        "Time stamp",
        "Symbol name",
        "Status",
    ]
    assert _engine.log_columns(["a", "value"]) == [None, None, "value"]
