"""`--help` reads like a manual."""

import pytest

from tests.conftest import Command

READER = (
    "--sql",
    "--table",
    "--time-column",
    "--signal-column",
    "--value-column",
    "--time-format",
    "--date",
    "--delimiter",
    "--analog",
    "--bits",
    "--on-error",
    "--reorder",
    "--naming",
    "--symbols",
    "--config",
)
LEARNING = (
    "--timing",
    "--false-alarms",
    "--stall-after",
    "--return-within",
    "--check-every",
    "--significant-change",
    "--scan-interval",
    "--starting",
)
IDENTIFY = (
    *("--format", "--output", "--events", "--label", "--tau", "--view", "--share", "--words"),
    *("--propose", "--propose-by", "--rows", "--accept", "--name", *READER),
)
LIVE = ("--record", "--store", "--publish", "--webhook", "--metrics", "--for")
INJECTION = (
    *("--faults", "--kinds", "--stuck", "--late", "--late-over", "--early", "--early-under"),
    *("--longest", "--stalls", "--stall-over", "--branch-shifts", "--time-shifts"),
    *("--shift-passes", "--shift-by", "--seed", "--from", "--after", "--spacing"),
)


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("demo", ("--fault", "--to")),
        ("learn", ("--output", *LEARNING, *READER)),
        ("show", ("--device", "--group", "--format", "--output", "--config")),
        ("init", ("--config",)),
        ("check", ("--config", "--model")),
        ("watch", ("--format", "--output", "--fail-on", "--notices", "--state", *LIVE, *READER)),
        ("confirm", ()),
        ("identify", IDENTIFY),
        ("import", ("--to", *READER)),
        ("export", ("--to", *READER)),
        ("simulate", ("--log", "--cycles", "--seed", "--fault", "--labels", "--list")),
        (
            "spark learn",
            ("--output", "--symbols", "--order-column", "--master", "--set", *LEARNING),
        ),
        (
            "spark watch",
            (
                *("--to", "--checkpoint", "--plant", "--format", "--plant-by-key", "--starting"),
                *("--delay", "--quiet", "--ahead", "--every", "--rows", "--until-here"),
            ),
        ),
        ("spark feed", ("--plant", "--format", "--for")),
        ("simulate faults", ("--to", "--labels", "--reference", *INJECTION, *READER)),
    ],
)
def test_every_option_is_explained(
    runglight: Command, command: str, options: tuple[str, ...]
) -> None:
    helped = runglight(*command.split(), "--help")
    assert helped.returncode == 0, helped.stderr
    assert helped.stdout.startswith(f"Usage: runglight {command} ")
    lines = helped.stdout.splitlines()
    for option in options:
        explained = [line for line in lines if f" {option} " in line]
        assert explained, f"{command} --help does not explain {option}"
    assert "--no-" not in helped.stdout
    assert "default: ()" not in helped.stdout


def test_the_overview(runglight: Command) -> None:
    for arguments in ([], ["--help"], ["-h"]):
        helped = runglight(*arguments)
        assert helped.returncode == 0
        commands = [
            line.strip("│ ").split()[0]
            for line in helped.stdout.splitlines()
            if line.startswith("│ ") and not line.startswith("│ --")
        ]
        assert commands == [
            "demo",
            "init",
            "check",
            "record",
            "learn",
            "show",
            "watch",
            "confirm",
            "serve",
            "identify",
            "mine",
            "predict",
            "control",
            "spark",
            "import",
            "export",
            "simulate",
        ]
