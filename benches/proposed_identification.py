"""Identification without anybody's events: `python -m benches.proposed_identification [--seeds N]`.

The photos of the case studies are searched for events (`runglight identify --propose`): bottles
behind station 2 by their look, the belt by its motion. Counts how often those alone give the same
first rank as the machine's truth. Photos are taken at the times of the scans, as a camera beside
the recorder would (tests/recording/test_photographed_plant.py shows that they are the same).
"""

import argparse
import json
import tempfile
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benches.bottling_cases import CASES, Case, Integers, Recorded
from benches.bottling_store import kept
from benches.identification import FOLDER, MINUTES, judged
from runglight.identification.proposal import propose_events
from runglight.plants.bottling import RunningBottling
from runglight.plants.bottling.picture import BEHIND_STATION_2, BELT_RECTANGLE, Rectangle
from runglight.plants.bottling.simulate import START_NS
from runglight.plants.photo_folder import PhotoFolder
from runglight.recording.layout import PHOTOS

SEEDS = 50

WATCHED: dict[str, tuple[Rectangle, Literal["look", "motion"], str]] = {
    "parts": (BEHIND_STATION_2, "look", "away"),
    "conveyor": (BELT_RECTANGLE, "motion", "any"),
}
"""Rectangle, what counts as an event in it, and the label of those that are taken."""


def photograph(case: Case, seed: int, recording: Recorded, directory: Path) -> None:
    """The photos that belong to the scans of a recording."""
    plant = RunningBottling(START_NS, seed, production_s=case.production_s)
    folder = PhotoFolder(directory / PHOTOS)
    for scan_ns in recording.scan_ns.tolist():
        plant.advance(scan_ns)
        folder.put(plant.expose()())


def proposed(case: Case, seed: int) -> Integers:
    """The events of one seed, taken from its photos."""
    path = FOLDER / f"events-{case.name}-{seed:03d}.json"
    if not path.exists():
        rectangle, by, label = WATCHED[case.name]
        with tempfile.TemporaryDirectory() as name:
            photograph(case, seed, kept(FOLDER, case, seed, MINUTES), Path(name))
            events = propose_events(name, rectangle, by=by).labelled(label)
        path.write_text(json.dumps(events.time_ns.tolist()), encoding="utf-8")
    return np.array(json.loads(path.read_text(encoding="utf-8")), np.int64)


def trial(case: Case, seed: int) -> dict[str, Any]:
    """What the events of one seed lead to."""
    recording, events = kept(FOLDER, case, seed, MINUTES), proposed(case, seed)
    seen = sum(sight.what in case.meaning.seen_as for sight in recording.sights)
    outcomes = judged(recording, case, events.tolist())
    told: dict[str, Any] = {"case": case.name, "seed": seed, "seen": seen, "proposed": len(events)}
    return told | {
        order: {"first": each.first, "rank": each.rank, "wrong": each.named}
        for order, each in outcomes.items()
    }


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--part", default="1/1", help="1/2: the first of two shares of the seeds")
    asked = parser.parse_args()
    own, of = (int(number) for number in asked.part.split("/"))
    trials: list[dict[str, Any]] = []
    for seed in range(own - 1, asked.seeds, of):
        for case in CASES.values():
            trials.append(trial(case, seed))
            print(json.dumps(trials[-1]), flush=True)
    if of == 1:
        (FOLDER / "proposed.json").write_text(json.dumps(trials) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
