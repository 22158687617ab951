"""What may come next in a run that goes on, and how surely."""

from __future__ import annotations

import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from runglight.process.event_log import read_event_log

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.process.next_activity import NextActivity

MOST_EVENTS = 2_000


def chances(network: NextActivity, run: Sequence[tuple[int, str]]) -> list[tuple[str, float]]:
    """Every activity and how probable it is as the next one, the likeliest first.

    `run` holds time (nanoseconds) and activity of each event since the run opened. The network
    tells how probable an event was that came: every activity is put to it as if it had come.
    """
    if not run or len(run) > MOST_EVENTS:
        return []
    end_ns = run[-1][0]
    with tempfile.TemporaryDirectory(prefix="runglight-") as name:
        path = Path(name) / "run.xes"
        path.write_text(
            _xes([[*run, (end_ns, activity)] for activity in network.activities]), encoding="utf-8"
        )
        imagined = read_event_log(path)
    told = network.foretell(imagined)
    names = [activity for activity, _ in imagined.activities]
    found = {
        names[came]: float(probability)
        for trace, event, came, probability in zip(
            told["trace"], told["event"], told["came"], told["probability"], strict=True
        )
        if event == len(run) and names[came] == network.activities[trace]
    }
    return sorted(found.items(), key=lambda each: -each[1])


def _xes(traces: Sequence[Sequence[tuple[int, str]]]) -> str:
    parts = ['<?xml version="1.0" encoding="UTF-8"?>\n<log xes.version="1.0">']
    for number, trace in enumerate(traces):
        parts.append(f'<trace><string key="concept:name" value="{number}"/>')
        for time_ns, activity in trace:
            seconds, rest = divmod(time_ns, 1_000_000_000)
            moment = datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%S")
            parts.append(
                f'<event><string key="concept:name" value={quoteattr(activity)}/>'
                f'<date key="time:timestamp" value="{moment}.{rest:09d}Z"/></event>'
            )
        parts.append("</trace>")
    parts.append("</log>")
    return "\n".join(parts)
