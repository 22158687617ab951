"""The known names nearest to one that is not known, for the end of an error sentence."""

from collections.abc import Iterable

# Below this, a likeness is chance; names this much less alike than the best are no help.
ALIKE = 0.5
MUCH_LESS_ALIKE = 0.12


def nearest(name: str, known: Iterable[str], at_most: int = 3) -> list[str]:
    """The names of `known` that resemble `name`, best first; none where nothing does."""
    # Loaded where something is not known.
    from difflib import SequenceMatcher  # noqa: PLC0415

    matcher = SequenceMatcher(b=name.casefold())
    alike: list[tuple[float, str]] = []
    for candidate in known:
        matcher.set_seq1(candidate.casefold())
        if matcher.quick_ratio() >= ALIKE and (ratio := matcher.ratio()) >= ALIKE:
            alike.append((ratio, candidate))
    alike.sort(key=lambda scored: -scored[0])
    return [name for ratio, name in alike[:at_most] if ratio > alike[0][0] - MUCH_LESS_ALIKE]


def suggestion(name: str, known: Iterable[str], at_most: int = 3) -> str:
    """` (did you mean A or B?)`, or an empty text where nothing resembles `name`."""
    matches = nearest(name, known, at_most)
    return f" (did you mean {' or '.join(matches)}?)" if matches else ""
