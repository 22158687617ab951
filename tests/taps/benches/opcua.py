"""asyncua's own server, in this process: an object `Station` with `Clamp` and `Step`."""

from asyncua import Server, ua

from tests.taps.benches.bench import Bench, free_port


class OpcUaBench(Bench):
    polls = False
    changing = "Station-Clamp"
    name_of_missing = None

    def __init__(self) -> None:
        self.signals = ["Station-Clamp", "Station-Step"]
        self.port = free_port()
        self.server: Server | None = None
        self.namespace = 2
        self.keeps = False
        """Whether values outlive a restart."""
        self._zero()

    def _zero(self) -> None:
        self.values: dict[str, bool | int] = {"Clamp": False, "Step": 0}

    @property
    def url(self) -> str:
        return self.url_at(self.port)

    @staticmethod
    def url_at(port: int) -> str:
        return f"opcua://127.0.0.1:{port}/line?timeout=1"

    @property
    def missing_url(self) -> str:
        return f"{self.url}&browse=ns=2;s=Nowhere"

    @property
    def unreachable_url(self) -> str:
        return self.url_at(free_port())

    async def start(self) -> None:
        if not self.keeps:
            self._zero()
        server = self.server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{self.port}/line")
        self.namespace = await server.register_namespace("urn:runglight:test")
        self.station = await server.nodes.objects.add_object(
            ua.NodeId("Station", self.namespace), f"{self.namespace}:Station"
        )
        self.nodes = {}
        for name, value in self.values.items():
            kind = ua.VariantType.Boolean if isinstance(value, bool) else ua.VariantType.Int16
            self.nodes[name] = await self.station.add_variable(
                ua.NodeId(name, self.namespace), f"{self.namespace}:{name}", value, kind
            )
        await self.more(server)
        await server.start()

    async def more(self, server: Server) -> None:
        """Further nodes."""

    async def kill(self) -> None:
        if self.server is not None:
            server, self.server = self.server, None
            await server.stop()

    async def change(self, value: int) -> None:
        await self.put(self.changing, value)

    async def put(self, name: str, value: int) -> None:
        short = name.removeprefix("Station-")
        content = bool(value) if isinstance(self.values[short], bool) else value
        self.values[short] = content
        kind = ua.VariantType.Boolean if isinstance(content, bool) else ua.VariantType.Int16
        if self.server is not None:
            await self.nodes[short].write_value(content, kind)
