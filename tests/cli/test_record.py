import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import runglight as rl
from runglight.recording.photos import photos
from runglight.recording.read import open_recording
from tests.conftest import Command

Refused = Callable[..., str]


def test_a_replayed_log_is_recorded_as_it_is(
    runglight: Command, tmp_path: Path, cell: Path
) -> None:
    nominal = cell / "nominal.csv"
    ended = runglight("record", f"replay:{nominal}?speed=max", "--to", "recording")
    assert ended.returncode == 0, ended.stderr
    log, recorded = rl.read_log(nominal), rl.read_log(tmp_path / "recording")
    assert ended.stdout.startswith(f"recording: recorded {len(log):,} rows of ")
    exported = runglight("export", "recording", "--to", "again.csv")
    assert exported.returncode == 0, exported.stderr
    for column, again in zip(log.columns(), recorded.columns(), strict=True):
        assert column.tolist() == again.tolist()
    assert recorded.signals == log.signals
    assert recorded.gaps == []


def test_names_and_source_come_from_the_configuration(
    runglight: Command, tmp_path: Path, cell: Path
) -> None:
    (tmp_path / "log.csv").write_text("time,signal,value\n0,%IX0.0,0\n1,%IX0.0,1\n2,%QX7.7,1\n")
    (tmp_path / "symbols.csv").write_text("address,group,device,signal\n%IX0.0,G,D,ON\n")
    (tmp_path / "runglight.toml").write_text(
        '[source]\nurl = "replay:log.csv?speed=max"\n[symbols]\ntable = "symbols.csv"\n'
        '[record]\nto = "recording"\n'
    )
    assert runglight("record").returncode == 0
    recording = open_recording(tmp_path / "recording")
    assert [(each.name, each.address) for each in recording.description.signals] == [
        ("G-D-ON", "%IX0.0"),
        ("%QX7.7", "%QX7.7"),
    ]


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_it_says_what_was_recorded(tmp_path: Path, cell: Path, how: int) -> None:
    folder = tmp_path / "camera"
    folder.mkdir()
    with subprocess.Popen(
        [
            *(sys.executable, "-m", "runglight", "record", f"replay:{cell / 'nominal.csv'}"),
            *("--to", "recording", "--camera", "camera"),
        ],
        cwd=tmp_path,
        env=os.environ | {"CI": "true"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    ) as process:
        assert process.stderr is not None
        assert "connected" in process.stderr.readline()
        (folder / "photo.jpg").write_bytes(b"photo")
        process.send_signal(how)
        said, complained = process.communicate(timeout=300)
    assert process.returncode == 130, complained
    assert complained == ""
    assert "1 photo" in said
    assert said.startswith("recording: recorded ")
    assert len(rl.read_log(tmp_path / "recording")) > 0
    assert len(photos(tmp_path / "recording")) == 1


def test_for_some_time(runglight: Command, tmp_path: Path, cell: Path) -> None:
    source = f"replay:{cell / 'nominal.csv'}?speed=100"
    assert runglight("record", source, "--to", "recording", "--for", "30s").returncode == 0
    recording = open_recording(tmp_path / "recording")
    assert recording.log.engine.start_ns is not None
    recorded_s = (recording.until_ns - recording.log.engine.start_ns) / 1e9
    assert 30 <= recorded_s < 300
    whole = rl.read_log(cell / "nominal.csv")
    assert 0 < len(recording.log) < len(whole)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "what shall be recorded? name a source like"),
        (["replay:log.csv"], "where to? runglight record replay:log.csv --to DIRECTORY"),
        (["log.csv", "--to", "r"], "log.csv: is no live source"),
        (["modbuss://x", "--to", "r"], "modbuss://x: is no live source"),
        (["replay:log.csv", "--to", "r", "--for", "soon"], "--for: 'soon' is not a duration"),
        (["replay:log.csv", "--to", "r", "--camera", "nowhere"], "--camera: nowhere is neither"),
        (["replay:nowhere.csv", "--to", "r"], "nowhere.csv"),
        (["replay:log.csv", "--to", "log.csv"], "log.csv: is a file; name a directory"),
        (["replay:log.csv", "--to", "r", "--reserve-mb", "1e12"], "MB are kept in reserve"),
    ],
)
def test_what_cannot_work_is_one_sentence(
    refused: Refused, tmp_path: Path, arguments: list[str], sentence: str
) -> None:
    (tmp_path / "log.csv").write_text("time,signal,value\n0,A,0\n1,A,1\n")
    assert sentence in refused("record", *arguments)
