"""Changes as they were read, before they are sorted into parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa


@dataclass(frozen=True)
class Changes:
    """Rows of one read; a row without a signal is a heartbeat, whose time alone counts."""

    time_ns: Any
    """int64: nanoseconds since 1970, UTC."""
    signal: Any
    """Dictionary array of names, null for a heartbeat."""
    value: Any
    """int64."""
    plant: Any
    """Dictionary array of names."""
    partition: Any
    """int32."""
    offset: int = 0
    """Where the first row stood in its partition."""
    unreadable: int = 0
    first: str = ""
    """What was wrong with the first that could not be read, and where it stood."""

    def __len__(self) -> int:
        return len(self.time_ns)

    def only(self, wanted: Any) -> Changes:
        """The rows where a boolean array is true."""
        chosen = pa.array(wanted)
        return Changes(
            self.time_ns[wanted],
            self.signal.filter(chosen),
            self.value[wanted],
            self.plant.filter(chosen),
            self.partition[wanted],
            self.offset,
            self.unreadable,
            self.first,
        )

    def blaming(self, count: int, first: str) -> Changes:
        """The same rows, and some more that could not be read."""
        return Changes(
            self.time_ns,
            self.signal,
            self.value,
            self.plant,
            self.partition,
            self.offset,
            self.unreadable + count,
            self.first or first,
        )


def names(texts: Any) -> Any:
    """Names as a dictionary array: of an Arrow array, or of a list."""
    array = texts if isinstance(texts, pa.Array) else pa.array(texts, pa.string())
    encoded = array.dictionary_encode()
    return encoded.cast(pa.dictionary(pa.int32(), pa.string()))


def everywhere(name: str, rows: int) -> Any:
    """One name for all rows."""
    return pa.DictionaryArray.from_arrays(pa.array(np.zeros(rows, np.int32)), pa.array([name]))
