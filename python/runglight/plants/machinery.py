"""Machine parts that simulated plants are built from: axes between two stops, and robots.

They know time, position and speed, and nothing of any PLC program.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from random import Random

from runglight.plants.agenda import Action, Agenda, Appointment, nanoseconds
from runglight.plants.field_wiring import ActuatorHealth

SPEED_JITTER = 0.01
"""Every motion is up to this share faster or slower than its nominal speed."""

SENSOR_WIDTH = 0.001
"""Share of the travel, measured from its stop, within which an end sensor reports."""


@dataclass(frozen=True, slots=True)
class Drive:
    """What moves an axis one way: its time from stop to stop, and how long it takes to react."""

    travel_s: float
    shortest_response_s: float
    longest_response_s: float
    health: ActuatorHealth


class Axis:
    """A carriage or a clamp between two stops, with an end sensor at each.

    `on_home` and `on_away` are called with what the two end sensors see, whenever it changes.
    """

    def __init__(
        self,
        agenda: Agenda,
        random: Random,
        *,
        outward: Drive,
        homeward: Drive,
        on_home: Callable[[bool], None],
        on_away: Callable[[bool], None],
    ) -> None:
        self._agenda = agenda
        self._random = random
        self._drives = {1: outward, -1: homeward}
        self._on_home = on_home
        self._on_away = on_away
        self._position = 0.0
        self._speed_per_ns = 0.0
        self._since_ns = agenda.now_ns
        self._direction = 0
        self._next: Appointment | None = None

    def position_at(self, now_ns: int) -> float:
        """Where it will be, if nothing happens meanwhile: 0 at home, 1 away."""
        moved = self._speed_per_ns * (now_ns - self._since_ns)
        return min(1.0, max(0.0, self._position + moved))

    def command(self, outward: bool, homeward: bool) -> None:
        """Follows the two outputs: both or none of them means stand still."""
        direction = int(outward) - int(homeward)
        if direction and self._drives[direction].health.dead:
            direction = 0
        if direction == self._direction:
            return
        self._stop()
        self._direction = direction
        if direction:
            drive = self._drives[direction]
            response_s = self._random.uniform(drive.shortest_response_s, drive.longest_response_s)
            self._next = self._agenda.after(
                nanoseconds(response_s) + drive.health.extra_response_ns, self._start
            )

    def _stop(self) -> None:
        if self._next is not None:
            self._next.cancel()
            self._next = None
        self._settle_position()
        self._speed_per_ns = 0.0

    def _settle_position(self) -> None:
        self._position = self.position_at(self._agenda.now_ns)
        self._since_ns = self._agenda.now_ns

    def _start(self) -> None:
        drive = self._drives[self._direction]
        jitter = self._random.uniform(1.0 - SPEED_JITTER, 1.0 + SPEED_JITTER)
        travel_ns = drive.travel_s * 1e9 * jitter * drive.health.slow_factor
        self._speed_per_ns = self._direction / travel_ns
        self._since_ns = self._agenda.now_ns
        self._head_for_next_mark()

    def _head_for_next_mark(self) -> None:
        """Appointment with the next place where something changes: a sensor's edge, a stop."""
        marks: tuple[float, ...] = (SENSOR_WIDTH, 1.0 - SENSOR_WIDTH, 1.0)
        if self._direction < 0:
            marks = (1.0 - SENSOR_WIDTH, SENSOR_WIDTH, 0.0)
        for mark in marks:
            if (mark - self._position) * self._direction > 0:
                distance = abs(mark - self._position)
                delay_ns = round(distance / abs(self._speed_per_ns))
                self._next = self._agenda.after(delay_ns, partial(self._reach, mark))
                return
        self._next = None
        self._speed_per_ns = 0.0

    def _reach(self, mark: float) -> None:
        self._position = mark
        self._since_ns = self._agenda.now_ns
        if mark == SENSOR_WIDTH:
            self._on_home(self._direction < 0)
        elif mark == 1.0 - SENSOR_WIDTH:
            self._on_away(self._direction > 0)
        self._head_for_next_mark()


@dataclass(frozen=True, slots=True)
class Task:
    """One program of a robot: what it needs, and what it does how long after its start.

    The robot waits in stage `begins_in` for its command; a step calls `Robot.finish` to end it.
    """

    begins_in: str
    steps: tuple[tuple[float, Action], ...]
    health: ActuatorHealth


class Robot:
    """An arm that runs one program at a time; once started, a program runs to its end."""

    def __init__(self, agenda: Agenda, random: Random, stage: str) -> None:
        self._agenda = agenda
        self._random = random
        self._tasks: Mapping[str, Task] = {}
        self._commands: Mapping[str, bool] = {}
        self._stage = stage

    def teach(self, tasks: Mapping[str, Task]) -> None:
        """Gives the robot its programs, by the name of the command that starts each."""
        self._tasks = tasks

    def command(self, commands: Mapping[str, bool]) -> None:
        """Follows the outputs; a program starts where its stage and its command meet."""
        self._commands = commands
        self._start_if_commanded()

    def finish(self, stage: str) -> None:
        """The running program has ended; the robot now waits in `stage`."""
        self._stage = stage
        self._start_if_commanded()

    def _start_if_commanded(self) -> None:
        for name, task in self._tasks.items():
            if self._stage == task.begins_in and self._commands.get(name) and not task.health.dead:
                self._start(task)
                return

    def _start(self, task: Task) -> None:
        self._stage = "busy"
        jitter = self._random.uniform(1.0 - SPEED_JITTER, 1.0 + SPEED_JITTER)
        for offset_s, action in task.steps:
            delay_ns = nanoseconds(offset_s * jitter * task.health.slow_factor)
            self._agenda.after(delay_ns + task.health.extra_response_ns, action)
