"""What the page asks, answered from a directory on the disk."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runglight.findings.store import FindingStore
from tests.server.conftest import COMMAND, TestClient, serving


def ids(client: TestClient) -> dict[str, str]:
    return {item["name"]: item["id"] for item in client.get("/api/sources").json()}


def fault(client: TestClient) -> dict[str, Any]:
    incidents = client.get("/api/live").json()["incidents"]
    return next(each for each in incidents if each["severity"] == "fault")


def test_the_live_picture(client: TestClient) -> None:
    live = client.get("/api/live").json()
    assert live["watching"]["state"] == "off"
    assert live["model"]["name"] == "cell.model"
    [group] = live["groups"]
    assert {device["device"] for device in group["devices"]} >= {"PrtLDR", "RBT1", "DCLAMP"}
    assert all(device["light"]["colour"] == "grey" for device in group["devices"])


def test_one_incident_in_full(client: TestClient) -> None:
    detail = client.get(f"/api/incidents/{fault(client)['id']}").json()
    assert detail["leading"]["suspects"][0]["address"] == "%IX0.2"
    [ghost] = detail["ghosts"]
    assert ghost["signal"] == "Group1-PrtLDR-RET"
    began_ns = int(detail["at_ns"]) - round(detail["leading"]["observed_s"] * 1e9)
    assert began_ns < int(ghost["earliest_ns"]) < int(ghost["typical_ns"]) < int(ghost["latest_ns"])
    assert detail["source"] == ids(client)["faulty.csv"]
    assert set(detail["snapshot"]["devices"]) >= {"Group1-PrtLDR", "Group1-RBT1"}
    assert {"Group1-PrtLDR-ADV_OFF"} <= {rule["current"] for rule in detail["rules"]}


def test_acknowledging_is_kept_and_told_to_everybody(client: TestClient, directory: Path) -> None:
    incident = fault(client)["id"]
    said = client.post("/api/incidents/acknowledge", json={"ids": [incident], "who": " Ada "})
    assert said.status_code == 200
    assert fault(client)["acknowledged"]["who"] == "Ada"
    with FindingStore(directory / "cell.model") as store:
        newest = store.newest(incident)
    assert newest is not None
    assert json.loads(newest)["state"] == "acknowledged"
    with serving(directory) as again:
        assert fault(again)["acknowledged"]["who"] == "Ada"
        assert fault(again)["state"] == "closed"


@pytest.mark.parametrize("body", [{"ids": ["nothing"], "who": "Ada"}, {"ids": [], "who": 3}, {}])
def test_what_cannot_be_acknowledged(client: TestClient, body: dict[str, object]) -> None:
    refused = client.post("/api/incidents/acknowledge", json=body)
    assert refused.status_code == 400
    assert refused.json()["error"]


def test_nobody_acknowledges_anonymously(client: TestClient) -> None:
    refused = client.post(
        "/api/incidents/acknowledge", json={"ids": [fault(client)["id"]], "who": " "}
    )
    assert "who you are" in refused.json()["error"]
    assert fault(client)["acknowledged"] is None


def test_shelving(client: TestClient) -> None:
    before = fault(client)["state"]
    body = {"ids": [fault(client)["id"]], "who": "Ada", "minutes": 30}
    assert client.post("/api/incidents/shelve", json=body).status_code == 200
    assert fault(client)["state"] == "shelved"
    assert client.post("/api/incidents/shelve", json=body | {"minutes": 0}).status_code == 200
    assert fault(client)["state"] == before
    refused = client.post("/api/incidents/shelve", json=body | {"minutes": 10**6})
    assert refused.status_code == 400


def test_the_list_for_a_spreadsheet(client: TestClient) -> None:
    told = client.get("/api/incidents.csv")
    assert told.headers["content-disposition"].endswith('"incidents.csv"')
    rows = list(csv.DictReader(io.StringIO(told.text)))
    assert [row["id"] for row in rows if row["severity"] == "fault"] == [fault(client)["id"]]
    assert "PRT_CHK" in rows[0]["message"]
    assert len(client.get("/api/incidents.csv?ids=none").text.splitlines()) == 1


def test_a_path_is_accepted_into_the_model(client: TestClient) -> None:
    incident = fault(client)["id"]
    [first, *_] = client.get(f"/api/incidents/{incident}").json()["acceptable"]
    body = {"finding": first, "who": "Ada"}
    answer = client.post("/api/incidents/accept", json=body)
    assert answer.json()["new_transitions"] >= 1
    assert fault(client)["accepted"]["who"] == "Ada"
    assert client.post("/api/incidents/accept", json=body).json()["new_transitions"] == 0


def test_a_window_of_a_log(client: TestClient) -> None:
    source = client.get(f"/api/sources/{ids(client)['faulty.csv']}").json()
    signal = next(each for each in source["signals"] if each["signal"] == "PRT_CHK")
    assert (signal["group"], signal["device"]) == ("Group1", "PrtLDR")
    query = {
        "origin": source["origin_ns"],
        "from": -1,
        "until": source["length_ns"] + 1,
        "columns": 5000,
        "lanes": str(signal["lane"]),
    }
    packed = client.get(f"/api/sources/{source['id']}/window", params=query).content
    version, lanes, spans, _ = np.frombuffer(packed, "<u4", 4)
    assert (version, lanes) == (1, 1)
    start = np.frombuffer(packed, "<f8", spans, 16)
    value = np.frombuffer(packed, "<f8", spans, 16 + 8 * spans)
    changes = np.frombuffer(packed, "<u4", spans, 16 + 16 * spans)
    assert np.all(np.diff(start) >= 0)
    assert set(value) <= {0.0, 1.0}
    assert spans - 1 + changes.sum() == signal["changes"]
    edge = client.get(
        f"/api/sources/{source['id']}/edge",
        params={"origin": source["origin_ns"], "at": int(start[1]), "lanes": signal["lane"]},
    ).json()
    assert edge["at"] == int(start[2])


@pytest.mark.parametrize(
    "query",
    [
        {},
        {"from": "a"},
        {"columns": "0"},
        {"columns": "1000000000"},
        {"lanes": "-1"},
        {"lanes": "1,,x"},
        {"lanes": ",".join(["1"] * 501)},
        {"from": "9" * 30},
    ],
)
def test_a_window_that_is_none(client: TestClient, query: dict[str, str]) -> None:
    good = {"origin": "0", "from": "0", "until": "1", "columns": "10", "lanes": "1"}
    asked = good | query if query else {}
    refused = client.get(f"/api/sources/{ids(client)['faulty.csv']}/window", params=asked)
    assert refused.status_code == 400
    assert refused.json()["error"]


def test_windows_of_extreme_times_are_answered(client: TestClient) -> None:
    source = ids(client)["faulty.csv"]
    far = str(2 * 10**18)
    query = {"origin": far, "from": f"-{far}", "until": far, "columns": "10", "lanes": "0,1,99"}
    assert client.get(f"/api/sources/{source}/window", params=query).status_code == 200


def test_how_long_a_transition_took(client: TestClient) -> None:
    [model] = client.get("/api/models").json()
    assert model["watching"]
    rules = client.get(
        f"/api/models/{model['id']}/rules", params={"group": "Group1", "device": "PrtLDR"}
    ).json()
    rule = next(each for each in rules if each["average_s"] > 5 and each["count"] > 10)
    query = {
        "group": "Group1",
        "device": "PrtLDR",
        "current": rule["current"],
        "next": rule["next"],
        "source": ids(client)["nominal.csv"],
    }
    told = client.get(f"/api/models/{model['id']}/times", params=query).json()
    assert told["known"]
    took = [seconds for _, seconds in told["times"]]
    # The first row of a signal only says how it stood.
    assert len(took) in {rule["count"], rule["count"] - 1}
    assert min(took) >= rule["minimum_s"] - 1e-6
    assert max(took) <= rule["maximum_s"] + 1e-6


def test_a_log_of_another_machine_knows_no_transition_of_this_one(
    client: TestClient, directory: Path
) -> None:
    (directory / "another.csv").write_text(
        "time,signal,value\n2026-01-01T00:00:00Z,Line9-Press-DOWN,1\n"
        "2026-01-01T00:00:01Z,Line9-Press-DOWN,0\n",
        encoding="utf-8",
    )
    [model] = client.get("/api/models").json()
    query = {"group": "Group1", "device": "PrtLDR", "source": ids(client)["another.csv"]}
    query |= {"current": "Group1-PrtLDR-RET_ON", "next": "Group1-PrtLDR-RET_OFF"}
    told = client.get(f"/api/models/{model['id']}/times", params=query).json()
    assert told == {"source": "another.csv", "known": False, "times": []}


def test_the_chain_of_a_group(client: TestClient) -> None:
    [model] = client.get("/api/models").json()
    rules = client.get(f"/api/models/{model['id']}/rules", params={"group": "Group1"}).json()
    assert {rule["model"] for rule in rules} == {"group"}
    rule = next(each for each in rules if each["count"] > 10)
    query = {
        "group": "Group1",
        "current": rule["current"],
        "next": rule["next"],
        "source": ids(client)["nominal.csv"],
    }
    times = client.get(f"/api/models/{model['id']}/times", params=query).json()["times"]
    assert len(times) in {rule["count"], rule["count"] - 1}


def test_a_log_is_uploaded_and_learned(client: TestClient, directory: Path) -> None:
    content = (directory / "nominal.csv").read_bytes()
    told = client.post("/api/uploads", params={"name": "../../of the day.csv"}, content=content)
    assert told.json()["name"] == "of-the-day.csv"
    assert told.json()["signals"] == 29
    assert (directory / "of-the-day.csv").read_bytes() == content
    lesson = {"sources": [told.json()["id"]], "name": "new one"}
    learned = client.post("/api/models/learn", json=lesson).json()
    assert learned["name"] == "new-one.model"
    assert learned["rules"] > 50
    assert client.get("/api/live").json()["model"]["name"] == "new-one.model"


@pytest.mark.parametrize(
    ("name", "content"), [("a.exe", b""), ("a.csv", b"\x00\xff\x00"), ("csv", b"")]
)
def test_an_upload_that_is_no_log_leaves_nothing(
    client: TestClient, directory: Path, name: str, content: bytes
) -> None:
    before = sorted(directory.iterdir())
    refused = client.post("/api/uploads", params={"name": name}, content=content)
    assert refused.status_code == 400
    assert str(directory) not in refused.json()["error"]
    assert sorted(directory.iterdir()) == before


def test_secrets_do_not_reach_the_page(client: TestClient, directory: Path) -> None:
    told = client.get("/api/configuration").json()["text"]
    assert "hunter22" not in told
    changed = told + "[signal_state]\nfalse_alarms_per_day = 2.0\n"
    assert client.post("/api/configuration/check", json={"text": changed}).json()["error"] is None
    assert client.post("/api/configuration", json={"text": changed}).status_code == 200
    kept = (directory / "runglight.toml").read_text(encoding="utf-8")
    assert "hunter22" in kept
    assert "false_alarms_per_day = 2.0" in kept


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("[souce]\n", "did you mean source"),
        ("[source\n", "line 1"),
        ('[source]\nurl = "modbus://plc?coil=0-9"\n', "coil"),
        ('[signal_state]\ntiming = "x"\n', "timing"),
    ],
)
def test_a_configuration_that_cannot_be_used(client: TestClient, text: str, part: str) -> None:
    assert part in client.post("/api/configuration/check", json={"text": text}).json()["error"]
    refused = client.post("/api/configuration", json={"text": text})
    assert (refused.status_code, part in refused.json()["error"]) == (400, True)


def test_symbols_are_edited(client: TestClient, directory: Path) -> None:
    rows = client.get("/api/symbols").json()["rows"]
    assert rows[0]["address"] == "%IX0.0"
    rows[0]["description"] = 'stands at home, "quoted"'
    assert client.post("/api/symbols", json={"rows": rows}).status_code == 200
    assert client.get("/api/symbols").json()["rows"] == rows
    refused = client.post("/api/symbols", json={"rows": [rows[0], rows[0]]})
    assert "row 2" in refused.json()["error"]
    assert "quoted" in (directory / "symbols.csv").read_text(encoding="utf-8")


def test_nothing_is_recorded_without_a_machine(client: TestClient) -> None:
    assert client.post("/api/recordings/start", json={"name": "a"}).status_code == 400
    assert client.post("/api/recordings/stop", json={}).status_code == 400
    listed = {each["name"]: each for each in client.get("/api/recordings").json()}
    assert listed["nominal.csv"]["kind"] == "log"


def test_an_empty_directory_is_served(tmp_path: Path) -> None:
    with serving(tmp_path) as client:
        client.headers.update(COMMAND)
        live = client.get("/api/live").json()
        assert (live["model"], live["incidents"], live["groups"]) == (None, [], [])
        assert client.get("/api/models").json() == []
        assert client.get("/api/sources/live").status_code == 400
        assert client.get("/api/symbols").json()["rows"] == []
