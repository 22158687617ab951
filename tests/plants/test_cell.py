"""The cell from outside: what its log shows in nominal operation, and under each fault."""

import csv
import io
from collections import Counter, defaultdict
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from runglight.plants import PLANTS, FaultLabel, PlantRun, find_fault, symbols_csv, write_symbols
from runglight.plants.cell import simulate_cell

S = 1_000_000_000
TICK_NS = 10_000_000
Transition = tuple[str, str]

LOADER_CYCLE = (
    "RET_ON BACKWARD_OFF PRT_CHK_ON FORWARD_ON RET_OFF ADV_ON FORWARD_OFF PRT_CHK_OFF BACKWARD_ON "
    "ADV_OFF"
)
CLAMP_CYCLE = (
    "OpSen1_ON OpSen2_ON OPEN_OFF CLOSE_ON OpSen1_OFF OpSen2_OFF ClsSen1_ON ClsSen2_ON CLOSE_OFF "
    "OPEN_ON ClsSen1_OFF ClsSen2_OFF"
)
ROBOT_1_CYCLE = (
    "HOME_POS_ON RUNNING_OFF RET_HOME_OFF READY_ON PRT_PICK_ON RUNNING_ON READY_OFF HOME_POS_OFF "
    "1ST_WORK_COMP_ON PRT_PICK_OFF PRT_MOVE_ON 2ND_WORK_COMP_ON PRT_MOVE_OFF RET_HOME_ON "
    "1ST_WORK_COMP_OFF 2ND_WORK_COMP_OFF"
)
DAECHA_CYCLE = "RET_ON BACKWARD_OFF FORWARD_ON RET_OFF ADV_ON FORWARD_OFF BACKWARD_ON ADV_OFF"
ROBOT_2_CYCLE = (
    "HOME_POS_ON RUNNING_OFF RET_HOME_OFF READY_ON SEAL_ON RUNNING_ON READY_OFF HOME_POS_OFF "
    "WORK_COMP_ON SEAL_OFF RET_HOME_ON WORK_COMP_OFF"
)
# the transitions that only the first cycle has: nothing switched off before it
DEVICES = {
    "PrtLDR": (LOADER_CYCLE, ("RET_ON", "PRT_CHK_ON")),
    "DCLAMP": (CLAMP_CYCLE, ("OpSen2_ON", "CLOSE_ON")),
    "RBT1": (ROBOT_1_CYCLE, ("HOME_POS_ON", "READY_ON")),
    "DCHA": (DAECHA_CYCLE, ("RET_ON", "FORWARD_ON")),
    "RBT2": (ROBOT_2_CYCLE, ("HOME_POS_ON", "READY_ON")),
}
GROUP_CYCLE = [
    "PrtLDR-RET_OFF",
    "RBT1-HOME_POS_OFF",
    "DCLAMP-OpSen1_OFF",
    "RBT1-HOME_POS_ON",
    "RBT2-HOME_POS_OFF",
    "PrtLDR-RET_ON",
    "RBT2-HOME_POS_ON",
    "DCHA-RET_OFF",
    "DCLAMP-OpSen1_ON",
    "DCHA-RET_ON",
]
GROUP_START = [
    "PrtLDR-RET_ON",
    "DCLAMP-OpSen1_ON",
    "RBT1-HOME_POS_ON",
    "DCHA-RET_ON",
    "RBT2-HOME_POS_ON",
]


def events(run: PlantRun) -> Iterator[tuple[int, str, str]]:
    """Time, device and state (`Group1-PrtLDR-RET_ON`) of every change; samples are left out."""
    values: dict[int, int] = {}
    for time_ns, number, value in zip(
        run.time_ns.tolist(), run.signal_index.tolist(), run.value.tolist(), strict=True
    ):
        if values.get(number) != value:
            values[number] = value
            name = run.signals[number]
            yield time_ns, name.split("-")[1], f"{name}_{'ON' if value else 'OFF'}"


def chains(run: PlantRun) -> dict[str, list[tuple[int, str]]]:
    """Every device's chain of states with their times, and the group's under `""`."""
    found: dict[str, list[tuple[int, str]]] = defaultdict(list)
    starting: dict[str, str] = {}
    for time_ns, device, state in events(run):
        found[device].append((time_ns, state))
        signal = state.rpartition("_")[0]
        if starting.setdefault(device, signal) == signal:
            found[""].append((time_ns, state))
    return found


def transitions(run: PlantRun) -> dict[str, list[tuple[Transition, int, float]]]:
    """Per device (and group, `""`): the transition, the time of its end, the seconds it took."""
    return {
        device: [
            ((before, after), after_ns, (after_ns - before_ns) / S)
            for (before_ns, before), (after_ns, after) in pairwise(chain)
        ]
        for device, chain in chains(run).items()
    }


class Learned:
    """What twenty nominal cycles teach: the transitions, and the longest time of each."""

    def __init__(self, run: PlantRun) -> None:
        self.longest_s: dict[tuple[str, Transition], float] = {}
        for device, chain in transitions(run).items():
            for transition, _, elapsed_s in chain:
                key = device, transition
                self.longest_s[key] = max(elapsed_s, self.longest_s.get(key, 0.0))

    def unseen(self, run: PlantRun) -> list[tuple[int, str, Transition]]:
        """Transitions never learned: time, device, transition, in time order."""
        return sorted(
            (time_ns, device, transition)
            for device, chain in transitions(run).items()
            for transition, time_ns, _ in chain
            if (device, transition) not in self.longest_s
        )

    def late(self, run: PlantRun, delta_s: float) -> list[tuple[str, Transition, float]]:
        """Known transitions that took longer than ever by more than `delta_s`, in time order."""
        found = [
            (time_ns, device, transition, elapsed_s)
            for device, chain in transitions(run).items()
            for transition, time_ns, elapsed_s in chain
            if elapsed_s > self.longest_s.get((device, transition), np.inf) + delta_s
        ]
        return [late[1:] for late in sorted(found)]


@pytest.fixture(scope="module")
def nominal() -> PlantRun:
    return simulate_cell()


@pytest.fixture(scope="module")
def learned(nominal: PlantRun) -> Learned:
    return Learned(nominal)


def full(device: str, states: str) -> list[str]:
    return [f"Group1-{device}-{state}" for state in states.split()]


def only_label(run: PlantRun) -> FaultLabel:
    (label,) = run.labels
    return label


# nominal operation


def test_the_first_rows_are_the_signals_that_are_on(nominal: PlantRun) -> None:
    first = nominal.time_ns == nominal.time_ns[0]
    names = [nominal.signals[number] for number in nominal.signal_index[first]]
    assert names == [
        "Group1-PrtLDR-RET",
        "Group1-DCLAMP-OpSen1",
        "Group1-DCLAMP-OpSen2",
        "Group1-RBT1-HOME_POS",
        "Group1-DCHA-RET",
        "Group1-RBT2-HOME_POS",
    ]
    assert nominal.value[first].tolist() == [1] * 6
    assert int(nominal.time_ns[0]) == int(np.datetime64("2026-01-05T06:00:00", "ns").astype(int))


def test_the_log_is_in_time_order_on_the_scan_grid_and_typed(nominal: PlantRun) -> None:
    assert nominal.time_ns.dtype == np.int64
    assert nominal.signal_index.dtype == np.uint32
    assert nominal.value.dtype == np.int64
    assert (np.diff(nominal.time_ns) >= 0).all()
    assert ((nominal.time_ns - nominal.time_ns[0]) % TICK_NS == 0).all()
    assert set(nominal.value.tolist()) == {0, 1}
    assert set(nominal.signal_index.tolist()) == set(range(len(nominal.signals)))


def test_the_last_row_is_a_sample_a_few_seconds_after_the_last_change(nominal: PlantRun) -> None:
    assert int(nominal.time_ns[-1]) == nominal.end_ns
    assert nominal.signal_index[-1] == 0
    changes = list(events(nominal))
    assert len(changes) == len(nominal.time_ns) - 1
    assert 2 * S < nominal.end_ns - changes[-1][0] < 10 * S


@pytest.mark.parametrize("device", DEVICES)
def test_every_device_goes_round_one_ring(nominal: PlantRun, device: str) -> None:
    cycle, (first_from, first_to) = DEVICES[device]
    ring = full(device, cycle)
    counts = Counter(transition for transition, _, _ in transitions(nominal)[device])
    first = (f"Group1-{device}-{first_from}", f"Group1-{device}-{first_to}")
    assert set(counts) == {*pairwise([*ring, ring[0]]), first}
    assert counts[first] == 1


def test_the_group_goes_round_one_ring(nominal: PlantRun) -> None:
    states = [state.removeprefix("Group1-") for _, state in chains(nominal)[""]]
    assert states == GROUP_START + GROUP_CYCLE * 20


def test_events_of_one_device_never_share_a_scan(nominal: PlantRun) -> None:
    start_ns = int(nominal.time_ns[0])
    for device in DEVICES:
        times = [time_ns for time_ns, _ in chains(nominal)[device] if time_ns > start_ns]
        assert all(after - before >= TICK_NS for before, after in pairwise(times))


def test_starting_signals_keep_well_apart_where_no_cause_orders_them(nominal: PlantRun) -> None:
    start_ns = int(nominal.time_ns[0])
    nearest_s: dict[str, float] = defaultdict(lambda: np.inf)
    for (before, after), time_ns, elapsed_s in transitions(nominal)[""]:
        if time_ns > start_ns:
            for state in (before, after):
                nearest_s[state] = min(nearest_s[state], elapsed_s)
    assert min(nearest_s.values()) > 0.2
    # the loader's way home runs beside the robots' work, and nothing orders the two
    assert nearest_s["Group1-PrtLDR-RET_ON"] > 2.5
    # the next part comes when it comes
    assert nearest_s["Group1-PrtLDR-RET_OFF"] > 6.0


def test_parts_come_after_about_30_and_60_seconds(nominal: PlantRun) -> None:
    waits = [
        elapsed_s
        for (before, after), _, elapsed_s in transitions(nominal)["PrtLDR"]
        if before.endswith("BACKWARD_OFF") and after.endswith("PRT_CHK_ON")
    ]
    short = [wait for wait in waits if abs(wait - 30) < 0.5]
    long = [wait for wait in waits if abs(wait - 60) < 0.5]
    assert (len(short), len(long), len(waits)) == (9, 10, 19)


def test_the_longest_nominal_times_are_those_of_table_4(learned: Learned) -> None:
    def longest(device: str, before: str, after: str) -> float:
        return learned.longest_s[device, (f"Group1-{device}-{before}", f"Group1-{device}-{after}")]

    assert longest("DCLAMP", "OPEN_ON", "ClsSen1_OFF") == 0.03
    assert longest("PrtLDR", "BACKWARD_ON", "ADV_OFF") == 0.04
    assert longest("RBT1", "PRT_MOVE_ON", "2ND_WORK_COMP_ON") == pytest.approx(16.0, abs=0.1)


@pytest.mark.parametrize("seed", [2, 3, 4, 5, 6])
def test_five_hundred_other_nominal_cycles_hold_no_surprise(learned: Learned, seed: int) -> None:
    run = simulate_cell(500, seed=seed)
    assert learned.unseen(run) == []
    assert learned.late(run, 0.5) == []
    states = Counter(state for _, _, state in events(run))
    assert states["Group1-PrtLDR-PRT_CHK_ON"] == 500
    assert states["Group1-RBT2-WORK_COMP_ON"] == 500
    assert run.labels == ()


def test_skipping_idle_scans_changes_nothing() -> None:
    skipped = simulate_cell(2, seed=7, fault=8, fault_cycle=1)
    scanned = simulate_cell(2, seed=7, fault=8, fault_cycle=1, skip_idle_scans=False)
    assert same(skipped, scanned)


def same(one: PlantRun, other: PlantRun) -> bool:
    return (
        np.array_equal(one.time_ns, other.time_ns)
        and np.array_equal(one.signal_index, other.signal_index)
        and np.array_equal(one.value, other.value)
        and (one.labels, one.end_ns) == (other.labels, other.end_ns)
    )


def test_a_seed_gives_one_log_and_another_seed_another() -> None:
    assert same(simulate_cell(5, seed=3), simulate_cell(5, seed=3))
    assert same(simulate_cell(seed=3, fault=12), simulate_cell(seed=3, fault=12))
    assert not same(simulate_cell(5, seed=3), simulate_cell(5, seed=4))


def test_the_start_time_only_shifts_the_log() -> None:
    early, late = simulate_cell(2, start_ns=0), simulate_cell(2, start_ns=12_345_678_900)
    assert np.array_equal(early.time_ns + 12_345_678_900, late.time_ns)
    assert np.array_equal(early.signal_index, late.signal_index)


def test_part_intervals_can_be_chosen() -> None:
    run = simulate_cell(6, part_intervals_s=(45.0,))
    waits = [
        elapsed_s
        for (_, after), _, elapsed_s in transitions(run)["PrtLDR"]
        if after.endswith("PRT_CHK_ON")
    ]
    assert waits == pytest.approx([45.0] * 6, abs=0.5)


# faults


@pytest.mark.parametrize("number", [n for n in range(1, 13) if n not in (6, 7)])
def test_nothing_differs_before_the_fault_begins(number: int) -> None:
    broken, whole = simulate_cell(seed=2, fault=number), simulate_cell(seed=2)
    began_ns = only_label(broken).time_ns
    before = int(np.searchsorted(whole.time_ns, began_ns))
    assert before > 100
    assert np.array_equal(broken.time_ns[:before], whole.time_ns[:before])
    assert np.array_equal(broken.signal_index[:before], whole.signal_index[:before])
    assert not np.array_equal(broken.time_ns, whole.time_ns)


UNKNOWN = {
    1: ("ADV_OFF", "PRT_CHK_ON", {"RET_ON"}),
    2: ("CLOSE_ON", "OpSen2_OFF", {"OpSen1_OFF"}),
    4: ("PRT_MOVE_ON", "1ST_WORK_COMP_OFF", {"2ND_WORK_COMP_ON"}),
    7: ("RET_ON", "RET_OFF", {"BACKWARD_OFF", "PRT_CHK_ON"}),
    8: ("2ND_WORK_COMP_ON", "HOME_POS_ON", {"PRT_MOVE_OFF"}),
    10: ("OpSen2_OFF", "ClsSen2_ON", {"ClsSen1_ON"}),
}


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("number", UNKNOWN)
def test_the_first_unknown_transition_is_that_of_table_4(
    learned: Learned, number: int, seed: int
) -> None:
    run = simulate_cell(seed=seed, fault=number)
    label = only_label(run)
    before, after, expected = UNKNOWN[number]
    start = f"Group1-{label.device}"
    on_device = [found for found in learned.unseen(run) if found[1]]
    time_ns, device, transition = on_device[0]
    assert device == label.device
    assert transition == label.faulty == (f"{start}-{before}", f"{start}-{after}")
    assert set(label.expected) == {(f"{start}-{before}", f"{start}-{state}") for state in expected}
    assert all((device, known) in learned.longest_s for known in label.expected)
    assert label.shown_ns == time_ns
    assert label.time_ns <= time_ns
    # the group may show it too, but not before
    assert learned.unseen(run)[0][0] >= label.time_ns


LATE = {3: (2.11, 0.03, 0.02), 9: (2.57, 0.04, 0.02), 12: (24.56, 16.01, 0.3)}


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("number", LATE)
def test_slow_actuators_show_as_late_only(learned: Learned, number: int, seed: int) -> None:
    run = simulate_cell(seed=seed, fault=number)
    label = only_label(run)
    observed_s, expected_s, tolerance_s = LATE[number]
    assert learned.unseen(run) == []
    device, transition, elapsed_s = next(
        late for late in learned.late(run, 1.5) if late[0] and late[1] == label.faulty
    )
    assert device == label.device
    assert elapsed_s == label.observed_s == pytest.approx(observed_s, abs=tolerance_s)
    assert label.expected_s == expected_s
    assert learned.longest_s[device, transition] == pytest.approx(expected_s, abs=0.1)
    on_devices = [late for late in learned.late(run, 1.5) if late[0]]
    assert on_devices[0][:2] == (device, transition)
    assert sum(late[:2] == (device, transition) for late in on_devices) == 1


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("number", "last"), [(5, "Group1-PrtLDR-FORWARD_ON"), (11, "Group1-RBT1-PRT_PICK_ON")]
)
def test_dead_actuators_stop_the_line(learned: Learned, number: int, last: str, seed: int) -> None:
    run = simulate_cell(seed=seed, fault=number)
    label = only_label(run)
    last_ns, _, state = list(events(run))[-1]
    assert state == label.last_state == last
    assert learned.unseen(run) == []
    assert run.end_ns - last_ns >= 200 * S
    assert label.shown_ns == last_ns
    assert label.observed_s == (run.end_ns - last_ns) / S
    assert list(events(run))[-2][0] < last_ns


def test_a_dead_sensor_stops_the_line_too() -> None:
    run = simulate_cell(fault=10)
    last_ns, _, state = list(events(run))[-1]
    assert run.end_ns - last_ns >= 200 * S
    parts = [after for _, _, after in events(run) if after == "Group1-PrtLDR-PRT_CHK_ON"]
    assert len(parts) == 4
    assert state == "Group1-RBT1-RUNNING_OFF"


@pytest.mark.parametrize("number", [1, 2, 3, 4, 7, 8, 9, 12])
def test_after_the_other_faults_the_line_goes_on(number: int) -> None:
    run = simulate_cell(seed=4, fault=number)
    states = Counter(state for _, _, state in events(run))
    assert states["Group1-DCHA-ADV_ON"] == 20
    assert run.end_ns - list(events(run))[-1][0] < 10 * S


def test_the_part_pattern_shifts_the_shares(learned: Learned) -> None:
    run = simulate_cell(fault=6)
    label = only_label(run)
    waits = [
        elapsed_s
        for transition, _, elapsed_s in transitions(run)["PrtLDR"]
        if transition == label.faulty
    ]
    short = [wait < 45 for wait in waits]
    assert (sum(short), len(short)) == (6, 29)
    assert sum(short[:15]) == 3
    assert learned.unseen(run) == []
    assert learned.late(run, 0.5) == []


def test_a_stuck_sensor_stays_stuck() -> None:
    run = simulate_cell(fault=2)
    label = only_label(run)
    changes = [
        time_ns for time_ns, _, state in events(run) if state.startswith("Group1-DCLAMP-OpSen1")
    ]
    assert max(changes) < label.time_ns


@pytest.mark.parametrize("number", [1, 2, 3, 4, 5, 8, 9, 10, 11, 12])
def test_a_fault_begins_in_the_cycle_asked_for(number: int) -> None:
    for cycle in (1, 6):
        run = simulate_cell(8, fault=number, fault_cycle=cycle)
        label = only_label(run)
        parts = [time_ns for time_ns, _, state in events(run) if state.endswith("LDR-FORWARD_ON")]
        # fault 5 begins with the part; the answer to it is logged two scans later at most
        assert sum(time_ns <= label.time_ns + 2 * TICK_NS for time_ns in parts) == cycle


def test_faults_by_name_and_several_at_once() -> None:
    assert same(simulate_cell(fault="open-decelerated"), simulate_cell(fault=3))
    assert same(simulate_cell(fault="3"), simulate_cell(fault=3))
    assert [label.number for label in simulate_cell(fault=(9, 3)).labels] == [3, 9]
    # 5 stops the line before 9 can begin
    assert [label.number for label in simulate_cell(fault=(5, 9)).labels] == [5]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"fault": 13}, "no fault 13"),
        ({"fault": "nonsense"}, "1 prt-chk-on-while-returning"),
        ({"cycles": 0}, "at least 1 cycle"),
        ({"cycles": 3, "fault": 1, "fault_cycle": 4}, "cycle 1 to 3"),
        ({"cycles": 3, "fault": 11, "fault_cycle": 3}, "cycle 1 to 2"),
        ({"cycles": 1, "fault": 11}, "at least 2 cycles"),
        ({"part_intervals_s": (45.0,), "fault": 6}, "one or the other"),
        ({"part_intervals_s": ()}, "pattern of part intervals is empty"),
    ],
)
def test_what_does_not_exist_is_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        simulate_cell(**arguments)  # type: ignore[arg-type]


# the registry and the symbol table


def test_the_registry_describes_the_cell(nominal: PlantRun) -> None:
    cell = PLANTS["cell"]
    assert list(cell.faults) == list(range(1, 13))
    assert len({fault.name for fault in cell.faults.values()}) == 12
    for fault in cell.faults.values():
        assert fault.sentence.endswith(".")
        assert find_fault(cell.faults, fault.name) is fault
        assert f"{fault.group}-{fault.device}-{fault.signal}" in nominal.signals
    assert same(cell.simulate(cycles=2), simulate_cell(2))


def test_the_symbol_table_names_every_signal_once(nominal: PlantRun, tmp_path: Path) -> None:
    symbols = PLANTS["cell"].symbols
    path = tmp_path / "symbols.csv"
    write_symbols(symbols, path)
    text = path.read_text(encoding="utf-8")
    assert text == symbols_csv(symbols)
    assert text.startswith("address,group,device,signal,class,type,description\n")
    rows = list(csv.DictReader(io.StringIO(text)))
    names = [f"{row['group']}-{row['device']}-{row['signal']}" for row in rows]
    assert tuple(names) == nominal.signals
    assert len({row["address"] for row in rows}) == len(rows) == 29
    for row in rows:
        assert row["address"].startswith("%IX" if row["class"] == "input" else "%QX")
        assert row["type"] == "BOOL"
        assert row["description"]
