"""What the served directory, the live machine and the incidents are to one another."""

from __future__ import annotations

import asyncio
import sqlite3
from typing import TYPE_CHECKING, TypeVar

import msgspec

from runglight.configuration import Configuration, load_configuration
from runglight.errors import InputError
from runglight.findings.acts import Act, Acts, Deed
from runglight.findings.store import FindingStore
from runglight.live.signal_names import names_in_model
from runglight.model import load_model
from runglight.moments import now_iso
from runglight.server.catalogue import Catalogue
from runglight.server.diagrams import Diagrams
from runglight.server.hub import Hub
from runglight.server.incidents import Incidents
from runglight.server.lights import DeviceLight, GroupLight, lit, trouble, worst
from runglight.server.live_watch import LiveWatch
from runglight.server.places import Place, places_of_log, places_of_model
from runglight.server.subjects import Subjects

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from runglight.model import NominalModel
    from runglight.server.catalogue import Item
    from runglight.server.live_feed import LiveFeed
    from runglight.server.policy import Policy
    from runglight.taps.clock import Clock

Result = TypeVar("Result")

NOTES_KEPT = 50
HISTORY_LINES = 50_000
CONFIGURATION_FILE = "runglight.toml"


class Note(msgspec.Struct, frozen=True):
    """A sentence for whoever looks."""

    time: str
    text: str


class Workshop:
    """Everything the routes answer from. Lives in the event loop."""

    def __init__(
        self,
        directory: Path,
        policy: Policy,
        *,
        configuration_path: Path | None = None,
        source: str | None = None,
        model: Path | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.directory = directory
        self.policy = policy
        self.configuration_path = configuration_path or directory / CONFIGURATION_FILE
        self.catalogue = Catalogue(directory)
        self.hub = Hub()
        self.incidents = Incidents()
        self.notes: list[Note] = []
        self.model: NominalModel | None = None
        self.model_item: Item | None = None
        self.places: dict[str, Place] = {}
        self.configuration = Configuration()
        self._source = source
        self._model_path = model
        self._acts: Acts | None = None
        self._store_lock = asyncio.Lock()
        self._lights: dict[str, DeviceLight] = {}
        self.live = LiveWatch(
            tell=self._tell, begun=self._begun, show=self._show, say=self.say, clock=clock
        )
        self.diagrams = Diagrams(self.configuration.log)
        self.subjects = Subjects(self.configuration.log)
        self._live_places: list[Place] = []
        self._last_signal: dict[str, tuple[int, str]] = {}

    async def open(self) -> None:
        """Reads the set-up and begins to watch; InputError where the set-up cannot be used."""
        self.configuration = self._load_configuration()
        self.diagrams = Diagrams(self.configuration.log)
        self.subjects = Subjects(self.configuration.log)
        self.model_item = self._choose_model()
        if self.model_item is not None:
            self.model = await asyncio.to_thread(load_model, self.model_item.path)
            self.places = places_of_model(self.model)
            await self._load_incidents(self.model_item.path)
        else:
            self.model, self.places = None, {}
        directory = None if self.model_item is None else self.model_item.path
        self.live.start(self.configuration, self.model, directory)

    async def close(self) -> None:
        """Ends watching, with everything kept."""
        await self.live.stop()
        if self._acts is not None:
            self._acts.close()
            self._acts = None

    async def reopen(self) -> None:
        """Begins anew with the set-up as it is now on the disk."""
        await self.close()
        self.incidents = Incidents()
        self._lights = {}
        self._live_places = []
        await self.open()
        self.hub.publish("resync", None)

    def say(self, sentence: str) -> None:
        """Tells whoever looks; from any thread."""
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            # The keeper's thread: the next look at the notes finds it.
            self.notes.append(Note(now_iso(), sentence))
            return
        self.notes.append(Note(now_iso(), sentence))
        del self.notes[:-NOTES_KEPT]
        self.hub.publish("note", self.notes[-1])

    async def act(
        self, deed: Deed, incident_ids: Iterable[str], who: str, until: str | None = None
    ) -> None:
        """Something an operator did; InputError for incidents that are not there."""
        ids = list(incident_ids)
        missing = [each for each in ids if self.incidents.get(each) is None]
        if missing:
            raise InputError(f"there is no incident {missing[0]} any more; look at the list again")
        if not who.strip():
            raise InputError("say who you are first: it is kept with what you do")
        now = now_iso()
        acts = [Act(each, deed, who.strip()[:80], now, until) for each in ids]
        if self._acts is not None:
            await self._in_store(self._acts.append, acts)
        changed = self.incidents.act(acts)
        if deed == "acknowledge":
            await self._keep_acknowledged(ids)
        self.changed(changed)

    def changed(self, incident_ids: Iterable[str]) -> None:
        """Tells the pages that incidents have changed, and the lights with them."""
        found = [self.incidents.get(each) for each in incident_ids]
        summaries = [self.incidents.summary(each) for each in found if each is not None]
        if summaries:
            self.hub.publish("incidents", summaries)
        self._publish_lights()

    def lights(self) -> list[GroupLight]:
        """The stack light of every group and device of the model, or of the live signals."""
        lights = trouble(self.incidents)
        connected = self.live.watching.state == "connected"
        devices: dict[str, dict[str, None]] = {}
        for place in self.places.values() if self.places else self._live_places:
            devices.setdefault(place.group, {})[place.full_device] = None
        told = self._device_states()
        groups = []
        for group, names in devices.items():
            rows = []
            for name in names:
                state, since_ms = told.get(name, (None, None))
                light = lit(name, lights, seen=connected and state is not None)
                short = name.removeprefix(f"{group}-")
                rows.append(DeviceLight(short, light, state, since_ms))
            own = lit(group, lights, seen=connected)
            groups.append(GroupLight(group, worst([own, *(row.light for row in rows)]), rows))
        return groups

    def live_signals(self) -> list[Place]:
        """The live tap's signals and where they belong, by index."""
        feed = self.live.feed
        if feed is None:
            return []
        signals = feed.tap.signals
        if len(signals) != len(self._live_places):
            name_of = (
                (lambda name, _address: name)
                if self.model is None
                else names_in_model(self.model, self.configuration.symbols)
            )
            places = places_of_log(
                [name_of(each.name, each.address) for each in signals], self.places
            )
            self._live_places = [
                msgspec.structs.replace(
                    place, address=signal.address or place.address, type=signal.type
                )
                for place, signal in zip(places, signals, strict=True)
            ]
        return self._live_places

    def log_signals(self, signals: Iterable[str], addresses: dict[str, str]) -> list[Place]:
        """A log's signals and where they belong."""
        names = list(signals)
        if self.model is not None:
            name_of = names_in_model(self.model, self.configuration.symbols)
            called = [name_of(name, addresses.get(name, name)) for name in names]
        else:
            called = names
        places = places_of_log(called, self.places)
        return [
            msgspec.structs.replace(place, address=addresses.get(name) or place.address)
            for name, place in zip(names, places, strict=True)
        ]

    async def with_store(self, look: Callable[[FindingStore], Result]) -> Result | None:
        """Looks into the findings store beside the model; None where there is none."""
        if self.model_item is None:
            return None
        path = self.model_item.path

        def work() -> Result:
            with FindingStore(path) as store:
                return look(store)

        return await asyncio.to_thread(work)

    def _load_configuration(self) -> Configuration:
        configuration = (
            load_configuration(self.configuration_path)
            if self.configuration_path.is_file()
            else Configuration()
        )
        if self._source is not None:
            configuration.source.url = self._source
        if configuration.symbols.table is None and (self.directory / "symbols.csv").is_file():
            configuration.symbols.table = str(self.directory / "symbols.csv")
        return configuration

    def _choose_model(self) -> Item | None:
        models = self.catalogue.items("model")
        wanted = self._model_path
        if wanted is None and self.configuration.server.model is not None:
            wanted = self.directory / self.configuration.server.model
        if wanted is not None:
            for item in models:
                if wanted.exists() and item.path.samefile(wanted):
                    return item
            raise InputError(
                f"{wanted}: there is no such model in {self.directory}; learn one with "
                f"runglight learn LOG -o {wanted}"
            )
        # The newest: a model learned anew is meant to be used.
        return max(
            models, key=lambda item: (item.path / "manifest.json").stat().st_mtime, default=None
        )

    async def _load_incidents(self, directory: Path) -> None:
        def load() -> tuple[list[str], list[Act], Acts | None]:
            try:
                with FindingStore(directory) as store:
                    first = max(store.last_sequence() - HISTORY_LINES, 0)
                    lines = [kept.line for kept in store.after(first, HISTORY_LINES)]
                acts = Acts(directory)
            except sqlite3.Error as error:
                self.say(f"{directory.name}: earlier findings cannot be read ({error})")
                return [], [], None
            return lines, acts.all(), acts

        lines, acts, self._acts = await asyncio.to_thread(load)
        self.incidents.take(lines, of_this_run=False)
        self.incidents.act(acts)

    async def _keep_acknowledged(self, incident_ids: list[str]) -> None:
        """For everybody else who is told of findings, it is a change of their state."""
        lines: list[str] = []
        for each in incident_ids:
            incident = self.incidents.get(each)
            if incident is None:
                continue
            for finding in incident.findings.values():
                if finding.severity != "notice" and finding.state != "acknowledged":
                    content = msgspec.to_builtins(finding) | {"state": "acknowledged"}
                    lines.append(msgspec.json.encode(content).decode())
        if lines and not self.live.keep(lines):
            await self.with_store(lambda store: store.append(lines))

    async def _in_store(self, work: Callable[..., None], *arguments: object) -> None:
        async with self._store_lock:
            await asyncio.to_thread(work, *arguments)

    def _tell(self, lines: list[str]) -> None:
        self.changed(self.incidents.take(lines))

    def _begun(self, feed: LiveFeed) -> None:
        self._live_places = []
        self._last_signal = {}
        self.live_signals()
        self.hub.publish("resync", None)

    def _show(self) -> None:
        ended = self.incidents.shelf_ends()
        self.hub.publish("status", self.status())
        self.changed(ended)

    def status(self) -> dict[str, object]:
        """What is told four times a second."""
        feed = self.live.feed
        recording = None
        if feed is not None and feed.recorder is not None and feed.meter is not None:
            recording = {
                "name": feed.recorder.directory.name,
                "rows": feed.recorder.rows,
                "seconds": feed.meter.recorded_s,
                "changes_per_s": feed.meter.changes_per_s,
                "free_bytes": feed.recorder.free_bytes,
            }
        return {
            "watching": self.live.watching,
            "until_ms": None if feed is None or not feed.until_ns else feed.until_ns / 1e6,
            "recording": recording,
        }

    def _device_states(self) -> dict[str, tuple[str, float]]:
        feed = self.live.feed
        newest: dict[str, tuple[int, str]] = {}
        if feed is None:
            return {}
        for index, place in enumerate(self.live_signals()):
            told = feed.value(index)
            if told is None:
                continue
            time_ns, value = told
            device = place.full_device
            if device not in newest or time_ns > newest[device][0]:
                newest[device] = (time_ns, _state(place, value))
        return {device: (state, time_ns / 1e6) for device, (time_ns, state) in newest.items()}

    def _publish_lights(self) -> None:
        """Tells which lights are other ones than before."""
        if not self.hub.subscribers:
            self._lights = {}
            return
        now = {
            f"{group.group}-{row.device}" if row.device else group.group: row
            for group in self.lights()
            for row in group.devices
        }
        changed = {name: row for name, row in now.items() if self._lights.get(name) != row}
        self._lights = now
        if changed:
            self.hub.publish("lights", changed)


def _state(place: Place, value: int) -> str:
    if place.type == "BOOL":
        return f"{place.signal}_{'ON' if value else 'OFF'}"
    return f"{place.signal}={value}"
