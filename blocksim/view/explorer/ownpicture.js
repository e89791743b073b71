"use strict";
/* Picture of any blocks: forces at joints, the mechanism and the load. In metres, y upwards, turned as the
   ground is tilted. */

const ownPicture = (() => {
  const { add, pathOf } = svg;
  const DEGREE = Math.PI / 180;
  const VERGE = 1e-7; // margin that hides in rounding
  const REACH = 0.08; // largest displacement drawn, and longest force, over the picture
  const TURNLESS = 1e-6; // rotation that counts as none, over that of the whole
  const FORCELESS = 1e-6; // of the largest force: not drawn
  const lineOf = (points) => pathOf(points, 6);

  function draw(picture, { state, seen, box, moving }) {
    const room = 0.16 * box.size;
    const size = [box.high[0] - box.low[0] + 2 * room, box.high[1] - box.low[1] + 2 * room];
    picture.replaceChildren();
    picture.setAttribute("viewBox", `${box.low[0] - room} ${box.low[1] - room} ${size.join(" ")}`);
    const pixel = Math.max(size[0] / picture.clientWidth, size[1] / picture.clientHeight);
    const turned = add(picture, "g", { id: "turned", transform: `rotate(${state.tilt / DEGREE}) scale(1 -1)` });
    const places = state.blocks.map(() => "");
    const turns = state.blocks.map(() => 0);
    const shift = REACH * box.size * state.moved;
    if (moving) seen.given.moving.forEach(({ i, centre: [x, y] }, at) => {
      const [u, v, turn] = moving.rates[at];
      // About the centre that the rates have: blocks that move as one stay together.
      turns[i] = Math.abs(turn) * box.size > TURNLESS ? (turn * shift) / DEGREE : 0;
      places[i] = turns[i]
        ? `rotate(${turns[i]} ${x - v / turn} ${y + u / turn})` : `translate(${u * shift} ${v * shift})`;
    });
    const wrong = new Set([...seen.overlaps.flat(), ...seen.loose]);
    state.blocks.forEach(({ corners, fixed }, i) => {
      const kind = `${fixed ? "abutment" : `stone shade-${i % 3}`}${i === state.chosen ? " chosen" : ""}${wrong.has(i) ? " amiss" : ""}`;
      add(turned, "path", { d: `${lineOf(corners)}Z`, class: kind, "data-block": i, transform: places[i] });
    });
    if (seen.rest?.margin > -VERGE) forces(turned, seen, box, 1 - 0.7 * state.moved);
    if (moving) blockwork.moves(seen.given, seen.joints, moving.rates).forEach(({ slides, hinge }, i) => {
      const { a, b, ends } = seen.joints[i];
      const transform = state.blocks[b].fixed ? places[a] : places[b];
      if (slides) add(turned, "path", { d: lineOf(ends), class: "slide", transform });
      if (hinge) add(turned, "circle", { cx: hinge[0], cy: hinge[1], r: 4.5 * pixel, class: "hinge", transform });
    });
    const chosen = state.blocks[state.chosen];
    chosen?.corners.forEach(([cx, cy], i) => add(turned, "circle", { cx, cy, r: 7 * pixel, class: "corner", "data-corner": i }));
    arrow(turned, pixel, state, places[state.load.block], turns[state.load.block]);
  }

  /** What joints carry: lines along the forces, as long and wide as these are large. */
  function forces(turned, seen, box, opacity) {
    const lines = add(turned, "g", { class: "forces", opacity });
    const sizes = seen.rest.forces.map(({ force }) => Math.hypot(...force));
    const most = Math.max(...sizes);
    seen.rest.forces.forEach(({ force, at }, i) => {
      if (!(sizes[i] > FORCELESS * most)) return;
      const half = force.map((value) => (value / most) * (REACH / 2) * box.size);
      const line = [-1, 1].map((side) => at.map((value, k) => value + side * half[k]));
      add(lines, "path", { d: lineOf(line), class: "thrust", "stroke-width": 1 + (3 * sizes[i]) / most });
    });
  }

  /** The load: an arrow that ends where it acts; it stays upright, as a weight does. */
  function arrow(turned, pixel, state, transform, turn) {
    const [x, y] = state.load.point;
    const high = 46 * pixel;
    const upright = `translate(${x} ${y}) rotate(${state.tilt / DEGREE - turn})`;
    const group = add(add(turned, "g", { transform }), "g", { class: "load", transform: upright, "data-load": "" });
    add(group, "path", { d: `M0 ${high}V${8 * pixel}`, "stroke-width": state.load.share ? 3 : 1.5 });
    add(group, "path", { d: `M0 0L${5 * pixel} ${10 * pixel}H${-5 * pixel}Z`, class: "head" });
    add(group, "rect", { x: -14 * pixel, y: -6 * pixel, width: 28 * pixel, height: high + 12 * pixel, class: "grip" });
  }

  return { draw, VERGE };
})();
