"use strict";
/* Limit analysis of n voussoirs as built: blocksim/limit/statics.py in JavaScript, held to it by the
   tests. Two unknowns: 1 - h, here `short`, and the crown moment. No tension and Coulomb friction
   at every joint are half-planes in them; without the moment an interval of `short` remains. */

const built = (() => {
  const ETA_MAX = 2;
  const HOPELESS = 1e6; // times its strength, and an arch still falls
  const NOTHING = 1e-15; // a least thickness that is round-off: any thickness stands
  const MODES = ["rrr", "ss", "srr", "rrs", "rsr", "rs", "r"];
  const FEW = 200; // halvings that reach the last bit of any thickness that matters

  /** Joints of one half from the crown to the springing, with what their resultants are made of. */
  function half(halfAngle, voussoirs) {
    return theory.jointAngles(halfAngle, voussoirs).map((angle) =>
      ({ angle, sine: Math.sin(angle), cosine: Math.cos(angle), ...theory.section(angle) }));
  }

  /** Within the extrados at i and within the intrados at j: rate short + room >= 0. */
  function between(i, j, depth, level) {
    const drop = i.fall - j.fall;
    return {
      rate: (depth / 2) * (i.fall + j.fall - 2) + drop,
      room: (depth / 2) * (2 + i.gain + j.gain) - (i.bend - j.bend) - (level - 1) * drop,
    };
  }

  /** The interval of `short` within strength, and the joints that set its ends; empty where
      `least.short` is above `most.short`. `level`: radius of the weight over the mean radius. */
  function bounds(joints, depth, mu, level, turning = joints) {
    let [least, most] = [{ short: -Infinity }, { short: Infinity }];
    for (const i of turning) {
      for (const j of turning) {
        const { rate, room } = between(i, j, depth, level);
        const end = -room / rate;
        if (rate < 0 && end < most.short) most = { short: end, extrados: i.angle, intrados: j.angle };
        else if (rate > 0 && end > least.short) least = { short: end, extrados: i.angle, intrados: j.angle };
        else if (rate === 0 && room < 0) return { least: { short: Infinity }, most: { short: -Infinity } };
      }
    }
    if (mu === Infinity) return { least, most };
    for (const { angle, sine, cosine, gain, shear } of joints) {
      for (const [sign, slides] of [[1, "out"], [-1, "in"]]) {
        const rate = mu * cosine - sign * sine;
        const end = (mu * (1 + gain) - sign * shear) / rate;
        if (rate > 0 && end < most.short) most = { short: end, angle, slides };
        if (rate < 0 && end > least.short) least = { short: end, angle, slides };
      }
    }
    return { least, most };
  }

  /** Whether the interval is not empty: the same as `bounds`, without looking at all pairs. */
  function stands(joints, depth, mu, level) {
    const slides = bounds(joints, depth, mu, level, []);
    const floor = Math.max(slides.least.short, -HOPELESS);
    let short = Math.min(slides.most.short, HOPELESS);
    // What is between the strictest two half-planes is concave in `short`: from above, where they
    // meet is ever nearer to the end of the interval.
    for (let [round, extrados, intrados] = [0, null, null]; round < FEW && short >= floor; round++) {
      const before = [extrados, intrados];
      let [low, high] = [-Infinity, Infinity];
      for (const joint of joints) {
        const { fall, gain, bend } = joint;
        const middle = (short - (level - 1)) * fall - bend;
        const room = (depth / 2) * (1 + gain + short * (fall - 1));
        if (middle + room < high) [high, extrados] = [middle + room, joint];
        if (middle - room > low) [low, intrados] = [middle - room, joint];
      }
      if (high >= low || (before[0] === extrados && before[1] === intrados)) return true;
      const { rate, room } = between(extrados, intrados, depth, level);
      if (rate >= 0) return false;
      short = -room / rate;
    }
    return false;
  }

  /** Smallest value in (low, high] that will do, to the last bit; `high` does. */
  function smallest(does, low, high) {
    for (let i = 0; i < FEW; i++) {
      const middle = (low + high) / 2;
      if (middle === low || middle === high) break;
      if (does(middle)) high = middle;
      else low = middle;
    }
    return high;
  }

  /** Joints that act at two ends of an interval, from the springing up, as `mechanism` takes them. */
  function activeJoints({ least, most }) {
    const found = new Map();
    const put = (angle, kind) => found.set(`${angle} ${kind}`, { angle, kind });
    for (const end of [most, least]) {
      if (end.slides) put(end.angle, end.slides);
      else if (end.extrados !== undefined) {
        put(end.extrados, "extrados");
        put(end.intrados, "intrados");
      }
    }
    return [...found.values()].sort((a, b) => b.angle - a.angle || a.kind.localeCompare(b.kind));
  }

  const slidesAt = ({ kind }) => kind === "out" || kind === "in";

  /** Mode of active joints, as blocksim/modes.py names it; without joints where it is none of the seven. */
  function named(joints, halfAngle, voussoirs) {
    // An odd number of voussoirs has a keystone: its faces count as the crown.
    const crown = (halfAngle / voussoirs) * (voussoirs % 2 ? 1 + 1e-9 : 1e-9);
    const turnsAtCrown = (joint) => !slidesAt(joint) && joint.angle <= crown;
    const slides = joints.some(slidesAt);
    const parts = !slides && joints.filter(turnsAtCrown).length === 2;
    // Where halves overturn, what turns at the crown is left out of the name.
    const silent = (joint) => turnsAtCrown(joint) && (parts || (slides && joint.kind === "intrados"));
    const letters = joints.filter((joint) => !silent(joint))
      .sort((a, b) => b.angle - a.angle || slidesAt(a) - slidesAt(b))
      .map((joint) => (slidesAt(joint) ? "s" : "r"));
    const mode = letters.join("");
    if (!MODES.includes(mode)) return { mode: null, joints: [] };
    if (!parts) return { mode, joints };
    const { angle } = joints.at(-1);
    return { mode, joints: [...joints.filter((joint) => !turnsAtCrown(joint)), { angle, kind: "parts" }] };
  }

  /** Least thickness of n voussoirs, with its mode, thrust and joints; eta is null where none up to 2
      stands, 0 where any does. */
  function leastThickness(halfAngle, mu, voussoirs, weight = "centreline") {
    const joints = half(halfAngle, voussoirs);
    const does = (eta) => stands(joints, eta, mu, theory.levelOf(eta, weight));
    const eta = !does(ETA_MAX) ? null : does(NOTHING) ? 0 : smallest(does, 0, ETA_MAX);
    const last = eta ?? ETA_MAX;
    const ends = bounds(joints, last, mu, theory.levelOf(last, weight));
    const found = named(eta === 0 ? [] : activeJoints(ends), halfAngle, voussoirs);
    const angleOf = (test) => found.joints.find(test)?.angle ?? null;
    return {
      eta, ...found,
      thrust: eta === null ? null : 1 - ends.most.short,
      betaR: angleOf((joint) => joint.kind === "intrados"),
      betaS: angleOf((joint) => joint.kind === "in"),
    };
  }

  /** Share of thickness and friction that n voussoirs need, both scaled alike, the resultant at
      their crown then, and the joints that act; null where no share will do. */
  function equilibrium(halfAngle, mu, eta, voussoirs, weight = "centreline") {
    const joints = half(halfAngle, voussoirs);
    const level = theory.levelOf(eta, weight);
    const does = (share) => stands(joints, share * eta, share * mu, level);
    let [low, high] = [0, 1];
    while (!does(high)) {
      [low, high] = [high, 2 * high];
      if (high > HOPELESS) return null;
    }
    const share = smallest(does, low, high);
    const ends = bounds(joints, share * eta, share * mu, level);
    const short = (Math.max(ends.least.short, -HOPELESS) + Math.min(ends.most.short, HOPELESS)) / 2;
    // The moment that keeps as far from the one face as from the other.
    let [least, most] = [-Infinity, Infinity];
    for (const { fall, gain, bend } of joints) {
      const force = 1 + gain + short * (fall - 1);
      const moment = short * fall - bend - (level - 1) * fall; // above the thrust, at the centreline
      least = Math.max(least, moment - (share * eta * force) / 2);
      most = Math.min(most, moment + (share * eta * force) / 2);
    }
    const thrust = 1 - short;
    return {
      share, thrust, crownMoment: thrust + (least + most) / 2,
      ...named(activeJoints(ends), halfAngle, voussoirs),
    };
  }

  /** Least friction at which n voussoirs stand; Infinity where none will do. */
  function leastFriction(halfAngle, eta, voussoirs, weight = "centreline") {
    const joints = half(halfAngle, voussoirs);
    const does = (angle) => stands(joints, eta, Math.tan(angle), theory.levelOf(eta, weight));
    if (!does(Math.PI / 2)) return Infinity;
    return Math.tan(smallest(does, 0, Math.PI / 2));
  }

  return { leastThickness, equilibrium, leastFriction };
})();
