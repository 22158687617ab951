"""`runglight spark` where it cannot work: one sentence, whatever is installed."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from runglight.cli import main
from runglight.model import NominalModel


@pytest.fixture
def model(nominal_model: NominalModel, tmp_path: Path) -> str:
    directory = tmp_path / "cell.model"
    nominal_model.save(directory)
    return str(directory)


def told(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line that a refused command says."""
    assert main(["spark", *arguments]) == 2
    [line] = capsys.readouterr().err.splitlines()
    return line


WATCH = ("--to", "out", "--checkpoint", "checkpoint")


@pytest.mark.parametrize("module", ["pyspark", "pandas", "pyarrow"])
def test_without_spark(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], model: str, module: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    if module != "pyspark":
        pytest.importorskip("pyspark")
    line = told(capsys, "watch", model, "kafka://broker:9092/topic", *WATCH)
    assert f"needs {module}" in line
    assert 'pip install "runglight[spark]"' in line


def test_without_a_kafka_client(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "confluent_kafka", None)
    line = told(capsys, "feed", "replay:log.csv", "kafka://broker:9092/topic")
    assert 'pip install "runglight[kafka]"' in line


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("watch", "MODEL", *WATCH), "name the model and the stream"),
        (("watch", "nowhere", "kafka://b/t", *WATCH), "there is no model here"),
        (("watch", "MODEL", "kafka://b/t", *WATCH, "--delay", "soon"), "--delay"),
        (("watch", "MODEL", "kafka://b/t", *WATCH, "--plant", "a=b"), "either one model or one"),
        (("watch", "kafka://b/t", *WATCH, "--plant", "a"), "write NAME=MODEL"),
        (("watch", "MODEL", "kafka://b/t", *WATCH, "--set", "x"), "write KEY=VALUE"),
        (("feed", "replay:log.csv", "kafka://broker"), "write it like kafka://"),
        (("feed", "replay:log.csv", "broker:9092"), "write it like kafka://"),
    ],
)
def test_what_cannot_be_meant(
    capsys: pytest.CaptureFixture[str], model: str, arguments: tuple[str, ...], said: str
) -> None:
    line = told(capsys, *(model if each == "MODEL" else each for each in arguments))
    assert said in line
