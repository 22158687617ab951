"""Writes change logs of a made-up body shop of the paper's main size, to learn and to watch.

Cyclic devices, no more: every device repeats its signal-states in a fixed order, with pairs that
swap in some cycles (branches), steps that take two times, and a logger that stamps 10 ms. It has
the paper's numbers of signals, devices, groups and nearly of rules, so that the tables fill up
alike; it says nothing of accuracy.
"""

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt

SIGNALS, DEVICES, GROUPS = 21_960, 1_620, 6
PERIOD_NS = 330 * 10**9
SLOT_NS = 1_150_000_000
"""Devices of a group start one after the other, so that the chain of starting signals is steady."""
TICK_NS = 10_000_000
START_NS = 1_767_592_800 * 10**9
BRANCHES = 2_200
TWO_TIMES = 7_000

KINDS = ("CLAMP", "ROBOT", "LIFTER", "SHUTTLE", "STACKER", "SEALER", "TURNTABLE", "GRIPPER")
PARTS = ("ADV_SENSOR", "RET_SENSOR", "PRT_CHK", "FORWARD_SOL", "BACKWARD_SOL", "WORK_COMP", "READY")


def device_names() -> list[str]:
    """Full names, spread evenly over the groups."""
    return [
        f"Body{device % GROUPS + 1}-ST{device // 60:02}_{KINDS[device % len(KINDS)]}{device:04}"
        for device in range(DEVICES)
    ]


def one_device(
    device: int, sizes: npt.NDArray[np.int64], cycles: int, chance: np.random.Generator
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Times (ns) and states (2 * signal of the device + value) of all cycles, one row a cycle."""
    signals = int(sizes[device])
    # The starting signal is a pulse; the others switch on in one order and off in another.
    on, off = chance.permutation(signals - 1) + 1, chance.permutation(signals - 1) + 1
    order = np.concatenate(([1, 0], 2 * on + 1, 2 * off))
    states = np.tile(order, (cycles, 1))
    for first in branch_sites(order, chance):
        swapped = chance.random(cycles) < 0.3
        states[swapped, first], states[swapped, first + 1] = order[first + 1], order[first]
    steps_s = np.concatenate(([0.0, 0.55], chance.uniform(0.5, 300 / len(order), len(order) - 2)))
    taken_s = steps_s + chance.exponential(0.03, (cycles, len(order)))
    taken_s[:, 0], taken_s[:, 1] = chance.uniform(0, 0.2, cycles), steps_s[1]
    slow = np.flatnonzero(chance.random(len(order)) < TWO_TIMES / (2 * SIGNALS))
    slow = slow[slow > 2][:5]
    taken_s[:, slow] += 4.5 * (chance.random((cycles, len(slow))) < 0.4)
    starts_ns = START_NS + PERIOD_NS * np.arange(cycles) + SLOT_NS * (device // GROUPS)
    times_ns = starts_ns[:, None] + (np.cumsum(taken_s, axis=1) * 1e9).astype(np.int64)
    return times_ns // TICK_NS * TICK_NS, states


def branch_sites(order: npt.NDArray[np.int64], chance: np.random.Generator) -> list[int]:
    """Positions whose state may swap with the next one's, apart from one another."""
    sites: list[int] = []
    for first in range(3, len(order) - 2):
        apart = not sites or first - sites[-1] > 2
        other_signal = order[first] // 2 != order[first + 1] // 2
        if apart and other_signal and chance.random() < 1.3 * BRANCHES / (2 * SIGNALS):
            sites.append(first)
    return sites


def write(path: Path, times_ns: npt.NDArray[np.int64], names: list[str], states: list[int]) -> None:
    """Writes one log."""
    rows = (
        f"{time_ns}\t{names[state >> 1]}\t{state & 1}\n"
        for time_ns, state in zip(times_ns.tolist(), states, strict=True)
    )
    with path.open("w") as file:
        file.writelines(rows)
    print(f"{path}: {len(states):,} records")


def main() -> None:
    """Writes both logs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--learn", type=int, default=3_320_000, help="records to learn")
    parser.add_argument("--watch", type=int, default=1_000_000, help="records to watch")
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    chance = np.random.default_rng(chosen.seed)
    sizes = np.full(DEVICES, SIGNALS // DEVICES)
    sizes += chance.integers(-4, 5, DEVICES)
    sizes[: abs(SIGNALS - sizes.sum())] += np.sign(SIGNALS - sizes.sum())
    cycles = -(-(chosen.learn + chosen.watch) // (2 * SIGNALS)) + 1
    names: list[str] = []
    times_ns, states = [], []
    for device, name in enumerate(device_names()):
        device_times_ns, device_states = one_device(device, sizes, cycles, chance)
        times_ns.append(device_times_ns.ravel())
        states.append(device_states.ravel() + 2 * len(names))
        names += [f"{name}-{PARTS[n % len(PARTS)]}{n:02}" for n in range(int(sizes[device]))]
    all_ns, all_states = np.concatenate(times_ns), np.concatenate(states)
    order = np.argsort(all_ns, kind="stable")
    chosen.folder.mkdir(parents=True, exist_ok=True)
    ends = {"learn": (0, chosen.learn), "watch": (chosen.learn, chosen.learn + chosen.watch)}
    for part, (first, last) in ends.items():
        rows = order[first:last]
        write(chosen.folder / f"{part}.tsv", all_ns[rows], names, all_states[rows].tolist())


if __name__ == "__main__":
    main()
