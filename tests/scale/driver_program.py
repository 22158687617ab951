"""A driver as a site runs it: watches the files of a directory, then ends.

`python -m tests.scale.driver_program DIRECTORY MASTER [SERVERS TOPIC]`: reads `in`, `model`, writes
Parquet to `out`, or to a topic.
"""

from __future__ import annotations

import sys
from pathlib import Path

from runglight.scale.spark import KafkaSink, ParquetSink, watch
from tests.scale import feeding, needed
from tests.scale.sessions import end, new_session


def main(directory: Path, master: str, servers: str = "", topic: str = "") -> None:
    """Watches until all files have been judged."""
    jars = needed.jars("connector") if servers else []
    session = new_session(master, directory / "spark", jars)
    watching = watch(
        feeding.stream(session, directory / "in"),
        directory / "model",
        KafkaSink(servers, topic) if servers else ParquetSink(str(directory / "out")),
        checkpoint=str(directory / "checkpoint"),
        ahead_s=None,
        until_here=True,
    )
    watching.wait()
    end(session)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
