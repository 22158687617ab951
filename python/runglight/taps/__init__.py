"""Live sources: Modbus, S7, OPC UA, MQTT, Sparkplug B, and the replay of a log."""

from importlib import import_module
from typing import TYPE_CHECKING

from runglight.errors import InputError
from runglight.taps.registry import SCHEMES
from runglight.taps.url import is_live, parse_source

if TYPE_CHECKING:
    from runglight.taps.base import Tap
    from runglight.taps.clock import Clock

__all__ = ["is_live", "open_tap", "parse_source"]


def open_tap(source: str, *, interval: str | None = None, clock: "Clock | None" = None) -> "Tap":
    """The tap of a source URL; it connects when it is iterated.

    `interval` (`10ms`) is used where the URL names none. Raises InputError for a URL that cannot
    work, and where the library of its protocol is not installed.
    """
    url = parse_source(source)
    if interval is not None:
        url.options.setdefault("interval", interval)
    scheme = SCHEMES[url.scheme]
    module, _, name = scheme.home.partition(":")
    try:
        tap_class = getattr(import_module(module), name)
    except ModuleNotFoundError as missing:
        if scheme.extra is None or (missing.name or "").startswith("runglight"):
            raise
        raise InputError(
            f"{url.text}: {url.scheme} needs {missing.name}: "
            f'pip install "runglight[{scheme.extra}]"'
        ) from None
    if clock is None:
        from runglight.taps.clock import SteadyClock  # noqa: PLC0415

        clock = SteadyClock()
    tap: Tap = tap_class(url, clock)
    return tap
