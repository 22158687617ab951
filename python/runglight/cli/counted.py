"""Numbers of things, as people write them."""


def counted(number: int, noun: str) -> str:
    """`1 device`, `1,620 devices`."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
