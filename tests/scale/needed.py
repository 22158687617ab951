"""What the Spark tests need beside Python; where it is missing, a sentence says so."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent
JARS = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "runglight" / "jars"
_MAVEN_TIMEOUT_S = 300


@cache
def missing_for_spark() -> str | None:
    """Why there is no Spark here; None where there is."""
    for module in ("pyspark", "pandas", "google.protobuf"):
        try:
            found = importlib.util.find_spec(module)
        except ModuleNotFoundError:
            found = None
        if found is None:
            return f'{module} is not installed: pip install "runglight[spark]"'
    home = os.environ.get("JAVA_HOME")
    java = shutil.which("java") if home is None else f"{home}/bin/java"
    if java is None:
        return "no Java here: Spark needs Java 17"
    told = subprocess.run([java, "-version"], capture_output=True, text=True, check=False).stderr
    version = re.search(r'version "(\d+)', told)
    if version is None or int(version[1]) < 17:
        return f"Spark needs Java 17, and this is {told.splitlines()[0] if told else 'none'}"
    return None


def jars(kind: str) -> list[Path]:
    """The jars of `jars/KIND.xml` from Maven Central, fetched once; FileNotFoundError without."""
    source = HERE / "jars" / f"{kind}.xml"
    # The name changes with what is asked for.
    directory = JARS / f"{kind}-{_digest(source)}"
    if not directory.is_dir():
        maven = shutil.which("mvn")
        if maven is None:
            raise FileNotFoundError("no Maven here to fetch Kafka with")
        JARS.mkdir(parents=True, exist_ok=True)
        temporary = JARS / f".{kind}-{os.getpid()}"
        fetched = subprocess.run(
            [
                *(maven, "-q", "-B", "-s", HERE / "jars" / "settings.xml", "-f", source),
                "dependency:copy-dependencies",
                *(f"-DoutputDirectory={temporary}", "-DincludeScope=runtime"),
            ],
            capture_output=True,
            text=True,
            timeout=_MAVEN_TIMEOUT_S,
            check=False,
        )
        if fetched.returncode:
            shutil.rmtree(temporary, ignore_errors=True)
            raise FileNotFoundError(f"Maven could not fetch Kafka: {fetched.stdout[-300:]}")
        temporary.rename(directory)
    return sorted(directory.glob("*.jar"))


def _digest(source: Path) -> str:
    return hashlib.sha256(source.read_bytes()).hexdigest()[:8]
