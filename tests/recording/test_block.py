import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.recording.block import Block, DamagedBlockError, pack, unpack
from runglight.taps.base import Batch
from tests.recording.doubles import batches


@given(batches())
def test_what_is_packed_is_unpacked(given: list[Batch]) -> None:
    if not given:
        return
    block = Block.of(given, [7, 5, 3, 1])
    again = unpack(pack(block))
    assert again.until_ns == given[-1].until_ns
    assert again.marks == tuple(mark for each in given for mark in each.marks)
    for name in ("time_ns", "signal", "value", "scan_ns"):
        assert getattr(again, name).tolist() == getattr(block, name).tolist()
    assert set(again.signal.tolist()) <= {7, 5, 3, 1}


@given(st.binary(max_size=200))
def test_junk_is_no_block(content: bytes) -> None:
    with pytest.raises(DamagedBlockError):
        unpack(content)


@given(st.integers(0), st.integers(1, 255))
def test_one_wrong_byte_is_noticed(place: int, flip: int) -> None:
    given = Batch(until_ns=5)
    content = bytearray(pack(Block.of([given], [])))
    content[place % len(content)] ^= flip
    try:
        again = unpack(bytes(content))
    except DamagedBlockError:
        return
    # Some bits of a zlib header mean nothing.
    assert again.until_ns == 5
