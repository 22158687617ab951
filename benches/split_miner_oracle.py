"""Split Miner beside an independent implementation, on logs of random process trees.

    python -m benches.split_miner_oracle --oracle DIRECTORY --record   # its models, as recorded
    python -m benches.split_miner_oracle                               # ours beside the record

The oracle is the miner that the Simod project packages (`pip download simod`, its
`split-miner-1.7.1-all.jar`, with `javax.xml.bind:jaxb-api:2.3.1` on the class path for Java 11 and
newer), run as `-f -r -e 0.0 -p 0.5 -i N.xes -o N` on the logs that `--logs DIRECTORY` writes. It is
no dependency: what its models are worth is recorded in `tests/process/split_miner_oracle.json`,
measured by our evaluator, and a test compares.

Its models become nets the way ours do, and both are measured by the same evaluator.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
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


class BpmnNet:
    """A BPMN model as PNML, made as our own models become nets.

    Exclusive gateways are places (two in a row are one where that changes nothing), parallel ones
    silent transitions, and a task that is marked as a loop stands between two places of its own.
    """

    def __init__(self, bpmn: Path) -> None:
        process = ElementTree.parse(bpmn).getroot().find(f"{SPACE}process")
        assert process is not None
        nodes = {node.get("id"): node for node in process}
        flows = [
            (flow.get("sourceRef"), flow.get("targetRef"))
            for flow in process.iter(f"{SPACE}sequenceFlow")
        ]
        into = Counter(target for _, target in flows)
        out = Counter(source for source, _ in flows)
        self.places: list[str] = []
        self.transitions: list[tuple[str | None, list[str], list[str]]] = []
        kinds = {name: node.tag.removeprefix(SPACE) for name, node in nodes.items()}
        place = {
            name: f"place {name}"
            for name, kind in kinds.items()
            if kind.endswith("Event") or kind in {"exclusiveGateway", "inclusiveGateway"}
        }
        # Several flows into a task are a choice, those out of one are taken together.
        inputs: dict[Any, list[str]] = {}
        outputs: dict[Any, list[str]] = {}
        between = []
        for source, target in flows:
            if source in place and target in place:
                free = out[source] == 1 or into[target] == 1
                closed = (kinds[source] == "startEvent" and into[target] > 1) or (
                    kinds[target] == "endEvent" and out[source] > 1
                )
                if free and not closed:
                    kept, gone = place[source], place[target]
                    place = {n: kept if p == gone else p for n, p in place.items()}
                else:
                    between.append((source, target))
        for number, (source, target) in enumerate(flows):
            if source not in place and target not in place:
                self.places.append(f"flow {number}")
                outputs.setdefault(source, []).append(f"flow {number}")
                inputs.setdefault(target, []).append(f"flow {number}")
            elif source not in place:
                outputs.setdefault(source, []).append(place[target])
            elif target not in place:
                inputs.setdefault(target, []).append(place[source])
        self.places += sorted(set(place.values()))
        self.transitions += [(None, [place[a]], [place[b]]) for a, b in between]
        [self.start] = {place[name] for name, kind in kinds.items() if kind == "startEvent"}
        [self.end] = {place[name] for name, kind in kinds.items() if kind == "endEvent"}
        for name, node in nodes.items():
            if kinds[name] == "parallelGateway":
                self._transition(None, inputs[name], outputs[name])
            elif kinds[name] == "task":
                self._task(node, inputs[name], outputs[name])

    def _task(self, node: Any, inputs: list[str], outputs: list[str]) -> None:
        looped = node.find(f"{SPACE}standardLoopCharacteristics") is not None
        if len(inputs) > 1 or looped:
            before = f"before {node.get('id')}"
            self.places.append(before)
            self.transitions += [(None, [place], [before]) for place in inputs]
            inputs = [before]
        if looped:
            after = f"after {node.get('id')}"
            self.places.append(after)
            self.transitions += [(None, [after], inputs), (None, [after], outputs)]
            outputs = [after]
        self._transition(node.get("name"), inputs, outputs)

    def _transition(self, label: str | None, inputs: list[str], outputs: list[str]) -> None:
        """Every arc weighs 1: a second token for one place goes a way of its own."""
        sides: list[list[str]] = []
        for places, forward in ((inputs, False), (outputs, True)):
            side: list[str] = []
            for place in places:
                if place in side:
                    detour = f"detour {len(self.places)}"
                    self.places.append(detour)
                    ends = ([detour], [place]) if forward else ([place], [detour])
                    self.transitions.append((None, *ends))
                    side.append(detour)
                else:
                    side.append(place)
            sides.append(side)
        self.transitions.append((label, sides[0], sides[1]))

    def pnml(self) -> str:
        """The text of the net."""
        marked = "<initialMarking><text>1</text></initialMarking>"
        parts = [
            f"<place id={quoteattr(place)}>{marked if place == self.start else ''}</place>"
            for place in self.places
        ]
        for number, (label, inputs, outputs) in enumerate(self.transitions):
            name = "" if label is None else f"<name><text>{label}</text></name>"
            parts.append(f'<transition id="t{number}">{name}</transition>')
            arcs = [(quoteattr(place), f'"t{number}"') for place in inputs]
            arcs += [(f'"t{number}"', quoteattr(place)) for place in outputs]
            parts += [f'<arc id="a{number}" source={a} target={b}/>' for a, b in arcs]
        end = f"<place idref={quoteattr(self.end)}><text>1</text></place>"
        final = f"<finalmarkings><marking>{end}</marking>"
        return f"<pnml><net id='n'>{''.join(parts)}{final}</finalmarkings></net></pnml>"


def measured(net: rl.PetriNet, log: rl.EventLog) -> dict[str, Any]:
    """What a net is worth: soundness, share of traces that fit, fitness, precision."""
    soundness, fitness, precision = net.quality(log)
    return {
        "sound": soundness.sound,
        "fitting": round(fitness.fitting / fitness.traces, 4),
        "fitness": round(fitness.fitness, 6),
        "precision": round(precision, 6),
    }


def theirs(bpmn: Path, log: rl.EventLog) -> dict[str, Any]:
    """What a model of the oracle is worth."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "net.pnml"
        path.write_text(BpmnNet(bpmn).pnml(), encoding="utf-8")
        return measured(rl.read_net(path), log)


def ours(seed: int) -> dict[str, Any]:
    """What our model of one log is worth."""
    log = rl.EventLog.from_traces(random_log(seed))
    return measured(rl.mine(log).net, log)


def worse(our: dict[str, Any], their: dict[str, Any]) -> bool:
    """Ours is not sound where theirs is, or it fits fewer traces or is less precise without a gain.

    A gain in the other measure pays by the harmonic mean of fitness and precision. An unsound model
    can be precise by letting hardly anything happen: it is beaten by a sound one.
    """
    if bool(our["sound"]) != bool(their["sound"]):
        return not our["sound"]
    fitting, precision = (our[key] - their[key] for key in ("fitting", "precision"))
    if fitting >= -TOLERANCE and precision >= -TOLERANCE:
        return False
    if fitting <= TOLERANCE and precision <= TOLERANCE:
        return True
    return score(our) < score(their) - TOLERANCE


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
            str(seed): theirs(chosen.oracle / str(seed), rl.EventLog.from_traces(random_log(seed)))
            for seed in SEEDS
        }
        lines = ",\n".join(f'"{seed}": {json.dumps(row)}' for seed, row in rows.items())
        RECORD.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
    else:
        compare()


if __name__ == "__main__":
    main()
