"""A table, as the terminal shows it and as the page does."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich import box
from rich.table import Table as RichTable
from rich.text import Text


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text; all columns but the first `left` are numbers."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: int = 1

    def markdown(self) -> str:
        """The table alone, without its title."""
        rulers = ["---" if at < self.left else "---:" for at in range(len(self.columns))]
        lines = [self.columns, rulers, *self.rows]
        return "".join(f"| {' | '.join(line)} |\n" for line in lines)

    def rich(self) -> RichTable:
        """The table for a terminal."""
        shown = RichTable(
            title=self.title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False
        )
        for at, column in enumerate(self.columns):
            shown.add_column(column, justify="left" if at < self.left else "right")
        for row in self.rows:
            shown.add_row(*(Text(cell.replace("**", "").replace("`", "")) for cell in row))
        return shown


def verdict(met: bool) -> str:
    """How a figure stands to what was demanded of it."""
    return "MET" if met else "**MISSED**"


def share(part: float, whole: float, decimals: int = 1) -> str:
    """A share in percent; a dash where there is nothing to share."""
    return f"{100 * part / whole:.{decimals}f} %" if whole else "-"
