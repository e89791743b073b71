"use strict";
/* The page's second view: blocks of any convex shape, drawn, dragged, loaded and tilted. */

const own = (() => {
  const { VERGE } = ownPicture;
  const DEGREE = Math.PI / 180;
  const NEAR = 14; // pixels within which corners and faces catch each other
  const FINE = 10; // digits of coordinates in the address
  const RANGES = { rub: [0, 1000], load: [0, 100], lean: [-60, 60] };
  const data = JSON.parse(document.getElementById("data").textContent);
  const find = (id) => document.getElementById(id);
  const plain = (value, digits = 4) => String(+value.toPrecision(digits));
  const state = { name: null, blocks: [], mu: 0.7, load: null, tilt: 0, chosen: null, moved: 0 };
  let [seen, box, arches, drawing] = [null, null, "#", false];

  const here = () => new URLSearchParams(location.hash.slice(1)).has("blocks");

  /* The address. */

  const textOf = (name, blocks) => name ?? blocks.map(({ corners, fixed }) =>
    (fixed ? "f" : "") + corners.flat().map((value) => plain(value, FINE)).join("_")).join("*");

  function addressOf({ name, blocks, mu, load: { block, point, share }, tilt, moved }) {
    const [x, y] = point.map((value) => plain(value, FINE));
    return new URLSearchParams({
      blocks: textOf(name, blocks), mu: mu === Infinity ? "inf" : plain(mu, FINE),
      load: [plain(share, FINE), block, x, y].join("_"), lean: plain(tilt / DEGREE, FINE), move: plain(moved, 3),
    }).toString();
  }

  const within = ([least, most], value) => value >= least && value <= most;

  /** Blocks as an address has them; null where it has none. */
  function blocksOf(text) {
    const blocks = text.split("*").map((part) => {
      const values = part.replace(/^f/, "").split("_").map(Number);
      const corners = Array.from({ length: values.length >> 1 }, (_, i) => values.slice(2 * i, 2 * i + 2));
      return { corners, fixed: part.startsWith("f") };
    });
    const good = ({ corners }) => corners.length > 2 && corners.flat().every(Number.isFinite) && blockwork.isConvex(corners);
    return blocks.every(good) ? blocks : null;
  }

  function arrive() {
    const said = new URLSearchParams(location.hash.slice(1));
    const blocks = data.structures.some(({ name }) => name === said.get("blocks")) ? null : blocksOf(said.get("blocks"));
    if (blocks) Object.assign(state, { name: null, blocks, mu: 0.7, tilt: 0, chosen: null, moved: 0, load: top(blocks) });
    else take(said.get("blocks"));
    const mu = said.get("mu") === "inf" ? Infinity : Number(said.get("mu") ?? NaN);
    if (mu === Infinity || within(RANGES.rub, mu)) state.mu = mu;
    const [share, block, ...point] = (said.get("load") ?? "").split("_").map(Number);
    const on = state.blocks[block];
    const inside = on && !on.fixed && blockwork.across(on.corners).every((range, i) => within(range, point[i]));
    if (inside && within(RANGES.load, share)) state.load = { share, block, point };
    if (said.has("lean") && within(RANGES.lean, Number(said.get("lean")))) state.tilt = Number(said.get("lean")) * DEGREE;
    if (within([0, 1], Number(said.get("move")))) state.moved = Number(said.get("move"));
    fit();
  }

  /** Take a structure of the list; of another name the first. */
  function take(name) {
    const found = data.structures.find((each) => each.name === name) ?? data.structures[0];
    const { blocks, mu } = found;
    Object.assign(state, { name: found.name, blocks, mu: mu ?? Infinity, tilt: 0, chosen: null, moved: 0, load: top(blocks) });
  }

  /** A load of no size, on the highest corner. */
  function top(blocks) {
    const corners = blocks.flatMap(({ corners, fixed }, block) => (fixed ? [] : corners.map((point) => ({ block, point, share: 0 }))));
    return corners.reduce((best, each) => (best && best.point[1] >= each.point[1] ? best : each), null);
  }

  /** What is shown as a structure file, for blocksim. */
  function structure() {
    const { block, point, share } = state.load;
    const weight = state.blocks.filter(({ fixed }) => !fixed).reduce((sum, { corners }) => sum + blockwork.measure(corners).area, 0);
    const down = [Math.sin(state.tilt), -Math.cos(state.tilt)];
    return {
      title: "Drawn in the explorer", friction: state.mu === Infinity ? "inf" : state.mu, density: 1,
      blocks: state.blocks.map(({ corners, fixed }, id) => ({ id, vertices: corners, fixed })),
      dead: [{ body: down }], live: [{ block, point, force: down.map((way) => way * weight) }], load: share,
    };
  }

  /* Showing it. */

  /** Show all of it, and room around it. */
  function fit() {
    const [c, s] = [Math.cos(state.tilt), Math.sin(state.tilt)];
    const corners = state.blocks.flatMap((block) => block.corners).map(([x, y]) => [c * x + s * y, s * x - c * y]);
    const [low, high] = [Math.min, Math.max].map((end) => [0, 1].map((i) => end(...corners.map((corner) => corner[i]))));
    const size = Math.max(high[0] - low[0], high[1] - low[1]);
    box = { low, high, size };
  }

  function update(change) {
    Object.assign(state, change);
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(() => {
      drawing = false;
      if (!here() || !find("own").clientWidth) return; // 0 while the view is left
      history.replaceState(null, "", `#${addressOf(state)}`);
      show();
    });
  }

  /** The motion that is shown: under the largest load, or as it falls at any, or as it is tilted. */
  function motion() {
    const { rest, bears, tilts } = seen;
    if (bears.factor >= 0 && bears.factor < Infinity && bears.factor !== null) return bears;
    if (!(rest.margin > VERGE)) return rest;
    return tilts[0].factor > tilts[1].factor ? tilts[1] : tilts[0];
  }

  function words() {
    if (seen.overlaps.length) return ["Blocks overlap", "Move one of those outlined, or drag its corners.", "wrong"];
    if (seen.loose.length) return ["Collapses", "Nothing holds the blocks outlined: let them touch others.", "collapses"];
    if (!seen.rest) return ["Nothing can move", "Every block is fixed.", "stands"];
    const { rest, bears, tilts } = seen;
    if (Number.isNaN(rest.margin)) return ["Undecided", "Rounding hides whether it stands.", "undecided"];
    const angles = tilts.map(({ factor }) => (factor === null ? null : plain(Math.atan(factor) / DEGREE)));
    const tilted = angles.includes(null) ? "" : ` Tilted slowly from level ground, it falls at ${angles[0] === angles[1]
      ? `${angles[0]}° to either side` : `${angles[0]}° to the right, at ${angles[1]}° to the left`}.`;
    const load = {
      null: "No load at this point lets it stand.", Infinity: "No load at this point brings it down.",
      NaN: "Rounding hides what it bears here.",
    }[bears.factor] ?? `At this point it bears ${plain(100 * bears.factor)} % of the weight of all blocks; with more, it falls as the slider shows.`;
    if (Math.abs(rest.margin ?? 1) < VERGE) return ["On the verge", `It just stands, or just falls. ${load}${tilted}`, "undecided"];
    if (rest.margin > 0) return ["Stands", `Forces within friction and without tension hold it. ${load}${tilted}`, "stands"];
    const borne = bears.factor > state.load.share ? " It needs a larger load here to stand." : bears.factor >= 0 ? ` ${load}` : "";
    return ["Collapses", `No forces within friction and without tension hold it.${borne}${tilted}`, "collapses"];
  }

  function show() {
    seen = blockwork.analyse(state);
    const [verdict, because, looks] = words();
    find("own-verdict").textContent = verdict;
    find("own-verdict").className = `verdict ${looks}`;
    find("own-because").textContent = because;
    ownPicture.draw(find("own"), { state, seen, box, moving: seen.rest ? motion() : null });
    const values = { rub: state.mu, load: state.load.share, lean: state.tilt / DEGREE };
    for (const [id, value] of Object.entries(values)) {
      find(id).value = value;
      find(id).disabled = find(`${id}-number`).disabled = value === Infinity;
      if (document.activeElement !== find(`${id}-number`)) find(`${id}-number`).value = value === Infinity ? "" : +value.toPrecision(5);
    }
    find("rough").checked = state.mu === Infinity;
    find("structure").value = state.name ?? "own";
    const chosen = state.blocks[state.chosen];
    for (const id of ["remove", "fixed"]) find(id).disabled = !chosen;
    find("fixed").checked = Boolean(chosen?.fixed);
    find("fall").value = state.moved;
    find("own").setAttribute("aria-label", `${verdict}. ${because}`);
  }

  /* Changing it. */

  const placeOf = (event) => {
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(find("turned").getScreenCTM().inverse());
    return [x, y];
  };

  /** The nearest point of a stretch. */
  function onto([[a, b], [c, d]], [x, y]) {
    const share = Math.min(1, Math.max(0, ((x - a) * (c - a) + (y - b) * (d - b)) / ((c - a) ** 2 + (d - b) ** 2)));
    return [a + share * (c - a), b + share * (d - b)];
  }
  const sidesOf = (corners) => corners.map((start, i) => [start, corners[(i + 1) % corners.length]]);
  const apart = ([a, b], [c, d]) => Math.hypot(a - c, b - d);

  /** Where corners go so that they meet those of others, or else a face: the least way, within a few pixels. */
  function caught(corners, others) {
    const near = NEAR / find("turned").getScreenCTM().a * Math.cos(state.tilt);
    const ways = [];
    for (const other of others) {
      for (const corner of corners) {
        for (const end of other) ways.push({ from: corner, to: end, far: 0 });
        for (const side of sidesOf(other)) ways.push({ from: corner, to: onto(side, corner), far: near / 2 });
      }
      if (corners.length < 2) continue;
      for (const end of other) for (const side of sidesOf(corners)) ways.push({ from: onto(side, end), to: end, far: near / 2 });
    }
    for (const way of ways) way.far += apart(way.from, way.to);
    const best = ways.reduce((least, way) => (least && least.far <= way.far ? least : way), null);
    return best && best.far < near ? [best.to[0] - best.from[0], best.to[1] - best.from[1]] : [0, 0];
  }

  const shifted = (corners, [x, y]) => corners.map(([a, b]) => [a + x, b + y]);
  const others = () => state.blocks.filter((_, i) => i !== state.chosen).map(({ corners }) => corners);

  /** Move the chosen block, and a load on it. */
  function moveTo(corners, load = state.load) {
    const before = state.blocks[state.chosen].corners[0];
    const way = [corners[0][0] - before[0], corners[0][1] - before[1]];
    const blocks = state.blocks.map((block, i) => (i === state.chosen ? { ...block, corners } : block));
    update({ name: null, blocks, moved: 0, load: load.block === state.chosen ? { ...load, point: shifted([load.point], way)[0] } : load });
  }

  /** Put the load where the nearest face of a block is. */
  function put(place) {
    let best = null;
    state.blocks.forEach(({ corners, fixed }, block) => {
      if (fixed) return;
      for (const side of sidesOf(corners)) {
        const point = onto(side, place);
        if (!best || apart(point, place) < apart(best.point, place)) best = { block, point, share: state.load.share };
      }
    });
    update({ load: best, moved: 0 });
  }

  function grasp(event) {
    const { block, corner } = event.target.dataset;
    const from = placeOf(event);
    if (event.target.closest("[data-load]")) return put;
    if (corner !== undefined) {
      const old = state.blocks[state.chosen].corners;
      return (place) => {
        const moved = shifted([place], caught([place], others()))[0];
        const corners = old.map((each, i) => (i === +corner ? moved : each));
        if (!blockwork.isConvex(corners)) return;
        const blocks = state.blocks.map((each, i) => (i === state.chosen ? { ...each, corners } : each));
        update({ name: null, blocks, moved: 0 });
      };
    }
    if (block === undefined) return update({ chosen: null });
    update({ chosen: +block });
    const [old, load] = [state.blocks[+block].corners, state.load];
    return (place) => {
      const free = shifted(old, [place[0] - from[0], place[1] - from[1]]);
      moveTo(shifted(free, caught(free, others())));
    };
  }

  function listen() {
    const picture = find("own");
    let drag = null;
    picture.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      drag = grasp(event) ?? null;
      picture.setPointerCapture(event.pointerId);
    });
    picture.addEventListener("pointermove", (event) => drag?.(placeOf(event)));
    for (const end of ["pointerup", "pointercancel"]) picture.addEventListener(end, () => {
      drag = null;
      fit();
      update({});
    });
    // Blocks follow a finger; beside them it scrolls the page.
    picture.addEventListener("touchstart", (event) => {
      if (event.target !== picture) event.preventDefault();
    }, { passive: false });
    picture.addEventListener("keydown", (event) => {
      const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      if (event.key === " ") update({ chosen: ((state.chosen ?? -1) + 1) % state.blocks.length });
      else if (event.key === "Delete" && state.chosen !== null) remove();
      else if (ways[event.key] && state.chosen !== null) moveTo(shifted(state.blocks[state.chosen].corners,
        ways[event.key].map((way) => (way * box.size) / 200)));
      else return;
      event.preventDefault();
    });
    const set = { rub: (mu) => ({ mu }), load: (share) => ({ load: { ...state.load, share } }), lean: (angle) => ({ tilt: angle * DEGREE }) };
    for (const [id, change] of Object.entries(set)) {
      for (const input of [find(id), find(`${id}-number`)]) input.addEventListener("input", () => {
        if (input.value === "" || !within(RANGES[id], +input.value)) return;
        update({ ...change(+input.value), moved: 0 });
        if (id === "lean") fit();
      });
      find(`${id}-number`).addEventListener("blur", () => update({}));
    }
    find("rough").addEventListener("change", (event) => update({ mu: event.target.checked ? Infinity : 0.7 }));
    find("structure").addEventListener("change", (event) => {
      if (event.target.value === "own") return;
      take(event.target.value);
      fit();
      update({});
    });
    find("fall").addEventListener("input", (event) => update({ moved: +event.target.value }));
    find("add").addEventListener("click", () => {
      const [x, y, side] = [box.low[0], box.size * 1.05 - box.high[1], box.size / 5];
      const corners = [[x, y], [x + side, y], [x + side, y + side / 2], [x, y + side / 2]];
      update({ name: null, blocks: [...state.blocks, { corners, fixed: false }], chosen: state.blocks.length, moved: 0 });
      fit();
    });
    find("remove").addEventListener("click", remove);
    find("fixed").addEventListener("change", (event) => {
      const blocks = state.blocks.map((block, i) => (i === state.chosen ? { ...block, fixed: event.target.checked } : block));
      update({ name: null, blocks, moved: 0, load: blocks[state.load.block].fixed ? top(blocks) ?? state.load : state.load });
    });
    find("keep").addEventListener("click", () =>
      exporting.hand(`data:application/json,${encodeURIComponent(JSON.stringify(structure()))}`, "blocks.json"));
    new ResizeObserver(() => picture.clientWidth && seen && here() && show()).observe(picture);
  }

  function remove() {
    const blocks = state.blocks.filter((_, i) => i !== state.chosen);
    if (!top(blocks)) return;
    const { block } = state.load;
    const load = block === state.chosen ? top(blocks) : { ...state.load, block: block - (block > state.chosen) };
    update({ name: null, blocks, load, chosen: null, moved: 0 });
  }

  /** Show this view or the map, as the address says. Returns whether it is this one. */
  function turn(event) {
    if (event && here() && !event.oldURL.includes("blocks=")) arches = new URL(event.oldURL).hash || "#";
    document.body.classList.toggle("own", here());
    find("to-map").href = arches;
    for (const [id, current] of [["to-map", !here()], ["to-own", here()]]) {
      if (current) find(id).setAttribute("aria-current", "page");
      else find(id).removeAttribute("aria-current");
    }
    if (!here()) return false;
    arrive();
    show();
    return true;
  }

  /** Go on with blocks from elsewhere. */
  function open(blocks, mu) {
    arches = location.hash || "#";
    location.hash = addressOf({ name: null, blocks, mu, load: top(blocks), tilt: 0, moved: 0 });
  }

  function start() {
    listen();
    turn();
  }

  return { start, turn, open, structure };
})();
