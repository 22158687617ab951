"""The page of benchmarks is what its numbers say; a quick run gives such numbers."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from benches import page
from benches.topics import TOPICS

ROOT = Path(__file__).parents[2]


def test_the_page_is_what_its_numbers_give() -> None:
    results = json.loads(page.NUMBERS.read_text(encoding="utf-8"))
    assert not results["quick"]
    assert set(TOPICS) <= results.keys()
    assert page.PAGE.read_text(encoding="utf-8") == page.page(results)
    assert page.PICTURE.is_file()


def test_another_number_makes_another_page() -> None:
    results = json.loads(page.NUMBERS.read_text(encoding="utf-8"))
    before = page.page(results)
    next(iter(results["throughput"].values()))["learn"]["plat"] *= 2
    assert page.page(results) != before


def test_the_page_names_no_place_of_the_machine_it_was_made_on() -> None:
    assert str(Path.home()) not in page.NUMBERS.read_text(encoding="utf-8")
    assert "/tmp" not in page.PAGE.read_text(encoding="utf-8")


@pytest.mark.skipif(not (shutil.which("g++") and shutil.which("make")), reason="needs a compiler")
def test_a_quick_run_gives_a_page(tmp_path: Path) -> None:
    output = tmp_path / "numbers.json"
    subprocess.run(
        [sys.executable, "-m", "benches.run", "--quick", "--output", output],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    results = json.loads(output.read_text(encoding="utf-8"))
    assert results["quick"]
    written = page.page(results)
    for name in ("Speed and memory", "Clusterings", "Detection", "The budget"):
        assert f"## {name}" in written
