"""The server that is scanned, in its own process: `python -m benches.scanning_server s7 PORT`.

400 Modbus variables or 27 S7 input bytes; one of them changes every 100 ms. Says `ready` when it
serves, and ends when its standard input does.
"""

import asyncio
import sys
from collections.abc import Awaitable, Callable

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice
from snap7.server import Server
from snap7.type import SrvArea

MODBUS_VARIABLES = 400
S7_BYTES = 27
CHANGE_EVERY_S = 0.1
_WRITE_COIL = 5


async def _modbus(port: int) -> Callable[[int], Awaitable[None]]:
    bits = [SimData(0, values=[False] * MODBUS_VARIABLES, datatype=DataType.BITS)]
    words = [SimData(0, values=[0], datatype=DataType.REGISTERS)]
    device = SimDevice(1, (bits, bits, words, words))
    server = ModbusTcpServer(device, address=("127.0.0.1", port))
    await server.serve_forever(background=True)

    async def change(value: int) -> None:
        await server.async_setValues(1, _WRITE_COIL, MODBUS_VARIABLES // 2, [bool(value)])

    return change


async def _s7(port: int) -> Callable[[int], Awaitable[None]]:
    inputs = bytearray(S7_BYTES)
    server = Server(log=False)
    server.register_area(SrvArea.PE, 0, inputs)
    server.start_to("127.0.0.1", port)

    async def change(value: int) -> None:
        inputs[S7_BYTES // 2] = value

    return change


SERVERS = {"modbus": _modbus, "s7": _s7}


async def _serve(protocol: str, port: int) -> None:
    change = await SERVERS[protocol](port)
    print("ready", flush=True)
    ended = asyncio.ensure_future(asyncio.to_thread(sys.stdin.read))
    value = 0
    while not ended.done():
        await asyncio.sleep(CHANGE_EVERY_S)
        value = 1 - value
        await change(value)


if __name__ == "__main__":
    asyncio.run(_serve(sys.argv[1], int(sys.argv[2])))
