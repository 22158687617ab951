"""Tables of every shape, made and filled in any database."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from sqlalchemy import (
    BigInteger,
    Column,
    Connection,
    Double,
    Integer,
    MetaData,
    NullPool,
    SmallInteger,
    String,
    Table,
    create_engine,
    insert,
)

from runglight.log.database.url import database_url


@contextmanager
def writing(url: str) -> Iterable[Connection]:  # type: ignore[misc]
    """A connection that writes; commits at its end."""
    with create_engine(database_url(url), poolclass=NullPool).begin() as connection:
        yield connection


def made(url: str, table: Table, rows: Sequence[Mapping[str, Any]] = ()) -> Table:
    """Makes a table, with rows."""
    with writing(url) as connection:
        table.create(connection)
    add(url, table, rows)
    return table


def add(url: str, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Adds rows to a table."""
    if rows:
        with writing(url) as connection:
            connection.execute(insert(table), list(rows))


def paper_003(time: Any = None, value: Any = Integer, name: str = "history") -> Table:
    """`id; date and time; variable name; value`."""
    return Table(
        name,
        MetaData(),
        Column("id", BigInteger, primary_key=True, autoincrement=False),
        Column("Date and time", time or String(40)),
        Column("Variable name", String(80)),
        Column("Value", value),
    )


def kepserverex(time: Any = None) -> Table:
    """The table of KEPServerEX DataLogger."""
    return Table(
        "plant",
        MetaData(),
        Column("_NAME", String(64)),
        Column("_NUMERICID", Integer),
        Column("_VALUE", String(64)),
        Column("_TIMESTAMP", time or String(40)),
        Column("_QUALITY", SmallInteger),
    )


def ignition_partition(name: str) -> Table:
    """One partition of Ignition's tag history."""
    return Table(
        name,
        MetaData(),
        Column("tagid", Integer, primary_key=True, autoincrement=False),
        Column("intvalue", BigInteger),
        Column("floatvalue", Double),
        Column("stringvalue", String(255)),
        Column("datevalue", String(40)),
        Column("dataintegrity", Integer),
        Column("t_stamp", BigInteger, primary_key=True, autoincrement=False),
    )


def ignition_lists() -> dict[str, Table]:
    """The tables that say what the partitions hold."""
    data = MetaData()

    def numbers(*names: str) -> list[Column[int]]:
        return [Column(name, BigInteger) for name in names]

    return {
        "sqlth_te": Table(
            "sqlth_te",
            data,
            Column("id", Integer, primary_key=True),
            Column("tagpath", String(255)),
            *numbers("scid", "datatype", "querymode", "created", "retired"),
        ),
        "sqlth_partitions": Table(
            "sqlth_partitions",
            data,
            Column("pname", String(64)),
            *numbers("drvid", "start_time", "end_time", "blocksize", "flags"),
        ),
        "sqlth_scinfo": Table(
            "sqlth_scinfo",
            data,
            Column("id", Integer),
            Column("scname", String(64)),
            *numbers("drvid"),
        ),
        "sqlth_drv": Table(
            "sqlth_drv",
            data,
            Column("id", Integer),
            Column("name", String(64)),
            Column("provider", String(64)),
        ),
    }
