import numpy as np
import pytest

from benches.scanning import FLOORS, Scans, histogram, measure
from runglight.taps.base import Batch, Gap, Tap


def test_intervals_run_across_batches() -> None:
    scans = Scans()
    scans.add(Batch(until_ns=0, scan_ns=np.array([0, 2_000_000]), image=True))
    scans.add(Batch(until_ns=0, scan_ns=np.array([3_000_000]), marks=(Gap(0, 1, "lost"),)))
    assert scans.intervals_ms.tolist() == [2.0, 1.0]
    assert round(scans.per_second) == 667
    assert scans.gaps == 1
    assert [str(cell) for cell in histogram(scans).columns[1].cells] == ["1", "1"]


@pytest.mark.parametrize("protocol", FLOORS)
def test_every_batch_is_handed_on_and_changes_are_seen(protocol: str) -> None:
    taken: list[Batch] = []

    def take(tap: Tap, batch: Batch) -> None:
        assert tap.connection.reconnects == 0
        taken.append(batch)

    scans = measure(protocol, 0.5, take=take)
    assert sum(len(batch.scan_ns) for batch in taken) == len(scans.intervals_ms) + 1
    assert taken[0].image
    assert scans.changes > 0
