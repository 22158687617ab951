"""What Prometheus sees."""

import asyncio
import socket
import urllib.request
from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.live.metrics import Metrics, parse_address
from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.live.double_tap import batch_of
from tests.live.receivers import DoubleReceiver
from tests.live.running import Watching

REFERENCE = Path(__file__).parents[2] / "docs" / "reference" / "metrics.md"


def test_a_scrape_after_a_session(
    nominal_model: NominalModel, model_directory: Path, faulty: Log
) -> None:
    metrics = Metrics()

    async def main() -> None:
        watching = Watching(nominal_model, model_directory, faulty, metrics=metrics)
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await watching.session.run([DoubleReceiver("mail")], duration_s=0.6)

    server = metrics.serve("0")
    try:
        asyncio.run(main())
        with urllib.request.urlopen(f"http://127.0.0.1:{server.port}/metrics", timeout=10) as got:
            text = got.read().decode()
    finally:
        server.stop()
    scans = len(set(faulty.columns()[0].tolist()))
    assert f"runglight_scans_total {float(scans)}" in text
    assert f"runglight_changes_total {float(len(faulty))}" in text
    assert 'runglight_findings_total{kind="transition",severity="fault"} 1.0' in text
    assert 'runglight_connection{state="connected"} 1.0' in text
    assert 'runglight_connection{state="retrying"} 0.0' in text
    assert 'runglight_delivered{receiver="mail"} 3.0' in text
    assert "runglight_monitor_seconds_count 1.0" in text
    assert "runglight_gaps_total 0.0" in text


def test_every_metric_is_documented() -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    families = list(Metrics().registry.collect())
    assert len(families) > 10
    for family in families:
        assert f"`{family.name}" in page, family.name
        assert family.documentation in page


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("9109", ("127.0.0.1", 9109)),
        (":9109", ("127.0.0.1", 9109)),
        ("0.0.0.0:80", ("0.0.0.0", 80)),
        ("[::1]:9109", ("::1", 9109)),
    ],
)
def test_addresses(text: str, expected: tuple[str, int]) -> None:
    assert parse_address(text) == expected


@pytest.mark.parametrize("text", ["host", "host:", "1:2:x", "70000", ""])
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--metrics"):
        parse_address(text)


def test_a_port_in_use_is_one_sentence() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match="cannot listen there"):
            Metrics().serve(str(port))
