"use strict";
/* What is known of an arch: whether it stands, its least thickness, how it falls. */

const knowing = (() => {
  const ON_THE_VERGE = 1e-7; // share of strength needed, this near to all of it

  /** Of the continuous arch, or of its voussoirs as built. */
  function assess({ halfAngle, mu, eta, weight, voussoirs }, asBuilt) {
    const critical = asBuilt
      ? built.leastThickness(halfAngle, mu, voussoirs, weight)
      : theory.leastThickness(halfAngle, mu, weight);
    const balance = asBuilt
      ? built.equilibrium(halfAngle, mu, eta, voussoirs, weight)
      : theory.equilibrium(halfAngle, mu, eta, weight);
    const verge = balance !== null && Math.abs(balance.share - 1) < ON_THE_VERGE;
    const stands = verge || (critical.eta !== null && eta >= critical.eta);
    // Thick enough and yet on the verge: it is friction that has nothing to spare.
    const slides = verge && critical.eta !== null && eta > critical.eta * (1 + 1e-6);
    const mode = slides ? "ss" : critical.mode;
    const betaS = slides && !asBuilt ? theory.innerSliding(mu).betaS : critical.betaS;
    let joints = slides ? balance.joints : critical.joints;
    if (!asBuilt) joints = mechanism.activeJoints(mode, halfAngle, critical.betaR ?? 0, betaS ?? 0);
    const friction = asBuilt
      ? built.leastFriction(halfAngle, eta, voussoirs, weight)
      : theory.leastFriction(halfAngle, eta, weight);
    return { voussoirs: asBuilt ? voussoirs : null, critical, balance, verge, stands, slides, mode, betaS, joints, friction };
  }

  const verdictOf = ({ verge, stands }) => (verge ? "undecided" : stands ? "stands" : "collapses");

  /** What is known of an arch with what lies on it. */
  function underLoad(state) {
    const found = loaded.analyse(state, state.voussoirs);
    const { margin } = found.rest;
    const verge = Number.isNaN(margin) || Math.abs(margin) < ON_THE_VERGE;
    return { loaded: found, verge, stands: margin > 0, joints: found.falls.joints };
  }

  return { assess, underLoad, verdictOf };
})();
