"""What the stream itself has to tell, in the published schema: findings of kind `gap`, all notices.

A change that could not be judged is a gap in what was watched, and is never left out in silence.
"""

from __future__ import annotations

import hashlib
import json

from runglight.moments import iso

_NOTHING: dict[str, object] = {
    "group": None,
    "device": None,
    "signal": None,
    "address": None,
    "from": None,
    "to": None,
    "expected": [],
    "observed_s": None,
    "limit_s": None,
    "rank": None,
    "suspects": [],
    "path": [],
    "snapshot_id": None,
}


def notice(time_ns: int, message: str, *told_of: object) -> str:
    """A notice as a JSON line. Of the same `told_of` it has the same id, whenever it is made."""
    named = "\0".join(map(str, ("stream", *told_of)))
    identity = hashlib.sha256(named.encode()).hexdigest()[:12]
    return json.dumps(
        {
            "id": identity,
            "incident": identity,
            "time": iso(time_ns),
            "kind": "gap",
            "severity": "notice",
            "state": "confirmed",
            "model": "plant",
            **_NOTHING,
            "message": message,
        },
        ensure_ascii=False,
    )


def late(plant: str, part: str, times_ns: list[int], judged_until_ns: int) -> str:
    """Changes came after their part had been judged beyond them."""
    oldest = times_ns[0]
    behind_s = (judged_until_ns - oldest) / 1e9
    text = (
        f"{_of(plant, part)}{_counted(len(times_ns), 'change')} came too late to be judged, "
        f"the oldest {behind_s:.1f} s; a longer delay waits for them"
    )
    return notice(judged_until_ns, text, "late", plant, part, oldest, len(times_ns))


def replaced(plant: str, part: str, time_ns: int, fingerprint: str) -> str:
    """Another model watches from here on."""
    text = (
        f"{_of(plant, part)}another model watches from here; it starts afresh, and what the last "
        "one suspected stays suspected"
    )
    return notice(time_ns, text, "replaced", plant, part, time_ns, fingerprint)


def vanished(plant: str, part: str, times_ns: list[int], fingerprint: str) -> str:
    """Changes waited for their turn while their part left the model."""
    text = (
        f"{_of(plant, part)}the model that watches now has no such part; "
        f"{_counted(len(times_ns), 'change')} that waited could not be judged"
    )
    return notice(times_ns[-1], text, "vanished", plant, part, times_ns[0], fingerprint)


def homeless(plant: str, rows: int, time_ns: int) -> str:
    """A plant of the stream has no model."""
    text = (
        f"Plant {plant} has no model: {_counted(rows, 'change')} could not be judged, and those "
        "to come are not told; learn one and start the watch with it"
    )
    return notice(time_ns, text, "homeless", plant)


def unreadable(count: int, first: str, time_ns: int) -> str:
    """Messages that are no changes."""
    text = f"{_counted(count, 'message')} could not be read and told nothing; the first {first}"
    return notice(time_ns, text, "unreadable", first)


def _of(plant: str, part: str) -> str:
    name = " ".join(each for each in (plant, part) if each)
    return f"{name}: " if name else ""


def _counted(number: int, what: str) -> str:
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"
