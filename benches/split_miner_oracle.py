"""Split Miner beside an independent implementation, on logs of random process trees.

    python -m benches.split_miner_oracle --oracle DIRECTORY --record   # its models, as recorded
    python -m benches.split_miner_oracle                               # ours beside the record

The oracle is the miner that the Simod project packages (`pip download simod`, its
`split-miner-1.7.1-all.jar`, with `javax.xml.bind:jaxb-api:2.3.1` on the class path for Java 11 and
newer), run as `-f -r -e 0.0 -p 0.5 -i N.xes -o N` on the logs that `--logs DIRECTORY` writes. It is
no dependency: what its models are worth is recorded in `tests/process/split_miner_oracle.json`,
measured by our evaluator, and a test compares.

Both models are measured as the same kind of net: every flow is a place, every gateway is silent.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import runglight as rl
from tests.process.process_trees import log as random_log

RECORD = Path(__file__).parents[1] / "tests" / "process" / "split_miner_oracle.json"
SEEDS = range(200)
SPACE = "{http://www.omg.org/spec/BPMN/20100524/MODEL}"
TOLERANCE = 1e-6


class FlowNet:
    """A BPMN model as PNML: flows are places, gateways silent transitions."""

    def __init__(self, bpmn: Path) -> None:
        process = ElementTree.parse(bpmn).getroot().find(f"{SPACE}process")
        assert process is not None
        flows = [
            (flow.get("id"), flow.get("sourceRef"), flow.get("targetRef"))
            for flow in process.iter(f"{SPACE}sequenceFlow")
        ]
        self.places: list[str] = ["source", "sink"]
        self.transitions: list[tuple[str | None, list[str], list[str]]] = []
        self.places += [f"flow {number}" for number in range(len(flows))]
        into: dict[Any, list[str]] = {}
        out: dict[Any, list[str]] = {}
        for number, (_, source, target) in enumerate(flows):
            out.setdefault(source, []).append(f"flow {number}")
            into.setdefault(target, []).append(f"flow {number}")
        for node in process:
            name = node.get("id")
            self._node(node, into.get(name, []), out.get(name, []))

    def _node(self, node: Any, into: list[str], out: list[str]) -> None:
        kind = node.tag.removeprefix(SPACE)
        if kind == "startEvent":
            self.transitions.append((None, ["source"], out))
        elif kind == "endEvent":
            self.transitions += [(None, [flow], ["sink"]) for flow in into]
        elif kind == "parallelGateway":
            self.transitions.append((None, into, out))
        elif kind in {"exclusiveGateway", "inclusiveGateway"}:
            self.transitions += [(None, [a], [b]) for a, b in product(into, out)]
        elif kind == "task":
            before, after = f"before {node.get('id')}", f"after {node.get('id')}"
            self.places += [before, after]
            self.transitions += [(None, [flow], [before]) for flow in into]
            self.transitions.append((node.get("name"), [before], [after]))
            self.transitions.append((None, [after], out))
            if node.find(f"{SPACE}standardLoopCharacteristics") is not None:
                self.transitions.append((None, [after], [before]))

    def pnml(self) -> str:
        """The text of the net."""
        marked = "<initialMarking><text>1</text></initialMarking>"
        parts = [
            f"<place id={quoteattr(place)}>{marked if place == 'source' else ''}</place>"
            for place in self.places
        ]
        for number, (label, inputs, outputs) in enumerate(self.transitions):
            name = "" if label is None else f"<name><text>{label}</text></name>"
            parts.append(f'<transition id="t{number}">{name}</transition>')
            arcs = [(quoteattr(place), f'"t{number}"') for place in inputs]
            arcs += [(f'"t{number}"', quoteattr(place)) for place in outputs]
            parts += [f'<arc id="a{number}" source={a} target={b}/>' for a, b in arcs]
        final = '<finalmarkings><marking><place idref="sink"><text>1</text></place></marking>'
        return f"<pnml><net id='n'>{''.join(parts)}{final}</finalmarkings></net></pnml>"


def measured(bpmn: Path, log: rl.EventLog) -> dict[str, Any]:
    """What a model is worth: soundness, share of traces that fit, fitness, precision."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "net.pnml"
        path.write_text(FlowNet(bpmn).pnml(), encoding="utf-8")
        soundness, fitness, precision = rl.read_net(path).quality(log)
    return {
        "sound": soundness.sound,
        "fitting": round(fitness.fitting / fitness.traces, 4),
        "fitness": round(fitness.fitness, 6),
        "precision": round(precision, 6),
    }


def ours(seed: int) -> dict[str, Any]:
    """What our model of one log is worth."""
    log = rl.EventLog.from_traces(random_log(seed))
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "model.bpmn"
        rl.mine(log).write_bpmn(path)
        return measured(path, log)


def worse(our: dict[str, Any], their: dict[str, Any]) -> bool:
    """Ours is not sound where theirs is, or loses in one measure without winning in the other.

    An unsound model can be precise by letting hardly anything happen: it is beaten by a sound one.
    """
    if bool(our["sound"]) != bool(their["sound"]):
        return not our["sound"]
    fitness, precision = (our[key] - their[key] for key in ("fitness", "precision"))
    loses = fitness < -TOLERANCE or precision < -TOLERANCE
    return loses and score(our) < score(their) - TOLERANCE


def score(of: dict[str, Any]) -> float:
    """The harmonic mean of fitness and precision."""
    total = of["fitness"] + of["precision"]
    return 2 * of["fitness"] * of["precision"] / total if total else 0.0


def compare() -> None:
    """Ours beside the record, and a line for every log in which ours is worse."""
    record: dict[str, dict[str, Any]] = json.loads(RECORD.read_text(encoding="utf-8"))
    found = {seed: ours(int(seed)) for seed in record}
    bad = [seed for seed in record if worse(found[seed], record[seed])]
    for seed in bad:
        print(f"log {seed}: ours {found[seed]}, oracle {record[seed]}")
    for name, of in (("ours", found), ("oracle", record)):
        count = len(of)
        sound = sum(bool(one["sound"]) for one in of.values())
        means = {
            key: sum(one[key] for one in of.values()) / count
            for key in ("fitting", "fitness", "precision")
        }
        shown = ", ".join(f"{key} {value:.4f}" for key, value in means.items())
        print(f"{name:7} {sound} of {count} sound; mean {shown}")
    print(f"ours is worse in {len(bad)} of {len(record)} logs")


def write_logs(directory: Path) -> None:
    """The logs for the oracle."""
    directory.mkdir(parents=True, exist_ok=True)
    for seed in SEEDS:
        rl.EventLog.from_traces(random_log(seed)).write(directory / f"{seed}.xes")


def main() -> None:
    """Writes logs, records the oracle, or compares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--logs", type=Path, help="write the logs to this directory")
    parser.add_argument("--oracle", type=Path, help="directory of the oracle's models")
    parser.add_argument("--record", action="store_true", help="measure and record them")
    chosen = parser.parse_args()
    if chosen.logs:
        write_logs(chosen.logs)
    elif chosen.record:
        rows = {
            str(seed): measured(
                chosen.oracle / str(seed), rl.EventLog.from_traces(random_log(seed))
            )
            for seed in SEEDS
        }
        lines = ",\n".join(f'"{seed}": {json.dumps(row)}' for seed, row in rows.items())
        RECORD.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
    else:
        compare()


if __name__ == "__main__":
    main()
