"""Directories that an import fills piece by piece: Parquet segments, and a bookmark.

DIR/imported.json     segments, bookmark, what was left out: replaced whole with every step
DIR/000001.parquet    changes in time order
"""

from runglight.log.imported.directory import ImportDirectory
from runglight.log.imported.reading import is_imported, read_imported

__all__ = ["ImportDirectory", "is_imported", "read_imported"]
