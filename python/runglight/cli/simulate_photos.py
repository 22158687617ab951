"""`runglight simulate PLANT --photos DIR`: the camera before a simulated machine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from runglight.cli.counted import counted
from runglight.errors import InputError
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from runglight.plants import PlantDescription
    from runglight.plants.photo_folder import PhotoFolder
    from runglight.plants.running import PhotographedPlant

INTERVAL = "1s"
SHORTEST_S = 0.05


@dataclass(frozen=True, slots=True)
class PlantCamera:
    """A folder that photos go to, and how often."""

    folder: PhotoFolder
    interval_ns: int

    @property
    def witnessing(self) -> dict[str, object]:
        """What a plant's `simulate` takes, so that the photos of a run are taken."""
        return {"witness": self.take, "witness_every_ns": self.interval_ns}

    @property
    def told(self) -> str:
        """What has been done."""
        return f"{self.folder.folder}: {counted(self.folder.taken, 'photo')}"

    def take(self, plant: PhotographedPlant) -> None:
        """One photo of the plant as it stands."""
        self.folder.put(plant.expose()())


def camera_before(
    plant: PlantDescription, folder: Path | None, interval: str | None
) -> PlantCamera | None:
    """The camera that was asked for; InputError for a plant of which nothing is to be seen."""
    if folder is None:
        if interval is not None:
            raise InputError("--photo-interval goes with --photos only; leave it out")
        return None
    if not plant.has_photos:
        raise InputError(
            f"simulate {plant.name}: there are no photos of this plant; leave out --photos, or "
            "simulate bottling"
        )
    interval_s = duration_s(interval or INTERVAL, "--photo-interval")
    if interval_s < SHORTEST_S:
        raise InputError(f"--photo-interval: {interval} is shorter than a photo takes; 1s is usual")
    from runglight.plants.photo_folder import PhotoFolder  # noqa: PLC0415

    return PlantCamera(PhotoFolder(folder), round(interval_s * 1e9))
