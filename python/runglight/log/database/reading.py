"""A whole table as a log."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from runglight.log.database.connection import connected
from runglight.log.database.ignition import IgnitionHistory
from runglight.log.database.row_file import read_pages
from runglight.log.database.single_table import SingleTable
from runglight.log.database.url import database_url

if TYPE_CHECKING:
    from sqlalchemy import Connection
    from sqlalchemy.engine import URL

    from runglight.log.changelog import Log
    from runglight.log.options import ReadOptions


def read_table(options: ReadOptions) -> Log:
    """Reads the table that `options.sql` and `options.table` name."""
    url = database_url(options.sql or "")
    with connected(url) as connection:
        source = found_source(connection, url, options)
        with tempfile.TemporaryDirectory(prefix="runglight-") as directory:
            return read_pages(source.pages(connection), source, Path(directory), options)


def found_source(
    connection: Connection, url: URL, options: ReadOptions
) -> SingleTable | IgnitionHistory:
    """What options name: a historian's tables together, or one table."""
    history = IgnitionHistory.find(connection, url, options)
    return history or SingleTable.find(connection, url, options)
