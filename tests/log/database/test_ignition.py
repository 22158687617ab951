"""The tag history of Ignition, in each kind of database."""

from typing import Any

import pytest

import runglight as rl
from runglight.log.database import ignition
from tests.conftest import Command
from tests.log.database.filling import (
    add,
    ignition_lists,
    ignition_partition,
    made,
    paper_003,
)

JANUARY, FEBRUARY = 1767592800000, 1769997600000
INTEGER, FLOAT, TEXT = 0, 1, 2


def value(tag: int, time_ms: int, integer: int | None = None, **others: Any) -> dict[str, Any]:
    return {
        "tagid": tag,
        "intvalue": integer,
        "floatvalue": None,
        "stringvalue": None,
        "datevalue": None,
        "dataintegrity": 192,
        "t_stamp": time_ms,
    } | others


def partition(name: str, start_ms: int, end_ms: int, block: int = 0, driver: int = 1) -> dict:
    return {
        "pname": name,
        "drvid": driver,
        "start_time": start_ms,
        "end_time": end_ms,
        "blocksize": block,
        "flags": 0,
    }


def tag(number: int, path: str, kind: int = INTEGER, scan_class: int = 1, retired: Any = None):
    return {
        "id": number,
        "tagpath": path,
        "scid": scan_class,
        "datatype": kind,
        "querymode": 0,
        "created": JANUARY,
        "retired": retired,
    }


@pytest.fixture
def history(database: str) -> str:
    """Two months, one tag that was retired and made anew, one of floats, one of text."""
    lists = ignition_lists()
    for table in lists.values():
        made(database, table)
    add(
        database,
        lists["sqlth_te"],
        [
            tag(1, "line1/clamp/open", retired=FEBRUARY),
            tag(2, "line1/clamp/open"),
            tag(3, "line1/oven/temperature", FLOAT),
            tag(4, "line1/order", TEXT),
        ],
    )
    add(database, lists["sqlth_scinfo"], [{"id": 1, "scname": "_exempt_", "drvid": 1}])
    add(database, lists["sqlth_drv"], [{"id": 1, "name": "gateway", "provider": "default"}])
    months = [("sqlt_data_1_2026_02", FEBRUARY), ("sqlt_data_1_2026_01", JANUARY)]
    add(
        database,
        lists["sqlth_partitions"],
        [
            *(partition(name, start, start + 27 * 86_400_000) for name, start in months),
            partition("sqlt_data_1_60000_2026_01", JANUARY, FEBRUARY, 60_000),
            partition("sqlt_data_1_2025_12", 0, 1),  # Pruned; its table is gone.
        ],
    )
    made(
        database,
        ignition_partition("sqlt_data_1_2026_01"),
        [
            value(1, JANUARY + 1000, 0),
            value(1, JANUARY + 250, 1),
            value(1, JANUARY + 500, 0, dataintegrity=28),
            value(3, JANUARY + 300, floatvalue=71.5),
            value(4, JANUARY + 300, stringvalue="A-17"),
        ],
    )
    made(
        database,
        ignition_partition("sqlt_data_1_2026_02"),
        [
            value(2, FEBRUARY, 1),
            value(3, FEBRUARY, floatvalue=20.0),
            value(99, FEBRUARY, 1),
        ],
    )
    made(database, ignition_partition("sqlt_data_1_60000_2026_01"), [value(1, JANUARY, 7)])
    return database


def changes(log: rl.Log) -> list[tuple[int, str, int]]:
    time_ns, signal, number = log.columns()
    return [
        (int(t) // 1_000_000, log.signals[s], int(v))
        for t, s, v in zip(time_ns, signal, number, strict=True)
    ]


CLAMP = [
    (JANUARY + 250, "line1-clamp-open", 1),
    (JANUARY + 1000, "line1-clamp-open", 0),
    (FEBRUARY, "line1-clamp-open", 1),
]


@pytest.mark.parametrize("table", [None, "ignition"])
def test_partitions_are_one_log(history: str, table: str | None) -> None:
    log = rl.read_log(sql=history, table=table)
    assert changes(log) == CLAMP
    said = " ".join(log.report.sentences("it"))
    assert "left out line1-oven-temperature: analog" in said
    assert "left out line1-order: text" in said
    assert "1 row was skipped, because dataintegrity is below 192 (good)" in said
    assert "1 row was skipped, because no tag has their number" in said
    assert "hidden" not in str(log.path)


def test_analog_tags_are_banded(history: str) -> None:
    log = rl.read_log(sql=history, analog={"line1-oven-temperature": [20, 60, 90]})
    oven = [row for row in changes(log) if "oven" in row[1]]
    assert oven == [
        (JANUARY + 300, "line1-oven-temperature", 2),
        (FEBRUARY, "line1-oven-temperature", 1),
    ]
    with pytest.raises(rl.InputError, match="has no tag 'oven'"):
        rl.read_log(sql=history, analog={"oven": [20]})


def test_pages_of_any_size_are_the_same(history: str, monkeypatch: pytest.MonkeyPatch) -> None:
    name = "sqlt_data_1_2026_01"
    # Many tags at one time, so that pages end within it.
    rows = [value(1, JANUARY + 2000 + n // 3, n % 2) for n in range(0, 30, 3)]
    rows += [value(3, JANUARY + 2000 + n // 3, floatvalue=1.5) for n in range(0, 30, 3)]
    add(history, ignition_partition(name), rows)
    options = {"sql": history, "analog": {"line1/oven/temperature": 1}}
    whole = changes(rl.read_log(**options))
    assert len(whole) > 20
    for size in (1, 2, 3, 7):
        monkeypatch.setattr(ignition, "ROWS_AT_ONCE", size)
        assert changes(rl.read_log(**options)) == whole


def test_the_same_path_in_two_systems(history: str) -> None:
    lists = ignition_lists()
    add(history, lists["sqlth_te"], [tag(5, "line1/clamp/open", scan_class=2)])
    add(history, lists["sqlth_scinfo"], [{"id": 2, "scname": "_exempt_", "drvid": 2}])
    add(history, lists["sqlth_drv"], [{"id": 2, "name": "edge", "provider": "default"}])
    add(history, lists["sqlth_partitions"], [partition("sqlt_data_2_2026_01", 0, 9, driver=2)])
    made(history, ignition_partition("sqlt_data_2_2026_01"), [value(5, JANUARY + 600, 1)])
    assert [name for _, name, _ in changes(rl.read_log(sql=history))] == [
        "gateway-line1-clamp-open",
        "edge-line1-clamp-open",
        "gateway-line1-clamp-open",
        "gateway-line1-clamp-open",
    ]


def test_a_bad_value_names_its_tag(history: str) -> None:
    add(history, ignition_partition("sqlt_data_1_2026_02"), [value(2, FEBRUARY + 5)])
    with pytest.raises(rl.InputError, match=rf"is empty.*\[tagid 2, t_stamp {FEBRUARY + 5}\]"):
        rl.read_log(sql=history)


def test_imports_take_what_is_new_across_partitions(history: str, runglight: Command) -> None:
    command = ["import", "--sql", history, "--table", "ignition", "--to", "plant"]
    first = runglight(*command)
    assert (first.returncode, first.stdout) == (0, "plant: 3 new rows, 3 in all\n"), first.stderr
    assert runglight(*command).stdout == "plant: 0 new rows, 3 in all\n"
    march = FEBRUARY + 28 * 86_400_000
    add(history, ignition_partition("sqlt_data_1_2026_02"), [value(2, FEBRUARY + 900, 0)])
    made(history, ignition_partition("sqlt_data_1_2026_03"), [value(2, march, 1)])
    add(
        history,
        ignition_lists()["sqlth_partitions"],
        [partition("sqlt_data_1_2026_03", march, march + 1)],
    )
    assert runglight(*command).stdout == "plant: 2 new rows, 5 in all\n"
    # Late, within the reorder window of one second.
    add(history, ignition_partition("sqlt_data_1_2026_03"), [value(2, march - 400, 0)])
    assert runglight(*command).stdout == "plant: 1 new rows, 6 in all\n"
    ended = runglight("export", "plant", "--to", "plant.csv")
    assert ended.stdout.startswith("plant.csv: 6 rows of 1 signals")


def test_what_is_no_history(database: str) -> None:
    made(database, paper_003())
    with pytest.raises(rl.InputError, match="no tag history of Ignition"):
        rl.read_log(sql=database, table="ignition")
    with pytest.raises(rl.InputError, match="which table"):
        rl.read_log(sql=database)
    made(database, paper_003(name="ignition"))
    assert len(rl.read_log(sql=database, table="ignition")) == 0
