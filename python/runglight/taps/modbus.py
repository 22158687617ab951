"""Modbus TCP: `modbus://HOST:502?unit=1&coils=0-99&inputs=0-63&holding=0-299&names=openplc`."""

from runglight.errors import InputError
from runglight.taps.clock import Clock
from runglight.taps.device import Device
from runglight.taps.modbus_connection import ModbusEndpoint
from runglight.taps.modbus_device import ModbusDevice
from runglight.taps.modbus_names import Area, check_scheme
from runglight.taps.polled import PolledTap, timeout_s
from runglight.taps.ranges import parse_ranges
from runglight.taps.url import SourceUrl

UNIT = "1"


class ModbusTap(PolledTap):
    """Reads coils, discrete inputs, input and holding registers; never writes."""

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        self._timeout_s = timeout_s(url)
        self._unit = _unit(url)
        self._names = url.options.get("names", "modbus")
        check_scheme(self._names, url.text)
        self._areas = {
            area: parse_ranges(url.options[area.value], f"{url.text}: {area.value}")
            for area in Area
            if area.value in url.options
        }
        if not self._areas:
            raise InputError(
                f"{url.text}: says nothing to read; "
                "add coils=, inputs=, input_registers= or holding=, for example coils=0-99"
            )
        self._source = url
        super().__init__(url, clock, self.device(own_thread=False).signals)

    def device(self, *, own_thread: bool) -> Device:
        """A new device."""
        return ModbusDevice(
            self._source.text,
            ModbusEndpoint(self._source.host, self._source.port, self._unit, self._timeout_s),
            self._areas,
            self._names,
        )


def _unit(url: SourceUrl) -> int:
    text = url.options.get("unit", UNIT)
    if not (text.isascii() and text.isdigit() and int(text) <= 255):
        raise InputError(f"{url.text}: unit={text} is no unit; write a number from 0 to 255")
    return int(text)
