"""One finding, decoded from its JSON line."""

from __future__ import annotations

import msgspec


class Expected(msgspec.Struct, frozen=True):
    """A signal-state that should have come."""

    state: str
    probability: float | None = None
    limit_s: float | None = None


class Suspect(msgspec.Struct, frozen=True):
    """A signal to look at."""

    address: str | None = None
    signal: str | None = None
    score: float | None = None


class Finding(msgspec.Struct, frozen=True):
    """One departure from the nominal model; the fields are those of the published schema."""

    id: str
    incident: str
    time: str
    kind: str
    severity: str
    state: str
    model: str
    message: str
    group: str | None = None
    device: str | None = None
    signal: str | None = None
    address: str | None = None
    from_state: str | None = msgspec.field(name="from", default=None)
    to_state: str | None = msgspec.field(name="to", default=None)
    expected: list[Expected] = []
    observed_s: float | None = None
    limit_s: float | None = None
    rank: int | None = None
    suspects: list[Suspect] = []
    path: list[str] = []
    snapshot_id: str | None = None

    @property
    def place(self) -> str:
        """Device in full (`Group1-PrtLDR`), or the group where the whole group is meant."""
        return full_name(self.group, self.device)


_decoder = msgspec.json.Decoder(Finding)


def decode_finding(line: str) -> Finding:
    """The finding of one JSON line."""
    return _decoder.decode(line)


def full_name(group: str | None, device: str | None) -> str:
    """`Group1-PrtLDR`; the group alone without a device."""
    if device is None:
        return group or ""
    return f"{group}-{device}" if group and not device.startswith(f"{group}-") else device
