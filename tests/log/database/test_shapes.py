"""Each shape of table in each kind of database."""

from datetime import UTC, datetime, timedelta, timezone
from decimal import Decimal
from pathlib import Path

import pytest
from sqlalchemy import (
    Boolean,
    Column,
    DateTime,
    Integer,
    MetaData,
    Numeric,
    String,
    Table,
    insert,
    text,
)
from sqlalchemy.dialects import mysql

import runglight as rl
from runglight.log.database.connection import connected
from runglight.log.database.url import database_url
from tests.conftest import Command
from tests.log.database.filling import kepserverex, made, paper_003, writing

# Microseconds are kept, by MariaDB where it is told to.
MOMENT = DateTime().with_variant(mysql.DATETIME(fsp=6), "mysql", "mariadb")
START = datetime(2026, 1, 5, 6, 0, 0, 123456)


def rows_of(log: rl.Log) -> list[tuple[str, int]]:
    _, signal, value = log.columns()
    return [(log.signals[index], int(number)) for index, number in zip(signal, value, strict=True)]


@pytest.mark.parametrize("value", [Integer, Boolean, Numeric(8, 3), String(10)])
@pytest.mark.parametrize("moment", [MOMENT, String(40)])
def test_paper_003(database: str, value: object, moment: object) -> None:
    values = {Boolean: True, Integer: 1}.get(
        value, "1" if isinstance(value, String) else Decimal(1)
    )
    time = START if moment is MOMENT else START.isoformat(" ")
    row = {"Date and time": time, "Variable name": "%M1", "Value": values}
    made(database, paper_003(moment, value), [{"id": 2**40} | row])
    log = rl.read_log(sql=database, table="history")
    assert rows_of(log) == [("%M1", 1)]
    assert log.start == START.replace(tzinfo=UTC)


def test_kepserverex(database: str) -> None:
    rows = [
        {
            "_NAME": "Line1-Clamp-OPEN",
            "_NUMERICID": 7,
            "_VALUE": str(n % 2),
            "_TIMESTAMP": START + timedelta(seconds=9 - n),
            "_QUALITY": 24 if n == 3 else 192,
        }
        for n in range(10)
    ]
    made(database, kepserverex(MOMENT), rows)
    log = rl.read_log(sql=database, table="plant")
    assert rows_of(log) == [("Line1-Clamp-OPEN", n % 2) for n in range(9, -1, -1) if n != 3]
    assert "1 row was skipped, because _QUALITY is not 192 (good)" in log.report.notes


def test_reserved_words_and_odd_names(database: str) -> None:
    table = Table(
        "order",
        MetaData(),
        Column("select", String(40)),
        Column('from "where"', String(20)),
        Column("group %s", Integer),
    )
    made(database, table)
    with writing(database) as connection:
        connection.execute(insert(table).values(["2026-01-05T06:00:00Z", "A", 1]))
    log = rl.read_log(
        sql=database,
        table="order",
        time_column="select",
        signal_columns=['from "where"'],
        value_column="group %s",
    )
    assert rows_of(log) == [("A", 1)]


def test_bad_rows_are_named_by_their_id(database: str) -> None:
    times = [(START + timedelta(seconds=n)).isoformat() for n in range(3)]
    rows = [
        {"id": 100 + n, "Date and time": times[n], "Variable name": "A", "Value": n and None}
        for n in range(2)
    ]
    made(database, paper_003(), rows)
    with pytest.raises(rl.InputError) as raised:
        rl.read_log(sql=database, table="history")
    assert "row 2: column 'Value' is empty" in str(raised.value)
    assert str(raised.value).endswith("[id 101]")
    report = rl.read_log(sql=database, table="history", on_error="skip").report
    assert [(bad.row, bad.reason.endswith("[id 101]")) for bad in report.bad] == [(2, True)]


def test_zones_of_postgresql(postgresql: str) -> None:
    table = paper_003(DateTime(timezone=True), name="zoned")
    moment = START.replace(tzinfo=timezone(timedelta(hours=9)))
    row = {"id": 1, "Date and time": moment, "Variable name": "A", "Value": 1}
    made(postgresql, table, [row])
    with writing(postgresql) as connection:
        connection.execute(text("ALTER ROLE runglight SET timezone = 'Asia/Kolkata'"))
    assert rl.read_log(sql=postgresql, table="zoned").start == moment


def test_zones_of_mariadb(mariadb: str) -> None:
    # The server's own zone is five hours ahead; its TIMESTAMP is a moment, its DATETIME is not.
    with writing(mariadb) as connection:
        connection.execute(
            text(
                "CREATE TABLE zoned (id INT PRIMARY KEY, time TIMESTAMP(6), "
                "tag VARCHAR(9), value BIT(1))"
            )
        )
        connection.execute(text("INSERT INTO zoned VALUES (1, '2026-01-05 11:00:00.5', 'A', 1)"))
    log = rl.read_log(sql=mariadb, table="zoned")
    assert str(log.start) == "2026-01-05 06:00:00.500000+00:00"
    assert rows_of(log) == [("A", 1)]


def test_a_schema_of_mariadb(mariadb: str) -> None:
    with writing(mariadb) as connection:
        connection.execute(text("CREATE DATABASE line2"))
        connection.execute(
            text("CREATE TABLE line2.log (time DATETIME, tag VARCHAR(9), value INT)")
        )
        connection.execute(text("INSERT INTO line2.log VALUES ('2026-01-05 11:00:00', 'A', 1)"))
    assert rows_of(rl.read_log(sql=mariadb, table="line2.log")) == [("A", 1)]


def test_nothing_can_be_written(database: str) -> None:
    made(database, paper_003())
    with (
        pytest.raises(rl.InputError, match="cannot read") as raised,
        connected(database_url(database)) as connection,
    ):
        connection.execute(text("DELETE FROM history"))
    assert "hidden" not in str(raised.value)


def test_a_wrong_password_is_not_repeated(mariadb: str, runglight: Command, tmp_path: Path) -> None:
    url = mariadb.replace("hidden", "s3cret")
    ended = runglight("import", "--sql", url, "--table", "t", "--to", "out")
    assert ended.returncode == 2
    assert "cannot connect" in ended.stderr
    assert "s3cret" not in ended.stderr + ended.stdout
    assert not any("s3cret" in each.read_text() for each in tmp_path.rglob("*") if each.is_file())
