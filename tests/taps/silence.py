"""What every polled tap does about a device that accepts connections and never answers."""

import asyncio

import pytest

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState
from tests.taps.scripted_server import ScriptedServer, never_complete


async def is_retried_for_ever(scheme: str, query: str, reason: str) -> None:
    """Checking says `reason`; a reader waits while the tap connects again and again."""
    async with ScriptedServer(lambda frame: None, never_complete) as server:
        url = f"{scheme}://127.0.0.1:{server.port}?{query}"
        with pytest.raises(InputError, match=reason):
            await open_tap(url).check()
        async with open_tap(url) as tap:
            reading = asyncio.ensure_future(anext(aiter(tap)))
            while server.connections < 4:
                await asyncio.sleep(0.01)
            assert not reading.done()
            assert tap.connection.state is ConnectionState.RETRYING
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
