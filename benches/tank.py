"""The case study of Theis 2019 and what it should have shown: `python -m benches.tank`.

Traces of the three scenarios; the nets mined from them; the learned controller in the place of
each program for hours; its shadow beside the intact programs and beside ten seeded mutations.
Everything over real Modbus TCP, in virtual time.
"""

import argparse
import json
import time
from dataclasses import dataclass

from benches.tank_loop import RESET, Outcome, activities_of, at_the_tank, whole_traces
from runglight import _engine
from runglight.control.guards import LearnedGuards, learn_guards, said
from runglight.log.changelog import Log
from runglight.plants.tank import SCENARIOS, Scenario, simulate_tank
from runglight.plants.tank.mutations import Mutation, chosen, mutations

RECORDED_S = 880.0
HOUR_S = 3600.0
MUTATIONS = 10
TRAINING_RUNS = 17
EPOCHS = 200
"""The paper's five are too few for a network of this size and so few runs: see `predict`."""
PARTS = ["place", "network", "shadow", "mutations"]
OUTPUTS = ("%QX0.0", "%QX0.1")


@dataclass(frozen=True, slots=True)
class Learned:
    """What 880 s of one scenario taught."""

    name: str
    scenario: Scenario
    runs: _engine.EventLog
    traces: int
    net: _engine.PetriNet
    guards: LearnedGuards

    def controller(self) -> _engine.Controller:
        """A learned controller, decided by guards."""
        return _engine.Controller(self.net, self.guards.text)

    def by_network(self, seed: int) -> _engine.Controller:
        """One that a network decides, trained on the first 17 runs as in the paper."""
        settings = json.dumps({"epochs": EPOCHS, "seed": seed})
        training = list(range(min(TRAINING_RUNS, self.traces)))
        network = _engine.train_next(self.runs, self.net, training, settings, [], "{}")
        return _engine.Controller(self.net, None, network)

    def shadow(self) -> _engine.Shadow:
        """Its shadow."""
        return _engine.Shadow(self.net, self.guards.text)


def learned(name: str, seed: int, *, tapped: bool) -> Learned:
    """Records a scenario (through the tap, or as simulated), mines it, and learns its guards."""
    scenario = SCENARIOS[name]
    if tapped:
        log = at_the_tank(scenario.program, scenario.flows, RECORDED_S, seed=seed, tap=True).log
        assert log is not None
    else:
        run = simulate_tank(name, seed)
        log = Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
    runs = _engine.event_log(log.engine, RESET)
    net = _engine.mine(runs).net
    guards = learn_guards(net, [log])
    return Learned(name, scenario, runs, runs.traces, net, guards)


def shape(net: _engine.PetriNet) -> list[object]:
    """A net without the names of its places and transitions."""
    rows = sorted(
        (label or "", before, behind) for _, label, _, before, behind in net.transitions()
    )
    return [net.initial, net.last, rows]


def in_its_place(
    one: Learned, controller: _engine.Controller, seconds: float, seed: int, by: str
) -> None:
    """The learned controller for hours, against the program itself on the same plant."""
    name, scenario = one.name, one.scenario
    began_s = time.monotonic()
    controlled = at_the_tank(controller, scenario.flows, seconds, seed=seed)
    # The program itself needs no Modbus to be known.
    run = simulate_tank(name, seed, seconds)
    original = activities_of(run)
    # The last moments may be cut differently, and the first write has nothing before it.
    most = min(len(original), len(controlled.activities)) - 4
    same = controlled.activities[1:most] == original[1:most]
    language = set(controlled.traces) == set(whole_traces(original))
    print(
        f"  C' by {by} for {seconds / HOUR_S:g} h: {len(controlled.traces):,} runs "
        f"({len(whole_traces(original)):,} of the program), {most:,} activities, level "
        f"{controlled.lowest:.1f} to {controlled.highest:.1f}, {controlled.spilt:g} spilt, "
        f"{len(controlled.findings)} findings; sequence equal: {same}; language equal: "
        f"{language} ({controlled.scans:,} scans in {time.monotonic() - began_s:.0f} s)",
        flush=True,
    )


def beside(one: Learned, seconds: float, seed: int) -> None:
    """The shadow beside the intact program."""
    shadowed = at_the_tank(
        one.scenario.program, one.scenario.flows, seconds, seed=seed, shadow=one.shadow()
    )
    print(
        f"  shadow for {seconds / HOUR_S:g} h: {len(shadowed.findings)} disagreements in "
        f"{len(shadowed.traces):,} runs",
        flush=True,
    )
    for finding in shadowed.findings[:3]:
        print("   ", finding["message"])


def mutants(one: Learned, seed: int) -> list[Mutation]:
    """Seeded mutations that change what the program does at this plant at all."""
    scenario = one.scenario
    seconds = _cycle_s(one) * 2.5
    intact = at_the_tank(scenario.program, scenario.flows, seconds).activities
    found: list[Mutation] = []
    every = mutations(scenario.program)
    for mutation in chosen(every, len(every), seed):
        if at_the_tank(mutation.ladder, scenario.flows, seconds).activities != intact:
            found.append(mutation)
        if len(found) == MUTATIONS:
            break
    return found


def report_mutants(one: Learned, seed: int) -> None:
    """When each is reported, counted in cycles of the intact program."""
    cycle_s = _cycle_s(one)
    reported = 0
    for mutation in mutants(one, seed):
        outcome = at_the_tank(mutation.ladder, one.scenario.flows, 3 * cycle_s, shadow=one.shadow())
        reported += _tell(mutation, outcome, cycle_s)
    print(f"  mutations reported within two cycles: {reported} of {MUTATIONS}", flush=True)


def _tell(mutation: Mutation, outcome: Outcome, cycle_s: float) -> bool:
    if not outcome.findings:
        print(f"    NOT REPORTED: {mutation.sentence}")
        return False
    first = outcome.findings[0]
    at_s = _seconds(first["time"])
    print(f"    {at_s / cycle_s:4.1f} cycles: {mutation.sentence}: {first['message']}")
    return at_s <= 2 * cycle_s


def _seconds(time_text: str) -> float:
    from datetime import datetime  # noqa: PLC0415

    from runglight.plants.tank.simulate import START_NS  # noqa: PLC0415

    return datetime.fromisoformat(time_text).timestamp() - START_NS / 1e9


def _cycle_s(one: Learned) -> float:
    return RECORDED_S / (one.traces + 1)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--hours", type=float, default=10.0)
    parser.add_argument("--scenarios", nargs="*", default=list(SCENARIOS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--simulated", action="store_true", help="learn without tap and Modbus")
    parser.add_argument("--only", nargs="*", default=PARTS)
    asked = parser.parse_args()
    shapes = {}
    for name in asked.scenarios:
        one = learned(name, asked.seed, tapped=not asked.simulated)
        shapes[name] = json.dumps(shape(one.net))
        labels = {row[0]: row[1] or row[0] for row in one.net.transitions()}
        print(
            f"scenario {name}: {one.traces} whole traces in {RECORDED_S:g} s; "
            f"{len(one.net.places)} places, {len(labels)} transitions; "
            f"{one.guards.departures} departures from the net"
        )
        for point in one.guards.decisions:
            print(f"  after {point['after']}: {said(point['choice'], labels)}")

        text = _engine.structured_text_of(one.net, one.guards.text, [], "tank")
        print(f"  Structured Text: {len(text.splitlines())} lines", flush=True)
        if "place" in asked.only:
            in_its_place(one, one.controller(), asked.hours * HOUR_S, asked.seed + 1, "guards")
        if "network" in asked.only:
            controller = one.by_network(asked.seed)
            in_its_place(one, controller, asked.hours * HOUR_S, asked.seed + 1, "network")
        if "shadow" in asked.only:
            beside(one, asked.hours * HOUR_S, asked.seed + 2)
        if "mutations" in asked.only:
            report_mutants(one, asked.seed)
    if {"2", "3"} <= shapes.keys():
        print(f"nets of scenarios 2 and 3 identical: {shapes['2'] == shapes['3']}")


if __name__ == "__main__":
    main()
