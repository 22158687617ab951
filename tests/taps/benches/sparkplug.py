"""A broker, and an edge node that answers rebirth requests."""

from tests.taps.benches.bench import Bench, free_port
from tests.taps.benches.broker import Broker
from tests.taps.cable import Cable
from tests.taps.sparkplug_edge import Edge


class SparkplugBench(Bench):
    polls = False
    changing = "Cell-Station-Clamp"

    def __init__(self) -> None:
        self.signals = ["Cell-Station-Clamp", "Cell-Station-Step"]
        self.broker = Broker()
        # The edge node is there before a tap can connect: it hears the request for its birth.
        self.door = Cable(self.broker.port, free_port())
        self.port = self.door.port
        self.edge = Edge(self.broker.port)
        self.keeps = False
        """Whether values outlive a restart."""
        self._running = False

    @property
    def url(self) -> str:
        """Names the edge node, so that it is asked for its birth at once."""
        return self.url_at(self.port)

    @property
    def group_url(self) -> str:
        return f"sparkplug://127.0.0.1:{self.port}/line?timeout=1&keepalive=1"

    @staticmethod
    def url_at(port: int) -> str:
        return f"sparkplug://127.0.0.1:{port}/line/Cell?timeout=1&keepalive=1"

    @property
    def missing_url(self) -> str:
        return f"sparkplug://127.0.0.1:{self.port}/line/Cell/Station"

    @property
    def unreachable_url(self) -> str:
        return self.url_at(free_port())

    async def start(self) -> None:
        if not self.keeps:
            self.edge.values = dict.fromkeys(self.edge.values, 0)
        await self.broker.start()
        await self.edge.start()
        self._running = True
        await self.door.open()

    async def kill(self) -> None:
        await self.door.close()
        await self.broker.kill()
        if self._running:
            self._running = False
            await self.edge.stop(death=False)

    async def change(self, value: int) -> None:
        await self.put(self.changing, value)

    async def put(self, name: str, value: int) -> None:
        short = name.removeprefix("Cell-Station-")
        if self._running:
            await self.edge.put(short, value)
        else:
            self.edge.values[short] = value
