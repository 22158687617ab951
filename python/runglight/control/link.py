"""The link to a plant: every terminal read in one scan, outputs written."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from runglight.control.modbus_writer import WRITABLE, ModbusWriter
from runglight.control.terminals import Terminals, places_of, query_of
from runglight.errors import InputError
from runglight.taps.clock import SteadyClock
from runglight.taps.modbus import ModbusTap
from runglight.taps.modbus_connection import ModbusEndpoint
from runglight.taps.modbus_device import ModbusDevice
from runglight.taps.modbus_names import Area
from runglight.taps.polled import timeout_s
from runglight.taps.url import SourceUrl, parse_source

DEFAULT_NAMES = "openplc"
Image = list[int | None]


class PlantLink:
    """A Modbus TCP device that holds a plant's sensors and actuators.

    `url` is a source URL; without `coils=`, `inputs=` and so on, the addresses are found by the
    names of the terminals (`names=openplc` unless it says otherwise). `addresses` says where the
    device keeps terminals that are called otherwise. Raises InputError where that cannot be.
    """

    def __init__(
        self, url: str, terminals: Terminals, addresses: Mapping[str, str] | None = None
    ) -> None:
        source = parse_source(url)
        if source.scheme != "modbus":
            raise InputError(
                f"{source.text}: a plant is controlled over modbus, not over {source.scheme}; "
                "write modbus://HOST:502"
            )
        addresses = addresses or {}
        wanted = [addresses.get(name, name) for name in terminals.names]
        scheme = source.options.get("names", DEFAULT_NAMES)
        places = places_of(wanted, scheme, source.text)
        source = _reading(source, query_of(places), scheme)
        tap = ModbusTap(source, SteadyClock())
        self.url = source.text
        self.host = source.host
        self._terminals = terminals
        self._device = tap.device(own_thread=False)
        assert isinstance(self._device, ModbusDevice)
        number = {signal.name: n for n, signal in enumerate(self._device.signals)}
        self._order = [number[name] for name in wanted]
        self._places = [places[name] for name in wanted]
        for terminal in terminals.outputs:
            if self._places[terminal][0] not in WRITABLE:
                raise InputError(
                    f"{source.text}: {terminals.names[terminal]} is an output of the net, but "
                    f"{wanted[terminal]} cannot be written over Modbus"
                )
        unit = int(source.options.get("unit", "1"))
        self._writer = ModbusWriter(
            ModbusEndpoint(source.host, source.port, unit, timeout_s(source))
        )

    async def connect(self) -> None:
        """Connects anew; DeviceError where the device does not answer."""
        await self._device.connect()

    async def read(self) -> Image:
        """The values of all terminals; DeviceError where the device does not answer."""
        values = self._device.values(await self._device.read()).tolist()
        return [values[place] for place in self._order]

    async def write(self, writes: Sequence[tuple[int, int]]) -> None:
        """Writes terminals, in the order given; DeviceError where the device does not answer."""
        for terminal, _ in writes:
            if terminal not in self._terminals.outputs:
                raise AssertionError(f"{self._terminals.names[terminal]} is no output")
        await self._writer.write([(*self._places[t], value) for t, value in writes])

    async def close(self) -> None:
        """Lets go of both connections."""
        self._writer.close()
        await self._device.close()

    def spelled(self, writes: Sequence[tuple[int, int]]) -> str:
        """`%QX0.0=1, %QX0.1=0`."""
        return ", ".join(f"{self._terminals.names[t]}={value}" for t, value in writes)

    def output_places(self) -> list[str]:
        """What can be written, for people: `%QX0.0 (coil 0)`."""
        singular = {Area.COILS: "coil", Area.HOLDING: "holding register"}
        return [
            f"{self._terminals.names[t]} ({singular[self._places[t][0]]} {self._places[t][1]})"
            for t in sorted(self._terminals.outputs)
        ]


def _reading(source: SourceUrl, query: str, scheme: str) -> SourceUrl:
    """The URL with exactly the areas asked for: nothing else is read in a scan."""
    kept = {k: v for k, v in source.options.items() if k not in {area.value for area in Area}}
    areas = dict(part.split("=", 1) for part in query.split("&"))
    return replace(source, options=kept | areas | {"names": scheme})
