"""Live watching finds what watching the same log in one piece finds."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runglight.live.batch_watcher import BatchWatcher
from runglight.log.changelog import Log
from runglight.model import NominalModel
from runglight.taps.base import Batch, Gap, TapSignal
from tests.live.double_tap import batch_of, image_of

SECOND_NS = 1_000_000_000


def named(signal: TapSignal) -> str:
    return signal.name


def watcher_of(model: NominalModel, log: Log) -> BatchWatcher:
    signals = [TapSignal(name, name) for name in log.signals]
    return BatchWatcher(model, model.monitor(), signals, named)


def kinds(lines: list[str]) -> list[str]:
    return [json.loads(line)["kind"] for line in lines]


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_any_batches_give_the_findings_of_the_whole_log(
    nominal_model: NominalModel, faulty: Log, offline: list[str], data: st.DataObject
) -> None:
    time_ns = faulty.columns()[0]
    # A batch ends where time goes on: everything up to its end is in it.
    ends = np.flatnonzero(np.diff(time_ns)) + 1
    some = st.lists(st.sampled_from(ends.tolist()), max_size=200, unique=True)
    cuts = [0, *sorted(data.draw(some)), len(faulty)]
    hurry = data.draw(st.floats(0, 1))
    watcher = watcher_of(nominal_model, faulty)
    lines = []
    for start, end in itertools.pairwise(cuts):
        last = int(time_ns[end - 1])
        following = int(time_ns[end]) if end < len(faulty) else last
        lines += watcher.take(batch_of(faulty, start, end))
        # Then time goes on without a change, to just before the next one at most.
        quiet_ns = last + int((following - 1 - last) * hurry)
        if quiet_ns > last:
            lines += watcher.take(Batch(until_ns=quiet_ns))
    lines += watcher.complete()
    assert lines == offline


def test_every_row_alone(nominal_model: NominalModel, faulty: Log, offline: list[str]) -> None:
    watcher = watcher_of(nominal_model, faulty)
    time_ns = faulty.columns()[0]
    starts = [0, *(np.flatnonzero(np.diff(time_ns)) + 1).tolist(), len(faulty)]
    lines = []
    for start, end in itertools.pairwise(starts):
        lines += watcher.take(batch_of(faulty, start, end))
    assert lines + watcher.complete() == offline


def test_signals_that_come_later_are_known_by_name(
    nominal_model: NominalModel, faulty: Log, offline: list[str]
) -> None:
    # The tap meets its signals one after the other; indices stay.
    signals: list[TapSignal] = []
    watcher = BatchWatcher(nominal_model, nominal_model.monitor(), signals, named)
    order: dict[int, int] = {}
    lines = []
    time_ns, index, value = faulty.columns()
    for time in np.unique(time_ns):
        rows = np.flatnonzero(time_ns == time)
        for each in index[rows].tolist():
            if each not in order:
                order[each] = len(signals)
                signals.append(TapSignal(faulty.signals[each], faulty.signals[each]))
        renumbered = np.array([order[each] for each in index[rows].tolist()], np.uint32)
        lines += watcher.take(Batch(int(time), time_ns[rows], renumbered, value[rows]))
    assert lines + watcher.complete() == offline


def test_a_gap_with_changes_unseen_is_a_gap(nominal_model: NominalModel, faulty: Log) -> None:
    nominal = faulty  # Up to its fault it is one.
    time_ns = nominal.columns()[0]
    cuts = np.flatnonzero(np.diff(time_ns)) + 1
    for first, second in zip(cuts[40:140:10].tolist(), cuts[47:147:10].tolist(), strict=True):
        watcher = watcher_of(nominal_model, nominal)
        lines = watcher.take(batch_of(nominal, 0, first))
        lost_ns, back_ns = int(time_ns[first - 1]) + 1, int(time_ns[second - 1]) + 1
        gap = Gap(lost_ns, back_ns, "cable pulled")
        lines += watcher.take(image_of(nominal, second, at_ns=back_ns, marks=(gap,)))
        lines += watcher.take(batch_of(nominal, second, int(cuts[160])))
        assert kinds(lines) == ["gap"]
        assert json.loads(lines[0])["severity"] == "notice"


def test_the_image_at_the_start_is_no_fault(nominal_model: NominalModel, faulty: Log) -> None:
    time_ns = faulty.columns()[0]
    cuts = (np.flatnonzero(np.diff(time_ns)) + 1).tolist()
    for cut in cuts[10:60]:
        watcher = watcher_of(nominal_model, faulty)
        lines = watcher.take(image_of(faulty, cut, at_ns=int(time_ns[cut - 1]) + 1))
        lines += watcher.take(batch_of(faulty, cut, cuts[100]))
        assert not lines


def test_a_silent_machine_stalls_by_the_taps_clock(
    nominal_model: NominalModel, faulty: Log
) -> None:
    cut = 100
    watcher = watcher_of(nominal_model, faulty)
    last_ns = int(faulty.columns()[0][cut - 1])
    assert not watcher.take(batch_of(faulty, 0, cut))
    lines = []
    for second in range(1, 240):
        lines += watcher.take(Batch(until_ns=last_ns + second * SECOND_NS))
    assert kinds(lines) == ["stall"]


def test_time_without_a_connection_is_no_stall(nominal_model: NominalModel, faulty: Log) -> None:
    cut = 100
    watcher = watcher_of(nominal_model, faulty)
    last_ns = int(faulty.columns()[0][cut - 1])
    lines = watcher.take(batch_of(faulty, 0, cut))
    back_ns = last_ns + 3600 * SECOND_NS
    gap = Gap(last_ns, back_ns, "PLC switched off")
    lines += watcher.take(image_of(faulty, cut, at_ns=back_ns, marks=(gap,)))
    lines += watcher.take(Batch(until_ns=back_ns + 100 * SECOND_NS))
    assert kinds(lines) == ["gap"]
    # It stands still ever since: that is a stall, from when it was seen again.
    lines = watcher.take(Batch(until_ns=back_ns + 200 * SECOND_NS))
    assert kinds(lines) == ["stall"]


def test_a_tap_that_breaks_its_word_does_not_end_the_watch(
    nominal_model: NominalModel, faulty: Log
) -> None:
    watcher = watcher_of(nominal_model, faulty)
    last_ns = int(faulty.columns()[0][99])
    watcher.take(batch_of(faulty, 0, 100, until_ns=last_ns + SECOND_NS))
    watcher.take(batch_of(faulty, 90, 100, until_ns=last_ns + SECOND_NS))
    assert watcher.late_rows == 10


def test_a_restored_monitor_begins_with_a_gap(nominal_model: NominalModel, faulty: Log) -> None:
    cut = 100
    before = watcher_of(nominal_model, faulty)
    before.take(batch_of(faulty, 0, cut))
    signals = [TapSignal(name, name) for name in faulty.signals]
    after = BatchWatcher(nominal_model, nominal_model.monitor(before.state()), signals, named)
    at_ns = int(faulty.columns()[0][cut + 20])
    assert kinds(after.take(image_of(faulty, cut + 21, at_ns=at_ns))) == ["gap"]
    # A clock that was set back in between: afresh, and no row is out of order.
    again = BatchWatcher(nominal_model, nominal_model.monitor(before.state()), signals, named)
    assert not again.take(image_of(faulty, 10, at_ns=int(faulty.columns()[0][10])))
    assert again.late_rows == 0


def test_an_index_beyond_the_bound_signals_is_refused(nominal_model: NominalModel) -> None:
    monitor = nominal_model.monitor()
    monitor.bind(["Group1-PrtLDR-RET"])
    one = np.array([1], np.int64)
    with pytest.raises(Exception, match="signal index 1 is not among the 1 bound signals"):
        monitor.observe_rows(one, np.array([1], np.uint32), one)
    with pytest.raises(Exception, match="not of one length"):
        monitor.observe_rows(one, np.array([0, 0], np.uint32), one)
