"""Every safety rule, seen to refuse, and to let the page itself through."""

from pathlib import Path

import pytest

from runglight.server.guard import COMMAND_BYTES
from runglight.server.policy import policy
from tests.server.conftest import COMMAND, TestClient, serving

TOKEN = "a-token-of-the-test"
ACKNOWLEDGE = "/api/incidents/acknowledge"
NOBODY = {"ids": [], "who": "Ada"}


def test_what_the_page_asks_is_answered(client: TestClient) -> None:
    assert client.get("/api/live").status_code == 200
    same = {"origin": "http://127.0.0.1:8470", "sec-fetch-site": "same-origin"}
    assert client.post(ACKNOWLEDGE, json=NOBODY, headers=same).status_code == 200


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8470", "127.0.0.1.evil.example", ""]
)
def test_a_name_that_is_not_ours_is_refused(client: TestClient, host: str) -> None:
    refused = client.get("/api/live", headers={"host": host})
    assert refused.status_code == 421
    assert "not called" in refused.json()["error"]
    assert client.get("/", headers={"host": host}).status_code == 421


@pytest.mark.parametrize("host", ["localhost", "localhost:99", "127.0.0.1", "[::1]:8470"])
def test_loopback_has_several_names(client: TestClient, host: str) -> None:
    assert client.get("/api/live", headers={"host": host}).status_code == 200


def test_an_address_that_is_no_loopback_is_refused_on_loopback(client: TestClient) -> None:
    assert client.get("/api/live", headers={"host": "192.168.0.7"}).status_code == 421


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1:9999", "null"])
def test_commands_from_another_page_are_refused(client: TestClient, origin: str) -> None:
    refused = client.post(ACKNOWLEDGE, json=NOBODY, headers={"origin": origin})
    assert (refused.status_code, origin in refused.json()["error"]) == (403, True)


def test_a_form_of_another_page_cannot_command(directory: Path) -> None:
    with serving(directory) as client:
        refused = client.post(ACKNOWLEDGE, json=NOBODY)
        assert refused.status_code == 403
        assert "X-Runglight" in refused.json()["error"]


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_another_site_may_not_even_read(client: TestClient, site: str) -> None:
    assert client.get("/api/live", headers={"sec-fetch-site": site}).status_code == 403


def test_a_read_only_server_changes_nothing(directory: Path) -> None:
    with serving(directory, policy(read_only=True)) as client:
        client.headers.update(COMMAND)
        for path in (ACKNOWLEDGE, "/api/configuration", "/api/symbols", "/api/uploads?name=a.csv"):
            assert client.post(path, json=NOBODY).status_code == 403, path
        assert client.get("/api/session").json()["read_only"] is True
        assert client.get("/api/live").status_code == 200


def test_without_the_token_nothing_is_told(directory: Path) -> None:
    with serving(directory, policy("0.0.0.0", token=TOKEN)) as client:
        for path in ("/api/live", "/api/live/stream", "/api/incidents.csv", "/api/configuration"):
            assert client.get(path).status_code == 401, path
        assert client.get("/api/session").json() == {"needs_token": True}
        assert TOKEN not in client.get("/").text


def test_the_token_opens_and_is_not_handed_on(directory: Path) -> None:
    with serving(directory, policy("0.0.0.0", token=TOKEN)) as client:
        client.headers.update(COMMAND)
        assert client.post("/api/session", json={"token": "a-token-of-the-tesT"}).status_code == 401
        opened = client.post("/api/session", json={"token": TOKEN})
        cookie = opened.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=strict" in cookie
        assert TOKEN not in cookie
        assert client.get("/api/live").status_code == 200
        client.cookies.clear()
        bearer = {"authorization": f"Bearer {TOKEN}"}
        assert client.get("/api/live", headers=bearer).status_code == 200
        assert client.get("/api/live", headers={"authorization": "Bearer x"}).status_code == 401
        assert client.get("/api/live", headers={"cookie": "runglight=x"}).status_code == 401


def test_a_body_may_only_be_so_large(directory: Path) -> None:
    with serving(directory, policy(upload_mb=0.001)) as client:
        client.headers.update(COMMAND)
        large = b"x" * (COMMAND_BYTES + 1)
        assert client.post("/api/symbols", content=large).status_code == 413
        announced = client.post("/api/uploads?name=a.csv", content=b"x" * 1001)
        assert announced.status_code == 413

        def pieces() -> object:
            yield from (b"time,signal,value\n", b"x" * 600, b"x" * 600)

        unannounced = client.post("/api/uploads?name=a.csv", content=pieces())
        assert unannounced.status_code == 413
        assert not [path.name for path in directory.iterdir() if "upload" in path.name]


def test_every_answer_keeps_the_browser_in_bounds(client: TestClient) -> None:
    for path in ("/", "/api/live", "/api/nothing", "/assets/nothing.js"):
        headers = client.get(path).headers
        assert "default-src 'none'" in headers["content-security-policy"]
        assert "unsafe" not in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["x-frame-options"] == "DENY"
    assert client.get("/api/live").headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "path",
    [
        "/assets/../server.py",
        "/assets/%2e%2e/policy.py",
        "/assets/..%2f..%2fpolicy.py",
        "/api/sources/..%2f..%2fetc%2fpasswd",
        "/api/sources/%2fetc%2fpasswd",
        "/api/models/..%2fcell.model",
        "/api/models/cell.model",
    ],
)
def test_no_path_comes_from_a_client(client: TestClient, path: str) -> None:
    assert client.get(path).status_code in {400, 404}
