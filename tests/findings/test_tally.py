"""Findings are counted once, however often they are told."""

from runglight.findings.tally import Tally


def test_a_finding_told_again_counts_as_it_stands_at_last() -> None:
    tally = Tally()
    tally.add(["a", "b"], ["late", "stall"], ["notice", "fault"])
    tally.add(["c", "a", "c"], ["late", "late", "late"], ["anomaly", "anomaly", "notice"])
    assert tally.severities() == {"anomaly": 1, "fault": 1, "notice": 1}
    assert tally.alarms() == {"late": 1, "stall": 1}


def test_of_equally_many_the_first_told_stands_first() -> None:
    tally = Tally()
    tally.add(["a"], ["stall"], ["fault"])
    tally.add(["b"], ["late"], ["fault"])
    tally.add(["c"], ["early"], ["fault"])
    assert [kind for kind, _ in tally.alarms().most_common()] == ["stall", "late", "early"]


def test_nothing_told() -> None:
    assert not Tally().severities()
    assert not Tally().alarms()
