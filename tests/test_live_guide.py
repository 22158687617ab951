"""The source URLs in the pages can be used as they stand."""

import re
from pathlib import Path

import pytest

from runglight.taps import open_tap

GUIDE = Path(__file__).parent.parent / "docs" / "guides" / "live-machines.md"
URLS = re.findall(r"`((?:modbus|s7)://[^`…]+|replay:[^`]+)`", GUIDE.read_text(encoding="utf-8"))


def test_the_guide_has_urls() -> None:
    assert len(URLS) >= 6


@pytest.mark.parametrize("url", URLS)
def test_urls_of_the_guide_are_valid(url: str) -> None:
    open_tap(url)
