"""`python -m benches.mined_recordings DATA`: nets of three real logs, and how good they are.

DATA holds `vps_filling`, `komax565` and `atspm_signal`, which are not part of this repository.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

import runglight as rl

FILLING = "vps_filling/Filling_ALL.module.csv"
ROTARY_TABLE = "O_RotaryTable=1"
CAPPING = ["O_RotaryTable", "I_CapScrewer_Down", "I_CapScrewer_Up", "O_CapScrewDown", "O_CloseCap"]
# Indiana high-resolution enumeration: begin of green, yellow, end of yellow and of red clearance.
PHASE_EVENTS = {"1": "green", "8": "yellow", "9": "yellow ends", "11": "red ends"}


def filling(data: Path) -> Iterator[tuple[str, rl.EventLog]]:
    """A bottle filling line: a run is one index of its rotary table."""
    log = rl.read_log(data / FILLING)
    yield "filling line, all signals", rl.event_log(log, reset=ROTARY_TABLE)
    yield "filling line, cap screwer", rl.event_log(log, reset=ROTARY_TABLE, only=CAPPING)


def komax(data: Path) -> Iterator[tuple[str, rl.EventLog]]:
    """A wire crimping machine: a run is one job."""
    jobs: dict[str, list[str]] = {}
    for path in sorted((data / "komax565").glob("*/*/Producti.sdc")):
        name = ""
        for line in path.read_text(encoding="latin-1").splitlines():
            if line.startswith("["):
                name = line.strip("[] \t")
            elif line.startswith("Job=") and name != "Counter":
                jobs.setdefault(line.removeprefix("Job="), []).append(name)
    yield "crimping machine, jobs", rl.EventLog.from_traces(list(jobs.values()))


def signal(data: Path) -> Iterator[tuple[str, rl.EventLog]]:
    """A traffic signal: a run begins with the green of phase 2."""
    runs: list[list[str]] = []
    with (data / "atspm_signal" / "sample_raw_data.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if (event := PHASE_EVENTS.get(row["EventId"])) is None:
                continue
            name = f"phase {row['Parameter']} {event}"
            if name == "phase 2 green":
                runs.append([])
            if runs:
                runs[-1].append(name)
    yield "traffic signal, phases", rl.EventLog.from_traces(runs[:-1])


def main() -> None:
    """Prints a table; with --svg DIR draws the smaller nets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--svg", type=Path)
    chosen = parser.parse_args()
    print("log | η | runs | events | activities | transitions | sound | fitness | fit | precision")
    for source in (filling, komax, signal):
        for name, log in source(chosen.data):
            for eta in (0.0, 0.4):
                net = rl.mine(log, eta=eta).net
                quality = net.quality(log)
                fitness = quality.fitness
                print(
                    f"{name} | {eta} | {log.traces} | {len(log)} | {len(log.activities)} | "
                    f"{len(net.transitions)} | {quality.soundness.sound} | "
                    f"{fitness.fitness:.4f} | {fitness.fitting} | {quality.precision:.4f}",
                    flush=True,
                )
                if chosen.svg and len(net.transitions) < 60:
                    file = f"{name.replace(', ', '-').replace(' ', '-')}-{eta}.svg"
                    (chosen.svg / file).write_text(net.svg(), encoding="utf-8")


if __name__ == "__main__":
    main()
