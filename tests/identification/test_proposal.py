"""Events from photos: what the rectangle does counts, what light and camera do does not."""

from pathlib import Path

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.identification.proposal import propose_events
from runglight.identification.rectangle import Rectangle
from runglight.recording.photos import name_of

Image = pytest.importorskip("PIL.Image")
pytest.importorskip("skimage")

START_NS = 1_704_153_600_000_000_000
SECOND = 1_000_000_000
PLACE = (60, 40, 40, 30)


def scene(seed: int = 5) -> np.ndarray:
    """A machine: patches of many colours, 160 by 120 pixels."""
    random = np.random.default_rng(seed)
    patches = random.integers(40, 200, (12, 16, 3))
    return patches.repeat(10, axis=0).repeat(10, axis=1).astype(float)


def photos(
    directory: Path,
    present: list[bool],
    *,
    light: float = 0.0,
    noise: float = 0.0,
    shake: int = 0,
    belt: bool = False,
) -> Path:
    """A photo a second; a bottle (or a belt with stripes) is there, or runs, when `present`."""
    (directory / "photos").mkdir(parents=True)
    random = np.random.default_rng(1)
    x, y, width, height = PLACE
    phase = 0
    for second, there in enumerate(present):
        picture = scene()
        if belt:
            phase += 7 if there else 0
            stripes = 100 + 90 * ((np.arange(width) + phase) // 5 % 2)
            picture[y : y + height, x : x + width] = stripes[None, :, None]
        elif there:
            picture[y + 5 : y + 25, x + 12 : x + 24] = (30, 160, 60)
        picture *= 1 + light * np.sin(second / 9)
        picture += random.normal(0, noise, picture.shape) if noise else 0
        if shake:
            moved = random.integers(-shake, shake + 1, 2)
            picture = np.roll(picture, moved, axis=(0, 1))
        name = name_of(START_NS + second * SECOND, ".png")
        shown = np.clip(picture, 0, 255).astype(np.uint8)
        Image.fromarray(shown).save(directory / "photos" / name)
    return directory


def times_s(directory: Path, by: str = "look") -> list[tuple[float, str | None]]:
    events = propose_events(directory, PLACE, by=by)  # type: ignore[arg-type]
    seconds = ((events.time_ns - START_NS) / SECOND).tolist()
    return list(zip(seconds, events.labels, strict=True))


PRESENT = [second % 9 in {3, 4, 5} for second in range(40)]
SEEN = [
    (second - 0.5, "away" if PRESENT[second] else "back")
    for second in range(1, 40)
    if PRESENT[second] != PRESENT[second - 1]
]


@pytest.mark.parametrize(
    "trouble",
    [
        {},
        {"noise": 12.0},
        {"light": 0.35},
        {"shake": 2},
        {"noise": 6.0, "light": 0.2, "shake": 2},
    ],
)
def test_a_bottle_comes_and_goes(tmp_path: Path, trouble: dict[str, float]) -> None:
    assert len(SEEN) == 9
    assert times_s(photos(tmp_path / "line", PRESENT, **trouble)) == SEEN  # type: ignore[arg-type]


@pytest.mark.parametrize("trouble", [{"noise": 12.0}, {"light": 0.35}, {"shake": 2}])
def test_without_a_bottle_nothing_is_proposed(tmp_path: Path, trouble: dict[str, float]) -> None:
    directory = photos(tmp_path / "line", [False] * 30, **trouble)  # type: ignore[arg-type]
    assert times_s(directory) == []
    assert times_s(directory, by="motion") == []


def test_a_belt_starts_and_stops(tmp_path: Path) -> None:
    running = [8 <= second < 20 or 26 <= second < 33 for second in range(40)]
    directory = photos(tmp_path / "line", running, belt=True, noise=6.0, light=0.2)
    assert times_s(directory, by="motion") == [
        *((7.5, "starts"), (18.5, "stops")),
        *((25.5, "starts"), (31.5, "stops")),
    ]


def test_a_hole_in_the_photos_leaves_open_when(tmp_path: Path) -> None:
    directory = photos(tmp_path / "line", [False] * 10 + [True] * 8 + [False] * 8)
    for second in range(6, 14):
        (directory / "photos" / name_of(START_NS + second * SECOND, ".png")).unlink()
    assert times_s(directory) == [(17.5, "back")]


@pytest.mark.parametrize("text", ["", "1,2,3", "1,2,0,4", "-1,2,3,4", "a,b,c,d", "1;2;3;4"])
def test_a_rectangle_has_four_numbers(text: str) -> None:
    with pytest.raises(InputError, match="write X,Y,WIDTH,HEIGHT"):
        Rectangle.parse(text)


def test_what_cannot_be_looked_at_is_said(tmp_path: Path) -> None:
    directory = photos(tmp_path / "line", [False] * 4)
    with pytest.raises(InputError, match="has 4 photos, and 5 are the least"):
        propose_events(directory, PLACE)
    last = directory / "photos" / name_of(START_NS + 9 * SECOND)
    last.write_bytes(b"no photo")
    with pytest.raises(InputError, match=f"{last.name}: cannot be read as a photo"):
        propose_events(directory, PLACE)
    last.unlink()
    Image.new("RGB", (80, 60)).save(last)
    with pytest.raises(InputError, match="80 x 60 pixels, the photos before 160 x 120"):
        propose_events(directory, PLACE)
    with pytest.raises(InputError, match="160 x 120 pixels, so no rectangle from 150,40"):
        propose_events(directory, (150, 40, 40, 30))
