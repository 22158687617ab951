"""What the electrician reads."""

import io

from rich.console import Console

from runglight.cli.finding_table import print_findings, summary_line
from runglight.findings.finding import Expected, Finding, Suspect
from runglight.findings.tally import Tally


def finding(number: int, **changes: object) -> Finding:
    given: dict[str, object] = {
        "id": f"f-{number}",
        "incident": "f-1",
        "time": f"2026-01-05T06:00:{number:02}.123456789Z",
        "kind": "transition",
        "severity": "fault",
        "state": "suspected",
        "model": "device",
        "message": f"Finding {number} happened.",
        "group": "Cell",
        "device": "Loader",
        "signal": "HOME",
        "address": "%IX0.0",
        "from_state": "Cell-Loader-OUT_OFF",
        "to_state": "Cell-Loader-HOME_ON",
    }
    return Finding(**(given | changes))  # type: ignore[arg-type]


def printed(findings: list[Finding], *, notices: bool = False) -> str:
    text = io.StringIO()
    print_findings(Console(file=text, width=160, highlight=False), findings, notices=notices)
    return text.getvalue()


def test_consequences_stand_below_their_cause() -> None:
    other = finding(2, incident="f-2", device="Clamp")
    lines = printed([finding(1), other, finding(3, message="It follows.")]).splitlines()
    rows = [line for line in lines if "2026-01-05" in line]
    assert ["└" in row for row in rows] == [False, True, False]
    assert "└ It follows." in rows[1]
    assert "2026-01-05 06:00:01.123" in rows[0]


def test_a_change_of_state_is_no_further_row() -> None:
    later = finding(1, state="returned", time="2026-01-05T06:09:00Z", message="It is back.")
    text = printed([finding(1), later])
    assert text.count("Finding 1 happened.") == 1
    assert "2026-01-05 06:00:01.123" in text
    assert "returned" in text


def test_expected_states_and_times() -> None:
    expected = [Expected("Cell-Loader-HOME_OFF", 0.9), Expected("Cell-Loader-IN_ON", 0.1)]
    assert "HOME_OFF 90% or" in printed([finding(1, expected=expected)])
    late = finding(1, kind="late", severity="anomaly", limit_s=1.5, observed_s=2.5)
    assert "within 1.50 s" in printed([late])


def test_a_stalled_line_says_where_to_look_first() -> None:
    stall = finding(2, kind="stall", to_state=None, message="Nothing moves.", limit_s=180.0)
    text = " ".join(printed([finding(1), stall]).split())
    assert "→ Look first at Cell-Loader, signal HOME, address %IX0.0." in text
    suspected = finding(
        1, kind="stall", signal=None, address=None, suspects=[Suspect("%QX1.0", "RUN", 0.9)]
    )
    assert "Look first at Cell-Loader, signal RUN, address %QX1.0." in printed([suspected])


def test_a_narrow_terminal_keeps_ids_whole() -> None:
    text = io.StringIO()
    late = finding(1, id="a1796079b6d4", kind="late", limit_s=1.5, observed_s=2.5)
    print_findings(Console(file=text, width=80), [late], notices=False)
    assert "a1796079b6d4" in text.getvalue()
    assert "Expected: within" in text.getvalue()
    assert max(map(len, text.getvalue().splitlines())) <= 80


def test_a_notice_that_follows_from_an_alarm_stands_below_it() -> None:
    text = printed([finding(1), finding(2, severity="notice", message="It follows.")])
    assert "└ It follows." in text
    assert "not shown" not in text


def test_notices_are_one_line_unless_asked_for() -> None:
    notices = [finding(n, incident=f"f-{n}", severity="notice", kind="late") for n in range(1, 4)]
    quiet = printed(notices)
    assert len(quiet.splitlines()) == 1
    assert quiet.startswith("3 notices not shown (late 3)")
    assert printed(notices, notices=True).count("happened.") == 3


def test_a_long_incident_is_cut() -> None:
    text = printed([finding(number) for number in range(1, 30)])
    assert "and 22 more that follow from it" in text


def test_text_that_looks_like_markup_is_printed_as_it_is() -> None:
    assert "[bold]x[/red] came." in printed([finding(1, message="[bold]x[/red] came.")])


def test_summary() -> None:
    findings = [
        finding(1),
        finding(2, severity="anomaly", kind="late"),
        finding(3, severity="notice"),
    ]
    assert summary_line(Tally.of(findings), 1200, 0.5) == (
        "1 fault, 1 anomaly, 1 notice (transition 1, late 1)"
        " · 1,200 events in 0.50 s (2,400 events/s)"
    )
    assert summary_line(Tally(), 1, 0.0) == "No findings · 1 event in 0.00 s"
