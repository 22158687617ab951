"""Prometheus metrics of live watching, over HTTP."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, start_http_server

from runglight.errors import InputError
from runglight.taps.base import ConnectionState

if TYPE_CHECKING:
    from collections.abc import Iterable
    from threading import Thread
    from wsgiref.simple_server import WSGIServer

    from runglight.findings.finding import Finding
    from runglight.live.delivery import Delivery
    from runglight.live.status import Progress
    from runglight.taps.base import Connection

LOOPBACK = "127.0.0.1"
_MONITOR_BUCKETS_S = (0.00001, 0.00003, 0.0001, 0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 1.0)
_TOLD_BUCKETS_S = (0.001, 0.002, 0.005, 0.01, 0.015, 0.02, 0.025, 0.05, 0.1, 0.25, 1.0, 10.0)


class Metrics:
    """What a scrape sees. Methods are called after what they count."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        registry = self.registry
        self._scans = Counter("runglight_scans", "Scans of the source.", registry=registry)
        self._changes = Counter("runglight_changes", "Changes watched.", registry=registry)
        self._gaps = Counter("runglight_gaps", "Times nothing was seen.", registry=registry)
        self._findings = Counter(
            "runglight_findings",
            "Findings; a change of a finding's state is not counted again.",
            ["severity", "kind"],
            registry=registry,
        )
        self._open = Gauge(
            "runglight_open_findings",
            "Faults and anomalies that have not returned.",
            registry=registry,
        )
        self._connection = Gauge(
            "runglight_connection",
            "1 for the state the connection to the source is in, 0 for the others.",
            ["state"],
            registry=registry,
        )
        self._reconnects = Gauge(
            "runglight_reconnects", "Times the source was connected to again.", registry=registry
        )
        self._last_scan = Gauge(
            "runglight_last_scan_timestamp_seconds",
            "Time of the last scan, seconds since 1970.",
            registry=registry,
        )
        self._monitor = Histogram(
            "runglight_monitor_seconds",
            "Time the monitor took for one batch.",
            buckets=_MONITOR_BUCKETS_S,
            registry=registry,
        )
        self._told = Histogram(
            "runglight_finding_latency_seconds",
            "From the event (as the tap stamped it) to its finding being told.",
            buckets=_TOLD_BUCKETS_S,
            registry=registry,
        )
        self._delivered = Gauge(
            "runglight_delivered",
            "Findings a receiver has taken since the start.",
            ["receiver"],
            registry=registry,
        )
        self._refused = Gauge(
            "runglight_refused",
            "Findings a receiver has refused for good since the start.",
            ["receiver"],
            registry=registry,
        )
        self._failing = Gauge(
            "runglight_receiver_failing",
            "1 while a receiver takes no findings.",
            ["receiver"],
            registry=registry,
        )
        self._dropped = Gauge(
            "runglight_findings_dropped",
            "Findings lost because the disk took none for too long.",
            registry=registry,
        )
        self._counted = (0, 0, 0)

    def batch(self, progress: Progress, monitor_s: float) -> None:
        """A batch has been watched."""
        scans, changes, gaps = self._counted
        self._scans.inc(progress.scans - scans)
        self._changes.inc(progress.changes - changes)
        self._gaps.inc(progress.gaps - gaps)
        self._counted = (progress.scans, progress.changes, progress.gaps)
        self._monitor.observe(monitor_s)
        if progress.last_scan_ns is not None:
            self._last_scan.set(progress.last_scan_ns / 1e9)

    def findings(self, new: Iterable[Finding], open_findings: int) -> None:
        """Findings have been told."""
        for finding in new:
            self._findings.labels(finding.severity, finding.kind).inc()
        self._open.set(open_findings)

    def told(self, latency_s: float) -> None:
        """The findings of one live batch have been told so long after its first row."""
        self._told.observe(max(latency_s, 0.0))

    def connection(self, connection: Connection) -> None:
        """The connection as it is."""
        for state in ConnectionState:
            self._connection.labels(state.value).set(state is connection.state)
        self._reconnects.set(connection.reconnects)

    def deliveries(self, deliveries: Iterable[Delivery], dropped: int) -> None:
        """The receivers as they are."""
        for delivery in deliveries:
            name = delivery.receiver.name
            self._delivered.labels(name).set(delivery.delivered)
            self._refused.labels(name).set(delivery.refused)
            self._failing.labels(name).set(delivery.failing is not None)
        self._dropped.set(dropped)

    def serve(self, address: str) -> MetricsServer:
        """Answers scrapes at `HOST:PORT` (or `PORT`, on loopback) until stopped."""
        host, port = parse_address(address)
        try:
            server, thread = start_http_server(port, host, self.registry)
        except OSError as error:
            raise InputError(
                f"--metrics {address}: cannot listen there: {error.strerror or error}; "
                "choose another port"
            ) from None
        return MetricsServer(server, thread)


class MetricsServer:
    """The server of one `Metrics`."""

    def __init__(self, server: WSGIServer, thread: Thread) -> None:
        self._server = server
        self._thread = thread
        self.port = int(server.server_address[1])

    def stop(self) -> None:
        """Stops answering."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


def parse_address(text: str) -> tuple[str, int]:
    """Host and port of `HOST:PORT`, `[::1]:PORT`, `:PORT` or `PORT`; loopback without a host."""
    host, _, port = text.rpartition(":")
    if not port.isdecimal() or not 0 <= int(port) <= 65535:
        raise InputError(f"--metrics {text}: write HOST:PORT, or a port alone, like 9109")
    return host.strip("[]") or LOOPBACK, int(port)
