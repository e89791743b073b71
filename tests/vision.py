"""Colours as the colour-blind and a grey printer show them, and how far apart they look."""

from itertools import combinations
from typing import Any

import numpy as np

LINEAR_TO_XYZ = np.array(
    [
        [0.4123908, 0.3575843, 0.1804808],
        [0.2126390, 0.7151687, 0.0721923],
        [0.0193308, 0.1191948, 0.9505322],
    ]
)
WHITE = LINEAR_TO_XYZ.sum(axis=1)
GREY = np.tile(LINEAR_TO_XYZ[1], (3, 1))
SEEN = {
    "everybody": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
    "grey": GREY,
}
"""On linear RGB: Machado, Oliveira and Fernandes (2009), severity 1; luminance for grey."""


def linear(colours: list[str]) -> np.ndarray:
    """#rrggbb as linear RGB, (k, 3)."""
    values = [[int(each[i : i + 2], 16) / 255 for i in (1, 3, 5)] for each in colours]
    coded = np.array(values)
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIELAB under D65 of linear RGB, (k, 3)."""
    ratio = np.clip(rgb, 0, 1) @ LINEAR_TO_XYZ.T / WHITE
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = f.T
    return np.column_stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def difference(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """CIEDE2000 of CIELAB colours, as Sharma, Wu and Dalal (2005) write it."""
    (l1, a1, b1), (l2, a2, b2) = one.T, two.T
    mean = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    stretch = 1 + (1 - np.sqrt(mean**7 / (mean**7 + 25.0**7))) / 2
    a1, a2 = stretch * a1, stretch * a2
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = (np.degrees(np.arctan2(b, a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    grey = c1 * c2 == 0
    turn = np.where(grey, 0, (h2 - h1 + 180) % 360 - 180)
    dl, dc = l2 - l1, c2 - c1
    dh = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2)
    light, chroma = (l1 + l2) / 2, (c1 + c2) / 2
    hue = np.where(grey, h1 + h2, (h1 + turn / 2) % 360)
    t = (
        1
        - 0.17 * np.cos(np.radians(hue - 30))
        + 0.24 * np.cos(np.radians(2 * hue))
        + 0.32 * np.cos(np.radians(3 * hue + 6))
        - 0.20 * np.cos(np.radians(4 * hue - 63))
    )
    sl = 1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2)
    sc, sh = 1 + 0.045 * chroma, 1 + 0.015 * chroma * t
    turned = 60 * np.exp(-(((hue - 275) / 25) ** 2))
    rt = -np.sin(np.radians(turned)) * 2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7))
    return np.sqrt(
        (dl / sl) ** 2 + (dc / sc) ** 2 + (dh / sh) ** 2 + rt * (dc / sc) * (dh / sh)
    )


def nearest(colours: list[str], seen: str) -> tuple[float, str, str]:
    """Which two of these colours look most alike, and how far they are apart."""
    found = lab(linear(colours) @ SEEN[seen].T)
    pairs = list(combinations(range(len(colours)), 2))
    one, two = np.array(pairs).T
    apart = difference(found[one], found[two])
    least = int(apart.argmin())
    return float(apart[least]), colours[one[least]], colours[two[least]]


def shown(page: Any, tone: str) -> list[int]:
    """Red, green and blue of any colour that a style sheet may have, as a browser paints it."""
    return page.evaluate(
        """(colour) => {
          const pad = document.createElement("canvas").getContext("2d");
          pad.fillStyle = colour;
          pad.fillRect(0, 0, 1, 1);
          return [...pad.getImageData(0, 0, 1, 1).data].slice(0, 3); }""",
        tone,
    )


def shown_contrast(page: Any, ink: str, ground: str) -> float:
    """Contrast of two colours of a page."""
    return contrast(*("#" + bytes(shown(page, tone)).hex() for tone in (ink, ground)))


def contrast(one: str, two: str) -> float:
    """WCAG 2 contrast ratio of two colours."""
    dark, bright = sorted(linear([one, two]) @ LINEAR_TO_XYZ[1])
    return float((bright + 0.05) / (dark + 0.05))
