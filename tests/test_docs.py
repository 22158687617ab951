"""What the pages say is so."""

import re
from pathlib import Path

import msgspec
import pytest

from runglight.cli.learn import LearningOptions
from runglight.cli.model_tables import COLUMNS
from runglight.cli.reader_options import ReaderOptions
from runglight.configuration import Configuration
from runglight.findings.schema import KEYS

ROOT = Path(__file__).parent.parent
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def test_every_option_is_in_the_reference() -> None:
    options = [*ReaderOptions.__dataclass_fields__, *LearningOptions.__dataclass_fields__]
    for option in options:
        assert f"--{option.replace('_', '-')}" in page("reference/cli.md")


def test_every_key_is_in_the_reference() -> None:
    for table in msgspec.structs.fields(Configuration):
        assert f"## [{table.name}]" in page("reference/configuration.md")
        # The keys of [regions] are the user's own.
        of_table = msgspec.structs.fields(table.type) if table.name != "regions" else ()
        for field in of_table:
            assert f"| `{field.name}` |" in page("reference/configuration.md")
    for key in KEYS:
        assert f"| `{key}` |" in page("reference/finding.md")
    for column in COLUMNS:
        assert f"`{column}`" in page("reference/rules.md")


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8")):
        assert (path.parent / target).exists(), f"{path}: {target}"


def test_the_pages_were_found() -> None:
    assert len(PAGES) >= 10
