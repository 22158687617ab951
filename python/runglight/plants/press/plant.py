"""The press itself: cylinders, carriages, a spindle drive, belts with parts, safety relays."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from random import Random

from runglight.plants.agenda import Agenda, Appointment, nanoseconds
from runglight.plants.field_wiring import SensorCard
from runglight.plants.press.chart import AT_START, CLAMPS, DRILLS, PUNCHES
from runglight.plants.press.controller import MUST_BE_ON, SAFETY
from runglight.plants.press.symbols import ACTUATOR_NAMES, CARRIAGES, INPUTS, OUTPUTS

JITTER = 0.07
"""Every motion is up to this share faster or slower; two cylinders side by side swap places."""

LONG_WAIT_SHARE = 0.03
"""Parts that keep the press waiting for a minute or more."""

TRAVEL_S = {
    "Pin": 0.45,
    "Guard": 1.6,
    "Stop": 0.4,
    "Lift": 0.9,
    "Centre": 0.7,
    "Clamp": 0.8,
    "Punch": 0.6,
    "Drill": 3.2,
    "Tap": 2.1,
    "Table": 3.4,
    "Index": 0.35,
    "Eject": 0.7,
    "Grip": 0.4,
    "Slide": 1.1,
    "Transfer": 2.4,
    "Removal": 2.2,
}
_RELAYS: dict[str, tuple[str, ...]] = {
    "CLAMPED": tuple(f"{clamp}-ADV" for clamp in CLAMPS),
    "UNCLAMPED": tuple(f"{clamp}-RET" for clamp in CLAMPS),
    "TOOLS_HOME": tuple(f"{tool}-RET" for tool in (*PUNCHES, *DRILLS, "Tap1", "Tap2")),
    "TABLE_LOCKED": ("Index-ADV",),
    "PINS_IN": ("Pin1-ADV", "Pin2-ADV"),
    "PRESS_FREE": ("Transfer-RET", "Removal-RET", "Slide1-RET", "Slide2-RET"),
}


REBOUND_AFTER_S = 0.02
REBOUND_S = 0.03
WORN_REBOUND_S = 0.06
"""A sound cushion's rebound, and by how much it is longer at the end of its life."""
WORN_REBOUNDS = 0.5
"""Share of arrivals that rebound at the end of its life."""
FAILED_REBOUND_S = 0.6


@dataclass(frozen=True, slots=True)
class Wear:
    """How far a cushion's life has gone by; its rebounds grow with the cube of that."""

    since_ns: int
    life_ns: int

    def share(self, now_ns: int) -> float:
        """0 for new, 1 and more for failed."""
        return (now_ns - self.since_ns) / self.life_ns

    def rebound_s(self, now_ns: int, random: Random) -> float | None:
        """How long the sensor is left for on an arrival now; None: not at all."""
        share = self.share(now_ns)
        if share >= 1.0:
            return FAILED_REBOUND_S
        if random.random() >= WORN_REBOUNDS * share**3:
            return None
        return REBOUND_S + WORN_REBOUND_S * share * random.random()


class Cylinder:
    """Moves between two end sensors: one valve, ON is advance."""

    def __init__(self, plant: "PressPlant", name: str, advanced: bool) -> None:
        self.dead = False
        self.slow_factor = 1.0
        self.bounces = False
        self.wear: Wear | None = None
        self._plant = plant
        self._name = name
        self._random = plant.random(name)
        kind = name.rstrip("0123456789")
        # Cylinders of one kind differ: the hoses do. Some orders of arrival are rare.
        number = int(name.removeprefix(kind) or 1)
        self._travel_s = TRAVEL_S[kind] * (1.0 + 0.02 * number)
        self._out = advanced
        self._moves: list[Appointment] = []
        plant.set(f"{name}-ADV", advanced)
        plant.set(f"{name}-RET", not advanced)

    def command(self, out: bool) -> None:
        """Follows its valve."""
        if out == self._out or self.dead:
            return
        self._out = out
        for move in self._moves:
            move.cancel()
        response_s = self._random.uniform(0.015, 0.06)
        jitter = self._random.uniform(1.0 - JITTER, 1.0 + JITTER)
        travel_s = self._travel_s * jitter * self.slow_factor
        leaving, reaching = ("RET", "ADV") if out else ("ADV", "RET")
        agenda = self._plant.agenda
        report = partial(self._plant.set, f"{self._name}-{reaching}")
        arrival_ns = nanoseconds(response_s + travel_s)
        self._moves = [
            agenda.after(
                nanoseconds(response_s * self.slow_factor),
                partial(self._plant.set, f"{self._name}-{leaving}", False),
            ),
            agenda.after(arrival_ns, partial(report, True)),
        ]
        rebound_s = self._rebound_s()
        if rebound_s is not None:
            leaves_ns = arrival_ns + nanoseconds(REBOUND_AFTER_S)
            self._moves.append(agenda.after(leaves_ns, partial(report, False)))
            back_ns = leaves_ns + nanoseconds(rebound_s)
            self._moves.append(agenda.after(back_ns, partial(report, True)))

    def _rebound_s(self) -> float | None:
        if self.bounces:
            self.bounces = False
            return REBOUND_S
        if self.wear is None:
            return None
        return self.wear.rebound_s(self._plant.agenda.now_ns, self._random)


class PressPlant:
    """The machine at work: `advance` it in time, `read_inputs`, `write_outputs`."""

    def __init__(self, start_ns: int, seed: int) -> None:
        self.agenda = Agenda(start_ns)
        self.sensors = SensorCard([symbol.short_name for symbol in INPUTS])
        self.listeners: list[Callable[[str, bool], None]] = []
        self.feeder_stopped = False
        self._seed = seed
        self._true = {symbol.short_name: False for symbol in INPUTS}
        self._forced: dict[str, bool] = {}
        self._relay_inputs = {name for inputs in _RELAYS.values() for name in inputs}
        self._relay_random = self.random("relays")
        self._relays = dict.fromkeys(_RELAYS, False)
        self._feeding = self.random("feeder")
        self._on = {symbol.short_name: AT_START.get(symbol.short_name, False) for symbol in OUTPUTS}
        self.jammed: set[str] = set()
        """What does not happen: `Infeed`, `Outfeed`, `Pressure`, `Speed`, `Oil`."""
        for name in (
            *MUST_BE_ON,
            *SAFETY,
            "Inverter-STANDSTILL",
            "OilPump-SENSOR_LOW",
            "Panel-LAMPS_OK",
        ):
            self.set(name, True)
        self.set("Coolant-FLOW_OK", True)
        self.cylinders = {
            name: Cylinder(self, name, AT_START.get(f"{name}-VALVE", False))
            for name in (*ACTUATOR_NAMES, *CARRIAGES)
        }
        self._part_comes(first=True)

    def random(self, part: str) -> Random:
        """Every part draws its own numbers, so that a fault of one leaves the others' alone."""
        return Random(f"{self._seed}/{part}")

    def advance(self, now_ns: int) -> None:
        """Lets the machine move on to `now_ns`."""
        self.agenda.advance(now_ns)

    def next_event_ns(self) -> int | None:
        """When the machine next changes by itself."""
        return self.agenda.next_ns()

    def read_inputs(self) -> tuple[bool, ...]:
        """What the sensors report now."""
        return self.sensors.read()

    def set(self, name: str, value: bool) -> None:
        """What is true at a sensor from now on."""
        if self._true[name] == value:
            return
        self._true[name] = value
        self.sensors.set(name, value)
        for listener in self.listeners:
            listener(name, value)
        if name in self._relay_inputs:
            self._follow_relays()

    def is_true(self, name: str) -> bool:
        """What is true at a sensor, whatever it reports."""
        return self._true[name]

    def is_on(self, output: str) -> bool:
        """Whether an output is ON."""
        return self._on[output]

    def force(self, name: str, value: bool | None = None) -> None:
        """The sensor reports `value` whatever is true; None: what it reports now, for ever."""
        self._forced[name] = self._true[name] if value is None else value
        self.sensors.force(name, self._forced[name])
        if name in self._relay_inputs:
            self._follow_relays()

    def release(self, name: str) -> None:
        """The sensor is mended."""
        self._forced.pop(name, None)
        self.sensors.release(name)
        if name in self._relay_inputs:
            self._follow_relays()

    def write_outputs(self, outputs: Sequence[bool]) -> None:
        """Switches the valves and contactors."""
        before = self._on
        self._on = dict(zip(before, outputs, strict=True))
        self.follow_outputs(before)

    def follow_outputs(self, before: dict[str, bool] | None = None) -> None:
        """Lets everything follow its output; also after something was mended."""
        for name, cylinder in self.cylinders.items():
            output = "FORWARD" if name in CARRIAGES else "VALVE"
            cylinder.command(self._on[f"{name}-{output}"])
        changed = {name for name, value in self._on.items() if before and before[name] != value}
        if "Inverter-RUN" in changed:
            self._spindle(self._on["Inverter-RUN"])
        if "Hydraulics-LOAD" in changed:
            self._pressure(self._on["Hydraulics-LOAD"])
        if "OilPump-LUBRICATE" in changed:
            self._lubricate(self._on["OilPump-LUBRICATE"])
        if "Outfeed-BELT" in changed and not self._on["Outfeed-BELT"]:
            # Someone takes the part off the end of the belt once it stands.
            self._after(0.6, "Outfeed-EXIT", False)
        if "Stop1-VALVE" in changed and not self._on["Stop1-VALVE"]:
            self._let_part_in()
        if "Grip1-VALVE" in changed:
            self._take_part("Removal", self._on["Grip1-VALVE"])
        if "Grip2-VALVE" in changed:
            self._take_part("Transfer", self._on["Grip2-VALVE"])

    def _after(self, seconds: float, name: str, value: bool) -> None:
        jitter = self._relay_random.uniform(0.9, 1.1)
        self.agenda.after(nanoseconds(seconds * jitter), partial(self.set, name, value))

    def _follow_relays(self) -> None:
        # Relays hang on the sensors' wires: they see what the PLC sees.
        for relay, inputs in _RELAYS.items():
            value = all(self._forced.get(name, self._true[name]) for name in inputs)
            if value != self._relays[relay]:
                self._relays[relay] = value
                self.agenda.after(
                    nanoseconds(self._relay_random.uniform(0.012, 0.03)),
                    partial(self._switch_relay, relay),
                )

    def _switch_relay(self, relay: str) -> None:
        self.set(f"Relays-{relay}", self._relays[relay])

    def _spindle(self, runs: bool) -> None:
        if "Speed" in self.jammed and runs:
            return
        if runs:
            self._after(0.08, "Inverter-STANDSTILL", False)
            self._after(0.05, "Inverter-BRAKE_OPEN", True)
            self._after(0.15, "Inverter-RUNNING", True)
            self._after(1.8, "Inverter-AT_SPEED", True)
        else:
            self._after(0.1, "Inverter-AT_SPEED", False)
            self._after(0.9, "Inverter-RUNNING", False)
            self._after(1.2, "Inverter-STANDSTILL", True)
            self._after(1.5, "Inverter-BRAKE_OPEN", False)

    def _pressure(self, load: bool) -> None:
        if not (load and "Pressure" in self.jammed):
            self._after(0.5 if load else 0.2, "Hydraulics-PRESSURE", load)

    def _lubricate(self, on: bool) -> None:
        if on and "Oil" in self.jammed:
            return
        self._after(0.3, "OilPump-FLOW", on)
        self._after(0.5, "OilPump-SENSOR_LOW", not on)

    def _take_part(self, carriage: str, takes: bool) -> None:
        self._after(0.25, f"{carriage}-PART_ON", takes)
        if carriage == "Removal" and not takes and "Outfeed" not in self.jammed:
            self._let_part_out()
        if carriage == "Transfer" and takes:
            self._after(0.5, "Infeed-AT_STOP", False)

    def _let_part_out(self) -> None:
        self._after(0.8, "Outfeed-ENTRY", True)
        self._after(1.7, "Outfeed-ENTRY", False)
        self._after(3.0, "Outfeed-EXIT", True)

    def _part_comes(self, first: bool = False) -> None:
        random = self._feeding
        wait_s = random.uniform(2.0, 30.0)
        if random.random() < LONG_WAIT_SHARE:
            wait_s = random.uniform(60.0, 600.0)
        self.agenda.after(nanoseconds(5.0 if first else wait_s), self._part_waits)

    def _part_waits(self) -> None:
        if self.feeder_stopped:
            self.agenda.after(nanoseconds(10.0), self._part_waits)
        else:
            self.set("Infeed-WAITING", True)

    def _let_part_in(self) -> None:
        if "Infeed" in self.jammed or not self._true["Infeed-WAITING"]:
            return
        self._after(0.7, "Infeed-WAITING", False)
        self._after(2.0, "Infeed-AT_STOP", True)
        self.agenda.after(nanoseconds(3.0), self._part_comes)

    def clear(self, jam: str) -> None:
        """Someone has cleared a jam: what waited for it goes on."""
        self.jammed.discard(jam)
        match jam:
            case "Speed" if self._on["Inverter-RUN"]:
                self._spindle(True)
            case "Pressure" if self._on["Hydraulics-LOAD"]:
                self._pressure(True)
            case "Oil" if self._on["OilPump-LUBRICATE"]:
                self._lubricate(True)
            case "Infeed" if not self._on["Stop1-VALVE"]:
                self._let_part_in()
            case "Outfeed" if self._on["Outfeed-BELT"]:
                self._let_part_out()
            case _:
                pass
