"""Table 2 of Guim & Dias 2023 from findings."""

from runglight.findings.finding import Finding, Suspect
from runglight.findings.suspect_rows import suspect_rows


def finding(rank: int | None, model: str = "cycle") -> Finding:
    return Finding(
        id="a",
        incident="a",
        time="2023-04-14T12:26:12Z",
        kind="sequence",
        severity="fault",
        state="confirmed",
        model=model,
        message="",
        rank=rank,
        suspects=[
            Suspect("I12.2", "Clamp 2 Advance", 0.7),
            Suspect("I12.3", "Clamp 2 Return", 0.7),
            Suspect("I13.7", "Clamp 4 Return", 0.6),
        ],
    )


def test_classes_by_score_and_alarm() -> None:
    ranks = {rank: [row.rank for row in suspect_rows([finding(rank)])] for rank in (1, 2, 3, 4)}
    assert ranks == {1: [1, 1, 2], 2: [2, 2, 2], 3: [3, 3, 4], 4: [4, 4, 4]}


def test_one_row_a_suspect() -> None:
    first = next(suspect_rows([finding(1)]))
    assert first == ("I12.2", 1, "Clamp 2 Advance", "2023-04-14T12:26:12Z")


def test_other_findings_have_no_rows() -> None:
    assert list(suspect_rows([finding(None), finding(1, model="device")])) == []
