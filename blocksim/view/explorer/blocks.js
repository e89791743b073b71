"use strict";
/* Limit analysis of convex blocks in the plane: where they touch, whether forces of equilibrium exist
   and how large a load may be. blocksim/blocks/touching.py and blocksim/limit/programme.py in
   JavaScript, held to them by the tests. Corners are counter-clockwise. */

const blockwork = (() => {
  const TOUCHING = 1e-6; // gap that counts as none, over half the larger side of the smaller block
  const SHORT = 100; // gaps that a joint is longer than
  const MOVES = 1e-4; // of the fastest motion: slower ends of a joint stay

  const minus = ([a, b], [c, d]) => [a - c, b - d];
  const dot = ([a, b], [c, d]) => a * c + b * d;
  const cross = ([a, b], [c, d]) => a * d - b * c;
  const sidesOf = (corners) => corners.map((start, i) => [start, corners[(i + 1) % corners.length]]);

  /** Area, and its centre. */
  function measure(corners) {
    let [area, x, y] = [0, 0, 0];
    for (const [start, end] of sidesOf(corners.map((corner) => minus(corner, corners[0])))) {
      const part = cross(start, end) / 2;
      area += part;
      x += (part * (start[0] + end[0])) / 3;
      y += (part * (start[1] + end[1])) / 3;
    }
    return { area, centre: [corners[0][0] + x / area, corners[0][1] + y / area] };
  }

  const isConvex = (corners) =>
    sidesOf(corners).every(([start, end], i) => cross(minus(end, start), minus(corners[(i + 2) % corners.length], end)) > 0);

  const across = (corners) => [0, 1].map((i) => corners.map((corner) => corner[i]))
    .map((values) => [Math.min(...values), Math.max(...values)]);

  /** How deep two convex blocks lie in each other; below 0 how far they are apart at least. */
  function depth(one, other) {
    let least = Infinity;
    for (const [mine, theirs] of [[one, other], [other, one]]) {
      for (const [start, end] of sidesOf(mine)) {
        const way = minus(end, start);
        const inside = Math.max(...theirs.map((corner) => cross(way, minus(corner, start)))) / Math.hypot(...way);
        least = Math.min(least, inside);
      }
    }
    return least;
  }

  /** Where faces lie on each other, and where corners rest on a face; normals lead from `a` into `b`. */
  function joints(blocks) {
    const boxes = blocks.map(({ corners }) => across(corners));
    const slack = blocks.map(({ fixed }, i) => fixed ? Infinity : (TOUCHING / 2) * Math.max(...boxes[i].map(([low, high]) => high - low)));
    const found = [];
    const overlaps = [];
    for (let a = 0; a < blocks.length; a++) {
      for (let b = a + 1; b < blocks.length; b++) {
        const close = Math.min(slack[a], slack[b]);
        const apart = boxes[a].some(([low, high], i) => low > boxes[b][i][1] + close || high < boxes[b][i][0] - close);
        if (apart || close === Infinity) continue;
        const [one, other] = [blocks[a].corners, blocks[b].corners];
        if (depth(one, other) > close) overlaps.push([a, b]);
        const faces = stretches(one, other, close);
        found.push(...faces.map((joint) => ({ a, b, ...joint })));
        const off = (corner) => faces.every(({ ends: [start, end] }) => {
          const way = minus(end, start);
          const share = Math.min(1, Math.max(0, dot(minus(corner, start), way) / dot(way, way)));
          return Math.hypot(...minus(corner, [start[0] + share * way[0], start[1] + share * way[1]])) > 2 * close;
        });
        const taken = [];
        for (const [sign, mine, theirs] of [[1, one, other], [-1, other, one]]) {
          for (const corner of theirs) {
            const face = sidesOf(mine).find(([start, end]) => {
              const [way, arm] = [minus(end, start), minus(corner, start)];
              const [length, at] = [Math.hypot(...way), dot(arm, way) / Math.hypot(...way)];
              return at > close && at < length - close && Math.abs(cross(way, arm)) / length <= close;
            });
            if (!face || !off(corner) || taken.some((other) => Math.hypot(...minus(corner, other)) <= 2 * close)) continue;
            taken.push(corner);
            const way = minus(face[1], face[0]);
            const length = Math.hypot(...way) * sign;
            found.push({ a, b, ends: [corner, corner], normal: [way[1] / length, -way[0] / length] });
          }
        }
      }
    }
    return { found, overlaps };
  }

  /** Faces of two blocks that lie on each other. */
  function stretches(one, other, close) {
    const found = [];
    for (const [start, end] of sidesOf(one)) {
      const length = Math.hypot(...minus(end, start));
      const way = minus(end, start).map((value) => value / length);
      for (const [from, to] of sidesOf(other)) {
        if (dot(way, minus(to, from)) >= 0) continue;
        const [low, high] = [Math.max(0, dot(way, minus(to, start))), Math.min(length, dot(way, minus(from, start)))];
        if (high - low <= SHORT * close) continue;
        const [near, far] = [cross(way, minus(to, start)), cross(way, minus(from, start))];
        const [b0, b1] = [dot(way, minus(to, start)), dot(way, minus(from, start))];
        const gap = (at) => Math.abs(near + ((far - near) * (at - b0)) / (b1 - b0));
        if (Math.max(gap(low), gap(high)) > close) continue;
        const at = (share) => [start[0] + share * way[0], start[1] + share * way[1]];
        found.push({ ends: [at(low), at(high)], normal: [way[1], -way[0]] });
      }
    }
    return found;
  }

  /** Equations of equilibrium: what the edges of the friction cones at all ends of joints do to the
      blocks that move, in mean weights and in sizes. Unbounded friction leaves a tangent of any sign. */
  function equations(blocks, touching, mu) {
    const moving = blocks.map((block, i) => ({ ...block, i, ...measure(block.corners) })).filter(({ fixed }) => !fixed);
    const row = new Map(moving.map(({ i }, at) => [i, 3 * at]));
    const unit = moving.reduce((sum, { area }) => sum + area, 0) / moving.length;
    const box = across(moving.flatMap(({ corners }) => corners));
    const size = Math.max(...box.map(([low, high]) => high - low)) / 2;
    const act = (i, point, [x, y]) => {
      if (!row.has(i)) return [];
      const [at, arm] = [row.get(i), minus(point, moving[row.get(i) / 3].centre)];
      return [[at, x], [at + 1, y], [at + 2, cross(arm, [x, y]) / size]];
    };
    const columns = [];
    const parts = []; // joint, end and force of each column
    touching.forEach(({ a, b, ends, normal: [x, y] }, joint) => {
      const steep = mu === Infinity ? 1 : 1 / Math.max(1, mu);
      const along = mu === Infinity ? [[0, 1], [0, -1]] : [mu, -mu].slice(0, mu ? 2 : 1).map((slope) => [steep, slope * steep]);
      if (mu === Infinity) along.push([1, 0]);
      (ends[0] === ends[1] ? [0] : [0, 1]).forEach((end) => {
        for (const [n, t] of along) {
          const force = [n * x - t * y, n * y + t * x];
          columns.push([...act(b, ends[end], force), ...act(a, ends[end], force.map((value) => -value))]);
          parts.push({ joint, end, force, presses: n > 0 });
        }
      });
    });
    return { moving, row, unit, size, act, columns, parts };
  }

  /** What weights, under gravity that leans by `tilt`, and a load do; the load is in weights of all. */
  function pull({ moving, unit, act, row }, load, tilt) {
    const down = [Math.sin(tilt), -Math.cos(tilt)];
    const found = new Float64Array(3 * moving.length);
    moving.forEach(({ area }, at) => down.forEach((way, i) => { found[3 * at + i] += (area / unit) * way; }));
    const size = load ? load.share * moving.length : 0;
    if (size && row.has(load.block)) for (const [i, value] of act(load.block, load.point, down)) found[i] += value * size;
    return found;
  }

  const negative = (values) => Float64Array.from(values, (value) => -value);

  /** Rates of the blocks, (x, y, turn) each in metres and radians, the fastest corner moving by 1. */
  function ratesOf({ moving, size }, prices) {
    const rates = moving.map((block, at) => [-prices[3 * at], -prices[3 * at + 1], -prices[3 * at + 2] / size]);
    const speeds = moving.flatMap(({ corners, centre }, at) =>
      corners.map((corner) => Math.hypot(...velocity(rates[at], minus(corner, centre)))));
    const fastest = Math.max(...speeds);
    return rates.map((rate) => rate.map((value) => value / (fastest || 1)));
  }
  const velocity = ([x, y, turn], [a, b]) => [x - turn * b, y + turn * a];

  /** Resultants at joints: force on `b`, and where it acts. */
  function resultants({ parts }, touching, x) {
    const found = touching.map(() => ({ force: [0, 0], presses: [0, 0] }));
    parts.forEach(({ joint, end, force, presses }, j) => {
      force.forEach((value, i) => { found[joint].force[i] += value * x[j]; });
      if (presses) found[joint].presses[end] += dot(force, touching[joint].normal) * x[j];
    });
    return found.map(({ force, presses: [first, last] }, i) => {
      const [start, end] = touching[i].ends;
      const share = first + last > 0 ? last / (first + last) : 0.5;
      return { force, at: [start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])] };
    });
  }

  /** Forces as far inside their cones as can be. `margin`: the least part along any edge of a cone, at
      most 1 mean weight, below 0 where contacts would have to pull; null where not even that would do. */
  function equilibrium(given, touching, load, tilt) {
    const { columns, parts } = given;
    const all = new Float64Array(3 * given.moving.length);
    columns.forEach((column, j) => { if (parts[j].presses) for (const [i, value] of column) all[i] += value; });
    const short = [...all].map((value, i) => [i, -value]).filter(([, value]) => value);
    const cost = [...columns.map(() => 0), 1];
    // All parts have 1 less `short` in common.
    const right = pull(given, load, tilt).map((value, i) => -value - all[i]);
    const { ends, x, y } = programme.solve(cost, [...columns, short], right);
    const margin = ends === "best" ? 1 - x.at(-1) : ends === "impossible" ? null : NaN;
    const forces = resultants(given, touching, columns.map((_, j) => x[j] + (parts[j].presses ? margin : 0)));
    return { margin, forces, rates: ratesOf(given, y) };
  }

  /** Largest factor on a column of live loads beside what acts always: Infinity where none is too
      much, null where it falls at any, NaN where rounding hides it. */
  function most(given, touching, dead, live) {
    const column = [...live].map((value, i) => [i, value]).filter(([, value]) => value);
    const { ends, x, y } = programme.solve([...given.columns.map(() => 0), -1], [...given.columns, column], negative(dead));
    const factor = { best: x.at(-1), impossible: null, endless: Infinity, open: NaN }[ends];
    return { factor, forces: resultants(given, touching, x), rates: ratesOf(given, y) };
  }

  /** Blocks that nothing holds: joined to no fixed one, directly or by others. */
  function loose(blocks, touching) {
    const held = new Set(blocks.flatMap(({ fixed }, i) => (fixed ? [i] : [])));
    for (let before = -1; before < held.size;) {
      before = held.size;
      for (const { a, b } of touching) if (held.has(a) || held.has(b)) held.add(a).add(b);
    }
    return blocks.flatMap((_, i) => (held.has(i) ? [] : [i]));
  }

  /** All that is known of blocks: joints, overlaps, what nothing holds, whether they can rest, how large the load may be, in
      weights of all blocks, and how far they may be tilted to either side [rad]. */
  function analyse({ blocks, mu, load, tilt }) {
    const { found, overlaps } = joints(blocks);
    const free = loose(blocks, found);
    if (overlaps.length || free.length || blocks.every(({ fixed }) => fixed)) return { joints: found, overlaps, loose: free };
    const given = equations(blocks, found, mu);
    const rest = equilibrium(given, found, load, tilt);
    const dead = pull(given, null, tilt);
    const unit = load && pull(given, { ...load, share: 1 }, tilt).map((value, i) => value - dead[i]);
    const level = pull(given, load, 0);
    const aside = pull(given, load, Math.PI / 2);
    const tilts = [aside, negative(aside)].map((live) => most(given, found, level, live));
    return { joints: found, overlaps, loose: free, given, rest, bears: unit && most(given, found, dead, unit), tilts };
  }

  /** What joints do as blocks begin to move: hinges with the end that stays closed, and slides. */
  function moves({ row, moving }, touching, rates) {
    const at = (i, point) => row.has(i) ? velocity(rates[row.get(i) / 3], minus(point, moving[row.get(i) / 3].centre)) : [0, 0];
    return touching.map(({ a, b, ends, normal }) => {
      const apart = ends.map((end) => minus(at(b, end), at(a, end)));
      const opens = apart.map((way) => dot(way, normal) > MOVES);
      const slides = Math.max(...apart.map((way) => Math.abs(cross(normal, way)))) > MOVES && !(opens[0] && opens[1]);
      const hinge = opens[0] === opens[1] ? null : ends[opens[0] ? 1 : 0];
      return { slides: slides && !hinge, hinge, opens: opens[0] && opens[1] };
    });
  }

  return { analyse, joints, equations, equilibrium, measure, isConvex, across, moves };
})();
