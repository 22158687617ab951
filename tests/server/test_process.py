"""The process room: a recording is mined, its runs played, the machine followed beside the net."""

import asyncio
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import runglight as rl
from runglight.plants.tank import simulate_tank
from runglight.server.live_feed import LiveFeed
from runglight.server.policy import policy
from runglight.server.process.beside import Beside
from runglight.server.process.work import Sources, Wanted, opened
from runglight.server.workshop import Workshop
from runglight.taps.base import Batch, Gap, TapSignal
from tests.server.conftest import COMMAND, TestClient, serving

RESET = "%IX0.1=0"
GUARD_S = 60
FILL = "%QX0.0=1 & %QX0.1=0"


@pytest.fixture(scope="module")
def tanks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """`counting.csv` (fills three times a run) and `simple.csv` (once), and a net of the first."""
    directory = tmp_path_factory.mktemp("tanks")
    for name, scenario in (("counting", "2"), ("simple", "1")):
        run = simulate_tank(scenario, 1, 400)
        log = rl.Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
        log.write(directory / f"{name}.csv")
    runs = rl.event_log(rl.read_log(directory / "counting.csv"), reset=RESET)
    net = rl.mine(runs).net
    net.write(directory / "tank.pnml")
    rl.train_next(runs, net).save(directory / "tank.next")
    return directory


def named(client: TestClient, name: str) -> str:
    told = client.get("/api/process").json()
    return next(each["id"] for each in told["sources"] + told["nets"] if each["name"] == name)


def mined(client: TestClient, **wanted: object) -> str:
    """Mines, waits, and gives the id of the process."""
    body = {"reset": RESET} | wanted
    began = client.post("/api/process/mine", json=body, headers=COMMAND)
    assert began.status_code == 200, began.text
    job = began.json()
    until_s = time.monotonic() + GUARD_S
    while not job["done"]:
        assert time.monotonic() < until_s, job
        time.sleep(0.05)
        job = client.get(f"/api/process/jobs/{job['id']}").json()
    assert job["error"] is None, job
    return str(job["process"])


def test_openings_are_offered(tanks: Path) -> None:
    with serving(tanks) as client:
        source = named(client, "counting.csv")
        told = client.get("/api/process/openings", params={"source": source}).json()
        assert told["openings"][0]["change"] == RESET
        assert {each["name"] for each in told["signals"]} >= {"%IX0.0", "%QX0.1"}
        only = {"source": source, "only": "%IX0.0\n%IX0.2"}
        few = client.get("/api/process/openings", params=only).json()
        assert {each["change"][:6] for each in few["openings"]} == {"%IX0.0", "%IX0.2"}


def test_a_recording_is_mined_and_played(tanks: Path) -> None:
    with serving(tanks) as client:
        process = mined(client, source=named(client, "counting.csv"))
        told = client.get(f"/api/process/{process}").json()
        assert told["soundness"]["sound"] is True
        assert told["runs"]["fitting"] == told["runs"]["count"] > 5
        [variant] = told["runs"]["variants"]
        assert variant["fits"]
        assert variant["share"] == 1
        assert told["network"] == "tank.next"
        assert told["disagreements"] == []
        assert "has come 3 times in this run, wait" in told["guards"][0]
        run = client.get(f"/api/process/{process}/runs/{variant['runs'][0]}").json()
        assert [each["activity"] for each in run["events"][:2]] == [RESET, FILL]
        transitions = told["net"]["transitions"]
        for event in run["events"]:
            assert transitions[event["step"]["fired"][-1]]["label"] == event["activity"]
        [place] = run["end"]["marking"]
        assert told["net"]["places"][int(place)]["last"] == 1
        assert run["events"][1]["foretold"]["expected"] == FILL
        assert client.get(f"/api/process/{process}/runs/999").status_code == 400


def test_a_recording_of_another_program_departs(tanks: Path) -> None:
    with serving(tanks) as client:
        net = named(client, "tank.pnml")
        process = mined(client, source=named(client, "simple.csv"), net=net)
        told = client.get(f"/api/process/{process}").json()
        assert told["title"] == "simple.csv beside tank.pnml"
        assert told["runs"]["count"] > 10
        # The net allows a run that fills once: only what counts knows better.
        assert told["runs"]["fitting"] == told["runs"]["count"]
        assert client.get(f"/api/process/{net}").json()["runs"] is None


def test_what_it_counts_is_held_against_a_recording(tanks: Path) -> None:
    with serving(tanks) as client:
        kept = mined(client, source=named(client, "counting.csv"))
        said = client.post(f"/api/process/{kept}/keep", json={"name": "my tank"}, headers=COMMAND)
        assert said.json()["name"] == "my-tank.pnml"
        try:
            assert (tanks / "my-tank.guards.json").is_file()
            process = mined(client, source=named(client, "simple.csv"), net=said.json()["id"])
            told = client.get(f"/api/process/{process}").json()
            late = [each for each in told["disagreements"] if each["kind"] == "late"]
            assert len(late) > 5
            assert {each["address"] for each in late} == {"%QX0.0"}
            assert FILL in late[0]["message"]
        finally:
            (tanks / "my-tank.pnml").unlink()
            (tanks / "my-tank.guards.json").unlink()


def test_a_deviating_run_says_where(tanks: Path, tmp_path: Path) -> None:
    runs = [["%IX0.0=1", "%QX0.0=1", "%IX0.0=0", "%QX0.0=0"]] * 9
    rl.EventLog.from_traces([*runs, ["%IX0.0=1", "%IX0.0=0", "%QX0.0=0"]]).write(
        tmp_path / "runs.xes"
    )
    rl.mine(rl.EventLog.from_traces(runs)).net.write(tmp_path / "net.pnml")
    with serving(tmp_path) as client:
        source, net = named(client, "runs.xes"), named(client, "net.pnml")
        assert client.get("/api/process/openings", params={"source": source}).json()["runs"] == 10
        told = client.get(f"/api/process/{mined(client, source=source, net=net, reset='')}").json()
        common, odd = told["runs"]["variants"]
        assert (common["count"], common["fits"]) == (9, True)
        assert odd["departs"] == {
            "event": 1,
            "activity": "%IX0.0=0",
            "known": True,
            "allowed": ["%QX0.0=1"],
        }
        run = client.get(f"/api/process/{told['id']}/runs/9").json()
        assert run["events"][1]["step"]["missing"]


@pytest.mark.parametrize(
    ("file", "holds"),
    [
        ("net.pnml", b"<pnml"),
        ("net.bpmn", b"<task"),
        ("runs.xes", b"<trace>"),
        ("program.st", b"END_CASE"),
        ("guards.json", b"points"),
    ],
)
def test_everything_can_be_taken_along(tanks: Path, file: str, holds: bytes) -> None:
    with serving(tanks) as client:
        process = mined(client, source=named(client, "counting.csv"))
        assert file in client.get(f"/api/process/{process}").json()["files"]
        got = client.get(f"/api/process/{process}/files/{file}")
        assert holds in got.content
        assert f'filename="{file}"' in got.headers["content-disposition"]
        assert client.get(f"/api/process/{process}/files/..%2Ftank.pnml").status_code in {400, 404}


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        ({"source": "nothing"}, "there is no recording or log"),
        ({"source": "SOURCE", "reset": "%IX9.9=1"}, "%IX9.9"),
        ({"source": "SOURCE", "reset": ""}, "choose the change"),
        ({"source": "SOURCE", "net": "../tank.pnml"}, "there is no net"),
        ({"source": "SOURCE", "eta": 7}, "from 0 to 1"),
    ],
)
def test_what_cannot_be_mined(tanks: Path, wanted: dict[str, Any], says: str) -> None:
    with serving(tanks) as client:
        body = {"reset": RESET} | wanted
        if body["source"] == "SOURCE":
            body["source"] = named(client, "counting.csv")
        answer = client.post("/api/process/mine", json=body, headers=COMMAND)
        if answer.status_code == 200:
            job = answer.json()
            while not job["done"]:
                job = client.get(f"/api/process/jobs/{job['id']}").json()
            answer_says = job["error"]
        else:
            answer_says = answer.json()["error"]
        assert says in answer_says


def test_read_only_shows_nets_and_mines_none(tanks: Path) -> None:
    with serving(tanks, policy(read_only=True)) as client:
        body = {"source": named(client, "counting.csv"), "reset": RESET}
        refused = client.post("/api/process/mine", json=body, headers=COMMAND)
        assert refused.status_code == 403
        net = named(client, "tank.pnml")
        assert client.get(f"/api/process/{net}").json()["soundness"]["sound"] is True
        keep = client.post(f"/api/process/{net}/keep", json={"name": "x"}, headers=COMMAND)
        assert keep.status_code == 403
        assert "nothing has come" in client.get(f"/api/process/{net}/live").json()["error"]


class _Tap:
    """The signals of a tap that somebody else drives."""

    def __init__(self, signals: list[str]) -> None:
        self.signals = [TapSignal(name, name) for name in signals]


def followed(tanks: Path, name: str) -> tuple[Beside, list[Batch]]:
    """The counting tank's net beside a machine that does what a recording holds."""
    workshop = Workshop(tanks, policy())
    items = {item.name: item for item in workshop.catalogue.items()}
    wanted = Wanted(source=items["counting.csv"].id, reset=RESET)
    sources = Sources(items["counting.csv"], None, [items["tank.next"]], workshop.configuration)
    process = opened(wanted, sources, lambda _stage: None)
    log = rl.read_log(tanks / f"{name}.csv")
    time_ns, index, value = (np.asarray(column) for column in log.engine.columns())
    feed = LiveFeed(_Tap(log.signals), lambda _sentence: None)  # type: ignore[arg-type]
    batches = []
    for now in np.unique(time_ns):
        rows = time_ns == now
        batches.append(Batch(int(now), time_ns[rows], index[rows], value[rows], image=not batches))
    feed.append(batches[0])
    beside = Beside(process, feed, {})
    feed.listeners.append(beside.take)
    return beside, batches[1:]


def test_the_machine_moves_the_tokens(tanks: Path) -> None:
    beside, batches = followed(tanks, "counting")
    assert beside.missing == []
    for batch in batches:
        beside.feed.append(batch)
        beside.feed.append(Batch(batch.until_ns + 90_000_000))
        now = beside.now()
        if beside.runs and now is not None and now.sets:
            # Due at the next scan: nothing else may come now.
            assert now.waits_for == [] or now.why == "guard"
    assert beside.sure
    assert beside.runs > 5
    assert not any(each.step.departs for each in beside.steps)
    assert list(beside.disagreements) == []
    assert beside.follows
    expected = asyncio.run(asyncio.to_thread(beside.chances))
    assert expected[0][1] > 0.5


def test_another_program_disagrees_and_the_page_says_with_what(tanks: Path) -> None:
    beside, batches = followed(tanks, "simple")
    differing = set()
    for batch in batches:
        beside.feed.append(batch)
        for later_ns in (100_000_000, 800_000_000):
            beside.feed.append(Batch(batch.until_ns + later_ns))
        now = beside.now()
        for each in beside.outputs(now):
            if each.learned is not None and each.plc != each.learned and now and now.sets == FILL:
                differing.add(each.signal)
    assert beside.told > 3
    assert any('"late"' in line and "%QX0.0" in line for line in beside.disagreements)
    assert differing == {"%QX0.0", "%QX0.1"}


def test_a_net_that_holds_up_the_alarms_is_not_followed(
    tanks: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("runglight.server.process.beside.SLOW_S", -1.0)
    beside, batches = followed(tanks, "counting")
    for batch in batches[:10]:
        beside.feed.append(batch)
    assert beside.given_up
    assert len(beside.steps) <= 3


def test_after_a_gap_nothing_is_judged_until_it_is_known_again(tanks: Path) -> None:
    beside, batches = followed(tanks, "counting")
    half = len(batches) // 2
    for batch in batches[:half]:
        beside.feed.append(batch)
    assert beside.sure
    values = {index: told[1] for index in range(5) if (told := beside.feed.value(index))}
    for unseen in batches[half : half + 7]:
        values |= dict(zip(unseen.signal_index.tolist(), unseen.value.tolist(), strict=True))
    at_ns = batches[half + 7].until_ns - 1
    beside.feed.append(
        Batch(
            at_ns,
            np.full(5, at_ns, np.int64),
            np.arange(5, dtype=np.uint32),
            np.array([values[index] for index in range(5)], np.int64),
            marks=(Gap(at_ns - 2, at_ns - 1, "the cable"),),
            image=True,
        )
    )
    assert not beside.sure
    assert beside.now() is None
    for batch in batches[half + 7 :]:
        beside.feed.append(batch)
    assert beside.sure
    assert not any(each.step.departs for each in beside.steps)
