"""`runglight init` and `runglight check`."""

from collections.abc import Callable
from pathlib import Path

from runglight.configuration import load_configuration
from tests.conftest import Command


def test_init_writes_what_the_machine_has(runglight: Command, cell: Path, tmp_path: Path) -> None:
    url = f"replay:{cell / 'nominal.csv'}"
    written = runglight("init", url)
    assert written.returncode == 0, written.stderr
    assert "29 signals" in written.stdout
    configuration = load_configuration(tmp_path / "runglight.toml")
    assert configuration.source.url == url
    symbols = (tmp_path / "symbols.csv").read_text(encoding="utf-8").splitlines()
    assert symbols[0] == "address,group,device,signal,class,type,description"
    assert len(symbols) == 30


def test_every_commented_key_exists(runglight: Command, cell: Path, tmp_path: Path) -> None:
    runglight("init", f"replay:{cell / 'nominal.csv'}")
    path = tmp_path / "runglight.toml"
    lines = path.read_text(encoding="utf-8").splitlines()
    keys = [line for line in lines if line.startswith("# ") and " = " in line]
    assert len(keys) > 8
    path.write_text(
        "\n".join(line[2:] if line in keys else line for line in lines), encoding="utf-8"
    )
    configuration = load_configuration(path)
    assert configuration.notify.webhook == "https://host/path"


def test_init_overwrites_nothing(
    refused: Callable[..., str], runglight: Command, cell: Path, tmp_path: Path
) -> None:
    (tmp_path / "runglight.toml").write_text("# mine", encoding="utf-8")
    (tmp_path / "symbols.csv").write_text("address\n", encoding="utf-8")
    url = f"replay:{cell / 'nominal.csv'}"
    assert "is there already" in refused("init", url)
    assert (tmp_path / "runglight.toml").read_text(encoding="utf-8") == "# mine"
    assert runglight("init", url, "-c", "other.toml").returncode == 0
    assert (tmp_path / "symbols.csv").read_text(encoding="utf-8") == "address\n"


def test_check_says_what_answers(runglight: Command, cell: Path, tmp_path: Path) -> None:
    runglight("init", f"replay:{cell / 'nominal.csv'}")
    checked = runglight("check", "--model", cell / "cell.model")
    assert checked.returncode == 0, checked.stderr
    assert "29 of 29 signals answer" in checked.stdout
    assert "Group1-PrtLDR-PRT_CHK" in checked.stdout
    assert "all its signals are there" in checked.stderr


def test_check_names_what_the_model_misses(runglight: Command, cell: Path, tmp_path: Path) -> None:
    (tmp_path / "some.csv").write_text(
        "time,signal,value\n2026-01-05T06:00:00Z,Group1-PrtLDR-RET,1\n"
        "2026-01-05T06:00:01Z,STRANGE,1\n",
        encoding="utf-8",
    )
    checked = runglight("check", "replay:some.csv", "--model", cell / "cell.model")
    assert "28 signals of the model are not among them" in checked.stderr
    assert "does not know 1 signal: STRANGE" in checked.stderr


def test_check_refuses_in_one_sentence(refused: Callable[..., str], cell: Path) -> None:
    assert "what shall be checked?" in refused("check")
    assert "is a log" in refused("check", cell / "nominal.csv")
    assert "is the PLC running" in refused("check", "modbus://127.0.0.1:9?inputs=0-7")
    assert "nosuch" in refused("check", "replay:nosuch.csv")


def test_a_configuration_error_is_one_sentence(refused: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "runglight.toml").write_text("[notify]\nwebhok = 'x'\n", encoding="utf-8")
    assert "did you mean webhook" in refused("check")
