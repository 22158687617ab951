"""What guards say, held against what the log did next."""

import runglight as rl
from runglight.control.decisions import Decisions
from runglight.control.guards import learn_guards
from runglight.process.token_walk import TokenWalk
from tests.process.counting_tank import RESET, changes, log_of


def test_a_decision_is_what_the_program_did() -> None:
    log = log_of(changes(8))
    runs = rl.event_log(log, reset=RESET)
    net = rl.mine(runs).net
    decisions = Decisions(learn_guards(net.engine, [log]).text, net.engine)
    walk = TokenWalk(net)
    decided = {"wait": 0, "set": 0}
    for run in runs.sequences():
        walk.restart()
        fired: list[int] = []
        for place, activity in enumerate(run):
            step = walk.step(activity)
            fired.append(step.fired[-1])
            choice = decisions.at(step.marking, fired)
            if choice is None:
                continue
            following = run[place + 1] if place + 1 < len(run) else None
            assert choice != "uncounted"
            if choice == "wait":
                assert following is None
                decided["wait"] += 1
            else:
                assert net.transitions[choice[0]].label == following
                assert choice[1] == 0
                decided["set"] += 1
            # Who has not seen the run begin does not know.
            assert decisions.at(step.marking, None) == "uncounted"
    assert decided["wait"] == runs.traces
    assert decided["set"] == 2 * runs.traces
