"use strict";
/* Closed form of the continuous arch: blocksim/theory/ in JavaScript, held to it by the tests.

   Numbers in brackets are equations of Cocchetti and Rizzi (2024). Angles are in radians from the
   crown, mu may be Infinity. `weight` is "centreline", "sector", or the radius at which the weight
   is spread, over the mean radius, where that does not follow from eta. */

const theory = (() => {
  const ETA_MAX = 2;
  const TIE = 1e-12; // thrusts and angles closer than this coincide
  const CROWN_TIE = 1e-6; // inner hinges closer to the crown are at it
  const ON_DIVIDE = 1e-10; // thickness ratios closer to the divide are on it
  const BEYOND = 4; // stands for a thickness ratio that does not exist
  const AT_CROWN = 1e-77; // where eta without thrust is 0/0 at the crown: just beside it
  const HALVINGS = 64;
  const SAMPLES = 240;

  /** Root of a function that changes sign between low and high (Chandrupatla, 1997). */
  function root(f, low, high) {
    let [x1, x2, f1, f2, share] = [low, high, f(low), f(high), 0.5];
    if (f1 === 0) return x1;
    for (let round = 0; round < 400; round++) {
      const x = x1 + share * (x2 - x1);
      const fx = f(x);
      let [x3, f3] = [x1, f1];
      if (Math.sign(fx) !== Math.sign(f1)) [x3, f3, x2, f2] = [x2, f2, x1, f1];
      [x1, f1] = [x, fx];
      const [best, least] = Math.abs(f1) < Math.abs(f2) ? [x1, f1] : [x2, f2];
      const limit = (2 * Number.EPSILON * Math.abs(best) + 1e-300) / Math.abs(x2 - x1);
      if (least === 0 || limit > 0.5) return best;
      const [xi, phi] = [(x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)];
      share = 0.5;
      if (phi * phi < xi && (1 - phi) ** 2 < 1 - xi) {
        share = (f1 / (f2 - f1)) * (f3 / (f2 - f3)) +
          ((x3 - x1) / (x2 - x1)) * (f1 / (f3 - f1)) * (f2 / (f3 - f2));
      }
      share = Math.min(1 - limit, Math.max(limit, share));
    }
    return x1;
  }

  /* Entire functions of y = beta^2 in which nothing cancels where arches are flat:
     1 - cos beta = y C(y), beta sin beta = y S(y), C = 1/2 - y R(y), S = 1 - y (2 R + P). */
  const R = [], P = [];
  for (let k = 2, factorial = 24; k < 14; factorial *= (2 * k + 1) * (2 * k + 2), k++) {
    R.push((k % 2 ? -1 : 1) / factorial);
    P.push(((k % 2 ? -1 : 1) * (2 * k - 2)) / factorial);
  }
  const series = (terms, y) => terms.reduceRight((sum, term) => sum * y + term);

  /** Joints of n voussoirs from the crown to the springing; the first is the crown where n is even. */
  const jointAngles = (halfAngle, voussoirs) =>
    Array.from({ length: (voussoirs >> 1) + 1 }, (_, i) => (halfAngle * (2 * i + (voussoirs % 2))) / voussoirs);

  /** What the resultant of a thrust 1 - s is made of at a joint, without cancellation where arches
      are flat: N = 1 + gain + s (fall - 1) and T = shear - s sin x; bend = fall - gain. */
  function section(angle) {
    const y = angle * angle;
    const [r, p] = [series(R, y), series(P, y)];
    const [c, s] = [0.5 - y * r, 1 - y * (2 * r + p)];
    return {
      fall: y * c, // 1 - cos x
      gain: y * (s - c), // x sin x + cos x - 1
      bend: y * y * p, // 2 (1 - cos x) - x sin x
      shear: angle * y * (c - 2 * r - p), // sin x - x cos x
    };
  }

  const levelOf = (eta, weight) =>
    weight === "centreline" ? 1 : weight === "sector" ? 1 + (eta * eta) / 12 : weight;

  /** Thickness at which the line of thrust touches extrados and intrados, (1) or (2), and the side
      of the hinge that demands most, (4), both at y = beta^2; `short` is 1 - h. */
  function touching(y, short, far, weight) {
    const [r, p] = [series(R, y), series(P, y)];
    const [c, s] = [0.5 - y * r, 1 - y * (2 * r + p)];
    const [farR, farP] = [series(R, far), series(P, far)];
    const [fall, farFall] = [y * c, far * (0.5 - far * farR)];
    const drop = farFall - fall;
    let gap = far * far * farP - y * y * p - short * drop;
    const force = (1 - short) * (2 - fall - farFall) + y * s + far * (1 - far * (2 * farR + farP));
    let eta;
    if (weight === "sector") {
      const square = force * force - (4 / 3) * drop * gap;
      eta = (4 * gap) / (force + Math.sqrt(Math.max(square, 0)));
      if (square < 0 && gap > 0) eta = Math.max(eta, BEYOND);
    } else {
      gap += (levelOf(0, weight) - 1) * drop;
      eta = (2 * gap) / force;
    }
    const turn = short - (y * (c - p - 2 * r)) / s; // beta cot beta - h
    const slope = 2 * turn - eta * (1 + turn) - 2 * (levelOf(eta, weight) - 1);
    return { eta, slope };
  }

  /** Thickness needed at a given thrust, and the intrados hinge that demands it. */
  function innerHinge(short, extrados, halfAngle, weight) {
    const [far, end] = [extrados ** 2, halfAngle ** 2];
    const at = (y) => touching(y, short, far, weight);
    const crown = at(extrados === 0 ? AT_CROWN : 0);
    if (crown.eta > ETA_MAX || crown.slope <= 0) return { eta: crown.eta, betaR: 0 };
    const last = at(end);
    if (last.slope >= 0) return { eta: last.eta, betaR: halfAngle };
    const y = root((square) => at(square).slope, 0, end);
    return { eta: at(y).eta, betaR: Math.sqrt(y) };
  }

  let remembered = {}; // the arch asked about last: friction often changes alone

  /** 1 - h at which crown and shoulder ask for the same thickness; 1 where each half overturns. */
  function rotational(halfAngle, weight) {
    if (remembered.halfAngle === halfAngle && remembered.weight === weight) return remembered.found;
    const difference = (short) =>
      innerHinge(short, halfAngle, halfAngle, weight).eta - innerHinge(short, 0, halfAngle, weight).eta;
    const overturns = difference(1) >= 0;
    const found = { overturns, short: overturns ? 1 : root(difference, 0, 1) };
    remembered = { halfAngle, weight, found };
    return found;
  }

  /** Thrust and angle at which an inner joint slides, (9): Kepler's equation E - sin E = 2 arctan mu. */
  function innerSliding(mu) {
    if (mu < 1) {
      const target = 2 * Math.atan(mu);
      const sine = (e) => e ** 3 * (2 * series(R, e * e) + series(P, e * e)); // E - sin E
      const anomaly = root((e) => sine(e) - target, 0, Math.PI);
      return { thrust: Math.cos(anomaly / 2) ** 2, betaS: Math.sin(anomaly) / 2 };
    }
    const target = 2 * Math.atan(1 / mu);
    const rest = target === 0 ? 0 : root((d) => d + Math.sin(d) - target, 0, Math.PI);
    return { thrust: Math.sin(rest / 2) ** 2, betaS: Math.sin(rest) / 2 };
  }

  /** Thrusts that no joint resists by sliding: inner joints below, the shoulder above, (8), (9). */
  function thrustInterval(halfAngle, mu) {
    const frictionAngle = Math.atan(mu);
    let { thrust: lower, betaS } = innerSliding(mu);
    if (betaS > halfAngle) lower = halfAngle / Math.tan(halfAngle + frictionAngle);
    const excess = halfAngle - frictionAngle;
    return { lower, upper: excess > 0 ? halfAngle / Math.tan(excess) : Infinity, betaS };
  }

  /** Least thickness, modes, thrust, hinge and sliding angles; eta is null where none up to 2 stands. */
  function leastThickness(halfAngle, mu, weight = "centreline") {
    const { lower, upper, betaS } = thrustInterval(halfAngle, mu);
    const none = { eta: null, needed: Infinity, mode: "ss", modes: ["ss"], thrust: null, betaR: null, betaS };
    if (lower > upper + TIE) return none;
    const { short, overturns } = rotational(halfAngle, weight);
    const free = 1 - short;
    const thrust = Math.min(Math.max(free, lower), upper);
    // Below the rotational thrust the crown asks for more thickness, above it the shoulder.
    const extrados = thrust < free ? 0 : halfAngle;
    const missing = thrust === free ? short : 1 - thrust;
    const { eta, betaR } = innerHinge(missing, extrados, halfAngle, weight);
    const modes = [];
    // At finite friction an arch that overturns slides, too, at however small a thrust.
    if (overturns ? thrust === 0 : Math.abs(thrust - free) <= TIE) modes.push(overturns ? "r" : "rrr");
    if (upper <= free + TIE) modes.push("srr");
    if (lower >= free - TIE && thrust > 0) modes.push(...innerModes(betaR, betaS));
    if (upper - lower <= TIE) modes.push("ss");
    return {
      eta: eta <= ETA_MAX * (1 + TIE) ? Math.min(eta, ETA_MAX) : null,
      needed: eta, // beyond 2, too
      mode: modes[0],
      modes,
      thrust,
      betaR,
      betaS: modes.some((mode) => ["rrs", "rsr", "rs", "ss"].includes(mode)) ? betaS : null,
    };
  }

  function innerModes(betaR, betaS) {
    if (betaR <= CROWN_TIE) return betaR === 0 ? ["rs"] : ["rs", "rsr"];
    if (Math.abs(betaR - betaS) <= TIE) return ["rrs", "rsr"];
    return [betaR > betaS ? "rrs" : "rsr"];
  }

  /** Half-angle and modes of a point of the map: the widest arch that stands there. */
  function atPoint(eta, mu, weight = "centreline") {
    let [low, high] = [0, Math.PI];
    for (let i = 0; i < HALVINGS; i++) {
      const middle = (low + high) / 2;
      const { lower, upper } = thrustInterval(middle, mu);
      // The slack that counts as a tie would lead beyond the divide.
      const enough = lower <= upper && leastThickness(middle, mu, weight).needed <= eta;
      if (enough) low = middle;
      else high = middle;
    }
    const critical = leastThickness(low, mu, weight);
    const { lower, upper } = thrustInterval(high, mu);
    // On the left of the divide it is friction that stops wider arches, whatever their eta.
    const slides = lower > upper && critical.needed < eta - ON_DIVIDE;
    return { halfAngle: low, modes: slides ? ["ss"] : critical.modes, critical };
  }

  /** Least friction at which an arch stands; Infinity where none will do. With eta = Infinity it
      is the friction at and below which no thickness stands, where (8) and (9) meet. */
  function leastFriction(halfAngle, eta, weight = "centreline") {
    const enough = (angle) => {
      const { needed } = leastThickness(halfAngle, Math.tan(angle), weight);
      return needed < Infinity && needed <= eta;
    };
    let [low, high] = [0, Math.PI / 2];
    for (let i = 0; i < HALVINGS; i++) {
      const middle = (low + high) / 2;
      if (enough(middle)) high = middle;
      else low = middle;
    }
    return high === Math.PI / 2 ? Infinity : Math.tan(high);
  }

  const normalForce = (angle, thrust) => thrust * Math.cos(angle) + angle * Math.sin(angle);

  /** Moment about the centreline, positive towards the extrados. */
  const sectionMoment = (angle, thrust, crownMoment, eta, weight) =>
    crownMoment - normalForce(angle, thrust) + levelOf(eta, weight) * (1 - Math.cos(angle));

  /** Line of thrust, (10) and (11): 1 at the intrados, -1 at the extrados. */
  const thrustLine = (angle, thrust, crownMoment, eta, weight) =>
    -sectionMoment(angle, thrust, crownMoment, eta, weight) / ((normalForce(angle, thrust) * eta) / 2);

  /** Line of friction, (13): 1 where an inner joint slides, -1 where the shoulder does. */
  const frictionLine = (angle, thrust, mu) =>
    -(thrust * Math.sin(angle) - angle * Math.cos(angle)) / (mu * normalForce(angle, thrust));

  /** Share of thickness and friction that the arch needs, both scaled alike, and the resultant at
      its crown; more than 1 where it falls, null where no share will do.

      With the weight where it is, an arch of thickness share eta and friction share mu is at its
      least thickness. */
  function equilibrium(halfAngle, mu, eta, weight = "centreline") {
    const level = levelOf(eta, weight);
    const at = (share) => leastThickness(halfAngle, share * mu, level);
    let [low, high] = [Math.log(1e-6), Math.log(1e4)];
    if (!(at(1e4).needed <= 1e4 * eta)) return null;
    for (let i = 0; i < HALVINGS; i++) {
      const middle = (low + high) / 2;
      if (at(Math.exp(middle)).needed <= Math.exp(middle) * eta) high = middle;
      else low = middle;
    }
    const share = Math.exp(high);
    const { thrust, betaR } = at(share);
    // The moment that keeps as far from the one face as from the other.
    let [least, most] = [-Infinity, Infinity];
    for (let i = -1; i <= SAMPLES; i++) {
      const angle = i < 0 ? betaR : (halfAngle * i) / SAMPLES;
      const room = (normalForce(angle, thrust) * share * eta) / 2;
      const moment = sectionMoment(angle, thrust, 0, eta, level);
      least = Math.max(least, -room - moment);
      most = Math.min(most, room - moment);
    }
    return { share, thrust, crownMoment: (least + most) / 2 };
  }

  return {
    leastThickness, atPoint, leastFriction, equilibrium, innerSliding, jointAngles, section,
    levelOf, normalForce, sectionMoment, thrustLine, frictionLine,
  };
})();
