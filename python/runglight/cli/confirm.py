"""`runglight confirm`: the operator accepts an alarm path into the model."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path

from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.errors import InputError
from runglight.findings.acceptance import refuse_without_path
from runglight.findings.finding import decode_finding
from runglight.findings.store import FindingStore
from runglight.model import load_model


def confirm(model: Path, finding_id: str, /) -> int:
    """Accept a finding's path: from now on it is nominal.

    For a way the machine may take that was not in the learned logs, and that ended well.

    Parameters
    ----------
    model: Path
        Model directory; `runglight watch` has kept the finding there.
    finding_id: str
        The id, as `runglight watch` shows it.

    """
    nominal = load_model(model)
    line = _newest(model, finding_id)
    finding = decode_finding(line)
    refuse_without_path(finding)
    new = nominal.confirm(line)
    path = " → ".join(finding.path)
    console = terminal.results()
    if new == 0:
        console.print(Text(f"{finding_id} is already known (0 new): {path}"), soft_wrap=True)
        return DONE
    nominal.save(model)
    _acknowledge(model, line)
    console.print(
        Text(f"{model}: {counted(new, 'new transition')} of {finding.place}: {path}"),
        soft_wrap=True,
    )
    return DONE


def _newest(model: Path, finding_id: str) -> str:
    try:
        with FindingStore(model, create=False) as store:
            line = store.newest(finding_id)
            near = [] if line is not None else store.nearest_ids(finding_id)
    except sqlite3.Error as error:
        raise InputError(
            f"{model}: no findings are kept here ({error}); run runglight watch {model} LOG first"
        ) from None
    if line is None:
        known = f"nearest: {', '.join(near)}" if near else "there are none yet"
        raise InputError(f"{model}: no finding {finding_id!r} is kept here; {known}")
    return line


def _acknowledge(model: Path, line: str) -> None:
    acknowledged = json.loads(line) | {"state": "acknowledged"}
    try:
        with FindingStore(model) as store:
            store.append([json.dumps(acknowledged, ensure_ascii=False, separators=(",", ":"))])
    except sqlite3.Error as error:
        terminal.note(f"{model}: the finding could not be marked as acknowledged ({error})")
