"use strict";
/* The point looked at, in the part of the page's address behind #, so that it can be reloaded and shared. */

const address = (() => {
  const DEGREE = Math.PI / 180;
  const DIGITS = 12;
  const PAUSE = 200; // between writings: browsers refuse more than a few a second [ms]
  const plain = (value) => (value === Infinity ? "inf" : String(+value.toPrecision(DIGITS)));

  const textOf = (state) =>
    new URLSearchParams({
      ...(state.at === null ? {} : { at: +state.at.toPrecision(3) }),
      ...(state.lesson ? { lesson: state.lesson } : {}),
      ...(state.embed ? { embed: "yes" } : {}),
      alpha: plain(state.halfAngle / DEGREE), mu: plain(state.mu), eta: plain(state.eta),
      ...(state.load ? { load: `${plain(state.load.share)}_${plain(state.load.place)}` } : {}),
      ...(state.fill ? { fill: plain(state.fill) } : {}),
      n: state.voussoirs, arch: state.asBuilt ? "built" : "continuous", weight: state.weight, view: state.view,
    }).toString();

  /** What an address says, as a change of the state; what it says wrongly is left out. */
  function read(hash, ranges, isView) {
    const said = new URLSearchParams(hash.slice(1));
    const change = {};
    const take = (name, key, value) => {
      const [least, most] = ranges[name === "n" ? "voussoirs" : name];
      if (said.has(name) && value >= least && value <= most) change[key] = value;
    };
    take("alpha", "halfAngle", Number(said.get("alpha")));
    if (change.halfAngle !== undefined) change.halfAngle *= DEGREE;
    take("eta", "eta", Number(said.get("eta")));
    take("at", "at", Number(said.get("at")));
    take("fill", "fill", Number(said.get("fill")));
    const [share, place] = (said.get("load") ?? "").split("_").map(Number);
    const within = (value, [least, most]) => value >= least && value <= most;
    if (said.has("load") && within(share, ranges.share) && within(place, ranges.place)) change.load = { place, share };
    take("lesson", "lesson", Math.round(Number(said.get("lesson"))));
    change.embed = said.get("embed") === "yes";
    take("n", "voussoirs", Math.round(Number(said.get("n"))));
    if (said.get("mu") === "inf") change.mu = Infinity;
    else take("mu", "mu", Number(said.get("mu")));
    if (said.has("arch")) change.asBuilt = said.get("arch") === "built";
    if (["centreline", "sector"].includes(said.get("weight"))) change.weight = said.get("weight");
    if (said.has("view") && isView(said.get("view"))) change.view = said.get("view");
    return change;
  }

  let waiting = null;

  function writeNow(state) {
    clearTimeout(waiting);
    waiting = null;
    // The view of any blocks has an address of its own.
    if (!location.hash.includes("blocks=")) history.replaceState(null, "", `#${textOf(state)}`);
  }

  /** Write the state into the address soon. */
  function write(state) {
    waiting ??= setTimeout(() => writeNow(state), PAUSE);
  }

  return { read, write, textOf, flush: (state) => waiting !== null && writeNow(state) };
})();
