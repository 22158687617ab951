"""Tables for terminal and page (`benches.tables`)."""

from rich.console import Console

from benches.tables import Table, share, verdict

TABLE = Table("Speeds", ["plant", "M/s", ""], [["tiny", "12.5", verdict(met=False)]])


def test_a_page_aligns_numbers_right() -> None:
    assert TABLE.markdown() == (
        "| plant | M/s |  |\n| --- | ---: | ---: |\n| tiny | 12.5 | **MISSED** |\n"
    )


def test_a_terminal_shows_no_markup() -> None:
    console = Console(width=60, record=True, file=None)
    with console.capture() as captured:
        console.print(TABLE.rich())
    assert "MISSED" in captured.get()
    assert "**" not in captured.get()


def test_nothing_has_no_share() -> None:
    assert share(1, 8, 2) == "12.50 %"
    assert share(0, 0) == "-"
