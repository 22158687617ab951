"""Signals of Ignition's tags."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def signal_names(
    paths: Mapping[int, tuple[int | None, str]], drivers: Mapping[int, str]
) -> dict[int, str]:
    """Signals of tags: folders by dashes; the system before them where two have the same path.

    A tag that was retired and made anew has another number and the same path: one signal.
    """
    systems: defaultdict[str, set[int | None]] = defaultdict(set)
    for system, path in paths.values():
        systems[path].add(system)
    return {
        tag: "-".join(
            [
                *([str(drivers.get(system or 0, system))] if len(systems[path]) > 1 else []),
                *filter(None, path.split("/")),
            ]
        )
        for tag, (system, path) in paths.items()
    }
