"""Guards: what a log shows and a net cannot say, learned, kept, and told to people."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.replacing import replacing

REACTION_S = 0.3
"""A PLC that acts within this time acts at once; longer is a timer."""


@dataclass(frozen=True, slots=True)
class LearnedGuards:
    """Guards, and how well the logs followed the net."""

    text: str
    """As the engine takes them."""
    events: int
    runs: int
    departures: int

    @property
    def decisions(self) -> list[dict[str, Any]]:
        """The markings at which the guards say something, as the engine keeps them."""
        points: list[dict[str, Any]] = json.loads(self.text)["points"]
        return [point for point in points if point["choice"] is not None]

    def save(self, path: Path) -> None:
        """Writes them as JSON; the file appears whole or not at all."""
        with replacing(path) as temporary:
            temporary.write_text(
                json.dumps(json.loads(self.text), indent=1) + "\n", encoding="utf-8"
            )


def learn_guards(
    net: _engine.PetriNet, logs: list[Log], reaction_s: float = REACTION_S
) -> LearnedGuards:
    """Learns counters and timers from I/O logs of the machine; InputError where none follows."""
    learned = json.loads(_engine.learn_guards(net, [log.engine for log in logs], reaction_s))
    return LearnedGuards(
        json.dumps(learned["guards"]), learned["events"], learned["runs"], learned["departures"]
    )


def read_guards(path: Path) -> str:
    """The text of a file of guards; InputError where it is none."""
    try:
        text = path.read_text(encoding="utf-8")
        known = json.loads(text)
    except FileNotFoundError:
        raise InputError(
            f"{path}: there are no guards here; learn some with runglight control learn LOG "
            f"--net NET -o {path}"
        ) from None
    except (UnicodeDecodeError, json.JSONDecodeError):
        raise InputError(f"{path}: these are no guards; learn them anew") from None
    if not isinstance(known, dict) or "points" not in known:
        raise InputError(f"{path}: these are no guards; learn them anew")
    return text


def said(tree: dict[str, Any] | str, labels: dict[str, str]) -> str:
    """What a decision says, in words; `labels` names the transitions."""
    if tree == "wait":
        return "wait"
    assert isinstance(tree, dict)
    if "output" in tree:
        output = tree["output"]
        delay = f" after {output['after_s']:g} s" if output["after_s"] else ""
        return f"set {labels[output['transition']]}{delay}"
    count = tree["count"]
    counter = count["counter"]
    since = counter["reset_by"]
    of = labels[counter["counts"]]
    began = "in this run" if since is None else f"since {labels[since]}"
    return (
        f"{said(count['below'], labels)}; once {of} has come {count['preset']} times {began}, "
        f"{said(count['reached'], labels)}"
    )
