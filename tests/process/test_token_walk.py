"""Tokens after every event, held against what the engine's own replay counts."""

import random

import pytest

import runglight as rl
from runglight.process.departures import departure
from runglight.process.token_walk import TokenWalk
from tests.process.counting_tank import RESET, changes, log_of
from tests.process.process_trees import play, tree

RUN = ["a", "b", "c", "d"]


def chain() -> rl.PetriNet:
    return rl.mine(rl.EventLog.from_traces([RUN])).net


def test_a_run_that_fits_moves_one_token_to_the_end() -> None:
    net = chain()
    steps = TokenWalk(net).walk(RUN)
    assert len(steps) == 5
    assert not any(step.departs for step in steps)
    assert [sum(step.marking.values()) for step in steps] == [1] * 5
    assert [net.last[place] for place in steps[-1].marking] == [1]
    fired = [net.transitions[step.fired[-1]].label for step in steps[:-1]]
    assert fired == RUN


def test_what_the_net_does_not_allow_misses_a_token() -> None:
    net = chain()
    steps = TokenWalk(net).walk(["a", "c", "b", "d"])
    assert [step.departs for step in steps] == [False, True, False, False, True]
    assert len(steps[1].missing) == 1
    assert steps[4].remaining


def test_an_activity_of_another_machine_is_told_and_moves_nothing() -> None:
    steps = TokenWalk(chain()).walk(["a", "x", "b", "c", "d"])
    assert [step.known for step in steps] == [True, False, True, True, True, True]
    assert steps[1].marking == steps[0].marking
    assert not steps[-1].departs


@pytest.mark.parametrize("seed", range(12))
def test_it_finds_a_way_wherever_the_engine_does(seed: int) -> None:
    grown, chance = tree(seed, 9), random.Random(seed)
    log = rl.EventLog.from_traces([play(grown, chance) for _ in range(40)])
    net = rl.mine(log, eta=0.4 if seed % 2 else 0.0).net
    walk = TokenWalk(net)
    looked = 0
    for run in {tuple(run) for run in log.sequences()}:
        fits = net.fitness(rl.EventLog.from_traces([run])).fitting == 1
        assert fits == (not any(step.departs for step in walk.walk(run))), run
        looked += 1
    assert looked


def test_a_choice_is_settled_by_what_comes_later() -> None:
    # Twice the same activity: only the one after it tells which branch it was.
    log = rl.EventLog.from_traces([["a", "b", "c"], ["a", "d", "c"], ["a", "b", "b", "c"]])
    walk = TokenWalk(rl.mine(log).net)
    for run in log.sequences():
        assert not any(step.departs for step in walk.walk(run))


def test_it_takes_up_the_net_anywhere() -> None:
    net = rl.mine(rl.event_log(log_of(changes(3)), reset=RESET)).net
    walk = TokenWalk(net)
    assert walk.anywhere()
    assert not walk.sure
    walk.step("%IX0.0=1")
    assert walk.sure
    assert [net.transitions[number].label for number in walk.enabled()] == ["%QX0.0=0 & %QX0.1=1"]


def test_where_a_run_departs_is_told() -> None:
    net = chain()
    walk = TokenWalk(net)
    assert departure(walk, net, RUN) is None
    found = departure(walk, net, ["a", "c", "d"])
    assert found is not None
    assert (found.event, found.activity, found.allowed, found.known) == (1, "c", ["b"], True)
    ended = departure(walk, net, ["a", "b"])
    assert ended is not None
    assert (ended.event, ended.activity, ended.allowed) == (2, None, ["c"])
