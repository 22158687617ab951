"""Sealing, cut off at any point: nothing doubled, nothing lost."""

from contextlib import nullcontext
from pathlib import Path

import polars as pl
import pytest

import runglight as rl
from runglight.recording import recorder as recorder_module
from runglight.recording import segment
from runglight.recording.layout import changes_file, scans_file
from runglight.recording.read import open_recording, read_recording
from runglight.recording.recorder import SealAt
from runglight.recording.tail import Tail, read_tail
from runglight.taps.base import Gap
from tests.recording.doubles import at, batch, eventually, record, recorder

FIRST = [batch(n, [(n - 0.5, n % 4, n)], [n - 0.5, n]) for n in range(1, 6)]
SECOND = [batch(n, [(n - 0.5, n % 4, n)], [n - 0.5, n]) for n in range(11, 16)]


class CutOffError(OSError):
    """The moment at which the power goes."""


def values(directory: Path) -> list[int]:
    value: list[int] = read_recording(directory).columns()[2].tolist()
    return value


@pytest.mark.parametrize("moment", ["before", "changes written", "scans written", "forgetting"])
def test_cut_off_while_sealing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    def fails(*_arguments: object, **_options: object) -> None:
        raise CutOffError(5, moment)

    with monkeypatch.context() as cut:
        if moment == "before":
            cut.setattr(recorder_module, "seal", fails)
        elif moment == "changes written":
            cut.setattr(segment, "write_durably", fails)
        elif moment == "scans written":
            cut.setattr(
                recorder_module, "seal", lambda *arguments: (segment.seal(*arguments), fails())
            )
        else:
            cut.setattr(Tail, "seal", fails)
        with (
            pytest.raises(rl.InputError, match="cannot be written")
            if moment == "forgetting"
            else nullcontext()
        ):
            record(tmp_path, FIRST)
    left = {path.name for path in (tmp_path / "segments").iterdir()}
    assert (
        left
        == {
            "before": set(),
            "changes written": {"000001.parquet"},
            "scans written": {"000001.parquet", "000001.scans.npz"},
            "forgetting": {"000001.parquet", "000001.scans.npz"},
        }[moment]
    )
    state, blocks = read_tail(tmp_path)
    assert state.segments == 0
    assert blocks
    assert values(tmp_path) == [1, 2, 3, 4, 5]

    record(tmp_path, SECOND)
    assert values(tmp_path) == [1, 2, 3, 4, 5, 11, 12, 13, 14, 15]
    state, blocks = read_tail(tmp_path)
    assert state.segments == 1
    assert not blocks
    assert len(open_recording(tmp_path).scan_ns) == 20


def test_sealing_while_recording(tmp_path: Path) -> None:
    with recorder(tmp_path, SealAt(rows=1)) as sealing:
        for position, each in enumerate(FIRST, 1):
            sealing.append(each)
            eventually(lambda: scans_file(tmp_path, position).exists())  # noqa: B023
            assert values(tmp_path) == [1, 2, 3, 4, 5][:position]


def test_a_segment_is_a_log_of_its_own(tmp_path: Path) -> None:
    gap = Gap(at(1), at(2), "cable cut")
    record(tmp_path, [batch(1, [(0.5, 0, 1)]), batch(3, [(2.5, 3, -7)], marks=[gap])])
    path = changes_file(tmp_path, 1)
    log = rl.read_log(path)
    assert log.engine.gaps == [(at(1), at(2))]
    assert log.scan_interval_s == 0.01
    assert pl.read_parquet(path)["signal"].to_list() == ["A-B-ON", "Zähler Ω"]


def test_scans_without_a_change_are_sealed(tmp_path: Path) -> None:
    record(tmp_path, [batch(1, scans_s=[0.25, 0.5])])
    record(tmp_path, [batch(3, scans_s=[2.25, 2.5])])
    assert not changes_file(tmp_path, 1).exists()
    recording = open_recording(tmp_path)
    assert recording.scan_ns.tolist() == [at(0.25), at(0.5), at(2.25), at(2.5)]
    assert len(recording.log) == 0
