"""Any file truncated or garbled: data, or one sentence that names the file. Never a traceback."""

import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import runglight as rl
from runglight.recording.read import open_recording
from tests.recording.doubles import batch, eventually, record, recorder

ROUNDS = 25
WHOLE = list(range(40))


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two segments, and a tail with a write-ahead log."""
    directory = tmp_path_factory.mktemp("sound") / "recording"
    for start in (0, 10):
        rows = [(start + n / 20, n % 4, start + n) for n in range(10)]
        record(directory, [batch(start + 1, rows, [start + 0.5])])
    with recorder(directory) as at_work:
        for start in range(20, 40, 5):
            rows = [(start + n / 20, n % 4, start + n) for n in range(5)]
            at_work.append(batch(start + 1, rows, [start + 0.5]))
            eventually(lambda: at_work.until_ns == batch(start + 1).until_ns)  # noqa: B023
        shutil.copytree(directory, directory.with_name("copy"))
    return directory.with_name("copy")


def truncated(content: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content))]


def flipped(content: bytes, chance: random.Random) -> bytes:
    garbled = bytearray(content)
    for _ in range(chance.choice([1, 1, 3, 50])):
        garbled[chance.randrange(len(garbled))] ^= chance.randrange(1, 256)
    return bytes(garbled)


def overwritten(content: bytes, chance: random.Random) -> bytes:
    start = chance.randrange(len(content))
    length = chance.randrange(1, 1 + len(content) - start)
    return (
        content[:start] + chance.choice([b"\0", b"\xff", b"x"]) * length + content[start + length :]
    )


def emptied(_content: bytes, _chance: random.Random) -> bytes:
    return b""


FILES = [
    "recording.json",
    "tail.sqlite",
    "tail.sqlite-wal",
    "segments/000001.parquet",
    "segments/000002.scans.npz",
]


@pytest.mark.parametrize("damage", [truncated, flipped, overwritten, emptied])
@pytest.mark.parametrize("file", FILES)
def test_a_damaged_file(
    sound: Path, tmp_path: Path, file: str, damage: Callable[[bytes, random.Random], bytes]
) -> None:
    assert open_recording(sound).log.columns()[2].tolist() == WHOLE
    chance = random.Random(f"{file} {damage.__name__}")
    original = (sound / file).read_bytes()
    assert original
    refused = 0
    for number in range(1 if damage is emptied else ROUNDS):
        directory = tmp_path / str(number)
        shutil.copytree(sound, directory, ignore=shutil.ignore_patterns("*-shm"))
        (directory / file).write_bytes(damage(original, chance))
        try:
            value = open_recording(directory).log.columns()[2].tolist()
        except rl.InputError as error:
            refused += 1
            sentence = str(error)
            assert str(directory) in sentence
            assert "\n" not in sentence
            if file != "recording.json":
                assert file.removesuffix("-wal") in sentence
        else:
            if file == "tail.sqlite-wal":
                # What follows a damaged frame of the log was never committed, SQLite holds.
                assert value == WHOLE[: len(value)]
            elif file != "recording.json":
                assert value == WHOLE
        going_on(directory)
        shutil.rmtree(directory)
    if file.startswith("segments") and damage is truncated:
        assert refused == ROUNDS


def going_on(directory: Path) -> None:
    """Recording on works, or is refused with a sentence."""
    refusal = None
    try:
        with recorder(directory) as again:
            again.append(batch(100, [(99, 0, 1)]))
    except rl.InputError as error:
        refusal = str(error)
    if refusal is not None:
        assert "\n" not in refusal
        assert str(directory) in refusal


def test_a_newer_recording_is_refused(tmp_path: Path) -> None:
    record(tmp_path, [batch(1)])
    text = (tmp_path / "recording.json").read_text(encoding="utf-8")
    newer = text.replace('"format": 1', '"format": 2').replace(
        '"created": "', '"created": 7, "x": "'
    )
    assert newer != text
    (tmp_path / "recording.json").write_text(newer, encoding="utf-8")
    for opened in (open_recording, recorder):
        with pytest.raises(rl.InputError, match="written by a newer runglight"):
            opened(tmp_path)


def test_the_mend_of_a_damaged_tail_works(sound: Path, tmp_path: Path) -> None:
    directory = tmp_path / "recording"
    shutil.copytree(sound, directory)
    (directory / "tail.sqlite").write_bytes(b"x" * 5000)
    with pytest.raises(rl.InputError, match=r"tail\.sqlite: is damaged .* move tail\.sqlite"):
        open_recording(directory)
    for path in directory.glob("tail.sqlite*"):
        path.rename(tmp_path / path.name)
    assert open_recording(directory).log.columns()[2].tolist() == WHOLE[:20]
