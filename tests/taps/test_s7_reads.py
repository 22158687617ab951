from hypothesis import given
from hypothesis import strategies as st

from runglight.taps.s7_address import S7Area
from runglight.taps.s7_reads import MOST_ITEMS, Item, requests

items = st.lists(
    st.builds(
        Item,
        st.sampled_from(S7Area),
        st.just(1),
        st.integers(0, 9_000),
        st.integers(1, 700),
    ),
    min_size=1,
    max_size=50,
)


@given(items, st.sampled_from([112, 240, 480, 960]))
def test_every_byte_is_read_once_in_order_and_all_fits(asked: list[Item], pdu_bytes: int) -> None:
    packed = requests(asked, pdu_bytes)

    def read(item: Item) -> list[tuple[S7Area, int]]:
        return [(item.area, byte) for byte in range(item.start, item.start + item.count)]

    wanted = [byte for item in asked for byte in read(item)]
    assert [byte for request in packed for item in request for byte in read(item)] == wanted
    for request in packed:
        assert 0 < len(request) <= MOST_ITEMS
        assert 12 + 12 * len(request) <= pdu_bytes
        replied = sum(4 + item.count + item.count % 2 for item in request[:-1])
        assert 14 + replied + 4 + request[-1].count <= pdu_bytes


def test_small_areas_share_one_request() -> None:
    asked = [Item(S7Area.INPUT, 0, 0, 27), Item(S7Area.OUTPUT, 0, 0, 4)]
    assert requests(asked, 240) == [asked]
