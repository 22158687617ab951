"""Ranges of addresses as people write them: `0-99,200,300-310`."""

from collections.abc import Iterable, Iterator

from runglight.errors import InputError


def parse_ranges(text: str, where: str, most: int = 65_535) -> list[range]:
    """Ascending ranges that neither meet nor overlap; InputError names `where`."""
    numbers: list[tuple[int, int]] = []
    for part in text.split(","):
        first, dash, last = (piece.strip() for piece in part.partition("-"))
        last = last if dash else first
        if not (_is_number(first) and _is_number(last)):
            raise InputError(
                f"{where}: {part.strip()!r} is no range of addresses; write for example 0-99,200"
            )
        if int(first) > int(last):
            raise InputError(f"{where}: {part.strip()} runs backwards; write {last}-{first}")
        if int(last) > most:
            raise InputError(f"{where}: {last} is too large; addresses end at {most}")
        numbers.append((int(first), int(last) + 1))
    merged: list[range] = []
    for start, stop in sorted(numbers):
        if merged and start <= merged[-1].stop:
            merged[-1] = range(merged[-1].start, max(stop, merged[-1].stop))
        else:
            merged.append(range(start, stop))
    return merged


def split(ranges: Iterable[range], most: int) -> Iterator[range]:
    """The same addresses in ranges of at most `most`."""
    for whole in ranges:
        for start in range(whole.start, whole.stop, most):
            yield range(start, min(start + most, whole.stop))


def spelled(addresses: Iterable[int]) -> str:
    """`0-99, 200` of ascending addresses."""
    runs: list[list[int]] = []
    for address in addresses:
        if runs and address == runs[-1][1] + 1:
            runs[-1][1] = address
        else:
            runs.append([address, address])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in runs)


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < 10
