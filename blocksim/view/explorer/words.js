"use strict";
/* What is said of an arch: numbers, whether it stands, and why; always of which arch. */

const wordsWith = (modes) => {
  const DEGREE = Math.PI / 180;

  const decimals = (value, digits) => String(+value.toPrecision(digits));
  const number = (value, digits = 4) =>
    value === null ? "–" : value === Infinity ? "∞" : value > 0 && value < 1e-3 ? value.toExponential(2) : decimals(value, digits);
  const degrees = (angle) => (angle === null ? "–" : `${(angle / DEGREE).toFixed(2)}°`);
  const percent = (share) => {
    const value = Math.abs(share) * 100;
    return `${value < 1e-3 ? "under 0.001" : value < 10 ? value.toPrecision(2) : value.toFixed(0)} %`;
  };

  const shortly = (mode) => modes[mode].description.split(" (")[0];
  const named = (mode) => (mode === null ? "a mode without a name" : `mode ${mode}, ${shortly(mode)}`);
  const share = (balance) => {
    const apart = Math.abs(balance.share - 1);
    return `${(balance.share * 100).toFixed(apart > 0.02 ? 0 : apart > 2e-4 ? 2 : 5)} %`;
  };

  /** Which arch: the continuous one, or its voussoirs. */
  const which = (voussoirs) => (voussoirs ? `${voussoirs} voussoirs as built` : "the continuous arch");

  /** What lies on the arch. */
  const onIt = ({ load, fill }) => [load && "load", fill && "fill"].filter(Boolean).join(" and ");

  /** The same in numbers. */
  const laid = ({ load, fill }, { loaded }) => (loaded
    ? `${load ? `, load of ${number(load.share)} weights at x = ${number(loaded.place)} r` : ""}${fill ? `, fill ${number(fill)} r over the crown` : ""}` : "");

  function headline(state, seen) {
    if (seen.loaded) {
      const unknown = Number.isNaN(seen.loaded.rest.margin) ? "Undecided" : "On the verge";
      return `${seen.verge ? unknown : seen.stands ? "Stands" : "Collapses"}: ${seen.voussoirs} voussoirs under ${onIt(state)}`;
    }
    const { critical, verge, stands, slides, mode, voussoirs } = seen;
    const arch = which(voussoirs);
    if (critical.eta === 0) return `Stands: ${arch} stand at any thickness`;
    if (slides) return `On the verge: ${arch} ${voussoirs ? "have" : "has"} no friction to spare`;
    if (verge) return `On the verge: the least thickness of ${arch}`;
    if (critical.eta === null) {
      return mode === "ss"
        ? `Collapses: too little friction for any thickness of ${arch}`
        : `Collapses: no thickness of ${arch} will do, up to η = 2`;
    }
    const over = state.eta / critical.eta - 1;
    const margin = over > 1 ? `${decimals(over + 1, 2)} times` : `${percent(over)} ${stands ? "above" : "below"}`;
    return `${stands ? "Stands" : "Collapses"}: ${margin} the least thickness of ${arch}`;
  }

  /** The verdict on an arch named elsewhere. */
  function shortVerdict(state, { critical, verge, stands }) {
    const verdict = stands ? "stands" : "collapses";
    if (verge) return "on the verge";
    if (!critical.eta) return verdict;
    const over = state.eta / critical.eta - 1;
    if (over > 1) return `${verdict}, ${decimals(over + 1, 2)} times the least`;
    return `${verdict}, ${percent(over)} ${stands ? "to spare" : "short"}`;
  }

  /** What an arch bears where its load is. */
  function underLoad(state, { verge, stands, loaded: { rest, bears } }) {
    const fits = Number.isNaN(rest.margin) ? "Rounding hides whether it stands."
      : verge ? "Its line of thrust has nothing to spare."
      : stands ? "A line of thrust fits inside it, and friction holds every joint." : "No line of thrust fits inside it that friction could hold.";
    if (!bears) return fits;
    const most = { null: "No load here lets it stand.", Infinity: "No load here brings it down.", NaN: "Rounding hides what it bears here." }[bears.factor]
      ?? `Here it bears ${decimals(100 * bears.factor, 4)} % of its own weight; with more, it falls as the slider shows.`;
    return `${fits} ${!stands && !verge && bears.factor > state.load.share ? "It needs a larger load here to stand." : ""} ${most}`;
  }

  function because(state, seen) {
    if (seen.loaded) return underLoad(state, seen);
    const { critical, balance, verge, stands, slides, mode, friction, voussoirs } = seen;
    if (slides) {
      return `Springings and inner joints are about to slide, ${named(mode)}. With less friction, or
        opened wider, it falls as shown, however thick.`;
    }
    if (verge) {
      return `The lines of thrust and friction touch wherever a joint is about to move: it just stands.
        Any thinner, it falls as shown, in ${named(mode)}.`;
    }
    if (critical.eta === 0) return "No joint lies where it could turn.";
    if (stands) {
      return `Lines of thrust and friction fit inside it: ${share(balance)} of its thickness and friction
        would do. At its least thickness, η = ${number(critical.eta)}, it falls in ${named(mode)}.`;
    }
    const needs = balance
      ? `No lines of thrust and friction fit inside it: that takes ${share(balance)} of its thickness and
         friction.`
      : "No thrust holds it up: its halves overturn by themselves.";
    const falls = critical.eta === null
      ? `Even at η = 2 it falls, in ${named(mode)}; thinner, it may fall in another.`
      : `At its least thickness, η = ${number(critical.eta)}, it falls in ${named(mode)}.`;
    let remedy = "";
    if (friction === Infinity) {
      const grip = voussoirs
        ? built.leastFriction(state.halfAngle, 2, voussoirs, state.weight)
        : theory.leastFriction(state.halfAngle, Infinity, state.weight);
      remedy = grip > state.mu && grip < Infinity ? ` Opened so wide, nothing stands below μ = ${number(grip)}.` : "";
      remedy += " At this thickness no friction would do.";
    } else if (friction > state.mu) {
      // In as many digits as tell it from what it has.
      remedy = ` At this thickness it stands from μ = ${number(friction, friction / state.mu < 1.001 ? 7 : 4)} on.`;
    }
    return `${needs} ${falls}${remedy}`;
  }

  const SLIDES = { out: true, in: true };
  const KINDS = {
    extrados: "turns about its extrados", intrados: "turns about its intrados",
    out: "slides outwards", in: "slides inwards", parts: "parts",
  };

  function ofJoints(state, { joints, critical, voussoirs, loaded }) {
    if (loaded) {
      const acts = joints.map(({ angle, kind }) => `the joint at ${number(angle / DEGREE)}° ${kind in SLIDES ? "slides" : KINDS[kind]}`);
      return acts.length ? `Mechanism: ${acts.join(", ")}.` : "";
    }
    if (!joints.length) return "No mechanism to show: the joints that act form none of the seven modes.";
    const told = joints.map(({ angle, kind }) => {
      const where = angle === 0 ? "the crown" : Math.abs(angle - state.halfAngle) < 1e-12
        ? "each springing" : `the joint at ${(angle / DEGREE).toFixed(1)}°`;
      return `${where} ${KINDS[kind]}`;
    });
    const when = critical.eta === null ? " at η = 2" : " at the least thickness";
    return `Mechanism of ${which(voussoirs)}${when}: ${told.join(", ")}.`;
  }

  /** What engines found at just this point. */
  const ofResult = (row) => `Simulated: ${row.scenario}, by ${row.engine}, n = ${row.voussoirs}: ${row.found}.`;

  return { number, degrees, shortly, which, headline, shortVerdict, because, ofJoints, ofResult, laid };
};
