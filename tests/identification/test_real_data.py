"""Real controllers: a traffic signal of Oregon DOT, and a bottle filling station in Lemgo."""

import csv
from datetime import UTC, datetime

import numpy as np
import pytest

import runglight as rl
from benches.recordings import folder
from runglight.log.changelog import Log

SIGNAL = folder() / "atspm_signal"
FILLING = folder() / "vps_filling" / "Filling_ALL.module.csv"
SECOND = 1_000_000_000

# Codes of the Indiana enumeration: what begins and what ends.
CODES = {
    1: ("green", 1),
    7: ("green", 0),
    8: ("yellow", 1),
    9: ("yellow", 0),
    10: ("red clearance", 1),
    11: ("red clearance", 0),
    43: ("call", 1),
    44: ("call", 0),
    82: ("detector", 1),
    81: ("detector", 0),
}


def crossing(kinds: set[str]) -> Log:
    """The traffic signal's log, or a part of it."""
    numbers: dict[str, int] = {}
    rows: list[tuple[int, int, int]] = []
    with (SIGNAL / "sample_raw_data.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            kind, value = CODES.get(int(row["EventId"]), ("", 0))
            if kind in kinds:
                time = datetime.fromisoformat(row["TimeStamp"]).replace(tzinfo=UTC)
                number = numbers.setdefault(f"{kind} {row['Parameter']}", len(numbers))
                rows.append((round(time.timestamp() * 1000) * 1_000_000, number, value))
    time_ns, signal, value = zip(*rows, strict=True)
    return Log.from_columns(
        np.array(time_ns, np.int64),
        np.array(signal, np.uint32),
        np.array(value, np.int64),
        list(numbers),
    )


def rises(log: Log, signal: str) -> list[int]:
    """When a signal comes on."""
    time_ns, signals, value = log.columns()
    moments: list[int] = time_ns[(signals == log.signals.index(signal)) & (value == 1)].tolist()
    return moments


def declared(moments: list[int], seed: int) -> list[int]:
    """As a person would: one in twenty missed, the others up to a second late."""
    random = np.random.default_rng(seed)
    return [
        moment + round(random.uniform(0, 1) * SECOND)
        for moment in moments
        if random.uniform() > 0.05
    ]


@pytest.mark.skipif(not SIGNAL.is_dir(), reason="the data are not here")
@pytest.mark.parametrize("phase", [2, 5, 6, 8])
def test_green_starts_name_the_output_of_their_phase(phase: int) -> None:
    log = crossing({"green", "yellow", "red clearance", "call", "detector"})
    events = declared(rises(log, f"green {phase}"), seed=phase)
    assert len(events) > 70
    found = rl.identify(log, events, tau_s=2, view="rising")
    assert f"green {phase}" in [each.address for each in found.best(2)]


@pytest.mark.skipif(not SIGNAL.is_dir(), reason="the data are not here")
@pytest.mark.parametrize("phase", [2, 5, 6, 8])
def test_green_starts_name_a_detector_of_their_phase(phase: int) -> None:
    # When a phase turns green, the cars on its own detectors drive off.
    with (SIGNAL / "sample_config.csv").open(encoding="utf-8") as file:
        right = {
            f"detector {row['Parameter']}"
            for row in csv.DictReader(file)
            if int(row["Phase"]) == phase
        }
    events = rises(crossing({"green"}), f"green {phase}")
    found = rl.identify(crossing({"detector"}), events, tau_s=4, view="falling")
    assert right & {each.address for each in found.best(2)}


@pytest.mark.skipif(not FILLING.is_file(), reason="the data are not here")
def test_the_index_movements_name_the_rotary_table() -> None:
    log = rl.read_log(FILLING)
    moved = rises(log, "Rotating")
    assert len(moved) == 37
    events = declared(moved, seed=1)
    for view in ("rising", "falling"):
        found = rl.identify(log, events, tau_s=2, view=view)  # type: ignore[arg-type]
        # The program's own memory (Rotating, a bit of State) goes with it; asked for is the wire.
        wired = [each for each in found if each.address.startswith(("I_", "O_"))]
        assert wired[0].address in {"O_RotaryTable", "I_RotaryTablePosReached"}, view
        assert wired[0].rank <= 4
