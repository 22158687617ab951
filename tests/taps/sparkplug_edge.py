"""A Sparkplug B edge node, with an encoder of its own: written from the specification's table of
fields with `struct` and lists, not with the code it tests."""

import asyncio
import time
from contextlib import suppress

import aiomqtt

TYPES = {"Int8": 1, "Int16": 2, "Int32": 3, "Int64": 4, "UInt8": 5, "UInt16": 6, "UInt32": 7,
         "UInt64": 8, "Float": 9, "Double": 10, "Boolean": 11, "String": 12, "DataSet": 16,
         "Template": 19}  # fmt: skip


def number(value: int) -> bytes:
    groups = []
    while True:
        groups.append(value % 128)
        value //= 128
        if not value:
            break
    return bytes([group + 128 for group in groups[:-1]] + [groups[-1]])


def field(position: int, content: int | bytes | str) -> bytes:
    if isinstance(content, int):
        return number(position * 8) + number(content)
    raw = content.encode() if isinstance(content, str) else content
    return number(position * 8 + 2) + number(len(raw)) + raw


def metric(  # noqa: PLR0911
    value: object,
    kind: str | None = None,
    *,
    name: str | None = None,
    alias: int | None = None,
    time_ms: int | None = None,
    historical: bool = False,
    meant: str | None = None,
) -> bytes:
    """One metric; `meant` is the type where a data message does not name it."""
    parts = b""
    if name is not None:
        parts += field(1, name)
    if alias is not None:
        parts += field(2, alias)
    if time_ms is not None:
        parts += field(3, time_ms)
    if kind is not None:
        parts += field(4, TYPES[kind])
    if historical:
        parts += field(5, 1)
    kind = kind or meant or ("Boolean" if isinstance(value, bool) else "Int32")
    if value is None:
        return parts + field(7, 1)
    if kind in ("Float", "Double"):
        import struct  # noqa: PLC0415

        wide = kind == "Double"
        position, wire = (13, 1) if wide else (12, 5)
        return parts + number(position * 8 + wire) + struct.pack("<d" if wide else "<f", value)
    if kind == "Boolean":
        return parts + field(14, int(bool(value)))
    if kind == "String":
        return parts + field(15, str(value))
    if kind in ("DataSet", "Template"):
        return parts + field(17 if kind == "DataSet" else 18, b"\x08\x01")
    assert isinstance(value, int)
    if kind in ("Int64", "UInt64"):
        return parts + field(11, value % 2**64)
    return parts + field(10, value % 2**32)


def payload(metrics: list[bytes], seq: int | None = None, time_ms: int | None = None) -> bytes:
    parts = field(1, time_ms if time_ms is not None else time.time_ns() // 1_000_000)
    for content in metrics:
        parts += field(2, content)
    return parts if seq is None else parts + field(3, seq)


class Edge:
    """Edge node `Cell` of group `line` with the device `Station`: `Clamp` and `Step`."""

    def __init__(self, port: int, *, answers: bool = True) -> None:
        self._port = port
        self._answers = answers
        self._seq = 0
        self.bd_seq = 0
        self.values: dict[str, int] = {"Clamp": 0, "Step": 0}
        self.node_metrics: list[bytes] = [metric(4.7, "Double", name="Temperature", alias=1)]
        self.asked = 0
        self.commands: list[tuple[str, bytes]] = []

    def _next(self) -> int:
        seq, self._seq = self._seq, (self._seq + 1) % 256
        return seq

    def _death(self) -> bytes:
        return payload([metric(self.bd_seq, "UInt64", name="bdSeq")])

    async def start(self) -> None:
        self._client = aiomqtt.Client(
            "127.0.0.1",
            self._port,
            will=aiomqtt.Will("spBv1.0/line/NDEATH/Cell", self._death(), qos=1),
        )
        await self._client.__aenter__()
        await self._client.subscribe("spBv1.0/line/NCMD/Cell")
        self._listening = asyncio.create_task(self._listen())
        await self.birth()

    async def stop(self, *, death: bool = True) -> None:
        self._listening.cancel()
        await asyncio.wait([self._listening])
        with suppress(aiomqtt.MqttError):
            if death:
                await self.publish("NDEATH", "", self._death())
            await self._client.__aexit__(None, None, None)

    async def publish(self, kind: str, device: str, data: bytes) -> None:
        topic = f"spBv1.0/line/{kind}/Cell" + (f"/{device}" if device else "")
        await self._client.publish(topic, data)

    async def birth(self) -> None:
        self._seq = 0
        born = [
            metric(self.bd_seq, "UInt64", name="bdSeq"),
            metric(False, "Boolean", name="Node Control/Rebirth"),
            *self.node_metrics,
        ]
        await self.publish("NBIRTH", "", payload(born, self._next()))
        await self.device_birth()

    async def device_birth(self) -> None:
        born = [
            metric(bool(self.values["Clamp"]), "Boolean", name="Clamp", alias=10),
            metric(self.values["Step"], "Int16", name="Step", alias=11),
        ]
        await self.publish("DBIRTH", "Station", payload(born, self._next()))

    async def put(self, name: str, value: int, **more: object) -> None:
        self.values[name] = value
        content = bool(value) if name == "Clamp" else value
        alias = {"Clamp": 10, "Step": 11}[name]
        changed = metric(content, alias=alias, **more)  # type: ignore[arg-type]
        await self.publish("DDATA", "Station", payload([changed], self._next()))

    def lose(self) -> None:
        """A message is lost on the way."""
        self._next()

    async def _listen(self) -> None:
        with suppress(aiomqtt.MqttError):
            async for message in self._client.messages:
                assert isinstance(message.payload, bytes)
                self.commands.append((str(message.topic), message.payload))
                if b"Node Control/Rebirth" in message.payload:
                    self.asked += 1
                    if self._answers:
                        await self.birth()
