"""Database servers of our own, on sockets in directories of their own."""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def postgresql_server() -> Iterator[str]:
    """The URL of a PostgreSQL server."""
    pytest.importorskip("psycopg")
    programs = max(Path("/usr/lib/postgresql").glob("*/bin/initdb"), default=None)
    if programs is None:
        pytest.skip("no PostgreSQL server on this system")
    user = None
    if os.geteuid() == 0:
        pwd = pytest.importorskip("pwd")
        if "postgres" not in {each.pw_name for each in pwd.getpwall()}:
            pytest.skip("PostgreSQL does not run as root, and there is no user postgres")
        user = "postgres"
    # Not pytest's directory: a socket's path must be short, and the server's user must reach it.
    directory = Path(tempfile.mkdtemp(prefix="pg-"))
    if user is not None:
        shutil.chown(directory, user)

    def run(program: str, *arguments: str) -> None:
        subprocess.run(
            [programs.with_name(program), "-D", directory / "data", *arguments],
            cwd=directory,
            user=user,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=True,
            timeout=600,
        )

    try:
        run("initdb", "-U", "runglight", "-A", "trust", "-E", "UTF8", "--no-sync")
        run("pg_ctl", "start", "-w", "-l", "log", "-o", f"-k {directory} -c listen_addresses=''")
        try:
            yield f"postgresql://runglight:hidden@/postgres?host={directory}"
        finally:
            run("pg_ctl", "stop", "-m", "immediate")
    finally:
        shutil.rmtree(directory)


@contextmanager
def mariadb_server() -> Iterator[str]:
    """The URL of a MariaDB server."""
    pymysql = pytest.importorskip("pymysql")
    path = f"{os.environ['PATH']}:/usr/sbin"
    server = shutil.which("mariadbd", path=path)
    install = shutil.which("mariadb-install-db", path=path)
    if server is None or install is None:
        pytest.skip("no MariaDB server on this system")
    directory = Path(tempfile.mkdtemp(prefix="maria-"))
    socket, data = directory / "socket", f"--datadir={directory / 'data'}"
    as_root = ["--user=root"] if os.geteuid() == 0 else []
    quiet = {
        "stdin": subprocess.DEVNULL,
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
    }
    process = None
    try:
        subprocess.run(
            [
                *[install, "--no-defaults", data, "--skip-test-db", *as_root],
                "--auth-root-authentication-method=normal",
            ],
            **quiet,
            check=True,
            timeout=600,
        )
        process = subprocess.Popen(
            [
                *[server, "--no-defaults", data, f"--socket={socket}", "--skip-networking"],
                *[f"--pid-file={directory / 'pid'}", "--innodb-flush-log-at-trx-commit=0"],
                *["--innodb-buffer-pool-size=32M", "--default-time-zone=+05:00", *as_root],
            ],
            **quiet,
        )
        deadline = time.monotonic() + 60
        while not socket.exists():
            assert process.poll() is None, "the server has ended"
            assert time.monotonic() < deadline, "the server does not answer"
            time.sleep(0.1)
        connection = pymysql.connect(unix_socket=str(socket), user="root", connect_timeout=60)
        with connection, connection.cursor() as cursor:
            cursor.execute("CREATE USER runglight@localhost IDENTIFIED BY 'hidden'")
            cursor.execute("GRANT ALL ON *.* TO runglight@localhost")
            cursor.execute("CREATE DATABASE plant CHARACTER SET utf8mb4")
        yield f"mariadb://runglight:hidden@localhost/plant?unix_socket={socket}&charset=utf8mb4"
    finally:
        if process is not None:
            process.kill()
            process.wait()
        shutil.rmtree(directory)
