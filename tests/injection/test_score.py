"""What counts as found, as a consequence, and as false."""

from typing import Any

from runglight.injection import InjectionKind, InjectionLabel, score

LABEL = InjectionLabel(
    id="F00001",
    time="2026-01-05T06:00:10Z",
    start="2026-01-05T06:00:08Z",
    end="2026-01-05T06:00:20Z",
    kind=InjectionKind.MISSING_EDGE,
    group="G",
    device="D",
    description="",
)


def finding(second: int, **said: Any) -> dict[str, Any]:
    return {
        "id": said.get("id", f"f{second}"),
        "incident": f"i{second}",
        "time": f"2026-01-05T06:{second // 60:02}:{second % 60:02}Z",
        "kind": "transition",
        "severity": "fault",
        "model": "device",
        "group": "G",
        "device": "D",
    } | said


def counts(*findings: dict[str, Any], **options: Any) -> tuple[int, int, int]:
    told = score([LABEL], findings, 10.0, **options)
    assert told.matched + told.consequences + told.false == told.findings
    return told.found, told.consequences, told.false


def test_found_from_its_time_to_the_tolerance_after_its_end() -> None:
    assert counts(finding(10)) == (1, 0, 0)
    assert counts(finding(30)) == (1, 0, 0)
    assert counts(finding(31)) == (0, 0, 1)
    assert counts(finding(9)) == (0, 1, 0)
    assert counts(finding(7)) == (0, 0, 1)


def test_device_and_kind_must_fit() -> None:
    assert counts(finding(12, device="E")) == (0, 1, 0)
    assert counts(finding(12, kind="late")) == (0, 1, 0)
    assert counts(finding(12, group="H")) == (0, 0, 1)
    assert counts(finding(12, kind="stall", device=None)) == (1, 0, 0)


def test_the_same_incident_is_a_consequence_however_late() -> None:
    late = finding(50, incident="i12", group="H")
    assert counts(finding(12), late) == (1, 1, 0)
    assert counts(late) == (0, 0, 1)


def test_severities_are_chosen() -> None:
    notice = finding(12, severity="notice")
    assert counts(notice) == (0, 0, 0)
    assert counts(notice, severities="any") == (1, 0, 0)
    assert counts(finding(12, severity="anomaly"), severities="fault") == (0, 0, 0)


def test_a_change_of_state_is_no_new_finding() -> None:
    again = finding(40, id="f12")
    assert counts(finding(12), again) == (1, 0, 0)


def test_delays() -> None:
    told = score([LABEL], [finding(13), finding(12)])
    assert told.kinds["missing-edge"].delay_median_s == 2.0
    assert told.found_by == {"F00001": "f12"}
    assert score([LABEL], []).missed == ["F00001"]
