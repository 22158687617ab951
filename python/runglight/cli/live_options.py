"""Options of live watching, and the configuration they are laid over."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import msgspec
from cyclopts import Parameter

if TYPE_CHECKING:
    from runglight.configuration import Configuration

Settings = TypeVar("Settings", bound=msgspec.Struct)


@Parameter(name="*", group="Live watching")
@dataclass(frozen=True, kw_only=True)
class LiveOptions:
    """What happens beside watching where the source is a live one."""

    record: Path | None = None
    "Directory of a recording to make meanwhile."
    store: str | None = None
    "Database to copy findings to: `postgresql://user@host/database`."
    publish: str | None = None
    "MQTT broker and topic to publish findings and status to: `mqtt://host/topic`."
    webhook: str | None = None
    "Address to post every finding to, as JSON."
    metrics: str | None = None
    "`HOST:PORT` to answer Prometheus at; a port alone is on loopback."
    duration: Annotated[str | None, Parameter(name="--for")] = None
    "End after this time: `10m`."

    def over(self, configuration: Configuration) -> None:
        """Lays what was said over the configuration."""
        record = None if self.record is None else str(self.record)
        said = {"record": record, "store": self.store, "duration": self.duration}
        configuration.watch = _laid_over(configuration.watch, said)
        said = {"publish": self.publish, "webhook": self.webhook}
        configuration.notify = _laid_over(configuration.notify, said)
        configuration.server = _laid_over(configuration.server, {"metrics": self.metrics})

    def first_said(self) -> str | None:
        """One option that was given, as the user typed it."""
        for name in self.__dataclass_fields__:
            if getattr(self, name) is not None:
                return "--for" if name == "duration" else f"--{name}"
        return None


def _laid_over(settings: Settings, said: dict[str, str | None]) -> Settings:
    changes = {key: value for key, value in said.items() if value is not None}
    return msgspec.structs.replace(settings, **changes)
