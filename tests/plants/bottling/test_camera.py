"""Photos show the machine at their time, under a light that drifts."""

import io
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling import RunningBottling
from runglight.plants.bottling.picture import (
    BEHIND_STATION_2,
    BELT_RECTANGLE,
    GREEN_LAMP_RECTANGLE,
    Rectangle,
)
from runglight.plants.bottling.simulate import START_NS
from runglight.recording.exif import taken_ns

GRAIN = 8.0
"""Mean difference of two photos of the same, more than grain and light make."""


def photo_at(plant: RunningBottling, seconds: float) -> tuple[int, np.ndarray]:
    plant.advance(START_NS + round(seconds * NS_PER_S))
    photo = plant.expose()()
    return photo.time_ns, np.asarray(Image.open(io.BytesIO(photo.content)), np.float32)


def difference(a: np.ndarray, b: np.ndarray, rectangle: Rectangle) -> float:
    return float(np.abs(_within(a, rectangle) - _within(b, rectangle)).mean())


@pytest.fixture(scope="module")
def photos() -> list[tuple[float, np.ndarray, object]]:
    plant = RunningBottling(START_NS, 1, production_s=75.0)
    taken = []
    for second in range(34, 110):
        _, pixels = photo_at(plant, second)
        taken.append((second, pixels, plant.scene()))
    return taken


def test_the_time_of_a_photo_stands_in_it() -> None:
    plant = RunningBottling(START_NS, 1)
    plant.advance(START_NS + 1_234_567_891)
    photo = plant.expose()()
    assert photo.time_ns == START_NS + 1_234_567_891
    assert taken_ns(photo.content) == photo.time_ns
    assert plant.expose()().content == photo.content


def test_a_photo_developed_late_shows_what_was_exposed() -> None:
    plant = RunningBottling(START_NS, 1)
    plant.advance(START_NS + 40 * NS_PER_S)
    develop = plant.expose()
    at_once = develop().content
    plant.advance(START_NS + 60 * NS_PER_S)
    assert develop().content == at_once


def test_the_belts_marks_move_when_it_runs_and_only_then(photos: list) -> None:
    moved = stood = 0
    for (_, before, earlier), (_, after, later) in pairwise(photos):
        changed = difference(before, after, BELT_RECTANGLE) > GRAIN
        assert changed == (later.travel_m - earlier.travel_m > 0.05)
        moved += changed
        stood += not changed
    assert moved > 20
    assert stood > 10


def test_bottles_and_lamp_are_where_the_machine_has_them(photos: list) -> None:
    seen = 0
    for _, pixels, scene in photos:
        places_m = [each.position_m for each in scene.bottles]
        if any(0.93 < at < 1.15 for at in places_m):
            assert _within(pixels, BEHIND_STATION_2).std() > 18
            seen += 1
        elif not any(0.87 < at < 1.22 for at in places_m):
            assert _within(pixels, BEHIND_STATION_2).std() < 12
        assert (_within(pixels, GREEN_LAMP_RECTANGLE)[6:-6, 6:-6, 1].mean() > 140) == scene.green
    assert seen > 5


def test_the_light_drifts_and_photos_have_grain() -> None:
    plant = RunningBottling(START_NS, 1)
    corner = (4, 4, 40, 40)
    _, first = photo_at(plant, 10)
    _, soon = photo_at(plant, 11)
    _, late = photo_at(plant, 310)
    assert 3 < difference(first, soon, corner) < GRAIN
    assert abs(float(first[4:44, 4:44].mean() - late[4:44, 4:44].mean())) > 8


def _within(pixels: np.ndarray, rectangle: Rectangle) -> np.ndarray:
    x, y, width, height = rectangle
    return pixels[y : y + height, x : x + width]
