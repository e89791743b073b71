"use strict";
/* What is said of an arch: numbers, whether it stands, and why. */

const wordsWith = (modes) => {
  const DEGREE = Math.PI / 180;

  const decimals = (value, digits) => String(+value.toPrecision(digits));
  const number = (value, digits = 4) =>
    value === null ? "–" : value === Infinity ? "∞" : value > 0 && value < 1e-3 ? value.toExponential(2) : decimals(value, digits);
  const degrees = (angle) => (angle === null ? "–" : `${(angle / DEGREE).toFixed(2)}°`);
  const percent = (share) => {
    const value = Math.abs(share) * 100;
    return `${value < 10 ? value.toPrecision(2) : value.toFixed(0)} %`;
  };

  const shortly = (mode) => modes[mode].description.split(" (")[0];
  const share = (balance) => {
    const near = Math.abs(balance.share - 1) < 0.02;
    return `${(balance.share * 100).toFixed(near ? 2 : 0)} %`;
  };

  function headline(state, { critical, verge, stands, slides, mode }) {
    if (slides) return "Just stands: no friction to spare";
    if (verge) return "Just stands: this is the least thickness";
    if (critical.eta === null) {
      return mode === "ss"
        ? "Collapses: too little friction for any thickness"
        : "Collapses: no thickness up to η = 2 will do";
    }
    const margin = state.eta / critical.eta - 1;
    if (stands) {
      return margin > 1
        ? `Stands: ${decimals(margin + 1, 2)} times the least thickness`
        : `Stands: thickness ${percent(margin)} above the least`;
    }
    return `Collapses: thickness ${percent(margin)} below the least`;
  }

  function because(state, { critical, balance, verge, stands, slides, mode, friction }) {
    const name = `${mode}, ${shortly(mode)}`;
    if (slides) {
      return `Springings and inner joints are about to slide, mode ${name}. With less friction, or
        opened wider, it falls, however thick.`;
    }
    if (verge) return `The lines touch wherever a joint is about to move: any thinner, it falls in mode ${name}.`;
    if (stands) {
      return `Lines of thrust and friction fit inside it: ${share(balance)} of its thickness and friction
        would do. At its least thickness, η = ${number(critical.eta)}, it falls in mode ${name}.`;
    }
    const needs = balance
      ? `No lines of thrust and friction fit inside it: that takes ${share(balance)} of its thickness and
         friction.`
      : "No thrust holds it up: its halves overturn by themselves.";
    let remedy = "";
    if (friction === Infinity) {
      const grip = theory.leastFriction(state.halfAngle, Infinity, state.weight);
      remedy = grip > state.mu ? ` Opened so wide, nothing stands below μ = ${number(grip)}.` : "";
      remedy += " At this thickness no friction would do.";
    } else if (friction > state.mu) remedy = ` At this thickness it stands from μ = ${number(friction)} on.`;
    return `${needs} It falls in mode ${name}.${remedy}`;
  }

  const KINDS = {
    extrados: "turns about its extrados", intrados: "turns about its intrados",
    out: "slides outwards", in: "slides inwards", parts: "parts",
  };

  function ofJoints(state, { joints }) {
    return joints.map(({ angle, kind }) => {
      const where = angle === 0 ? "the crown" : angle === state.halfAngle
        ? "each springing" : `the joint at ${(angle / DEGREE).toFixed(1)}°`;
      return `${where} ${KINDS[kind]}`;
    }).join(", ");
  }

  return { number, degrees, shortly, headline, because, ofJoints };
};
