"""A model on its way to the executors, which may share no disk with the driver.

The model directory travels in the query as bytes; each Python worker loads it once.
"""

from __future__ import annotations

import hashlib
import io
import os
import tarfile
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeAlias

from runglight.errors import InputError
from runglight.model import NominalModel, load_model
from runglight.scale.spark.plant_parts import PlantParts

if TYPE_CHECKING:
    from os import PathLike

Model: TypeAlias = "NominalModel | str | PathLike[str]"

_OF_THE_STORE = "findings.sqlite"
_loaded: dict[str, PlantParts] = {}
_KEPT_AT_MOST = 64
"""Models kept by one Python worker; a replaced one makes room in time."""


@dataclass(frozen=True)
class ShippedModel:
    """A model directory as bytes; `fingerprint` tells whether two are the same."""

    fingerprint: str
    packed: bytes

    def parts(self) -> PlantParts:
        """The parts of the plant; loaded once in this process."""
        known = _loaded.get(self.fingerprint)
        if known is None:
            while len(_loaded) >= _KEPT_AT_MOST:
                _loaded.pop(next(iter(_loaded)))
            known = _loaded[self.fingerprint] = PlantParts(self._load())
        return known

    def _load(self) -> NominalModel:
        with (
            tempfile.TemporaryDirectory(prefix="runglight-model-") as directory,
            tarfile.open(fileobj=io.BytesIO(self.packed)) as archive,
        ):
            archive.extractall(directory, filter="data")
            return load_model(directory)


class Models(Protocol):
    """The models of a stream's plants."""

    def of(self, plant: str) -> ShippedModel | None:
        """The model of a plant; None where it has none."""


@dataclass(frozen=True)
class ShippedModels:
    """One model for every plant of the stream, or one for each by name."""

    everywhere: ShippedModel | None
    by_plant: Mapping[str, ShippedModel]

    def of(self, plant: str) -> ShippedModel | None:
        """The model of a plant; None where it has none."""
        return self.by_plant.get(plant, self.everywhere)


def ship(model: Model | Mapping[str, Model]) -> ShippedModels:
    """Packs a model, or one by plant; raises ModelError where one cannot be loaded."""
    if isinstance(model, Mapping):
        if not model:
            raise InputError("watch: no plant has a model; give one for each plant by its name")
        return ShippedModels(None, {plant: _shipped(each) for plant, each in model.items()})
    return ShippedModels(_shipped(model), {})


def _shipped(model: Model) -> ShippedModel:
    if not isinstance(model, NominalModel):
        # Loaded here already: a damaged model is told before a stream is started.
        model = load_model(model)
    # Saved anew, so that the same model always gives the same bytes.
    with tempfile.TemporaryDirectory(prefix="runglight-model-") as directory:
        saved = Path(directory) / "model"
        model.save(saved)
        names = sorted(name for name in os.listdir(saved) if name != _OF_THE_STORE)
        digest = hashlib.sha256()
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w") as archive:
            for name in names:
                content = (saved / name).read_bytes()
                digest.update(f"{name}\0{len(content)}\0".encode() + content)
                entry = tarfile.TarInfo(name)
                entry.size = len(content)
                archive.addfile(entry, io.BytesIO(content))
    return ShippedModel(digest.hexdigest()[:16], buffer.getvalue())
