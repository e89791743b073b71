"use strict";
/* Limit analysis of n voussoirs under fill and a load, by two linear programmes in the resultant at the
   crown; blocksim/limit/ in JavaScript, held to it by the tests. Lengths are over r, forces over the weight
   of all voussoirs. Fill weighs as much as voussoirs and goes straight down, as the load does. */

const loaded = (() => {
  const AT_JOINT = 1e-12; // from a joint: a load here is shared by halves
  const MOVES = 1e-4; // of the fastest corner: slower motion of a joint is none
  const UPRIGHT = Math.PI / 2;

  const anglesOf = (halfAngle, voussoirs) =>
    Array.from({ length: voussoirs + 1 }, (_, i) => halfAngle * ((2 * i) / voussoirs - 1));

  /** Half the width of what is seen of the extrados from above. */
  const widthOf = ({ halfAngle, eta }, voussoirs) =>
    (1 + eta / 2) * Math.max(...anglesOf(halfAngle, voussoirs).map(Math.sin));

  /** Weight of each voussoir and of the fill on it, and its moment about the crown's vertical. */
  function weights({ halfAngle, eta, weight, fill }, angles) {
    const [outer, level, whole] = [1 + eta / 2, theory.levelOf(eta, weight), 2 * halfAngle * eta];
    const road = outer + fill;
    const soil = (a) => outer * (road * Math.sin(a) - outer * (a / 2 + Math.sin(2 * a) / 4));
    const turn = (a) => outer ** 2 * ((road * Math.sin(a) ** 2) / 2 + (outer * Math.cos(a) ** 3) / 3);
    return angles.slice(1).map((to, i) => {
      const from = angles[i];
      const own = [eta * (to - from), eta * level * (Math.cos(from) - Math.cos(to))];
      const above = fill ? [soil(to) - soil(from), turn(to) - turn(from)] : [0, 0];
      return own.map((value, k) => (value + above[k]) / whole);
    });
  }

  /** Shares of a load at x on the voussoirs that lie uppermost there. */
  function shares(angles, outer, x) {
    const places = angles.map((angle) => outer * Math.sin(angle));
    return places.slice(1).map((to, i) => {
      const from = places[i];
      if (to <= from || x < from - AT_JOINT || x > to + AT_JOINT) return 0;
      return Math.min(x - from, to - x) <= AT_JOINT ? 0.5 : 1;
    });
  }

  /** What joints can carry, as rows a y <= room: y is the thrust, shear and moment at the crown and the load. */
  function rows(state, voussoirs) {
    const { halfAngle, eta, mu, load } = state;
    const angles = anglesOf(halfAngle, voussoirs);
    const dead = weights(state, angles);
    const place = load ? load.place * widthOf(state, voussoirs) : 0;
    const live = shares(angles, 1 + eta / 2, place);
    const middle = voussoirs >> 1;
    const half = dead.reduce((sum, [size]) => sum + size, 0) / 2;
    const before = dead.slice(0, middle).reduce((sum, [, turn]) => sum + turn, 0);
    const found = [];
    let [gone, turned, borne, tipped] = [0, 0, 0, 0]; // weights left of a joint, their moments, and of the load
    angles.forEach((angle, joint) => {
      const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
      const left = half - gone;
      // Each is [thrust, shear, moment, load, what is there without them].
      const normal = [cosine, -sine, 0, borne * sine, -left * sine];
      const shear = [sine, cosine, 0, -borne * cosine, left * cosine];
      const off = [2 * Math.sin(angle / 2) ** 2, sine, eta / 2, tipped - borne * sine, turned - before + left * sine]
        .map((value) => (2 * value) / eta); // from the centreline, in half thicknesses, times the force
      const put = (one, sign, share, kind) => {
        const steep = 1 / Math.max(1, share);
        const row = one.map((value, i) => steep * (sign * value - share * normal[i]));
        found.push({ joint, angle, kind, steep, a: row.slice(0, 4), room: -row[4] });
      };
      put(off, 1, 1, "extrados");
      put(off, -1, 1, "intrados");
      if (mu < Infinity) {
        put(shear, 1, mu, "in");
        put(shear, -1, mu, "out");
      }
      if (joint === voussoirs) return;
      gone += dead[joint][0];
      turned += dead[joint][1];
      borne += live[joint];
      tipped += live[joint] * place;
    });
    return { found, angles, place };
  }

  const sparse = (values) => values.map((value, i) => [i, value]).filter(([, value]) => value);

  /** How the piece right of a joint moves against the one left of it, (x, y, turn about the centre). */
  function opening({ kind, angle, steep }, eta, mu, rate) {
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    if (kind === "extrados" || kind === "intrados") {
      const [sign, radius] = kind === "extrados" ? [1, 1 + eta / 2] : [-1, 1 - eta / 2];
      return [radius * cosine, -radius * sine, 1].map((value) => (sign * rate * 2 * value) / eta);
    }
    const sign = kind === "in" ? 1 : -1;
    return [mu * cosine - sign * sine, -mu * sine - sign * cosine, 0].map((value) => steep * rate * value);
  }

  /** Motions of voussoirs from the rates of rows, the fastest corner moving by 1, and what joints do. */
  function motionOf({ found, angles }, { eta, mu }, rates) {
    const joints = angles.map(() => [0, 0, 0]);
    const parts = found.map((row, j) => opening(row, eta, mu, rates[j]));
    found.forEach(({ joint }, j) => parts[j].forEach((value, k) => { joints[joint][k] += value; }));
    let motion = [0, 0, 0];
    const motions = joints.slice(0, -1).map((joint) => (motion = motion.map((value, k) => value + joint[k])));
    const speed = ([x, y, turn], angle) => Math.max(...[1 - eta / 2, 1 + eta / 2].map((radius) =>
      Math.hypot(x - turn * radius * Math.cos(angle), y + turn * radius * Math.sin(angle))));
    const fastest = motions.reduce((most, each, i) => Math.max(most, speed(each, angles[i]), speed(each, angles[i + 1])), 0);
    const acting = found.filter(({ angle }, j) => speed(parts[j], angle) > MOVES * fastest);
    return {
      motions: motions.map((each) => each.map((value) => value / fastest)),
      joints: acting.map(({ joint, angle, kind }) => ({ joint, angle, kind })),
    };
  }

  /** How far forces keep within all rows, whose last unknown that is. */
  function within(columns, costs) {
    const [[last]] = columns.at(-1);
    const { ends, x, y } = programme.solve(costs, columns, [...Array(last).fill(0), 1]);
    return { margin: ends === "best" ? y.at(-1) : NaN, x, y };
  }

  /** Forces as far within all that joints can carry as can be; `margin` is how far, at most 1 weight. */
  function equilibrium(given, state) {
    const { found, angles } = given;
    const share = state.load?.share ?? 0;
    const columns = found.map(({ a }) => sparse([...a.slice(0, 3), 1]));
    const { margin, x, y } = within([...columns, [[3, 1]]], [...found.map(({ a, room }) => room - share * a[3]), 1]);
    // Where the joints turn, from the sum and the difference of two rows of each.
    const line = angles.flatMap((angle, joint) => {
      const first = joint * (found.length / angles.length);
      const [outer, inner] = found.slice(first, first + 2).map(({ a, room }) =>
        a.slice(0, 3).reduce((sum, value, i) => sum + value * y[i], share * a[3] - room));
      const [off, normal] = [(outer - inner) / 2, -(outer + inner) / 2];
      return normal > AT_JOINT ? [{ angle, radius: 1 + (state.eta / 2) * (off / normal) }] : [];
    });
    return { margin, line, ...motionOf(given, state, x) };
  }

  /** The largest load here: null where none lets it stand, Infinity where none is too much, NaN where rounding hides it. */
  function most(given, state) {
    const { found } = given;
    const columns = [...found.map(({ a }) => sparse(a)), [[3, -1]]];
    const costs = [...found.map(({ room }) => room), 0];
    const { ends, x, y } = programme.solve(costs, columns, [0, 0, 0, 1]);
    if (ends === "best") return { factor: y[3], ...motionOf(given, state, x) };
    // Nothing would be largest, too, where it falls under any load.
    const { margin } = within([...columns.slice(0, -1).map((column) => [...column, [4, 1]]), columns.at(-1), [[4, 1]]], [...costs, 1]);
    return { factor: margin < 0 ? null : margin > 0 && ends === "impossible" ? Infinity : NaN };
  }

  /** Whether it stands with its fill and load, the largest load at that place, and how it falls: under that,
      or else as it is. */
  function analyse(state, voussoirs) {
    const given = rows(state, voussoirs);
    const rest = equilibrium(given, state);
    const bears = state.load ? most(given, state) : null;
    const falls = bears?.motions ? bears : rest.margin > 0 ? { motions: [], joints: [] } : rest;
    return { rest, bears, falls, place: given.place, angles: given.angles };
  }

  return { analyse, widthOf, takesFill: (halfAngle) => halfAngle <= UPRIGHT };
})();
