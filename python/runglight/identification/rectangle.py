"""A rectangle of a recording's photos, `X,Y,WIDTH,HEIGHT` in pixels from the upper left corner."""

from __future__ import annotations

import re
from dataclasses import dataclass

from runglight.errors import InputError

_WRITTEN = re.compile(r"\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*", re.ASCII)


@dataclass(frozen=True, slots=True)
class Rectangle:
    """Pixels from `x` on, `width` of them, and from `y` on, `height` of them."""

    x: int
    y: int
    width: int
    height: int

    @classmethod
    def parse(cls, text: str, where: str = "--propose") -> Rectangle:
        """InputError where the text is no rectangle, or one without pixels."""
        match = _WRITTEN.fullmatch(text)
        if match is None or int(match[3]) == 0 or int(match[4]) == 0:
            raise InputError(
                f"{where}: {text!r} is no rectangle; write X,Y,WIDTH,HEIGHT in pixels from the "
                "upper left corner, such as 640,200,80,60"
            )
        return cls(*map(int, match.groups()))

    def check_within(self, width: int, height: int, photo: str) -> None:
        """InputError where a photo is smaller than the rectangle needs."""
        if self.x + self.width > width or self.y + self.height > height:
            raise InputError(
                f"{photo}: has {width} x {height} pixels, so no rectangle from {self.x},{self.y} "
                f"to {self.x + self.width},{self.y + self.height}; look the numbers up in an "
                "image viewer"
            )
