from pathlib import Path

from benches.kill_recording import kills


def test_killed_at_random_moments(tmp_path: Path) -> None:
    killed = kills(6, tmp_path, seed=7, longest_s=1.0)
    assert len(killed) == 6
    assert sum(each.rows for each in killed) > 6_000
    for each in killed:
        assert each.doubled == 0
        assert each.missing == 0
        assert each.lost_s <= 1.0
