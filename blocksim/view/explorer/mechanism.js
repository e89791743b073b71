"use strict";
/* Collapse mechanisms as finite motions of rigid pieces: joints anywhere, or those of voussoirs.

   Only the right half is moved, the left one mirrors it. Hinges turn about the edge that stays
   closed, sliding joints slide as Coulomb friction has it, without opening. */

const mechanism = (() => {
  const STEP = 1e-6; // amount of motion small enough to be a rate
  const CLOSED = 1e-12; // distance from the axis at which the crown is on it
  const ROUNDS = 30;

  /** Joints that move, from the springing up: where, and what the piece above does. */
  function activeJoints(mode, halfAngle, betaR, betaS) {
    const joints = {
      rrr: [[halfAngle, "extrados"], [betaR, "intrados"], [0, "extrados"]],
      ss: [[halfAngle, "out"], [betaS, "in"]],
      srr: [[halfAngle, "out"], [betaR, "intrados"], [0, "extrados"]],
      rrs: [[halfAngle, "extrados"], [betaR, "intrados"], [betaS, "in"]],
      rsr: [[halfAngle, "extrados"], [betaS, "in"], [betaR, "intrados"]],
      rs: [[halfAngle, "extrados"], [betaS, "in"], [0, "intrados"]],
      r: [[halfAngle, "extrados"], [0, "parts"]],
    };
    return joints[mode].map(([angle, kind]) => ({ angle, kind }));
  }

  const IDENTITY = { turn: 0, x: 0, y: 0 };

  /** Where a motion (clockwise turn about the centre of the arch, then a shift) takes a point. */
  function move(motion, x, y) {
    const [sine, cosine] = [Math.sin(motion.turn), Math.cos(motion.turn)];
    return [cosine * x + sine * y + motion.x, cosine * y - sine * x + motion.y];
  }

  /** Motion of the piece above a joint, relative to the piece below in its first place. */
  function relative({ angle, kind }, amount, eta) {
    const [x, y] = [Math.sin(angle), Math.cos(angle)];
    if (kind === "out" || kind === "in") {
      const slip = kind === "out" ? amount : -amount;
      return { turn: 0, x: slip * x, y: slip * y };
    }
    const turn = kind === "extrados" ? amount : -amount;
    const radius = kind === "extrados" ? 1 + eta / 2 : 1 - eta / 2;
    const [movedX, movedY] = move({ turn, x: 0, y: 0 }, radius * x, radius * y);
    return { turn, x: radius * x - movedX, y: radius * y - movedY };
  }

  /** First one motion, then another. */
  function after(first, second) {
    const [x, y] = move(second, first.x, first.y);
    return { turn: first.turn + second.turn, x, y };
  }

  /** Motions of the pieces of the right half, from the springing up. */
  function chain(joints, amounts, eta) {
    const motions = [];
    let motion = IDENTITY;
    amounts.forEach((amount, i) => {
      motion = after(relative(joints[i], amount, eta), motion);
      motions.push(motion);
    });
    return motions;
  }

  const turnOf = ({ kind }) => (kind === "extrados" ? 1 : kind === "intrados" ? -1 : 0);

  /** Which joint turns back what the others turn, where the crown has no hinge; -1 where none. */
  function turningBack(free) {
    const against = free.findIndex((joint, i) => i > 0 && turnOf(joint) * turnOf(free[0]) < 0);
    return against > 0 ? against : free.findLastIndex((joint, i) => i > 0 && turnOf(joint) !== 0);
  }

  /** Move the mechanism by an amount at the springing (a turn, or a slip over r).

      Every other amount follows from symmetry: the crown stays on the axis, and where nothing
      turns there it does not turn. `closed` is false where so large a motion is not possible. */
  function pose(joints, eta, amount) {
    const atCrown = joints.find((joint) => joint.angle === 0);
    const free = joints.filter((joint) => joint.angle > 0 && joint.kind !== "parts");
    if (free.length === 1) {
      const motions = chain(free, [amount], eta);
      const last = joints.at(-1);
      // Between halves that part, a keystone goes down with their faces.
      if (last.angle > 0) motions.push({ ...IDENTITY, y: move(motions[0], Math.sin(last.angle), Math.cos(last.angle))[1] - Math.cos(last.angle) });
      return { closed: true, amounts: [amount], motions };
    }
    const back = atCrown ? -1 : turningBack(free);
    const unknown = free.findIndex((joint, i) => i > 0 && i !== back);
    const radius = atCrown && atCrown.kind === "intrados" ? 1 - eta / 2 : 1 + eta / 2;
    const amountsAt = (first, value) => {
      const amounts = free.map((_, i) => (i === 0 ? first : i === unknown ? value : 0));
      const turn = free.reduce((sum, joint, i) => sum + turnOf(joint) * amounts[i], 0);
      if (back > 0) amounts[back] = -turnOf(free[back]) * turn;
      return amounts;
    };
    const aside = (first, value) => move(chain(free, amountsAt(first, value), eta).at(-1), 0, radius)[0];
    // At small amounts they are proportional; from there on by the secant method.
    const ratio = -aside(STEP, 0) / (aside(STEP, STEP) - aside(STEP, 0));
    let [before, value] = [0.99 * ratio * amount, ratio * amount];
    let [asideBefore, asideNow] = [aside(amount, before), aside(amount, value)];
    for (let i = 0; i < ROUNDS && Math.abs(asideNow) > CLOSED / 10 && asideNow !== asideBefore; i++) {
      const next = value - (asideNow * (value - before)) / (asideNow - asideBefore);
      [before, asideBefore, value] = [value, asideNow, next];
      asideNow = aside(amount, value);
    }
    const amounts = amountsAt(amount, value);
    const closed = Math.abs(asideNow) < CLOSED && Math.min(...amounts) >= 0 && value < 3 * ratio * amount + CLOSED;
    return { closed, amounts, motions: chain(free, amounts, eta) };
  }

  /** Faces between which the pieces of the right half lie: [[lower, upper], ...] angles. */
  function pieces(joints) {
    const angles = joints.map((joint) => joint.angle);
    if (angles.at(-1) !== 0) angles.push(0);
    return angles.slice(1).map((upper, i) => [angles[i], upper]);
  }

  /** How far, over r, an amount at the springing moves the farthest corner. */
  function reachOf(joints, eta, amount) {
    const { closed, motions } = pose(joints, eta, amount);
    let farthest = closed ? 0 : Infinity;
    pieces(joints).forEach(([lower, upper], i) => {
      for (const angle of [lower, upper]) {
        for (const radius of [1 - eta / 2, 1 + eta / 2]) {
          const [x, y] = [radius * Math.sin(angle), radius * Math.cos(angle)];
          const [movedX, movedY] = move(motions[i], x, y);
          farthest = Math.max(farthest, Math.hypot(movedX - x, movedY - y));
        }
      }
    });
    return farthest;
  }

  /** Amount at the springing that moves the farthest corner about this far, over r: less where
      pieces would lock before, as the hinges of a flat arch do once they lie on a line. */
  function amountFor(joints, eta, distance) {
    let amount = (STEP * distance) / reachOf(joints, eta, STEP);
    while (amount > STEP && reachOf(joints, eta, amount) > 1.3 * distance) amount *= 0.95;
    return amount;
  }

  return { activeJoints, pieces, pose, move, amountFor };
})();
