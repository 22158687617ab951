"""Where Parquet is read from: looked for before Spark reads, so that what is wrong is said once.

Spark itself logs a Java stack for a path that is not there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from runglight.errors import InputError

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

PREFIX = "parquet:"
_MAGICS = (b"PAR1", b"PARE")
"""How a file begins, plain and encrypted."""
_WANTED = "expected a file or directory of Parquet"


def parquet_path(session: SparkSession, place: str) -> str:
    """The path that a place names, with or without `parquet:`; a pattern (`day=*`) stays one.

    Looked up by Hadoop, as Spark will: also `hdfs://…`, `s3a://…`. Raises InputError where nothing
    is there, where the file system cannot be asked, and for a file that is no Parquet.
    """
    from py4j.protocol import Py4JJavaError  # noqa: PLC0415

    text = place.removeprefix(PREFIX)
    if not text:
        raise InputError(f"{place}: names nothing; {_WANTED}: write its path behind {PREFIX}")
    try:
        found, is_parquet = _look(session, text)
    except Py4JJavaError as error:
        raise InputError(
            f"{text}: cannot be looked up ({_said(error)}); {_WANTED}: check the address, and that "
            "Spark has the connector and the rights for it (--set KEY=VALUE)"
        ) from None
    if not found:
        raise InputError(
            f"{text}: nothing is there; {_WANTED}: check the path, or write a log with runglight "
            "export LOG --to FILE.parquet"
        )
    if not is_parquet:
        raise InputError(
            f"{text}: is no Parquet; {_WANTED}: turn a log into one with runglight export LOG "
            "--to FILE.parquet"
        )
    return text


def _look(session: SparkSession, text: str) -> tuple[bool, bool]:
    """Whether something is there, and whether it can be Parquet; Java's errors go through."""
    # Spark has no other way to its file systems.
    jvm: Any = session.sparkContext._jvm
    path = jvm.org.apache.hadoop.fs.Path(text)
    system = path.getFileSystem(session.sparkContext._jsc.hadoopConfiguration())
    found = list(system.globStatus(path) or [])
    # Spark leaves out what begins so, such as `_SUCCESS`. One file tells for those beside it.
    read = [each for each in found if not each.getPath().getName().startswith(("_", "."))]
    first = next(iter(read), None)
    is_parquet = first is None or first.isDirectory() or _begins(system, first) in _MAGICS
    return bool(found), is_parquet


def _begins(system: Any, status: Any) -> bytes:
    stream = system.open(status.getPath())
    try:
        read = [stream.read() for _ in range(4)]
    finally:
        stream.close()
    return bytes(byte for byte in read if byte >= 0)


def _said(error: Any) -> str:
    """What a Java exception says, in one line."""
    lines = str(error.java_exception.toString()).splitlines()
    return lines[0].strip() if lines else "no reason given"
