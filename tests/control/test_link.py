"""The link to a plant: names found, outputs written together, nothing else."""

import asyncio

import pytest

from runglight.control.link import PlantLink
from runglight.control.terminals import Terminals, places_of, query_of
from runglight.errors import InputError
from runglight.plants.cell import RunningCell
from runglight.plants.tank import SYMBOLS, RunningTank
from runglight.softplc import serve
from runglight.taps.clock import SteadyClock
from runglight.taps.device import DeviceError
from runglight.taps.modbus_names import Area

ROWS = [(symbol.address, symbol.signal_class) for symbol in SYMBOLS]
TANK = Terminals.of(ROWS)


def tank() -> RunningTank:
    """A tank that begins now."""
    return RunningTank(SteadyClock().now_ns())


def test_names_are_found_in_every_scheme() -> None:
    names = {"openplc": ["%IX0.1", "%QX1.0"], "modbus": ["10002", "00009"], "iec": ["%I1", "%M8"]}
    for scheme, wanted in names.items():
        places = places_of(wanted, scheme, "here")
        assert set(places.values()) == {(Area.INPUTS, 1), (Area.COILS, 8)}
        assert query_of(places) == "inputs=1&coils=8"
    with pytest.raises(InputError, match=r"no address is called Tank-UL with names=openplc"):
        places_of(["Tank-UL"], "openplc", "here")


def test_outputs_written_together_change_in_one_moment() -> None:
    plant = tank()
    heard: list[tuple[int, int, int]] = []
    plant.on_change(lambda *change: heard.append(change))

    async def run() -> list[int | None]:
        async with serve(plant, "modbus://127.0.0.1:0", SteadyClock()) as plc:
            link = PlantLink(str(plc.url), TANK)
            await link.connect()
            await link.write([(4, 1), (3, 1)])
            image = await link.read()
            await link.close()
            return image

    assert asyncio.run(run())[3:] == [1, 1]
    times = [time_ns for time_ns, number, _ in heard if number >= 3]
    assert len(times) == 2
    assert len(set(times)) == 1


def test_symbol_names_are_translated() -> None:
    named = Terminals.of([(symbol.name, symbol.signal_class) for symbol in SYMBOLS])
    link = PlantLink(
        "modbus://127.0.0.1:1", named, {symbol.name: symbol.address for symbol in SYMBOLS}
    )
    assert link.output_places()[0] == "Tank-Valves-INV (coil 0)"


def test_what_cannot_be_controlled_is_refused() -> None:
    with pytest.raises(InputError, match="is controlled over modbus, not over s7"):
        PlantLink("s7://127.0.0.1", TANK)
    with pytest.raises(InputError, match=r"%IX0.0 is an output of the net"):
        PlantLink("modbus://127.0.0.1", Terminals.of([("%IX0.0", "output")]))


def test_a_plc_with_its_own_program_refuses_writes() -> None:
    async def run() -> None:
        async with serve(
            RunningCell(SteadyClock().now_ns()), "modbus://127.0.0.1:0", SteadyClock()
        ) as plc:
            link = PlantLink(str(plc.url), TANK)
            try:
                await link.connect()
                await link.write([(3, 1)])
            finally:
                await link.close()

    with pytest.raises(InputError, match=r"refuses a write to coil 0 \(exception 1\)"):
        asyncio.run(run())


def test_coils_that_are_no_outputs_are_no_address() -> None:
    async def run() -> None:
        async with serve(
            RunningTank(SteadyClock().now_ns()), "modbus://127.0.0.1:0", SteadyClock()
        ) as plc:
            link = PlantLink(str(plc.url), Terminals.of([("%QX0.2", "output")]))
            try:
                await link.write([(0, 1)])
            finally:
                await link.close()

    with pytest.raises(InputError, match=r"exception 2"):
        asyncio.run(run())


def test_nobody_there_is_a_lost_device() -> None:
    async def run() -> None:
        await PlantLink("modbus://127.0.0.1:1", TANK).write([(3, 1)])

    with pytest.raises(DeviceError, match="no connection to write"):
        asyncio.run(run())
