"""Rows of a validation as made up for tests of the report, in no time; a page read again."""

import math
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
from recorded import recorded

from blocksim import Arch, CircularArch, Mode, Recording, Verdict
from blocksim.studies.agreement import Row

ARCH = Arch(half_angle=math.pi / 2, eta=0.105, voussoirs=8)


def sliding() -> Recording:
    """The right half slides down at the crown, by 0.02 r in the end."""
    moved = np.zeros((11, 8, 3))
    moved[:, 4:, 1] = -0.02 * np.linspace(0, 1, 11)[:, None] ** 2
    return recorded(CircularArch.of(ARCH, 0.7).problem(), moved, np.linspace(0, 2, 11))


ROW = Row(
    structure="semicircle",
    method="pymunk",
    question="thickness",
    half_angle=math.pi / 2,
    mu=0.7,
    blocks=8,
    weight="centreline",
    modes_published=(Mode.RRR,),
    published="0.107426",
    expected=0.106,
    mode_limit=Mode.RRR,
    low=0.1059,
    high=0.1060,
    error=-0.0005,
    mode=Mode.RRR,
    at_low=Verdict.COLLAPSES,
    at_high=Verdict.STANDS,
    wall_s=2.5,
    title="The semicircular arch",
    source="A source",
    recording=sliding(),
)


def rows() -> list[Row]:
    """Two arches by two engines: all kinds of values that a row can have."""
    hostile = replace(
        ROW,
        structure="second<script>alert(1)</script>",
        title='<img src=x onerror="alert(1)"> & co',
        source='"><b>bold</b>',
        mu=math.inf,
    )
    return [
        ROW,
        replace(ROW, method="pybullet", error=0.004, miss="error +0.40 %", note="slack"),
        replace(
            hostile,
            expected=None,
            published="",
            low=2.0,
            high=None,
            error=None,
            mode=Mode.SS,
            at_high=None,
        ),
        replace(
            hostile,
            method="pybullet",
            low=None,
            high=None,
            error=None,
            mode=None,
            mode_limit=None,
            at_low=None,
            at_high=None,
            recording=None,
            miss="no bracket; nothing tried 1 % below",
        ),
    ]


class Page(HTMLParser):
    """Elements with their attributes, and the words in between."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if not {"script", "style"} & set(self.open):
            self.words.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]
