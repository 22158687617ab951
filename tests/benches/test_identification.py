"""The case studies, short: one seed each, the whole way over Modbus."""

from pathlib import Path

import pytest

from benches import bottling_store
from benches.bottling_cases import CASES
from benches.bottling_store import kept, until
from benches.declaring import declared
from benches.identification import judged, tally

MINUTES = 3.0


@pytest.mark.parametrize("name", CASES)
def test_the_right_address_is_found_and_recorded_once(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = CASES[name]
    recording = kept(tmp_path, case, 1, MINUTES)
    assert len(recording.scan_ns) == 181
    assert len(recording.log.signals) == 400
    # Recorded once: from now on nothing could record.
    monkeypatch.setattr(bottling_store, "recorded", None)
    again = kept(tmp_path, case, 1, MINUTES)
    assert again.sights == recording.sights
    assert len(again.sights) > 8
    events = declared(again.sights, case.meaning, again.scan_ns, 1)
    assert judged(again, case, events)["agreement"].first
    # Events that have nothing to do with it do not find it.
    minute_ns = 60_000_000_000
    others = [int(again.scan_ns[0]) + minute_ns + k * 7_300_000_000 for k in range(3)]
    assert not judged(again, case, others)["agreement"].first
    told = tally(case, [(1, again)], missed=1.0)
    assert told["scores"]["first"] == told["agreement"]["selected"] == 0
    half = until(again, 1.5)
    assert len(half.scan_ns) == 91
    assert 0 < len(half.sights) < len(again.sights)
