"""The known names nearest to one that is not known, for the end of an error sentence."""

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(name: str, known: Iterable[str], at_most: int = 3) -> list[str]:
    """The names of `known` that resemble `name`, best first; none where nothing does."""
    by_folded: dict[str, str] = {}
    for candidate in known:
        by_folded.setdefault(candidate.casefold(), candidate)
    matches = get_close_matches(name.casefold(), list(by_folded), n=at_most, cutoff=0.5)
    return [by_folded[match] for match in matches]


def suggestion(name: str, known: Iterable[str], at_most: int = 3) -> str:
    """` (did you mean A or B?)`, or an empty text where nothing resembles `name`."""
    matches = nearest(name, known, at_most)
    return f" (did you mean {' or '.join(matches)}?)" if matches else ""
