"""Runs of a machine from its I/O log."""

import numpy as np
import pytest

import runglight as rl


def tank() -> rl.Log:
    """Three fillings; the outputs follow the inputs in the same scan."""
    rows = [(0, "%IX0.1", 0), (0, "%QX0.0", 0)]
    for start in (10, 20, 30):
        rows += [
            (start, "%QX0.0", 1),
            (start, "%IX0.1", 0 if start > 10 else 1),
            (start + 3, "%IX0.1", 1),
            (start + 3, "%IX0.2", 1),
            (start + 5, "%QX0.0", 0),
            (start + 5, "%IX0.2", 0),
        ]
    signals = ["%IX0.1", "%IX0.2", "%QX0.0"]
    return rl.Log.from_columns(
        np.array([row[0] for row in rows], np.int64) * 1_000_000_000,
        np.array([signals.index(row[1]) for row in rows], np.uint32),
        np.array([row[2] for row in rows], np.int64),
        signals,
    )


RUN = ["%IX0.1=0", "%QX0.0=1", "%IX0.1=1 & %IX0.2=1", "%IX0.2=0", "%QX0.0=0"]


def test_runs_are_cut_at_the_reset() -> None:
    log = rl.event_log(tank(), reset="%IX0.1=0")
    assert log.sequences() == [RUN]
    assert dict(log.activities) == {
        name: "input" if name.startswith("%I") else "output" for name in RUN
    }


def test_incomplete_runs_on_demand() -> None:
    log = rl.event_log(tank(), reset="%IX0.1=0", keep_partial=True)
    assert log.sequences()[1:] == [RUN, RUN]
    assert log.traces == 3
    assert log.select([2, 1]).names == ["3", "2"]


def test_some_signals_only() -> None:
    log = rl.event_log(tank(), reset="%IX0.1=0", only=["%IX0.1"])
    assert log.sequences() == [["%IX0.1=0", "%IX0.1=1"]]


@pytest.mark.parametrize(
    ("reset", "sentence"),
    [
        ("%IX0.1", "reset '%IX0.1' must be SIGNAL=VALUE"),
        ("%IX7.1=0", "the log has no signal '%IX7.1'; it has %IX0.1, %IX0.2, %QX0.0"),
        ("%IX0.1=4", "no change to %IX0.1=4"),
        ("", "reset is empty"),
    ],
)
def test_a_reset_that_cannot_be_used(reset: str, sentence: str) -> None:
    with pytest.raises(rl.InputError, match=sentence):
        rl.event_log(tank(), reset=reset)
