"""Directories that imports fill: whole at every moment, and damage is told."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import runglight as rl
from runglight.log.changelog import Log
from runglight.log.imported import ImportDirectory, is_imported
from runglight.log.imported import directory as module
from runglight.log.imported.manifest import Manifest

SECOND = 1_000_000_000


def log_of(times_s: list[int], names: str = "AB") -> Log:
    count = len(times_s)
    return Log.from_columns(
        np.array(times_s, np.int64) * SECOND,
        np.arange(count, dtype=np.uint32) % len(names),
        np.array(times_s, np.int64),
        list(names),
    )


@pytest.fixture
def filled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Three segments: of two rows, of two, of one."""
    monkeypatch.setattr(module, "SEGMENT_ROWS", 2)
    path = tmp_path / "plant"
    with ImportDirectory.opened(path, "here") as directory:
        for number, times in enumerate([[1, 4], [2, 5], [3]]):
            directory.add(log_of(times, "ABC"[number:]), {"step": number})
    return path


def values(path: Path) -> list[int]:
    return [int(value) for value in rl.read_log(path).columns()[2]]


def test_segments_are_one_log_in_time_order(filled: Path) -> None:
    assert sorted(each.name for each in filled.iterdir()) == [
        *["000001.parquet", "000002.parquet", "000003.parquet"],
        "imported.json",
    ]
    log = rl.read_log(filled)
    _, signal, value = log.columns()
    assert list(value) == [1, 2, 3, 4, 5]
    assert [log.signals[each] for each in signal] == ["A", "B", "C", "B", "C"]
    assert log.path == str(filled)


def test_a_small_segment_is_replaced(filled: Path) -> None:
    with ImportDirectory.opened(filled, "here") as directory:
        assert (directory.rows, directory.bookmark) == (5, {"step": 2})
        assert directory.newest_ns == 5 * SECOND
        directory.add(log_of([6]), {"step": 3})
    assert values(filled) == [1, 2, 3, 4, 5, 6]
    assert sorted(each.name for each in filled.glob("*.parquet")) == [
        *["000001.parquet", "000002.parquet", "000004.parquet"]
    ]


def test_a_step_without_rows_moves_the_bookmark(filled: Path) -> None:
    with ImportDirectory.opened(filled, "here") as directory:
        directory.add(None, {"step": 9}, skipped=2)
    manifest = Manifest.load(filled)
    assert manifest is not None
    assert (manifest.bookmark, manifest.skipped, len(manifest.segments)) == ({"step": 9}, 2, 3)
    assert rl.read_log(filled).report.notes == ["2 rows were left out when it was imported"]


@pytest.mark.parametrize("step", ["write", "save"])
def test_a_step_that_fails_changes_nothing(
    filled: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    class Killed(BaseException):
        pass

    def killed(*_: object) -> None:
        raise Killed

    before = (filled / "imported.json").read_bytes()
    monkeypatch.setattr(*((Manifest, "save") if step == "save" else (module, "to_disk")), killed)
    with pytest.raises(Killed), ImportDirectory.opened(filled, "here") as directory:
        directory.add(log_of([6]), {"step": 3})
    monkeypatch.undo()
    assert (filled / "000004.parquet").exists()
    assert (filled / "imported.json").read_bytes() == before
    assert values(filled) == [1, 2, 3, 4, 5]
    with ImportDirectory.opened(filled, "here"):
        assert not (filled / "000004.parquet").exists()
    assert values(filled) == [1, 2, 3, 4, 5]


def test_a_first_step_that_was_killed(tmp_path: Path) -> None:
    path = tmp_path / "plant"
    path.mkdir()
    (path / "000001.parquet").write_bytes(b"PAR1 half")
    (path / ".000001.0badcafe.parquet").write_bytes(b"")
    with ImportDirectory.opened(path, "here"):
        assert list(path.iterdir()) == []


def test_directories_of_other_things(tmp_path: Path, filled: Path) -> None:
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "a.png").touch()
    with (
        pytest.raises(rl.InputError, match=r"photos: is a directory of other things \(a\.png\)"),
        ImportDirectory.opened(tmp_path / "photos", "here"),
    ):
        pass
    with (
        pytest.raises(rl.InputError, match="holds an import of here, not of there"),
        ImportDirectory.opened(filled, "there"),
    ):
        pass
    assert not is_imported(tmp_path / "photos")
    with pytest.raises(rl.InputError, match="is a directory"):
        rl.read_log(tmp_path / "photos")


def test_one_at_a_time(filled: Path) -> None:
    pytest.importorskip("fcntl")
    with (
        ImportDirectory.opened(filled, "here"),
        pytest.raises(rl.InputError, match="another import is writing to it"),
        ImportDirectory.opened(filled, "here"),
    ):
        pass


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-20])


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def foreign(path: Path) -> None:
    text = json.loads(path.read_text(encoding="utf-8"))
    text["segments"][0]["file"] = "../elsewhere.parquet"
    path.write_text(json.dumps(text), encoding="utf-8")


def miscounted(path: Path) -> None:
    text = json.loads(path.read_text(encoding="utf-8"))
    text["segments"][0]["rows"] = 7
    path.write_text(json.dumps(text), encoding="utf-8")


@pytest.mark.parametrize(
    ("file", "damage", "sentence"),
    [
        ("imported.json", cut, "imported.json: is damaged"),
        ("imported.json", emptied, "imported.json: is damaged"),
        ("imported.json", foreign, "a segment lies outside the directory"),
        ("imported.json", miscounted, "000001.parquet: is damaged (2 rows instead of 7)"),
        ("000002.parquet", Path.unlink, "its segment 000002.parquet is missing"),
        ("000002.parquet", cut, "000002.parquet: "),
    ],
)
def test_damage(filled: Path, file: str, damage: Callable[[Path], None], sentence: str) -> None:
    damage(filled / file)
    with pytest.raises(rl.InputError) as raised:
        rl.read_log(filled)
    assert sentence in str(raised.value)
