"""The cell's PLC program: one sequential function chart per device, hand in hand.

It sees the input image and the time, and writes the output image; nothing else. A sensor that
never reports leaves its chart waiting, and with it the line, as the real thing would.
"""

from collections.abc import Sequence
from enum import Enum, auto

from runglight.plants.agenda import nanoseconds
from runglight.plants.timer import OnDelay


class LoaderStep(Enum):
    """Steps of the part loader."""

    HOME = auto()
    ADVANCE = auto()
    WAIT_FOR_GRIP = auto()
    RETURN = auto()


class ClampStep(Enum):
    """Steps of the Daecha clamp."""

    OPENED = auto()
    CLOSE = auto()
    CLOSED = auto()
    OPEN = auto()


class Robot1Step(Enum):
    """Steps of robot 1."""

    HOME = auto()
    READY = auto()
    PICK = auto()
    PICKED = auto()
    MOVE = auto()
    PLACED = auto()
    RETURN = auto()


class DaechaStep(Enum):
    """Steps of the Daecha."""

    HOME = auto()
    ADVANCE = auto()
    UNLOAD = auto()
    RETURN = auto()


class Robot2Step(Enum):
    """Steps of robot 2."""

    HOME = auto()
    READY = auto()
    SEAL = auto()
    SEALED = auto()
    RETURN = auto()
    DONE = auto()


class CellController:
    """The program of the cell: call `scan` once per scan cycle."""

    def __init__(self) -> None:
        self.loader = LoaderStep.HOME
        self.clamp = ClampStep.OPENED
        self.robot_1 = Robot1Step.HOME
        self.daecha = DaechaStep.HOME
        self.robot_2 = Robot2Step.HOME
        # a robot's ready bit stands before its start bit comes
        self._robot_1_ready = OnDelay(nanoseconds(0.1))
        self._robot_2_ready = OnDelay(nanoseconds(0.1))
        # the gripper is surely open
        self._robot_1_placed = OnDelay(nanoseconds(0.1))
        # nobody's sensor sees the part leave: it is given its time
        self._unloaded = OnDelay(nanoseconds(2.5))
        self._timers = (
            self._robot_1_ready,
            self._robot_2_ready,
            self._robot_1_placed,
            self._unloaded,
        )
        self._ran_ns = 0
        self._settled = False

    @property
    def settled(self) -> bool:
        """Whether the last scan left steps and timers as they were."""
        return self._settled

    def next_timer_ns(self) -> int | None:
        """When the next running timer ends; None if none runs."""
        due = (timer.due_ns for timer in self._timers)
        return min((time for time in due if time is not None and time > self._ran_ns), default=None)

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Runs every chart once, in the order of the devices; at most one step per chart."""
        before = self._memory()
        self._ran_ns = now_ns
        (
            loader_ret,
            loader_adv,
            loader_part,
            left_open,
            right_open,
            left_closed,
            right_closed,
            robot_1_home,
            robot_1_running,
            first_work_complete,
            second_work_complete,
            daecha_ret,
            daecha_adv,
            robot_2_home,
            robot_2_running,
            seal_complete,
        ) = inputs
        opened = left_open and right_open
        closed = left_closed and right_closed

        self._scan_loader(loader_ret, loader_adv, loader_part, closed)
        self._scan_clamp(opened, closed)
        self._scan_robot_1(
            wanted=loader_adv and loader_part and robot_1_home and daecha_ret and opened,
            first_work_complete=first_work_complete,
            second_work_complete=second_work_complete,
            home=robot_1_home,
            now_ns=now_ns,
        )
        self._scan_daecha(daecha_ret, daecha_adv, now_ns)
        self._scan_robot_2(
            wanted=closed and robot_1_home and robot_2_home and daecha_ret,
            seal_complete=seal_complete,
            home=robot_2_home and not robot_2_running,
            now_ns=now_ns,
        )
        self._settled = self._memory() == before
        return (
            self.loader is LoaderStep.ADVANCE,
            self.loader is LoaderStep.RETURN,
            self.clamp is ClampStep.CLOSE,
            self.clamp is ClampStep.OPEN,
            self.robot_1 is Robot1Step.READY
            or (self.robot_1 is Robot1Step.PICK and not robot_1_running),
            self.robot_1 is Robot1Step.PICK,
            self.robot_1 is Robot1Step.MOVE,
            self.robot_1 is Robot1Step.RETURN,
            self.daecha is DaechaStep.ADVANCE,
            self.daecha is DaechaStep.RETURN,
            self.robot_2 is Robot2Step.READY
            or (self.robot_2 is Robot2Step.SEAL and not robot_2_running),
            self.robot_2 is Robot2Step.SEAL,
            self.robot_2 is Robot2Step.RETURN,
        )

    def _memory(self) -> tuple[object, ...]:
        return (
            self.loader,
            self.clamp,
            self.robot_1,
            self.daecha,
            self.robot_2,
            *(timer.started_ns for timer in self._timers),
        )

    def _scan_loader(self, ret: bool, adv: bool, part: bool, gripped: bool) -> None:
        match self.loader:
            case LoaderStep.HOME if part and ret:
                self.loader = LoaderStep.ADVANCE
            case LoaderStep.ADVANCE if adv:
                self.loader = LoaderStep.WAIT_FOR_GRIP
            case LoaderStep.WAIT_FOR_GRIP if gripped and not part:
                self.loader = LoaderStep.RETURN
            case LoaderStep.RETURN if ret:
                self.loader = LoaderStep.HOME

    def _scan_clamp(self, opened: bool, closed: bool) -> None:
        match self.clamp:
            case ClampStep.OPENED if (
                self.robot_1 is Robot1Step.RETURN and self.daecha is DaechaStep.HOME
            ):
                self.clamp = ClampStep.CLOSE
            case ClampStep.CLOSE if closed:
                self.clamp = ClampStep.CLOSED
            case ClampStep.CLOSED if self.daecha is DaechaStep.UNLOAD:
                self.clamp = ClampStep.OPEN
            case ClampStep.OPEN if opened:
                self.clamp = ClampStep.OPENED

    def _scan_robot_1(
        self,
        wanted: bool,
        first_work_complete: bool,
        second_work_complete: bool,
        home: bool,
        now_ns: int,
    ) -> None:
        ready = self._robot_1_ready(self.robot_1 is Robot1Step.READY, now_ns)
        placed = self._robot_1_placed(
            self.robot_1 is Robot1Step.MOVE and second_work_complete, now_ns
        )
        match self.robot_1:
            case Robot1Step.HOME if wanted:
                self.robot_1 = Robot1Step.READY
            case Robot1Step.READY if ready:
                self.robot_1 = Robot1Step.PICK
            case Robot1Step.PICK if first_work_complete:
                self.robot_1 = Robot1Step.PICKED
            case Robot1Step.PICKED:
                self.robot_1 = Robot1Step.MOVE
            case Robot1Step.MOVE if placed:
                self.robot_1 = Robot1Step.PLACED
            case Robot1Step.PLACED:
                self.robot_1 = Robot1Step.RETURN
            case Robot1Step.RETURN if home and self.daecha is DaechaStep.RETURN:
                self.robot_1 = Robot1Step.HOME

    def _scan_daecha(self, ret: bool, adv: bool, now_ns: int) -> None:
        unloaded = self._unloaded(
            self.daecha is DaechaStep.UNLOAD and self.clamp is ClampStep.OPENED, now_ns
        )
        match self.daecha:
            case DaechaStep.HOME if ret and self.robot_2 is Robot2Step.DONE:
                self.daecha = DaechaStep.ADVANCE
            case DaechaStep.ADVANCE if adv:
                self.daecha = DaechaStep.UNLOAD
            case DaechaStep.UNLOAD if unloaded:
                self.daecha = DaechaStep.RETURN
            case DaechaStep.RETURN if ret:
                self.daecha = DaechaStep.HOME

    def _scan_robot_2(self, wanted: bool, seal_complete: bool, home: bool, now_ns: int) -> None:
        ready = self._robot_2_ready(self.robot_2 is Robot2Step.READY, now_ns)
        match self.robot_2:
            case Robot2Step.HOME if wanted:
                self.robot_2 = Robot2Step.READY
            case Robot2Step.READY if ready:
                self.robot_2 = Robot2Step.SEAL
            case Robot2Step.SEAL if seal_complete:
                self.robot_2 = Robot2Step.SEALED
            case Robot2Step.SEALED:
                self.robot_2 = Robot2Step.RETURN
            case Robot2Step.RETURN if home:
                self.robot_2 = Robot2Step.DONE
            case Robot2Step.DONE if self.daecha is DaechaStep.UNLOAD:
                self.robot_2 = Robot2Step.HOME
