"""Every environment variable runglight looks at, in one place."""

import os

DEBUG = "RUNGLIGHT_DEBUG"
"""`1` shows the traceback of an unexpected error instead of one sentence."""

CI = "CI"
"""Set by build servers: no spinners, and the demo asks nothing."""

COLUMNS = "COLUMNS"
"""Width of printed tables in characters, where standard output is not a terminal."""

WEBHOOK_AUTHORIZATION = "RUNGLIGHT_WEBHOOK_AUTHORIZATION"
"""Authorization header of every request to the webhook: `Bearer …`. Never in a file or address."""

MQTT_PASSWORD = "RUNGLIGHT_MQTT_PASSWORD"
"""Password for the broker that findings are published to."""

PAGE_TOKEN = "RUNGLIGHT_TOKEN"
"""What others must type in before the page shows them anything: `runglight serve --token`."""

# NO_COLOR and FORCE_COLOR are honoured by rich, PATH by the search for Graphviz.


def debug() -> bool:
    """True where the user asked for tracebacks."""
    return os.environ.get(DEBUG, "") not in {"", "0"}


def unattended() -> bool:
    """True on a build server."""
    return os.environ.get(CI, "").lower() not in {"", "0", "false"}


def webhook_authorization() -> str | None:
    """Authorization header for the webhook."""
    return os.environ.get(WEBHOOK_AUTHORIZATION) or None


def mqtt_password() -> str | None:
    """Password for the broker that findings are published to."""
    return os.environ.get(MQTT_PASSWORD) or None


def page_token() -> str | None:
    """Token of the page."""
    return os.environ.get(PAGE_TOKEN) or None


def columns(default: int) -> int:
    """Width for output that goes to a file or a pipe."""
    text = os.environ.get(COLUMNS, "")
    return int(text) if text.isdecimal() and int(text) >= 40 else default
