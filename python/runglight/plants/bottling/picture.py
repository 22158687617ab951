"""A picture of the two stations, the belt and the lamps. Needs Pillow (extra `vision`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PIL import Image, ImageDraw

from runglight.plants.bottling.belt import DIAMETER_M
from runglight.plants.bottling.machine import STATION_1_M, STATION_2_M, STOPS_M

if TYPE_CHECKING:
    from runglight.plants.bottling.scene import BottleSight, Scene

WIDTH, HEIGHT = 640, 360
"""Pixels."""

LEFT_PX = 20
PX_PER_M = 420
BELT_Y = 262
"""Top of the belt; its side, with the marks, is below."""
BELT_SIDE_Y = (272, 292)

LOOP_M = 3.37
MARKS_M = (0.0, 0.11, 0.31, 0.37, 0.64, 0.93, 1.02, 1.33, 1.45, 1.9, 1.97, 2.31, 2.6, 2.66, 3.05)
"""Joints and stains of the belt, unevenly spaced: at no speed do they look as if they stood."""

_BOTTLE_PX = (DIAMETER_M * PX_PER_M * 0.9, 74.0)
_STEEL, _DARK, _GLASS, _DRINK, _CAP = "#8d949b", "#3a3f45", "#cfe3e0", "#4a86b8", "#b8362f"
_LAMPS = {"green": ("#2fd65b", "#1d3a26"), "orange": ("#ffae2b", "#4a3818")}

Rectangle = tuple[int, int, int, int]
"""x, y, width, height, in pixels from the upper left corner."""

BELT_RECTANGLE: Rectangle = (LEFT_PX, BELT_SIDE_Y[0], 600, BELT_SIDE_Y[1] - BELT_SIDE_Y[0])
"""The side of the belt: changes while it runs."""
GREEN_LAMP_RECTANGLE: Rectangle = (600, 30, 24, 28)


def x_of(position_m: float) -> float:
    """Where a place on the belt lies in the picture."""
    return LEFT_PX + position_m * PX_PER_M


BEHIND_STATION_2: Rectangle = (round(x_of(0.91)), BELT_Y - 70, round(0.27 * PX_PER_M), 66)
"""Between station 2 and the end of the picture: every bottle passes here."""


def draw(scene: Scene) -> Image.Image:
    """The picture, with the same light everywhere."""
    image = Image.new("RGB", (WIDTH, HEIGHT), "#b9bcb4")
    pen = ImageDraw.Draw(image)
    pen.rectangle((0, 0, WIDTH, 90), fill="#c8cbc4")
    pen.rectangle((0, 300, WIDTH, HEIGHT), fill="#8a8578")
    _belt(pen, scene)
    _stops(pen, scene)
    for bottle in scene.bottles:
        _bottle(pen, bottle)
    _nozzle(pen, scene)
    _pick_and_place(pen, scene)
    _light(pen, scene)
    return image


def _belt(pen: ImageDraw.ImageDraw, scene: Scene) -> None:
    top, bottom = BELT_SIDE_Y
    pen.rectangle((0, BELT_Y, WIDTH, top), fill="#55595e")
    pen.rectangle((0, top, WIDTH, bottom), fill=_DARK)
    for number, mark_m in enumerate(MARKS_M):
        x = x_of((mark_m + scene.travel_m) % LOOP_M - 0.1)
        shade = ("#d8d2b0", "#9aa0a6", "#c9b458")[number % 3]
        pen.rectangle((x, top + 3, x + 9 + 4 * (number % 2), bottom - 3), fill=shade)


def _stops(pen: ImageDraw.ImageDraw, scene: Scene) -> None:
    for name, at_m in STOPS_M.items():
        x = x_of(at_m + DIAMETER_M / 2)
        reach = 4 if name in scene.open_stops else 16
        pen.rectangle((x, BELT_Y - reach, x + 4, BELT_Y), fill=_STEEL, outline=_DARK)


def _bottle(pen: ImageDraw.ImageDraw, bottle: BottleSight) -> None:
    width, height = _BOTTLE_PX
    x, y = x_of(bottle.position_m), BELT_Y
    left, right = x - width / 2, x + width / 2
    shoulder = y - height * 0.72
    pen.rectangle((left, shoulder, right, y), fill=_GLASS, outline=_DARK)
    pen.rectangle((x - 5, y - height, x + 5, shoulder), fill=_GLASS, outline=_DARK)
    if bottle.filled > 0.02:
        surface = y - 2 - (height * 0.66) * bottle.filled
        pen.rectangle((left + 2, surface, right - 2, y - 2), fill=_DRINK)
    if bottle.capped:
        pen.rectangle((x - 7, y - height - 4, x + 7, y - height + 5), fill=_CAP)


def _nozzle(pen: ImageDraw.ImageDraw, scene: Scene) -> None:
    x = x_of(STATION_1_M)
    tip = BELT_Y - _BOTTLE_PX[1] - 8
    pen.rectangle((x - 26, 60, x + 26, 120), fill=_STEEL, outline=_DARK)
    pen.rectangle((x - 4, 120, x + 4, tip), fill=_STEEL, outline=_DARK)
    if scene.filling:
        pen.rectangle((x - 2, tip, x + 2, BELT_Y - 40), fill=_DRINK)


def _pick_and_place(pen: ImageDraw.ImageDraw, scene: Scene) -> None:
    station, magazine = x_of(STATION_2_M), x_of(STATION_2_M - 0.17)
    pen.rectangle((magazine - 14, 130, magazine + 14, 176), fill="#767b80", outline=_DARK)
    x = magazine + (station - magazine) * scene.arm
    # Over the magazine it is lifted, over the bottle it is down.
    y = 122 + 52 * scene.arm
    pen.line((station, 62, x, y - 8), fill=_DARK, width=7)
    pen.ellipse((station - 9, 53, station + 9, 71), fill=_STEEL, outline=_DARK)
    pen.rectangle((x - 9, y - 10, x + 9, y), fill=_STEEL, outline=_DARK)
    if scene.holds_cap:
        pen.rectangle((x - 7, y, x + 7, y + 9), fill=_CAP)


def _light(pen: ImageDraw.ImageDraw, scene: Scene) -> None:
    x, y, width, height = GREEN_LAMP_RECTANGLE
    pen.rectangle((x + 8, y + 2 * height, x + 16, 130), fill=_DARK)
    for place, (name, shines) in enumerate((("green", scene.green), ("orange", scene.orange))):
        top = y + place * height
        fill = _LAMPS[name][0 if shines else 1]
        pen.rectangle((x, top, x + width, top + height), fill=fill, outline=_DARK)
