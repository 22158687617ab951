"""`events.csv`: any way a log may write its times."""

from pathlib import Path

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.identification.events import Events, read_events

NS = 1_000_000_000
DAY_S = 1_704_153_600  # 2024-01-02


@pytest.mark.parametrize(
    "text",
    [
        "time\n2024-01-02T00:00:10Z\n2024-01-02 00:00:20.5\n",
        "time\n2024-01-02T01:00:10+01:00\n2024-01-02T00:00:20.5Z\n",
        "Time stamp;what\n1704153610;x\n1704153620.5;y\n",
        "timestamp\n1704153610000\n1704153620500\n",
        "date,time\n2024-01-02,00:00:10\n2024-01-02,00:00:20.5\n",
        "time,label\n2024-01-02T00:00:20.5Z,\n2024-01-02T00:00:10Z\n",
        "2024-01-02T00:00:10Z\n2024-01-02T00:00:20.5Z\n",
        "time\n00:00:10\n00:00:20.50\n",
        "\ufefftime\r\n02.01.2024 00:00:10\r\n\r\n02.01.2024 00:00:20.5\r\n",
    ],
)
def test_times_are_read_as_a_log_writes_them(tmp_path: Path, text: str) -> None:
    path = tmp_path / "events.csv"
    path.write_text(text, encoding="utf-8", newline="")
    events = read_events(path, date="2024-01-02")
    assert events.time_ns.tolist() == [(DAY_S + 10) * NS, (DAY_S + 20) * NS + NS // 2]


def test_a_label_is_picked_where_there_are_several(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    path.write_text("time,label\n10,start\n20,stop\n30,start\n40,\n", encoding="utf-8")
    events = read_events(path)
    assert events.labels == ("start", "stop", "start", None)
    assert events.labelled("start").time_ns.tolist() == [10 * NS, 30 * NS]
    assert len(events.labelled("any")) == 4
    with pytest.raises(InputError, match=r"start \(2\), stop \(1\), and 1 without a label; say"):
        events.labelled(None)
    with pytest.raises(InputError, match=r"no event has the label 'stat' \(did you mean star?t"):
        events.labelled("stat")
    assert len(events.labelled("stop").labelled(None)) == 1


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "is empty"),
        ("when,what\nsoon,x\n", "no time column"),
        ("time\n2024-01-02T00:00:10Z\nsoon\n", "row 3: column 'time' is 'soon'"),
        ("label,time\nx\n", "row 2: has 1 fields"),
        ("<?xml version='1.0'?><log/>", "a CSV file with a column 'time'"),
    ],
)
def test_what_is_no_list_of_events_is_said(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "events.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as raised:
        read_events(path)
    assert sentence in str(raised.value)
    assert "events.csv" in str(raised.value)


def test_written_events_are_read_back(tmp_path: Path) -> None:
    written = Events(np.array([DAY_S * NS, DAY_S * NS + 1_500_000_000]), ("away", None))
    written.write(tmp_path / "events.csv")
    text = (tmp_path / "events.csv").read_text(encoding="utf-8")
    assert text == "time,label\n2024-01-02T00:00:00.000Z,away\n2024-01-02T00:00:01.500Z,\n"
    again = read_events(tmp_path / "events.csv")
    assert again.time_ns.tolist() == written.time_ns.tolist()
    assert again.labels == written.labels


def test_any_bytes_end_in_events_or_a_sentence(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    pieces = [
        b"time",
        b"label",
        b",",
        b";",
        b"\n",
        b'"',
        b"2024-01-02T00:00:10Z",
        b"\xff\x00",
        b"7",
    ]
    path = tmp_path / "events.csv"
    lists, sentences = 0, []
    for _ in range(300):
        path.write_bytes(b"".join(random.choice(pieces, random.integers(1, 12)).tolist()))
        try:
            read_events(path)
            lists += 1
        except InputError as error:
            sentences.append(str(error))
    assert lists > 5
    assert len(sentences) > 5
    assert not any("\n" in sentence for sentence in sentences)
