"""Models in the executors: broadcast once, and looked at only when they are needed.

Spark starts a stateful processor on the driver first, in a Python worker that has no broadcast
variables and fails on a function of more than 1 MB. So what travels in it is the number of
the broadcast alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from pyspark.sql import SparkSession

    from runglight.scale.spark.shipped_model import ShippedModel, ShippedModels


class Delivery:
    """Models on their way, or, in an executor, those that have come."""

    def __init__(self, session: SparkSession, models: ShippedModels) -> None:
        self._broadcast: Any = session.sparkContext.broadcast(models)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        # Asked how it is pickled, the broadcast notes that this function needs it.
        _, (number,) = self._broadcast.__reduce__()
        return Delivered, (number,)


class Delivered:
    """What a `Delivery` is on the other side."""

    def __init__(self, number: int) -> None:
        self._number = number

    def of(self, plant: str) -> ShippedModel | None:
        """The model of a plant; None where it has none."""
        from pyspark.core.broadcast import _from_id  # noqa: PLC0415

        models: ShippedModels = _from_id(self._number).value
        return models.of(plant)
