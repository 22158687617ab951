"""The press served over S7: polled as the paper polls, learned, broken, and the address named."""

import json
from collections.abc import Callable

import numpy as np
from snap7.client import Client
from snap7.type import Area

from runglight.log.changelog import Log
from runglight.model import learn_cycle
from runglight.plants.press import FAILURES, INPUTS, MODES, REGIONS, RunningPress
from tests.softplc.plants import Steered, served
from tests.softplc.test_s7_server import START_NS, URL, client_of

POLL_NS = 100_000_000
MEMORY = ("M0.0", "M0.1", "M0.2")
SIGNALS = (*(symbol.address for symbol in INPUTS), *MEMORY)


def polled(client: Client, clock: Steered, until: Callable[[], bool]) -> Log:
    """Reads PE and MK again and again; the press's clock advances with each reading."""
    rows: list[tuple[int, int, int]] = []
    before: list[int | None] = [None] * len(SIGNALS)
    while not until():
        clock.time_ns += POLL_NS
        inputs = client.read_area(Area.PE, 0, 0, 27)
        memory = client.read_area(Area.MK, 0, 0, 1)
        image = [byte >> bit & 1 for byte in inputs for bit in range(8)]
        image += [memory[0] >> bit & 1 for bit in range(len(MEMORY))]
        for number, (old, new) in enumerate(zip(before, image, strict=True)):
            if old != new:
                rows.append((clock.time_ns, number, new))
        before = list(image)
    time_ns, signal, value = zip(*rows, strict=True)
    return Log.from_columns(
        np.array(time_ns, dtype=np.int64),
        np.array(signal, dtype=np.uint32),
        np.array(value, dtype=np.int64),
        SIGNALS,
    )


def test_the_failing_address_over_s7() -> None:
    press, clock = RunningPress(START_NS), Steered(START_NS)
    with served(press, URL, clock) as (plc, _), client_of(plc) as client:
        assert "pe=0-26&pa=0-4&mk=0" in plc.tap_url
        nominal = polled(client, clock, lambda: press.cycles >= 14)
        press.inject("clamp2-adv-dead")
        broken = polled(client, clock, lambda: press.cycles >= 17)
    model = learn_cycle(nominal, MODES, REGIONS)
    monitor = model.monitor()
    lines = monitor.observe(broken).json_lines() + monitor.finish().json_lines()
    [cause] = [each for each in map(json.loads, lines) if each["rank"] == 1]
    [place] = FAILURES[1].shows
    address = next(symbol.address for symbol in INPUTS if symbol.short_name == place)
    assert cause["suspects"][0]["address"] == address == "I12.2"
