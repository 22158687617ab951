"""What a part of a plant costs: learning a group, and watching one in small batches.

    python benches/parts.py [--size main] [--learn-events 3320000] [--watch-events 1000000]

Learning: the survey, and each group's rows learned by itself, in one process. Watching: each part
takes its rows in batches; before each it is restored from bytes and after each it gives bytes, as
in a stream whose state lies elsewhere.
"""

from __future__ import annotations

import argparse
import json
import os
from time import perf_counter

import numpy as np
import pyarrow as pa

from runglight import _engine
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants.bodyshop import simulate_bodyshop
from runglight.plants.run import PlantRun

BATCHES = (100, 1_000, 10_000, 100_000)
ARROW_ROWS = 10_000


def as_log(run: PlantRun) -> Log:
    """With its signals in the order of their first rows."""
    names = pa.array(np.array(run.signals, object)[run.signal_index])
    time = pa.array(run.time_ns).cast(pa.timestamp("ns", "UTC"))
    return Log.from_arrow(pa.table({"time": time, "signal": names, "value": run.value}))


def as_batch(log: Log) -> pa.Table:
    """Arrow, with a dictionary of its own signals."""
    time_ns, signal, value = log.columns()
    used, keys = np.unique(signal, return_inverse=True)
    names = pa.array(np.array(log.signals, object)[used])
    coded = pa.DictionaryArray.from_arrays(pa.array(keys.astype(np.int32)), names)
    time = pa.array(time_ns).cast(pa.timestamp("ns", "UTC"))
    return pa.table({"time": time, "signal": coded, "value": value})


def learn_in_parts(log: Log) -> dict[str, float]:
    """Times of the survey, of each group, and of putting the lessons together."""
    time_ns, signal, value = log.columns()
    names = np.array(log.signals, object)
    table = pa.table({"time": time_ns, "signal": pa.array(names[signal]), "value": value})
    batches = table.to_batches(max_chunksize=ARROW_ROWS)
    start = perf_counter()
    survey = _engine.LogSurvey()
    for batch in batches:
        survey.add(batch)
    surveyed_s = perf_counter() - start
    context = _engine.LearningContext.of(survey)
    number = {name: index for index, (name, _) in enumerate(context.signals)}
    group_of = np.array([group for _, group in context.signals], np.int32)
    signal = np.array([number[name] for name in log.signals], np.int32)[signal]
    groups = group_of[signal]
    order = np.argsort(groups, kind="stable")
    columns = [column[order] for column in (groups, time_ns, signal, value)]
    start = perf_counter()
    learner = context.learner()
    lessons: list[bytes] = []
    for at in range(0, len(order), ARROW_ROWS):
        lessons += learner.add(*(column[at : at + ARROW_ROWS] for column in columns))
    lessons += [last for last in [learner.finish()] if last is not None]
    learned_s = perf_counter() - start
    start = perf_counter()
    context.merge(lessons)
    return {
        "survey_events_per_s": len(log) / surveyed_s,
        "survey_bytes": len(survey.state()),
        "context_bytes": len(context.state()),
        "learn_events_per_s": len(log) / learned_s,
        "lesson_bytes": sum(map(len, lessons)),
        "merge_s": perf_counter() - start,
    }


def watch_part(model: NominalModel, groups: list[str], rows: Log, size: int) -> dict[str, float]:
    """Restore, observe, save: per event, and what of it is bytes."""
    start = perf_counter()
    part = model.part(groups)
    part.monitor()
    cut_s = perf_counter() - start
    state = part.monitor().state()
    restored_s = observed_s = saved_s = 0.0
    # A batch of a stream names the signals it has, not all of the plant.
    slices = [rows.slice(at, size) for at in range(0, len(rows), size)][:400]
    calls = [as_batch(each) for each in slices]
    for batch in calls:
        t0 = perf_counter()
        monitor = part.monitor(state=state)
        t1 = perf_counter()
        monitor.observe(batch)
        t2 = perf_counter()
        state = monitor.state()
        restored_s += t1 - t0
        observed_s += t2 - t1
        saved_s += perf_counter() - t2
    events = sum(map(len, calls))
    return {
        "batch": size,
        "cut_s": cut_s,
        "restore_ms": restored_s / len(calls) * 1e3,
        "observe_ms": observed_s / len(calls) * 1e3,
        "save_ms": saved_s / len(calls) * 1e3,
        "events_per_s": events / (restored_s + observed_s + saved_s),
        "state_bytes": len(state),
    }


def main() -> None:
    """Prints one JSON object a line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="main")
    parser.add_argument("--learn-events", type=int)
    parser.add_argument("--watch-events", type=int)
    given = parser.parse_args()
    run = simulate_bodyshop(
        given.size, learn_events=given.learn_events, watch_events=given.watch_events
    )
    nominal, watched = as_log(run.learn), as_log(run.watch)
    print(json.dumps({"load": os.getloadavg()[0], "events": [len(nominal), len(watched)]}))
    start = perf_counter()
    model = learn(nominal)
    whole_s = perf_counter() - start
    print(json.dumps({"whole_learn_events_per_s": len(nominal) / whole_s}))
    print(json.dumps(learn_in_parts(nominal)))
    start = perf_counter()
    monitor = model.monitor()
    monitor.observe(watched)
    whole_s = perf_counter() - start
    told = {"events_per_s": len(watched) / whole_s, "state_bytes": len(monitor.state())}
    print(json.dumps({"whole": told}))
    time_ns, signal, value = watched.columns()
    groups = model.parts()[0]
    wanted = np.array([group in groups for group in model.groups_of(watched.signals)])[signal]
    rows = Log.from_columns(time_ns[wanted], signal[wanted], value[wanted], watched.signals)
    for size in BATCHES:
        print(json.dumps(watch_part(model, groups, rows, size)))
    print(json.dumps({"load": os.getloadavg()[0]}))


if __name__ == "__main__":
    main()
