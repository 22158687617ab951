"""What reading a log did: never a row or column left out without a word."""

import msgspec


class BadRow(msgspec.Struct):
    """A row that could not be read."""

    row: int
    reason: str


class LeftOut(msgspec.Struct):
    """A column that was not read."""

    column: str
    reason: str


class ReadReport(msgspec.Struct):
    """Format, rows, and everything that was not taken."""

    format: str | None = None
    rows: int = 0
    bad_rows: int = 0
    bad: list[BadRow] = []
    left_out: list[LeftOut] = []
    notes: list[str] = []

    def sentences(self, path: str) -> list[str]:
        """What the user must know of this file, one sentence each."""
        said = []
        if self.bad_rows:
            shown = "; ".join(f"row {bad.row}: {bad.reason}" for bad in self.bad[:5])
            rest = "" if self.bad_rows <= min(5, len(self.bad)) else "; …"
            rows = "1 row" if self.bad_rows == 1 else f"{self.bad_rows:,} rows"
            said.append(f"{path}: {rows} skipped ({shown}{rest})")
        reasons: dict[str, list[str]] = {}
        for left in self.left_out:
            reasons.setdefault(left.reason, []).append(left.column)
        for reason, columns in reasons.items():
            said.append(f"{path}: left out {', '.join(columns)}: {reason}")
        said.extend(f"{path}: {note}" for note in self.notes)
        return said
