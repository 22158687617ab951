"""The engine in mode `word` against the slow reading of the paper, on random words."""

import json
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from runglight.log.changelog import Log
from runglight.model import learn_cycle
from tests.reference import cycle_word
from tests.reference.cycle_word import Reading

WIDTH = 3
SIGNALS = (*(f"I0.{bit}" for bit in range(WIDTH)), "M0.0", "M0.1")
MODES = {"work_complete": "M0.0", "manual": "M0.1"}
REGIONS: dict[str, str | list[str]] = {"r": [f"I0.{bit}" for bit in reversed(range(WIDTH))]}
SECOND_NS = 1_000_000_000

readings = st.lists(
    st.tuples(
        st.integers(0, 2**WIDTH - 1),
        st.integers(0, 1),
        st.sampled_from((0, 0, 0, 0, 0, 0, 1)),
        st.just(0),
    ),
    min_size=4,
    max_size=60,
)


def log_of(told: list[Reading]) -> Log:
    """One row per bit and reading, changed or not, a second apart."""
    time_ns, signal, value = [], [], []
    for place, (word, work, manual, _) in enumerate(told):
        bits = [word >> bit & 1 for bit in range(WIDTH)]
        for number, each in enumerate((*bits, work, manual)):
            time_ns.append((place + 1) * SECOND_NS)
            signal.append(number)
            value.append(each)
    return Log.from_columns(
        np.array(time_ns, dtype=np.int64),
        np.array(signal, dtype=np.uint32),
        np.array(value, dtype=np.int64),
        SIGNALS,
    )


def work_cycles(words: list[list[int]]) -> list[Reading]:
    """Readings that learn these words of work, with set-up at word 0 between them."""
    told: list[Reading] = [(0, 0, 0, 0)]
    for each in [[0], *words, [0]]:
        told += [(word, 1, 0, 0) for word in each]
        told.append((0, 0, 0, 0))
    return [*told, (0, 1, 0, 0)]


def number(state: str | None) -> int | None:
    """The word of `r=5`."""
    return None if state is None else int(state.partition("=")[2], 16)


def seconds(finding: dict[str, Any]) -> int:
    """Number of the reading it was found at."""
    return int(finding["time"][17:19]) + 60 * int(finding["time"][14:16]) - 1


@settings(max_examples=150, deadline=None)
@given(learned=readings, seen=readings)
def test_the_same_machines_and_findings(learned: list[Reading], seen: list[Reading]) -> None:
    machines = cycle_word.learn(learned)
    if not any(machine.initial for machine in machines.values()):
        return
    model = learn_cycle(log_of(learned), MODES, REGIONS, mode="word")
    for phase, work in (("setup", 0), ("work", 1)):
        told = model.machine("r", phase)
        weights = {(int(t["from"], 16), int(t["to"], 16)): t["weight"] for t in told["transitions"]}
        expected = machines[work]
        assert weights == {
            (before, after): weight
            for before, counts in expected.weights.items()
            for after, weight in counts.items()
        }
        states = {int(s["word"], 16): (s["initial"], s["final"]) for s in told["states"]}
        assert states == {
            word: (expected.initial[word], expected.final[word]) for word in expected.states
        }
    monitor = model.monitor()
    log = log_of(seen)
    lines = monitor.observe(log).json_lines() + monitor.finish().json_lines()
    findings = [json.loads(line) for line in lines]
    # What never ends and what comes back is beyond the paper.
    first = {f["id"]: f for f in reversed(findings) if "does not end" not in f["message"]}
    engine = [
        (
            seconds(f),
            f["kind"],
            number(f["from"]),
            [number(each["state"]) for each in f["expected"]],
        )
        for f in reversed(first.values())
        if f["state"] == "suspected"
    ]
    reference = cycle_word.watch(machines, seen, WIDTH)
    assert sorted(engine, key=str) == sorted(
        [(f.place, f.kind, f.at, f.predicted) for f in reference], key=str
    )


def test_the_example_of_the_paper() -> None:
    """Section 3.6: 52 goes on to 42 (10 times), 4a (2) or 5a (6); 4e was found."""
    words = [[0x50, 0x52, after] for after in [0x42] * 10 + [0x4A] * 2 + [0x5A] * 6]
    told = work_cycles(words)
    signals = (*(f"I0.{bit}" for bit in range(8)), "M0.0")
    time_ns, signal, value = [], [], []
    for place, (word, work, _, _) in enumerate(told):
        for index, each in enumerate((*(word >> bit & 1 for bit in range(8)), work)):
            time_ns.append((place + 1) * SECOND_NS)
            signal.append(index)
            value.append(each)
    log = Log.from_columns(
        np.array(time_ns, dtype=np.int64),
        np.array(signal, dtype=np.uint32),
        np.array(value, dtype=np.int64),
        signals,
    )
    model = learn_cycle(log, {"work_complete": "M0.0"}, {"byte": "I0"}, mode="word")
    ranked = model.candidates("byte", "52", "4e")
    assert [(each["word"], each["weight"]) for each in ranked] == [("42", 10), ("4a", 2), ("5a", 6)]
    by_word = {each["word"]: each for each in ranked}
    assert by_word["42"]["popularity"] == 10 / 18
    # The paper prints 2 / 8 and 1.06 here: it counts the bits that differ, against its Eq. (3).
    assert by_word["42"]["similarity"] == 6 / 8
    assert round(by_word["42"]["score"], 2) == 2.06
    assert by_word["42"]["differing"] == "0c"
    monitor = model.monitor()
    failing = [(0, 0), (0x50, 1), (0x52, 1), (0x4E, 1)]
    rows = [
        (place * SECOND_NS, index, each)
        for place, (word, work) in enumerate(failing, 1)
        for index, each in enumerate((*(word >> bit & 1 for bit in range(8)), work))
    ]
    columns = list(zip(*rows, strict=True))
    seen = Log.from_columns(
        np.array(columns[0], dtype=np.int64),
        np.array(columns[1], dtype=np.uint32),
        np.array(columns[2], dtype=np.int64),
        signals,
    )
    lines = monitor.observe(seen).json_lines() + monitor.finish().json_lines()
    [finding] = [json.loads(line) for line in lines]
    assert (finding["kind"], finding["rank"], finding["model"]) == ("sequence", 3, "cycle")
    assert (finding["from"], finding["to"]) == ("byte=52", "byte=4e")
    assert finding["expected"][0]["state"] == "byte=42"
    suspects = [suspect["address"] for suspect in finding["suspects"]]
    assert suspects[:2] == ["I0.3", "I0.2"]
