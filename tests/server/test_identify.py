"""The routes of identification: photos, events, the ranking, a name that is accepted."""

import csv
import io
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from runglight.identification.events import read_events
from runglight.server.policy import policy
from tests.identification.machine import EPOCH, EVENTS, conveyor_log
from tests.server.conftest import COMMAND, TestClient, serving
from tests.server.photographed import Photographed

pytest.importorskip("skimage")


@pytest.fixture
def served(machine: Photographed, tmp_path: Path) -> Path:
    shutil.copytree(machine.path, tmp_path / "line3")
    conveyor_log().write(tmp_path / "conveyor.csv")
    return tmp_path


@pytest.fixture
def client(served: Path) -> Iterator[TestClient]:
    with serving(served) as client:
        client.headers.update(COMMAND)
        yield client


def ids(client: TestClient) -> dict[str, str]:
    return {each["name"]: each["id"] for each in client.get("/api/identify").json()}


def opened(client: TestClient, name: str) -> dict[str, Any]:
    told: dict[str, Any] = client.get(f"/api/identify/{ids(client)[name]}").json()
    return told


def conveyor(client: TestClient) -> dict[str, Any]:
    """A request about the log of the conveyor."""
    origin = int(opened(client, "conveyor.csv")["origin_ns"])
    assert origin == EPOCH
    events = [{"at": event - origin} for event in EVENTS]
    return {"source": ids(client)["conveyor.csv"], "events": events}


def test_the_list_says_where_photos_are(client: TestClient, machine: Photographed) -> None:
    listed = {each["name"]: each for each in client.get("/api/identify").json()}
    assert listed["line3"]["photos"] == len(machine.photos_ns)
    assert listed["conveyor.csv"] | {"id": ""} == {
        "id": "",
        "name": "conveyor.csv",
        "photos": 0,
        "events": False,
    }


def test_photos_are_bytes_that_a_browser_keeps(client: TestClient, machine: Photographed) -> None:
    told = opened(client, "line3")
    assert len(told["photos"]) == len(machine.photos_ns)
    time_ns = int(told["origin_ns"]) + told["photos"][7]
    address = f"/api/identify/{told['id']}/photos/{time_ns}"
    photo = client.get(address)
    assert photo.headers["content-type"] == "image/jpeg"
    assert "immutable" in photo.headers["cache-control"]
    assert "no-store" in client.get("/api/identify").headers["cache-control"]
    assert photo.content == sorted((machine.path / "photos").iterdir())[7].read_bytes()
    again = client.get(address, headers={"if-none-match": photo.headers["etag"]})
    assert again.status_code in {200, 304}


@pytest.mark.parametrize(
    "rest",
    ["0", "99999999999999999999", "..%2F..%2Frecording.json", "-1", "recording.json", "1/../../x"],
)
def test_nothing_but_photos_is_given(client: TestClient, rest: str) -> None:
    assert client.get(f"/api/identify/{ids(client)['line3']}/photos/{rest}").status_code == 404


def test_a_log_has_no_photos(client: TestClient) -> None:
    found = client.get(f"/api/identify/{ids(client)['conveyor.csv']}/photos/0")
    assert found.status_code == 400
    told = opened(client, "conveyor.csv")
    assert told["photos"] == []
    assert told["declared"] == {"file": "conveyor.events.csv", "events": [], "version": None}


def test_the_ranking_follows_tau_view_and_order(client: TestClient) -> None:
    asked = conveyor(client) | {"tau_s": 1}
    ranked = client.post("/api/identify/ranking", json=asked).json()
    assert [each["address"] for each in ranked["candidates"] if each["rank"] == 1] == [
        "%M25",
        "%MW74.0",
    ]
    assert ranked["windows"][0] == [19_000_000_000, 21_000_000_000, 1]
    assert "copies of one another" in ranked["verdict"]
    wide = client.post("/api/identify/ranking", json=asked | {"tau_s": 40}).json()
    assert len(wide["windows"]) == 1
    rising = client.post("/api/identify/ranking", json=asked | {"view": "rising"}).json()
    assert rising["candidates"][0]["score_in"] == 0.5
    agreed = client.post("/api/identify/ranking", json=asked | {"order": "agreement"}).json()
    assert agreed["candidates"][0]["agreement"] == 1
    swept = client.post("/api/identify/sweep", json=conveyor(client)).json()
    assert swept["tau_s"] <= 10
    assert "windows" in swept["reason"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"tau_s": -1},
        {"tau_s": 1e9},
        {"view": "sideways"},
        {"events": [{"at": 10**30}]},
        {"events": [{"at": 10**18}]},
        {"events": []},
        {"source": "../line3"},
        {"rows": 10**6},
    ],
)
def test_what_cannot_be_ranked(client: TestClient, wrong: dict[str, object]) -> None:
    refused = client.post("/api/identify/ranking", json=conveyor(client) | {"tau_s": 1} | wrong)
    assert refused.status_code == 400
    assert refused.json()["error"]


def test_events_are_kept_beside_what_they_were_seen_in(client: TestClient, served: Path) -> None:
    asked = conveyor(client)
    asked["events"][0]["label"] = "starts"
    saved = client.post("/api/identify/events", json=asked | {"version": None}).json()
    assert saved["file"] == "conveyor.events.csv"
    assert read_events(served / "conveyor.events.csv").time_ns.tolist() == EVENTS
    found = opened(client, "conveyor.csv")["declared"]
    assert found["events"][0] == {"at": EVENTS[0] - EPOCH, "label": "starts"}
    assert found["version"] == saved["version"]
    # It is no log.
    assert "conveyor.events.csv" not in ids(client)


def test_what_somebody_else_saved_is_not_lost(client: TestClient, served: Path) -> None:
    asked = conveyor(client) | {"version": None}
    mine = "time\n2024-01-02T00:00:10Z\n"
    (served / "conveyor.events.csv").write_text(mine, encoding="utf-8")
    refused = client.post("/api/identify/events", json=asked)
    assert "changed by somebody else" in refused.json()["error"]
    assert (served / "conveyor.events.csv").read_text(encoding="utf-8") == mine
    version = opened(client, "conveyor.csv")["declared"]["version"]
    assert client.post("/api/identify/events", json=asked | {"version": version}).is_success


def test_a_file_that_cannot_be_read_does_not_hide_the_photos(
    client: TestClient, served: Path
) -> None:
    (served / "line3" / "events.csv").write_text("when\nyesterday\n", encoding="utf-8")
    told = opened(client, "line3")
    assert told["photos"]
    assert told["declared_error"].startswith("events.csv")


def test_a_rectangle_proposes_events(client: TestClient, machine: Photographed) -> None:
    told = opened(client, "line3")
    belt = {"source": told["id"], "x": 20, "y": 272, "width": 600, "height": 20, "by": "motion"}
    proposed = client.post("/api/identify/proposal", json=belt).json()["events"]
    seen = [time_ns - int(told["origin_ns"]) for time_ns in machine.seen_ns]
    assert all(min(abs(each["at"] - at) for at in seen) < 2e9 for each in proposed)
    assert len(proposed) >= len(seen) - 2
    outside = client.post("/api/identify/proposal", json=belt | {"x": 600}).json()["error"]
    assert "640 x 360 pixels" in outside
    assert str(machine.path.parent) not in outside


def test_too_many_photos_are_not_looked_at_here(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("runglight.server.routes.identify.MOST_PHOTOS", 10)
    belt = {"source": ids(client)["line3"], "x": 0, "y": 0, "width": 9, "height": 9}
    refused = client.post("/api/identify/proposal", json=belt).json()["error"]
    assert "runglight identify --propose" in refused


def test_an_accepted_name_is_shown_back(client: TestClient, served: Path) -> None:
    source = {"source": ids(client)["conveyor.csv"]}
    accepting = source | {"address": "%MW74.0", "name": "Line3-Conveyor-Running"}
    told = client.post("/api/identify/accept", json=accepting).json()
    assert told == {"table": "symbols.csv", "before": None, "word": "%MW74"}
    [row] = csv.DictReader(io.StringIO((served / "symbols.csv").read_text(encoding="utf-8")))
    assert (row["address"], row["device"], row["type"]) == ("%MW74.0", "Conveyor", "BOOL")
    ranked = client.post("/api/identify/ranking", json=conveyor(client) | {"tau_s": 1}).json()
    assert {each["address"]: each["name"] for each in ranked["candidates"]}[
        "%MW74.0"
    ] == "Line3-Conveyor-Running"
    twice = client.post("/api/identify/accept", json=accepting | {"address": "%M25"})
    assert "is the name of %MW74.0 already" in twice.json()["error"]
    assert str(served) not in twice.json()["error"]
    nowhere = client.post("/api/identify/accept", json=accepting | {"address": "%M26"})
    assert "did you mean %M25" in nowhere.json()["error"]


def test_bits_and_words_are_drawn(client: TestClient) -> None:
    source = client.get(f"/api/sources/{ids(client)['conveyor.csv']}.searched").json()
    changes = {each["name"]: each["changes"] for each in source["signals"]}
    # The first value counts.
    assert changes["%MW74.0"] == changes["%M25"] == 1 + len(EVENTS)
    assert changes["%MW74"] == 1 + len(EVENTS) + 2
    lane = next(each["lane"] for each in source["signals"] if each["name"] == "%MW74.0")
    query = {"origin": source["origin_ns"], "at": 0, "lanes": lane}
    edge = client.get(f"/api/sources/{source['id']}/edge", params=query).json()
    assert (edge["at"], edge["value"]) == (EVENTS[0] - EPOCH, 1)


def test_read_only_asks_and_writes_nothing(served: Path) -> None:
    with serving(served, policy(read_only=True)) as client:
        client.headers.update(COMMAND)
        asked = conveyor(client)
        assert client.post("/api/identify/ranking", json=asked | {"tau_s": 1}).is_success
        kept = client.post("/api/identify/events", json=asked | {"version": None})
        named = client.post("/api/identify/accept", json=asked | {"address": "a", "name": "b"})
        assert kept.status_code == named.status_code == 403
    assert not (served / "conveyor.events.csv").exists()


def test_questions_too_come_from_this_page_only(served: Path) -> None:
    with serving(served) as client:
        body = json.dumps(conveyor(client) | {"tau_s": 1})
        assert client.post("/api/identify/ranking", content=body).status_code == 403
