"""`rl.identify` as a program uses it; the scores themselves are tested in the engine."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import polars
import pytest

import runglight as rl
from runglight.taps.base import TapSignal
from tests.identification.machine import EPOCH, EVENTS, conveyor_log, recorded

START = datetime(2024, 1, 2, tzinfo=UTC)


def test_the_best_stands_first() -> None:
    found = rl.identify(conveyor_log(), EVENTS, tau_s=1, share=1)
    assert [each.address for each in found.first()] == ["%M25", "%MW74.0"]
    assert found[0].score_in == found[0].score_out == 0
    assert found.copies(found[0]) == ["%MW74.0"]
    assert found[1].same_as == "%M25"
    assert len(found.windows) == len(EVENTS)
    assert found.changing == len(found) == len(list(found))
    assert found.moments(1)[0].tolist() == EVENTS
    assert found.best(2) == list(found)[:2]


def test_events_are_moments_of_any_kind(tmp_path: Path) -> None:
    datetimes = [START + timedelta(seconds=(event - EPOCH) / 1e9) for event in EVENTS]
    file = tmp_path / "events.csv"
    file.write_text("time\n" + "".join(f"{each.isoformat()}\n" for each in datetimes))
    wanted = list(rl.identify(conveyor_log(), EVENTS))
    assert list(rl.identify(conveyor_log(), datetimes)) == wanted
    assert list(rl.identify(conveyor_log(), np.array(EVENTS[::-1]))) == wanted
    assert list(rl.identify(conveyor_log(), file)) == wanted


def test_it_speaks_arrow_both_ways() -> None:
    log = polars.DataFrame(conveyor_log())
    table = polars.DataFrame(rl.identify(log, EVENTS, tau_s=1, share=1))
    assert table.columns == [
        *("rank", "address", "name", "score_in", "score_out", "changes", "same_as")
    ]
    assert table["address"][0] == "%M25"
    assert table["score_in"].dtype == polars.Float64


def test_a_symbol_table_names_what_is_known(tmp_path: Path) -> None:
    table = tmp_path / "symbols.csv"
    table.write_text("address,group,device,signal\n%MW74.0,Line1,Conveyor,Running\n")
    found = rl.identify(conveyor_log(), EVENTS, symbols=table)
    assert [each.name for each in found.first()] == [None, "Line1-Conveyor-Running"]


def test_a_recording_is_searched_by_its_addresses_and_types(tmp_path: Path) -> None:
    # The word was recorded under a name, and only its lowest bit moved.
    signals = [
        TapSignal("Line1-Display-Word", "%MW74", "UINT", "memory"),
        TapSignal("%M25", "%M25", "BOOL", "memory"),
    ]
    directory = recorded(tmp_path / "line1", signals, EVENTS)
    found = rl.identify(directory, EVENTS, tau_s=1, share=1)
    names = {each.address: each.name for each in found}
    assert names == {"%MW74": "Line1-Display-Word", "%MW74.0": None, "%M25": None}


def test_a_sweep_gives_reasons() -> None:
    late = [event + 600_000_000 for event in EVENTS]
    swept = rl.sweep_tau(conveyor_log(), late)
    assert swept.tau_s >= 0.7
    assert swept.step.best is not None
    assert swept.step.best.address == "%M25"
    assert "meets 6.0 of 6 windows" in swept.reason()
    assert "0.5 s misses changes" in swept.reason()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"events": []}, "no event was declared"),
        ({"events": [5]}, r"none of the 1 events .* \(2024-01-02T00:00:00.000Z to 2024-"),
        ({"tau_s": -1}, "tau must be 0 s or more, not -1 s"),
        ({"share": 2}, "share must be more than 0 and at most 1"),
        ({"view": "up"}, "there is no view 'up'"),
        ({"label": "x"}, "give its path"),
        ({"events": [datetime(2024, 1, 2)]}, "has no time zone"),
        ({"log": [1, 2]}, "of type list is no Arrow table"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(arguments: dict[str, object], sentence: str) -> None:
    with pytest.raises(rl.InputError, match=sentence):
        rl.identify(**({"log": conveyor_log(), "events": EVENTS} | arguments))  # type: ignore[arg-type]
