"""Which bytes go into which request: as few as the PDU allows."""

from collections.abc import Iterable
from dataclasses import dataclass

from runglight.taps.s7_address import S7Area

MOST_ITEMS = 20
"""Items of one read, the limit of every S7 CPU."""
# S7 header, parameters, and per item what goes with its data (see snap7.s7protocol).
_REQUEST_HEAD = 12
_REQUEST_ITEM = 12
_REPLY_HEAD = 14
_REPLY_ITEM = 4


@dataclass(frozen=True, slots=True)
class Item:
    """`count` bytes of one area from `start`."""

    area: S7Area
    db: int
    start: int
    count: int


def requests(items: Iterable[Item], pdu_bytes: int) -> list[list[Item]]:
    """The items in their order, split and packed into requests and replies of `pdu_bytes`."""
    most = pdu_bytes - _REPLY_HEAD - _REPLY_ITEM
    packed: list[list[Item]] = []
    asked = replied = 0
    for whole in items:
        for start in range(whole.start, whole.start + whole.count, most):
            count = min(most, whole.start + whole.count - start)
            item = Item(whole.area, whole.db, start, count)
            # All but the last item are filled up to an even length.
            needs = _REPLY_ITEM + count + count % 2
            full = (
                not packed
                or len(packed[-1]) == MOST_ITEMS
                or asked + _REQUEST_ITEM > pdu_bytes
                or replied + needs > pdu_bytes
            )
            if full:
                packed.append([])
                asked, replied = _REQUEST_HEAD, _REPLY_HEAD
            packed[-1].append(item)
            asked += _REQUEST_ITEM
            replied += needs
    return packed
