"""Where faults of sensors and actuators live: between the machine and the PLC's terminals."""

from collections.abc import Sequence
from dataclasses import dataclass


class SensorCard:
    """The PLC's input terminals: what the sensors report, which need not be what is true."""

    def __init__(self, names: Sequence[str]) -> None:
        self._number = {name: number for number, name in enumerate(names)}
        self._true = [False] * len(names)
        self._forced: list[bool | None] = [None] * len(names)
        self._reported = [False] * len(names)
        self._image: tuple[bool, ...] | None = None

    def set(self, name: str, value: bool) -> None:
        """What is physically true at this sensor from now on."""
        number = self._number[name]
        self._true[number] = value
        self._report(number)

    def force(self, name: str, value: bool) -> None:
        """From now on the sensor reports `value`, whatever is true."""
        number = self._number[name]
        self._forced[number] = value
        self._report(number)

    def freeze(self, name: str) -> None:
        """From now on the sensor repeats what it reported last: it is dead."""
        self.force(name, self._reported[self._number[name]])

    def release(self, name: str) -> None:
        """The sensor reports what is true again."""
        number = self._number[name]
        self._forced[number] = None
        self._report(number)

    def read(self) -> tuple[bool, ...]:
        """What the PLC sees, in the order of the names."""
        if self._image is None:
            self._image = tuple(self._reported)
        return self._image

    def _report(self, number: int) -> None:
        forced = self._forced[number]
        self._reported[number] = self._true[number] if forced is None else forced
        self._image = None


@dataclass(slots=True)
class ActuatorHealth:
    """How well one actuator follows its output; a new one follows at once and at full speed."""

    dead: bool = False
    extra_response_ns: int = 0
    slow_factor: float = 1.0
