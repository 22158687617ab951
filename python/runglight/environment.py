"""Every environment variable runglight looks at, in one place."""

import os

DEBUG = "RUNGLIGHT_DEBUG"
"""`1` shows the traceback of an unexpected error instead of one sentence."""

CI = "CI"
"""Set by build servers: no spinners, and the demo asks nothing."""

COLUMNS = "COLUMNS"
"""Width of printed tables in characters, where standard output is not a terminal."""

# NO_COLOR and FORCE_COLOR are honoured by rich, PATH by the search for Graphviz.


def debug() -> bool:
    """True where the user asked for tracebacks."""
    return os.environ.get(DEBUG, "") not in {"", "0"}


def unattended() -> bool:
    """True on a build server."""
    return os.environ.get(CI, "").lower() not in {"", "0", "false"}


def columns(default: int) -> int:
    """Width for output that goes to a file or a pipe."""
    text = os.environ.get(COLUMNS, "")
    return int(text) if text.isdecimal() and int(text) >= 40 else default
