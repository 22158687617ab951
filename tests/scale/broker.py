"""A real Kafka broker on loopback: one node, KRaft, from Maven Central's jars."""

from __future__ import annotations

import socket
import subprocess
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.live.broker import free_port

_START_TIMEOUT_S = 60


class Broker:
    """Where it listens, and the little that tests do with it."""

    def __init__(self, port: int) -> None:
        self.servers = f"127.0.0.1:{port}"

    def create(self, topic: str, partitions: int = 1) -> None:
        """Makes a topic."""
        from confluent_kafka.admin import AdminClient, NewTopic  # noqa: PLC0415

        client = AdminClient({"bootstrap.servers": self.servers})
        for made in client.create_topics([NewTopic(topic, partitions, 1)]).values():
            made.result(30)

    def send(
        self, topic: str, messages: Iterable[tuple[bytes | None, bytes]], partition: int = 0
    ) -> None:
        """Sends keys and values, in order, and waits until the broker has them."""
        from confluent_kafka import Producer  # noqa: PLC0415

        producer = Producer(
            {"bootstrap.servers": self.servers, "linger.ms": 20, "enable.idempotence": True}
        )
        for key, value in messages:
            while True:
                try:
                    producer.produce(topic, value, key, partition=partition)
                    break
                except BufferError:
                    producer.poll(1)
        assert producer.flush(60) == 0

    def received(self, topic: str) -> list[tuple[bytes | None, bytes]]:
        """All messages that stand in a topic."""
        from confluent_kafka import Consumer, TopicPartition  # noqa: PLC0415

        consumer = Consumer({"bootstrap.servers": self.servers, "group.id": "reader"})
        try:
            partitions = consumer.list_topics(topic, 30).topics[topic].partitions
            messages: list[Any] = []
            for partition in partitions:
                place = TopicPartition(topic, partition, 0)
                _, end = consumer.get_watermark_offsets(place, 30)
                consumer.assign([place])
                for _ in range(end):
                    message = consumer.poll(30)
                    assert message is not None
                    assert message.error() is None, message.error()
                    messages.append((message.key(), message.value()))
            return messages
        finally:
            consumer.close()


@contextmanager
def running(jars: Iterable[Path], directory: Path) -> Iterator[Broker]:
    """A broker until the end of the block."""
    directory.mkdir(parents=True, exist_ok=True)
    port, control = free_port(), free_port()
    settings = directory / "server.properties"
    settings.write_text(
        f"""process.roles=broker,controller
node.id=1
controller.quorum.voters=1@127.0.0.1:{control}
listeners=PLAINTEXT://127.0.0.1:{port},CONTROLLER://127.0.0.1:{control}
advertised.listeners=PLAINTEXT://127.0.0.1:{port}
controller.listener.names=CONTROLLER
listener.security.protocol.map=CONTROLLER:PLAINTEXT,PLAINTEXT:PLAINTEXT
log.dirs={directory / "log"}
auto.create.topics.enable=false
offsets.topic.num.partitions=1
offsets.topic.replication.factor=1
transaction.state.log.num.partitions=1
transaction.state.log.replication.factor=1
transaction.state.log.min.isr=1
share.coordinator.state.topic.num.partitions=1
share.coordinator.state.topic.replication.factor=1
share.coordinator.state.topic.min.isr=1
group.initial.rebalance.delay.ms=0
""",
        encoding="utf-8",
    )
    classes = ":".join(map(str, jars))
    java = ["java", "-Xmx384m", "-XX:+UseSerialGC", f"-Djava.io.tmpdir={directory}", "-cp", classes]
    with (directory / "broker.log").open("wb") as log:
        subprocess.run(
            [
                *java,
                "kafka.tools.StorageTool",
                *("format", "-t", "cnVuZ2xpZ2h0LXRlc3QtMQ", "-c", str(settings)),
            ],
            stdout=log,
            stderr=log,
            check=True,
            timeout=_START_TIMEOUT_S,
        )
        process = subprocess.Popen(
            [*java, "kafka.Kafka", str(settings)], stdout=log, stderr=log, cwd=directory
        )
        try:
            _wait_for(port, process)
            yield Broker(port)
        finally:
            process.terminate()
            try:
                process.wait(15)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _wait_for(port: int, process: subprocess.Popen[bytes]) -> None:
    from confluent_kafka import KafkaException  # noqa: PLC0415
    from confluent_kafka.admin import AdminClient  # noqa: PLC0415

    deadline = time.monotonic() + _START_TIMEOUT_S
    while time.monotonic() < deadline:
        assert process.poll() is None, "the broker ended; its directory has broker.log"
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                try:
                    AdminClient({"bootstrap.servers": f"127.0.0.1:{port}"}).list_topics(timeout=5)
                    return
                except KafkaException:
                    pass
        time.sleep(0.2)
    raise TimeoutError("the broker does not answer")
