"""What is known of one Sparkplug edge node: its births, aliases, and whether messages were lost."""

from dataclasses import dataclass, field

from runglight.taps.sparkplug_payload import Metric, Payload

NODE = ""
"""The device name under which an edge node keeps metrics of its own."""


@dataclass(frozen=True, slots=True)
class Born:
    """A metric as its birth told it."""

    device: str
    name: str
    datatype: int


@dataclass(slots=True)
class EdgeNode:
    """One edge node of a group; all times are ours, in ns."""

    group: str
    name: str
    bd_seq: int | None = None
    born: bool = False
    devices: set[str] = field(default_factory=set)
    """Devices born and not dead; `NODE` for the node itself."""
    unseen_since_ns: dict[str, int] = field(default_factory=dict)
    """Devices that were born once and are dead or doubtful, and since when."""
    asked_ns: int | None = None
    """When a rebirth was asked for last; None where it was answered."""
    _next_seq: int | None = None
    _by_name: dict[tuple[str, str], Born] = field(default_factory=dict)
    _by_alias: dict[int, Born] = field(default_factory=dict)

    def in_sequence(self, seq: int | None) -> bool:
        """Whether no message is missing before this one (Sparkplug 3.0.0, 6.4.1: 0 to 255)."""
        if seq is None or self._next_seq is None:
            self._next_seq = None if seq is None else (seq + 1) % 256
            return True
        complete = seq == self._next_seq
        self._next_seq = (seq + 1) % 256
        return complete

    def birth(self, device: str, payload: Payload) -> None:
        """NBIRTH or DBIRTH: the only messages that name types, and aliases with their names."""
        if device == NODE:
            # A node's birth ends everything before it, its devices included.
            self._by_name.clear()
            self._by_alias.clear()
            self.devices.clear()
            self.bd_seq = payload.bd_seq()
            self.born = True
            self.asked_ns = None
            self._next_seq = None if payload.seq is None else (payload.seq + 1) % 256
        self.devices.add(device)
        for metric in payload.metrics:
            if metric.name is None:
                continue
            born = Born(device, metric.name, metric.datatype or 0)
            self._by_name[device, metric.name] = born
            if metric.alias is not None:
                self._by_alias[metric.alias] = born

    def find(self, device: str, metric: Metric) -> Born | None:
        """The birth of a metric of a data message; None where it is not known."""
        if metric.name is not None and (born := self._by_name.get((device, metric.name))):
            return born
        born = None if metric.alias is None else self._by_alias.get(metric.alias)
        return born if born is not None and born.device == device else None

    def unseen(self, device: str, since_ns: int) -> set[str]:
        """The device (the whole node for `NODE`) is dead or doubtful; what that concerns."""
        concerned = set(self.devices) if device == NODE else {device} & self.devices
        for name in concerned:
            self.unseen_since_ns.setdefault(name, since_ns)
        return concerned

    def death(self, device: str, since_ns: int) -> set[str]:
        """NDEATH or DDEATH; the devices it concerns."""
        concerned = self.unseen(device, since_ns)
        self.devices -= concerned
        if device == NODE:
            self.born = False
            self._next_seq = None
        return concerned
