"""The case studies of Cadiou 2019: `python -m benches.identification [--seeds N] [--publish]`.

Records the bottling machine over Modbus TCP (two cases, three minutes each, once a second), lets
somebody declare what the photos show, with misses and delays, and counts how often the right
addresses are ranked first. What was recorded is kept in benches/results/identification: started
again it goes on, and `--part 1/2 --record` in one terminal and `--part 2/2 --record` in another
share the work. `--publish` makes docs/reference/identification.* of the result.
"""

import argparse
import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

import runglight as rl
from benches import identification_page
from benches.bottling_cases import CASES, Case, Recorded
from benches.bottling_store import kept, until
from benches.declaring import declared
from runglight.identification.identify import Identification, Order

FOLDER = Path(__file__).parent / "results" / "identification"
SEEDS = 200
SEEDS_OF_LENGTHS = 30
MINUTES = 3.0

MISSED = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5)
OFFSETS_S = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
LENGTHS_MINUTES = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0)

ORDERS: tuple[Order, ...] = ("scores", "agreement")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an identification gave."""

    first: bool
    """A right address is ranked first, alone or beside others that change in the same scans."""
    rank: int | None
    """Of the best right address; None where none was selected."""
    named: str
    """One that is ranked first although it is wrong; else empty."""


def outcome(found: Identification, case: Case) -> Outcome:
    """Judges what was found by the machine's truth table."""
    right = {each.same_as for each in found if each.address in case.meaning.addresses}
    ranks = [each.rank for each in found if each.same_as in right]
    wrong = [each.address for each in found.first() if each.same_as not in right]
    rank = min(ranks, default=None)
    return Outcome(rank == 1 and not wrong, rank, wrong[0] if wrong else "")


def judged(recording: Recorded, case: Case, events_ns: list[int]) -> dict[str, Outcome]:
    """The outcome of each order; nothing right where nothing was declared."""
    if not events_ns:
        return dict.fromkeys(ORDERS, Outcome(False, None, ""))
    events = np.array(events_ns, np.int64)
    return {
        order: outcome(rl.identify(recording.log, events, tau_s=case.tau_s, order=order), case)
        for order in ORDERS
    }


Trials = list[tuple[int, Recorded]]
"""Seeds, and what was recorded with each."""


def tally(case: Case, trials: Trials, **error: float) -> dict[str, Any]:
    """Over several recordings, declared with an error: how often right, and what was wrong."""
    outcomes = [
        judged(each, case, declared(each.sights, case.meaning, each.scan_ns, seed, **error))
        for seed, each in trials
    ]
    return {"seeds": len(outcomes)} | {
        order: _told([each[order] for each in outcomes]) for order in ORDERS
    }


def _told(outcomes: list[Outcome]) -> dict[str, Any]:
    ranks = [each.rank for each in outcomes if each.rank is not None]
    return {
        "first": sum(each.first for each in outcomes),
        "in_first_five": sum(rank <= 5 for rank in ranks),
        "selected": len(ranks),
        "wrong": dict(Counter(each.named for each in outcomes if each.named)),
    }


def study(case: Case, seeds: int, seeds_of_lengths: int) -> dict[str, Any]:
    """One case: as it is, and with more and more error."""
    trials = [(seed, kept(FOLDER, case, seed, MINUTES)) for seed in range(seeds)]
    longest = LENGTHS_MINUTES[-1]
    long_ones = [(seed, kept(FOLDER, case, seed, longest)) for seed in range(seeds_of_lengths)]
    lengths = {
        f"{minutes:g}": tally(case, [(seed, until(each, minutes)) for seed, each in long_ones])
        for minutes in LENGTHS_MINUTES
    }
    return {
        "tau_s": case.tau_s,
        "study": tally(case, trials),
        "missed": {f"{each:g}": tally(case, trials, missed=each) for each in MISSED},
        "offset_s": {f"{each:g}": tally(case, trials, offset_s=each) for each in OFFSETS_S},
        "length_minutes": lengths,
    }


def record_part(part: str, seeds: int, seeds_of_lengths: int) -> None:
    """Records what is not there yet; `part` is which share of the seeds, `1/2`."""
    own, of = (int(number) for number in part.split("/"))
    for seed in range(own - 1, seeds, of):
        for case in CASES.values():
            kept(FOLDER, case, seed, MINUTES)
    for seed in range(own - 1, seeds_of_lengths, of):
        for case in CASES.values():
            kept(FOLDER, case, seed, LENGTHS_MINUTES[-1])


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--seeds-of-lengths", type=int, default=SEEDS_OF_LENGTHS)
    parser.add_argument("--record", action="store_true", help="record only")
    parser.add_argument("--part", default="1/1", help="1/2: the first of two shares of the seeds")
    parser.add_argument("--publish", action="store_true", help="docs/reference/identification.*")
    asked = parser.parse_args()
    if asked.record:
        record_part(asked.part, asked.seeds, asked.seeds_of_lengths)
        return
    cases = {case.name: study(case, asked.seeds, asked.seeds_of_lengths) for case in CASES.values()}
    result = {"minutes": MINUTES, "cases": cases}
    (FOLDER / "study.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    for table in identification_page.tables(result):
        Console().print(table.rich())
    if asked.publish:
        identification_page.publish(FOLDER)


if __name__ == "__main__":
    main()
