"""The benches every tap is tested on: a new tap is added by listing its bench."""

from collections.abc import Callable

from tests.taps.benches.bench import Bench
from tests.taps.benches.modbus import ModbusBench
from tests.taps.benches.mqtt import MqttBench
from tests.taps.benches.opcua import OpcUaBench
from tests.taps.benches.replay import ReplayBench
from tests.taps.benches.s7 import S7Bench
from tests.taps.benches.sparkplug import SparkplugBench

BENCHES: list[Callable[[], Bench]] = [
    ModbusBench,
    S7Bench,
    OpcUaBench,
    MqttBench,
    SparkplugBench,
    ReplayBench,
]
