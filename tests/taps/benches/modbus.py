"""A Modbus device with sixteen coils, eight inputs and four holding registers."""

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from tests.taps.benches.bench import LOOPBACK, Bench, free_port

WRITE_COIL, READ_INPUTS, READ_INPUT_REGISTERS, WRITE_REGISTER = 5, 2, 4, 6


def bits(count: int) -> list[SimData]:
    return [SimData(0, values=[False] * count, datatype=DataType.BITS)]


def registers(count: int) -> list[SimData]:
    return [SimData(0, values=[0] * count, datatype=DataType.REGISTERS)]


class ModbusBench(Bench):
    signals = (
        *(f"1{number:04}" for number in range(1, 9)),
        *(f"0{number:04}" for number in range(1, 17)),
        *(f"4{number:04}" for number in range(1, 5)),
    )
    changing = "00004"
    name_of_missing = "40006"

    def __init__(
        self,
        *,
        host: str = LOOPBACK,
        port: int | None = None,
        coils: int = 16,
        inputs: int = 8,
        holding: int = 4,
    ) -> None:
        self.host = host
        self.port = port or free_port()
        self._sizes = (coils, inputs, holding)
        self._server: ModbusTcpServer | None = None

    @property
    def url(self) -> str:
        return f"modbus://{self.host}:{self.port}?coils=0-15&inputs=0-7&holding=0-3"

    @property
    def missing_url(self) -> str:
        return f"modbus://127.0.0.1:{self.port}?coils=0-15&holding=0-5"

    @property
    def unreachable_url(self) -> str:
        return f"modbus://127.0.0.1:{free_port()}?coils=0-15"

    async def start(self) -> None:
        coils, inputs, holding = self._sizes
        # Input registers last: every block needs at least one.
        device = SimDevice(1, (bits(coils), bits(inputs), registers(holding), registers(2)))
        self._server = ModbusTcpServer(device, address=(self.host, self.port))
        await self._server.serve_forever(background=True)

    async def change(self, value: int) -> None:
        await self.write(WRITE_COIL, 3, [bool(value)])

    async def write(self, function: int, address: int, values: list[int] | list[bool]) -> None:
        assert self._server is not None
        assert await self._server.async_setValues(1, function, address, values) is None

    async def kill(self) -> None:
        if self._server is not None:
            await self._server.shutdown()
            self._server = None
