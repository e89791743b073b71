"""Loads on what lies uppermost: at a place, along a width, or spread by fill on their way."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blocksim.blocks.assembly import Array
from blocksim.blocks.dispersal import Dispersal

Share = tuple[int, float, Array]
"""Body, share of the load, and the point at which that acts [m]."""
LEVEL = 1e-9
"""Difference in height that counts as none, over the width of all bodies."""
LEAST = 1e-12
"""Share of a load that is none; height below the road that counts as so much [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Profile:
    """What lies uppermost, seen from above: straight pieces from left to right.

    `ends`, (pieces, 2, 2): Left and right end of each [m]. Where there is no body there is no
        piece.
    `body`, (pieces,).
    `chain`, (links + 1, 2): From left to right along pieces and the steps between them [m].
    `owner`, (links,): Whose each link of the chain is; -1 of a gap.
    """

    ends: Array
    body: NDArray[np.int64]
    chain: Array
    owner: NDArray[np.int64]

    @classmethod
    def of(cls, bodies: Sequence[Sequence[Array]]) -> Profile:
        """Find the profile of bodies that do not overlap.

        `bodies`, sequence of sequences of (k, 2): Convex polygons of each body [m].
        """
        starts: list[Array] = []
        owners: list[int] = []
        for index, body in enumerate(bodies):
            for polygon in body:
                edges = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
                starts.append(edges)
                owners += [index] * len(edges)
        sides, of_side = np.concatenate(starts), np.array(owners)
        across = sides[:, 0, 0] != sides[:, 1, 0]
        edges, of_edge = sides[across], of_side[across]
        backward = edges[:, 0, 0] > edges[:, 1, 0]
        edges[backward] = edges[backward][:, ::-1]
        slope = (edges[:, 1, 1] - edges[:, 0, 1]) / (edges[:, 1, 0] - edges[:, 0, 0])
        pieces: list[tuple[int, float, float]] = []
        # Between corners what lies uppermost stays the same, and its top is straight.
        for left, right in itertools.pairwise(np.unique(edges[:, :, 0]).tolist()):
            over = np.flatnonzero((edges[:, 0, 0] <= left) & (edges[:, 1, 0] >= right))
            if not over.size:
                continue
            middle = (left + right) / 2
            height = edges[over, 0, 1] + slope[over] * (middle - edges[over, 0, 0])
            top = int(over[height.argmax()])
            if pieces and pieces[-1][0] == top and pieces[-1][2] == left:
                pieces[-1] = (top, pieces[-1][1], right)
            else:
                pieces.append((top, left, right))
        edge = np.array([each for each, _, _ in pieces])
        x = np.array([each[1:] for each in pieces])
        y = edges[edge, :1, 1] + slope[edge, None] * (x - edges[edge, :1, 0])
        ends, body = np.stack([x, y], axis=-1), of_edge[edge]
        chain, owner = [*ends[0]], [int(body[0])]
        for piece in range(1, len(ends)):
            for height, behind in _step(ends[piece - 1 : piece + 1], sides, of_side):
                chain.append(np.array([ends[piece, 0, 0], height]))
                owner.append(behind)
            chain.append(ends[piece, 1])
            owner.append(int(body[piece]))
        return cls(ends=ends, body=body, chain=np.array(chain), owner=np.array(owner))

    def height(self, piece: int, x: float) -> float:
        """Height of a piece at a place [m]."""
        (x0, y0), (x1, y1) = self.ends[piece].tolist()
        return y0 + (y1 - y0) * (x - x0) / (x1 - x0)

    def along(self, low: float, high: float) -> list[Share] | None:
        """Find what bears a load that is spread evenly from one x to another [m].

        None where somewhere along the width there is no body.
        """
        found: list[Share] = []
        reached = low
        for piece, ((left, _), (right, _)) in enumerate(self.ends.tolist()):
            start, end = max(left, low), min(right, high)
            if start < end:
                if start > reached:
                    return None
                middle, share = (start + end) / 2, (end - start) / (high - low)
                point = np.array([middle, self.height(piece, middle)])
                found.append((int(self.body[piece]), share, point))
                reached = end
        return found if reached == high else None

    def at(self, x: float) -> list[Share] | None:
        """Find what bears a load at a place [m].

        Where a body and others behind it are as high, as at a joint, they share it evenly.
        None where there is no body.
        """
        over = np.flatnonzero((self.ends[:, 0, 0] <= x) & (self.ends[:, 1, 0] >= x)).tolist()
        if not over:
            return None
        tops = {int(self.body[piece]): self.height(piece, x) for piece in over}
        wide = float(self.ends[-1, 1, 0] - self.ends[0, 0, 0])
        least = max(tops.values()) - LEVEL * wide
        highest = [body for body, top in tops.items() if top >= least]
        return [(body, 1 / len(highest), np.array([x, tops[body]])) for body in highest]

    def enters(self, dispersal: Dispersal) -> Array:
        """Return where on the road the outermost rays of a load meet corners [m]."""
        x, y = self.chain.T
        aside = dispersal.slope * np.maximum(dispersal.road - y, LEAST)
        # A load above a step, or a gap, meets it on one side and not on the other.
        before, after = self.ends[:-1, 1], self.ends[1:, 0]
        apart = np.hypot(*(after - before).T) > LEVEL * (x[-1] - x[0])
        beside = np.concatenate([x[[0, -1]], before[apart, 0], after[apart, 0]])
        return np.unique(np.concatenate([x - aside, x + aside, beside]))

    def spread(self, places: Array, dispersal: Dispersal) -> tuple[Array, Array]:
        """Find what each link of the chain bears of loads on the road, which fill spreads.

        Each part of a load goes straight along its own ray, to what lies uppermost there, and
        presses downwards on it.

        `places`, (k,): On the road [m].
        Returns `share`, (k, links).
        Returns `point`, (k, links, 2): [m]; of no meaning where the share is 0.
        """
        chain, most = self.chain, dispersal.slope
        depth = dispersal.road - chain[:, 1]
        seen = (chain[:, 0] - places[:, None]) / np.maximum(depth, LEAST)
        # What lies behind something nearer is hidden: rays go on only past what they missed.
        right = np.maximum.accumulate(seen.clip(0.0, most), axis=1)
        left = np.minimum.accumulate(seen.clip(-most, 0.0)[:, ::-1], axis=1)[:, ::-1]
        slopes = left + right
        met = (np.diff(slopes) > LEAST * most) & (self.owner >= 0)
        rays, weights = dispersal.rays(slopes[:, :-1, None], slopes[:, 1:, None])
        share = np.where(met, weights.sum(axis=-1), 0.0)
        way = np.diff(chain, axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            far = places[:, None, None] + rays * depth[:-1, None] - chain[:-1, :1]
            along = far / (way[:, :1] + rays * way[:, 1:])
            mean = np.where(met, (weights * along).sum(axis=-1) / share, 0.0)
        return share, chain[:-1] + mean[..., None] * way


def _step(
    pieces: Array, sides: Array, owners: NDArray[np.int64]
) -> Iterator[tuple[float, int]]:
    """Find who is behind a step between two pieces, and up or down to which height.

    `pieces`, (2, 2, 2): On the left and on the right of it.
    `sides`, (sides, 2, 2): Of all bodies, which are `owners`.
    """
    here, there = pieces[0, 1], pieces[1, 0]
    level = LEVEL * float(np.ptp(sides[:, :, 0]))
    if there[0] - here[0] > level:
        yield float(there[1]), -1
        return
    rises = there[1] > here[1]
    (low, high) = sorted((float(here[1]), float(there[1])))
    (x0, y0), (x1, y1) = sides.transpose(1, 2, 0)
    heights = np.unique(np.append(sides[:, :, 1].clip(low, high), [low, high]))
    bands = list(itertools.pairwise(heights.tolist()))
    for bottom, top in bands if rises else reversed(bands):
        crossed = np.flatnonzero((np.minimum(y0, y1) <= bottom) & (np.maximum(y0, y1) >= top))
        share = ((bottom + top) / 2 - y0[crossed]) / (y1 - y0)[crossed]
        far = (x0[crossed] + share * (x1 - x0)[crossed] - here[0]) * (1 if rises else -1)
        crossed, far = crossed[far >= -level], far[far >= -level]
        behind = int(owners[crossed[far.argmin()]]) if far.size else -1
        yield (top if rises else bottom), behind
