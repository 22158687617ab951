"""A real PostgreSQL server on loopback, in a directory of the test."""

import os
import pwd
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.live.broker import free_port


def _programs() -> Path:
    versions = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    if not versions:
        pytest.skip("Debian's postgresql is not installed")
    return versions[-1].parent


class PostgreSql:
    """A server that keeps its port and its data when it is started again."""

    def __init__(self, directory: Path) -> None:
        self._bin = _programs()
        self._data = directory / "data"
        self.port = free_port()
        self._as: list[str] = []
        if os.geteuid() == 0:
            # PostgreSQL refuses to run as root.
            try:
                owner = pwd.getpwnam("postgres")
            except KeyError:
                pytest.skip("there is no user postgres")
            if shutil.which("runuser") is None:
                pytest.skip("there is no runuser")
            os.chown(directory, owner.pw_uid, owner.pw_gid)
            self._as = ["runuser", "-u", "postgres", "--"]
        self._run("initdb", "-A", "trust", "-U", "runglight", "--no-sync")
        self.url = f"postgresql://runglight@127.0.0.1:{self.port}/postgres"

    def start(self) -> None:
        options = f"-p {self.port} -c listen_addresses=127.0.0.1 -c fsync=off -k {self._data}"
        self._run("pg_ctl", "-w", "-l", str(self._data / "log"), "-o", options, "start")

    def stop(self) -> None:
        self._run("pg_ctl", "-w", "-m", "immediate", "stop")

    def _run(self, program: str, *arguments: str) -> None:
        command = [*self._as, str(self._bin / program), "-D", str(self._data), *arguments]
        subprocess.run(
            command, check=True, timeout=120, cwd="/", stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
