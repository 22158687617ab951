"""A bench's server in a process of its own: `python -m tests.taps.benches.serve modbus HOST PORT`.

Says `ready` when it serves, and ends when its standard input does.
"""

import asyncio
import sys

from tests.taps.benches.modbus import ModbusBench
from tests.taps.benches.s7 import S7Bench

SERVERS = {"modbus": ModbusBench, "s7": S7Bench}


async def _serve(protocol: str, host: str, port: int) -> None:
    bench = SERVERS[protocol](host=host, port=port)
    await bench.start()
    print("ready", flush=True)
    await asyncio.to_thread(sys.stdin.read)
    await bench.kill()


if __name__ == "__main__":
    asyncio.run(_serve(sys.argv[1], sys.argv[2], int(sys.argv[3])))
