"""Logs that stand in tables of a database: any that SQLAlchemy reaches.

Whole tables are fetched in time order, written to a temporary CSV file, and read from there as
every other file is, so that columns, times, errors and reports are the same
(docs/decisions/0004-tables-through-a-temporary-file.md). Imports to a directory take only what is
new, piece by piece, through the same file.
"""

from runglight.log.database.reading import read_table

__all__ = ["read_table"]
