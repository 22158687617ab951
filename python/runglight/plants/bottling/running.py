"""The bottling machine at work without an end."""

from collections.abc import Callable, Mapping

from runglight.plants.bottling.camera import photograph
from runglight.plants.bottling.machine import BottlingMachine
from runglight.plants.bottling.memory import Memory
from runglight.plants.bottling.operator import PRODUCTION_S, Operator
from runglight.plants.bottling.program import BottlingProgram
from runglight.plants.bottling.scene import Scene, Sight
from runglight.plants.bottling.symbols import SYMBOLS
from runglight.plants.bottling.terminals import Output
from runglight.plants.faults import FaultDescription, FaultLabel
from runglight.plants.running import PlantPhoto
from runglight.plants.scanned import ScannedPlant


class RunningBottling(ScannedPlant[bool]):
    """A `RunningPlant` whose PLC shows its memory only: its inputs and outputs lie on a bus.

    `production_s` is how long it produces between two manual phases (`math.inf`: for ever).
    Nothing can be broken in it.
    """

    def __init__(self, start_ns: int, seed: int = 1, *, production_s: float = PRODUCTION_S) -> None:
        self._machine = BottlingMachine(start_ns, seed)
        self._program = BottlingProgram(seed)
        self._operator = Operator(self._machine, production_s)
        self._seed = seed
        memory = Memory(seed)
        super().__init__(
            SYMBOLS,
            self._machine,
            self._program,
            start_ns=start_ns,
            outputs=(False,) * len(Output),
            memory=lambda: memory.write(self._program),
        )

    @property
    def faults(self) -> Mapping[int, FaultDescription]:
        """None."""
        return {}

    @property
    def cycles(self) -> int:
        """Bottles filled so far."""
        return self._program.filling.filled

    def scene(self) -> Scene:
        """What is to be seen now: at the time it was advanced to."""
        return self._machine.scene(self.now_ns)

    def expose(self) -> Callable[[], PlantPhoto]:
        """Sees the machine as it stands; what it gives develops the photo."""
        scene, seed = self.scene(), self._seed
        return lambda: PlantPhoto(scene.time_ns, photograph(scene, seed))

    @property
    def sights(self) -> tuple[Sight, ...]:
        """What has happened for everybody to see, in time order."""
        return tuple(self._machine.sights)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Nothing can be broken: ValueError."""
        raise ValueError(f"the bottling machine has no faults, so not {fault!r} either")

    def labels(self) -> tuple[FaultLabel, ...]:
        """None."""
        return ()

    def waiting(self) -> tuple[FaultDescription, ...]:
        """None."""
        return ()

    def acting(self) -> tuple[FaultDescription, ...]:
        """None."""
        return ()

    def sample(
        self,
        time_ns: int,
        inputs: tuple[int, ...],
        outputs: tuple[int, ...],
        memory: tuple[int, ...] = (),
    ) -> None:
        """The scan cycle shows its images, of which a client sees the memory."""
        super().sample(time_ns, (), (), memory)
