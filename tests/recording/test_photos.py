from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from runglight.recording.photos import Photo, keep_photo, name_of, photos, time_of

MOMENT_NS = 1_767_225_600_123_456_789


@given(st.integers(0, 9 * 10**18))
def test_names_tell_the_time(time_ns: int) -> None:
    assert time_of(name_of(time_ns)) == time_ns


def test_names_are_readable_and_sort_by_time() -> None:
    assert name_of(MOMENT_NS) == "20260101T000000.123456789Z.jpg"
    times = [0, 5, 10**9, MOMENT_NS, MOMENT_NS + 1, 2 * MOMENT_NS]
    assert sorted(map(name_of, times)) == list(map(name_of, times))


def test_other_names_tell_no_time() -> None:
    for name in ("cat.jpg", "20261399T000000.000000000Z.jpg", "20260101T000000.1Z.jpg"):
        assert time_of(name) is None


def test_the_directory_is_its_own_index(tmp_path: Path) -> None:
    assert photos(tmp_path) == []
    later = keep_photo(tmp_path, MOMENT_NS + 10**9, b"later", ".png")
    first = keep_photo(tmp_path, MOMENT_NS, b"first")
    same = keep_photo(tmp_path, MOMENT_NS, b"of the same time")
    (tmp_path / "photos" / "Thumbs.db").write_bytes(b"not ours")
    assert photos(tmp_path) == [
        Photo(MOMENT_NS, first),
        Photo(MOMENT_NS + 10**6, same),
        Photo(MOMENT_NS + 10**9, later),
    ]
    assert first.read_bytes() == b"first"
