"use strict";
/* Collapse mechanisms of the continuous arch as finite motions of rigid pieces.

   Only the right half is moved, the left one mirrors it. Hinges turn about the edge that stays
   closed, sliding joints slide as Coulomb friction has it, without opening. */

const mechanism = (() => {
  const STEP = 1e-4; // amount of motion small enough to be a rate

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

  /** Move the mechanism by an amount at the springing (a turn, or a slip over r).

      Every other amount follows from symmetry: the crown stays on the axis, and where nothing
      turns there it does not turn. */
  function pose(joints, eta, amount) {
    const atCrown = joints.find((joint) => joint.angle === 0);
    const free = joints.filter((joint) => joint.angle > 0);
    if (free.length === 1) return { amounts: [amount], motions: chain(free, [amount], eta) };
    const unknown = free.findIndex((joint, i) => i > 0 && (atCrown || joint.kind === "in"));
    const radius = atCrown && atCrown.kind === "intrados" ? 1 - eta / 2 : 1 + eta / 2;
    const amountsWith = (value) => free.map((_, i) => (i === unknown ? value : amount));
    const aside = (value) => move(chain(free, amountsWith(value), eta).at(-1), 0, radius)[0];
    let [before, value] = [0, amount];
    let [asideBefore, asideNow] = [aside(before), aside(value)];
    for (let i = 0; i < 30 && Math.abs(asideNow) > 1e-15 && asideNow !== asideBefore; i++) {
      const next = value - (asideNow * (value - before)) / (asideNow - asideBefore);
      [before, asideBefore, value] = [value, asideNow, next];
      asideNow = aside(value);
    }
    const amounts = amountsWith(value);
    return { amounts, motions: chain(free, amounts, eta) };
  }

  /** Faces between which the pieces of the right half lie: [[lower, upper], ...] angles. */
  function pieces(joints) {
    const angles = joints.map((joint) => joint.angle);
    if (angles.at(-1) !== 0) angles.push(0);
    return angles.slice(1).map((upper, i) => [angles[i], upper]);
  }

  /** Amount at the springing that moves the farthest corner about this far, over r. */
  function amountFor(joints, eta, distance) {
    const { motions } = pose(joints, eta, STEP);
    let farthest = 0;
    pieces(joints).forEach(([lower, upper], i) => {
      for (const angle of [lower, upper]) {
        for (const radius of [1 - eta / 2, 1 + eta / 2]) {
          const [x, y] = [radius * Math.sin(angle), radius * Math.cos(angle)];
          const [movedX, movedY] = move(motions[i], x, y);
          farthest = Math.max(farthest, Math.hypot(movedX - x, movedY - y));
        }
      }
    });
    return (STEP * distance) / farthest;
  }

  return { activeJoints, pieces, pose, move, amountFor };
})();
