"""`runglight serve`: which doors it opens, and that it ends."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Callable
from pathlib import Path

GUARD_S = 120


def test_other_computers_need_a_token(refused: Callable[..., str], tmp_path: Path) -> None:
    told = refused("serve", tmp_path, "--host", "0.0.0.0", "--port", "0")
    assert "--token" in told
    assert "guessed" in refused("serve", tmp_path, "--host", "0.0.0.0", "--token", "short")


def test_what_cannot_be_served(refused: Callable[..., str], tmp_path: Path) -> None:
    assert "is no directory" in refused("serve", tmp_path / "nothing")
    (tmp_path / "runglight.toml").write_text("[souce]\n", encoding="utf-8")
    assert "did you mean source" in refused("serve", tmp_path)
    (tmp_path / "runglight.toml").unlink()
    assert "no such model" in refused("serve", tmp_path, "--model", "a.model", "--port", "0")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert "another port" in refused("serve", tmp_path, "--port", str(port))


def test_it_says_where_and_ends_cleanly(tmp_path: Path) -> None:
    serving = subprocess.Popen(
        [sys.executable, "-m", "runglight", "serve", str(tmp_path), "--port", "0"],
        env=os.environ | {"CI": "true"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert serving.stdout is not None
        found = re.search(r"http://127\.0\.0\.1:\d+/", serving.stdout.readline())
        assert found
        with urllib.request.urlopen(f"{found[0]}api/session", timeout=GUARD_S) as answer:
            assert json.load(answer)["needs_token"] is False
        # A page that listens does not keep it from ending.
        with urllib.request.urlopen(f"{found[0]}api/live/stream", timeout=GUARD_S) as stream:
            assert stream.readline() == b"event: hello\n"
            serving.send_signal(signal.SIGINT)
            _, complaints = serving.communicate(timeout=GUARD_S)
    finally:
        serving.kill()
    assert (serving.returncode, complaints) == (130, "")
