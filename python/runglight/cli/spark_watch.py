"""`runglight spark watch`: a stream of changes, watched in a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.spark_options import SparkOptions
from runglight.errors import InputError
from runglight.model import load_model
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from collections.abc import Mapping

    from runglight.model import NominalModel
    from runglight.scale.spark.watching import Watching

LOOK_EVERY_S = 5.0
"""How often the model directory is looked at."""


def spark_watch(
    model: Path | None = None,
    stream: str | None = None,
    /,
    *,
    to: tuple[str, ...],
    checkpoint: str,
    plant: tuple[str, ...] = (),
    format: Literal["json", "binary", "arrow"] = "json",
    plant_by_key: bool = False,
    starting: str = "earliest",
    delay: str = "10s",
    quiet: str = "30s",
    ahead: str = "1d",
    every: str | None = None,
    rows: int = 2_000_000,
    until_here: bool = False,
    spark: SparkOptions | None = None,
) -> int:
    """Watch a stream of changes with Spark: the findings are those of `runglight watch`.

    Goes on until it is interrupted, and from where it ended when it is started again with the
    same checkpoint. A model directory that is replaced meanwhile is taken up within seconds.

    Parameters
    ----------
    model: Path
        Model directory written by `runglight learn`; none where each plant has its own
        (`--plant`).
    stream: str
        `kafka://HOST:PORT/TOPIC`, or a directory that Parquet files with `time`, `signal`, `value`
        are put into.
    to: tuple[str, ...]
        Where findings go: `kafka://HOST:PORT/TOPIC`, a directory for Parquet files, or
        `jdbc:…#TABLE`; repeat it for several. After a crash, topics and tables may hold a finding
        twice, with the same plant, id and state; Parquet does not.
    checkpoint: str
        Directory where the watch keeps where it stands; every executor must see it.
    plant: tuple[str, ...]
        `NAME=MODEL`: the model of one plant of the stream; repeat it for each.
    format: str
        What a message of the topic holds (default: `json`): `json`, `binary` or `arrow`.
    plant_by_key: bool
        The key of a message names its plant.
    starting: str
        Where a watch without a checkpoint begins: `earliest` (default) or `latest`.
    delay: str
        How long a change waits for older ones (default: `10s`); what comes later still is left
        out, and told.
    quiet: str
        A silence, beyond the delay, after which a part of the plant is taken to have stopped
        (default: `30s`).
    ahead: str
        Messages this far ahead of the executors' clocks are not believed (default: `1d`;
        `never`: all are).
    every: str
        Start a micro-batch this often (default: as soon as the last one has ended).
    rows: int
        Messages in one micro-batch at most (default: 2,000,000).
    until_here: bool
        End when what is there now has been watched.

    """
    if plant:
        # All there is stands after the plants.
        if model is not None and stream is None:
            model, stream = None, str(model)
        if model is not None:
            raise InputError("--plant: give either one model or one for each plant")
    if stream is None:
        raise InputError(
            "spark watch: name the model and the stream: MODEL kafka://HOST:PORT/TOPIC"
        )
    directories: dict[str, Path] = dict(map(_named, plant))
    if model is not None:
        directories[""] = model
    models = {name: load_model(path) for name, path in directories.items()}
    seconds = {
        "delay_s": duration_s(delay, "--delay"),
        "quiet_s": duration_s(quiet, "--quiet"),
        "ahead_s": None if ahead == "never" else duration_s(ahead, "--ahead"),
        "every_s": None if every is None else duration_s(every, "--every"),
    }
    with (spark or SparkOptions()).session() as session:
        from runglight.scale.spark.places import sink_of, stream_of  # noqa: PLC0415
        from runglight.scale.spark.watching import watch  # noqa: PLC0415

        watching = watch(
            stream_of(session, stream, format, starting, rows, plant_by_key=plant_by_key),
            _one_or_each(models),
            [sink_of(place) for place in to],
            checkpoint=checkpoint,
            until_here=until_here,
            **seconds,  # type: ignore[arg-type]
        )
        try:
            _follow(watching, directories)
        finally:
            watching.stop()
    told = ", ".join(f"{count:,} {kind}" for kind, count in watching.counts.by_kind.most_common())
    terminal.note(f"watched to its end: {told or 'no findings'}")
    return DONE


def _follow(watching: Watching, directories: Mapping[str, Path]) -> None:
    seen = _written(directories)
    while not watching.wait(LOOK_EVERY_S):
        now = _written(directories)
        if now is None or now == seen:
            continue
        seen = now
        models = {name: load_model(path) for name, path in directories.items()}
        if watching.replace_model(_one_or_each(models)):
            terminal.note("the model was replaced: each part of the plant starts afresh")


def _written(directories: Mapping[str, Path]) -> list[tuple[int, int]] | None:
    found = []
    for directory in directories.values():
        try:
            status = (directory / "manifest.json").stat()
        except FileNotFoundError:
            # It is being replaced.
            return None
        found.append((status.st_ino, status.st_mtime_ns))
    return found


def _one_or_each(models: Mapping[str, NominalModel]) -> NominalModel | Mapping[str, NominalModel]:
    return models[""] if set(models) == {""} else models


def _named(text: str) -> tuple[str, Path]:
    name, separator, path = text.partition("=")
    if not separator or not name or not path:
        raise InputError(f"--plant {text}: write NAME=MODEL, the plant's name and its model")
    return name, Path(path)
