"""Mining from Python: nets, their quality, and files of them."""

from pathlib import Path

import pytest

import runglight as rl

LOOP = [["%IX0.1=0", "%QX0.0=1", "%IX0.0=1"], ["%IX0.1=0", "%QX0.0=1", "%QX0.0=1", "%IX0.0=1"]]


def test_a_mined_net_is_sound_and_follows_its_runs() -> None:
    log = rl.EventLog.from_traces(LOOP)
    net = rl.mine(log).net
    soundness, fitness, precision = net.quality(log)
    assert soundness.sound is True
    assert not soundness.problems
    assert (fitness.fitness, fitness.fitting, fitness.traces) == (1.0, 2, 2)
    assert 0.5 < precision <= 1.0
    classes = {t.label: t.signal_class for t in net.transitions if t.label}
    assert classes == {"%IX0.1=0": "input", "%QX0.0=1": "output", "%IX0.0=1": "input"}


def test_files_are_read_back(tmp_path: Path) -> None:
    log = rl.EventLog.from_traces(LOOP)
    mined = rl.mine(log)
    mined.net.write(tmp_path / "net.pnml")
    read = rl.read_net(tmp_path / "net.pnml")
    assert (read.places, read.transitions) == (mined.net.places, mined.net.transitions)
    assert (read.initial, read.last) == (mined.net.initial, mined.net.last)
    log.write(tmp_path / "log.xes")
    again = rl.read_event_log(tmp_path / "log.xes")
    assert again.sequences() == LOOP
    assert (again.activities, again.names) == (log.activities, log.names)
    mined.write_bpmn(tmp_path / "net.bpmn")
    text = (tmp_path / "net.bpmn").read_text(encoding="utf-8")
    assert text.count("<task ") == 3
    assert text.count("<exclusiveGateway ") == 2


def test_a_drawing_has_green_and_red() -> None:
    dot = rl.mine(rl.EventLog.from_traces(LOOP)).net.dot()
    assert dot.startswith("digraph")
    assert "#2da44e" in dot
    assert "#cf222e" in dot


def test_a_net_that_is_not_sound_is_explained(tmp_path: Path) -> None:
    path = tmp_path / "net.pnml"
    path.write_text(
        """<pnml><net id="n">
        <place id="s"><initialMarking><text>1</text></initialMarking></place>
        <place id="p"/><place id="q"/><place id="e"/>
        <transition id="a"><name><text>open</text></name></transition>
        <transition id="b"><name><text>skip</text></name></transition>
        <transition id="c"><name><text>close</text></name></transition>
        <arc id="1" source="s" target="a"/><arc id="2" source="a" target="p"/>
        <arc id="3" source="s" target="b"/><arc id="4" source="b" target="q"/>
        <arc id="5" source="p" target="c"/><arc id="6" source="q" target="c"/>
        <arc id="7" source="c" target="e"/></net></pnml>""",
        encoding="utf-8",
    )
    told = rl.read_net(path).soundness()
    assert told.sound is False
    assert told.problems[0] == (
        "after open the run is stuck: close waits for something that will not come"
    )


@pytest.mark.parametrize(
    ("parameters", "sentence"),
    [({"eta": 2.0}, "eta"), ({"epsilon": -0.1}, "epsilon")],
)
def test_parameters_are_shares(parameters: dict[str, float], sentence: str) -> None:
    with pytest.raises(rl.InputError, match=sentence):
        rl.mine(rl.EventLog.from_traces(LOOP), **parameters)


def test_nothing_cannot_be_mined() -> None:
    with pytest.raises(rl.InputError, match="no event"):
        rl.mine(rl.EventLog.from_traces([[]]))
