"""Incidents by ISA-18.2: seen or not, back or not, shelved or not."""

import datetime
import json
from pathlib import Path

import pytest

from runglight.findings.acts import Act, Acts
from runglight.server.incidents import Incidents
from runglight.server.lights import trouble

NOON = datetime.datetime(2026, 1, 5, 12, tzinfo=datetime.UTC)


def line(name: str = "a", *, incident: str = "i", **changes: object) -> str:
    finding = {
        "id": name,
        "incident": incident,
        "time": "2026-01-05T11:59:00Z",
        "kind": "transition",
        "severity": "fault",
        "state": "suspected",
        "model": "device",
        "message": "it did",
        "group": "G",
        "device": "D",
    }
    return json.dumps(finding | changes)


def act(deed: str, incident: str = "i", until: str | None = None) -> Act:
    return Act(incident, deed, "Ada", "2026-01-05T12:00:00Z", until)  # type: ignore[arg-type]


@pytest.fixture
def incidents() -> Incidents:
    incidents = Incidents(lambda: NOON)
    incidents.take([line()])
    return incidents


def state(incidents: Incidents, name: str = "i") -> str:
    incident = incidents.get(name)
    assert incident is not None
    return incidents.state(incident)


def test_the_four_corners(incidents: Incidents) -> None:
    assert state(incidents) == "unacknowledged"
    incidents.act([act("acknowledge")])
    assert state(incidents) == "acknowledged"
    incidents.take([line(state="returned")])
    assert state(incidents) == "closed"


def test_back_before_anybody_looked(incidents: Incidents) -> None:
    incidents.take([line(state="returned")])
    assert state(incidents) == "returned"
    incidents.act([act("acknowledge")])
    assert state(incidents) == "closed"


def test_it_stands_as_long_as_one_of_its_faults_does(incidents: Incidents) -> None:
    incidents.take([line("b", state="suspected"), line("a", state="returned")])
    assert state(incidents) == "unacknowledged"
    incidents.take([line("b", state="returned")])
    assert state(incidents) == "returned"


def test_what_takes_no_time_does_not_stand() -> None:
    incidents = Incidents(lambda: NOON)
    incidents.take([line(kind="late", state="confirmed", severity="anomaly")])
    assert state(incidents) == "returned"


def test_a_shelf_holds_for_its_time_and_for_what_is_alike(incidents: Incidents) -> None:
    incidents.act([act("shelve", until="2026-01-05T13:00:00Z")])
    incidents.take([line("b", incident="again"), line("c", incident="else", device="E")])
    assert [state(incidents, name) for name in ("i", "again", "else")] == [
        "shelved",
        "shelved",
        "unacknowledged",
    ]
    later = Incidents(lambda: NOON + datetime.timedelta(hours=2))
    later.take([line()])
    later.act([act("shelve", until="2026-01-05T13:00:00Z")])
    assert state(later) == "unacknowledged"
    assert later.shelf_ends() == ["i"]
    assert later.shelf_ends() == []


def test_a_shelf_can_be_emptied(incidents: Incidents) -> None:
    incidents.act([act("shelve", until="2026-01-05T13:00:00Z")])
    incidents.act([act("unshelve")])
    assert state(incidents) == "unacknowledged"


def test_who_and_when_is_kept(incidents: Incidents) -> None:
    incidents.act([act("acknowledge")])
    [summary] = incidents.summaries()
    assert summary.acknowledged is not None
    assert (summary.acknowledged.who, summary.acknowledged.time) == ("Ada", "2026-01-05T12:00:00Z")


def test_nobody_knows_whether_an_acknowledged_one_of_yesterday_stands() -> None:
    incidents = Incidents(lambda: NOON)
    incidents.take([line()], of_this_run=False)
    assert state(incidents) == "unacknowledged"
    incidents.act([act("acknowledge")])
    assert state(incidents) == "closed"


def test_the_gravest_finding_speaks(incidents: Incidents) -> None:
    incidents.take(
        [
            line("n", severity="notice", message="aside", time="2026-01-05T11:00:00Z"),
            line("f", message="later", time="2026-01-05T11:59:30Z"),
        ]
    )
    [summary] = incidents.summaries()
    assert (summary.message, summary.severity, summary.findings) == ("it did", "fault", 3)


def test_lights(incidents: Incidents) -> None:
    assert trouble(incidents)["G-D"].colour == "red"
    assert trouble(incidents)["G-D"].blinks
    incidents.act([act("acknowledge")])
    assert trouble(incidents)["G-D"].colour == "red"
    assert not trouble(incidents)["G-D"].blinks
    incidents.take([line(state="returned")])
    assert not trouble(incidents)
    incidents.take([line("x", incident="j", kind="late", severity="anomaly")])
    assert trouble(incidents)["G-D"].colour == "amber"


def test_acts_outlive_the_server(tmp_path: Path) -> None:
    acts = Acts(tmp_path)
    acts.append([act("acknowledge"), act("shelve", until="2026-01-05T13:00:00Z")])
    acts.close()
    again = Acts(tmp_path)
    assert [each.deed for each in again.all()] == ["acknowledge", "shelve"]
    again.close()
