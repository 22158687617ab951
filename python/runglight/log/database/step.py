"""One step of an import: rows that are new, and the bookmark behind them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from runglight.errors import InputError

if TYPE_CHECKING:
    from runglight.log.database.bookmark import Bookmark
    from runglight.log.database.page import Page


@dataclass(frozen=True)
class Step:
    """Rows that were not read before."""

    page: Page
    bookmark: Bookmark


def refuse_other_table(shown: str, missing: str) -> InputError:
    """The sentence on a table that is no longer the one the bookmark is of."""
    return InputError(
        f"{shown}: was emptied or made anew since the last import ({missing} is no longer there); "
        "import it to a new directory"
    )
