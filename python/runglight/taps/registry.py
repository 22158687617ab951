"""The taps there are: a new one is added by listing it here."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Scheme:
    """One kind of source URL, and where its tap lives (imported when first used)."""

    example: str
    home: str
    """`module:class`; the class is called with a `SourceUrl` and a `Clock`."""
    port: int = 0
    options: tuple[str, ...] = ()
    extra: str | None = None
    """What to install for it: `pip install "runglight[EXTRA]"`."""
    takes_file: bool = False


SCHEMES: dict[str, Scheme] = {
    "modbus": Scheme(
        example="modbus://HOST:502?coils=0-99&inputs=0-63",
        home="runglight.taps.modbus:ModbusTap",
        port=502,
        options=("unit", "coils", "inputs", "input_registers", "holding", "names", "timeout"),
    ),
    "s7": Scheme(
        example="s7://HOST:102?rack=0&slot=2&pe=0-26&pa=0-3",
        home="runglight.taps.s7:S7Tap",
        port=102,
        options=("rack", "slot", "pe", "pa", "mk", "db*", "timeout"),
    ),
    "opcua": Scheme(
        example="opcua://HOST:4840/PATH?browse=NODE",
        home="runglight.taps.opcua:OpcUaTap",
        port=4840,
        options=(
            "browse",
            "timeout",
            "queue",
            "reorder",
            "security",
            "certificate",
            "key",
            "server_certificate",
        ),
        extra="opcua",
    ),
    "mqtt": Scheme(
        example="mqtt://HOST:1883/TOPIC/#",
        home="runglight.taps.mqtt:MqttTap",
        port=1883,
        options=("timeout", "reorder", "keepalive", "client", "tls", "ca"),
        extra="mqtt",
    ),
    "sparkplug": Scheme(
        example="sparkplug://HOST:1883/GROUP",
        home="runglight.taps.sparkplug:SparkplugTap",
        port=1883,
        options=("timeout", "reorder", "keepalive", "client", "rebirth", "tls", "ca"),
        extra="mqtt",
    ),
    "replay": Scheme(
        example="replay:FILE?speed=10",
        home="runglight.taps.replay:ReplayTap",
        options=("speed",),
        takes_file=True,
    ),
}
