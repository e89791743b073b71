"use strict";
/* Picture of an arch, its lines and its mechanism. Angles from the crown to the right; the picture's
   y points down. */

const archPicture = (() => {
  const { add, pathOf } = svg;
  const SCALE = 100; // units of the picture in a mean radius
  const SPACING = 0.13; // of the joints drawn for the eye [rad]
  const SPRINGING = 0.1; // of the abutments drawn [rad]
  const OUTSIDE = 2.4; // how far out of the arch, in half thicknesses, lines are drawn
  const FORCELESS = 1e-9;
  const SAMPLES = 240;
  const SLIVER = 1e-9; // angle that no voussoir is thinner than
  const [SHORTEST, LONGER, MIDDLING] = [0.14, 0.5, 0.1]; // lengths of an arrow over r, and the load in the middle between them
  const [EDGE, MOST] = [0.99, 10]; // farthest from the crown over half the width, and largest load
  const FRESH = 0.05; // load, and fill over r, as they come from the corner
  const TURNLESS = 1e-6; // rate of rotation that counts as none
  const VERGE = 1e-7; // margin that hides in rounding

  const at = (angle, radius) => [SCALE * radius * Math.sin(angle), -SCALE * radius * Math.cos(angle)];

  function ring(from, to, inner, outer) {
    const steps = Math.max(2, Math.ceil((from - to) / 0.02));
    const angles = Array.from({ length: steps + 1 }, (_, i) => to + ((from - to) * i) / steps);
    return pathOf([...angles.map((a) => at(a, outer)), ...angles.reverse().map((a) => at(a, inner))]) + "Z";
  }

  /** Draw an arch, and what is laid on it. Returns a function that moves its pieces, by a share of
      `amount` at the springing, 0 for one that stands. */
  function draw(picture, looks) {
    const { state, amount, reach } = looks;
    const { halfAngle, eta } = state;
    const [inner, outer] = [1 - eta / 2, 1 + eta / 2];
    picture.replaceChildren();
    const pixel = fit(picture, state, inner, outer, reach);
    if (state.fill) add(picture, "path", { d: above(state, outer), class: "fill" });
    const below = Math.min(SPRINGING * Math.min(halfAngle, 1), (Math.PI - halfAngle) * 0.7);
    const halves = [1, -1].map((side) => add(picture, "g", { transform: `scale(${side} 1)` }));
    for (const half of halves) {
      const abutment = ring(halfAngle + below, halfAngle, Math.max(inner - below / 3, 0), outer + below / 3);
      add(half, "path", { d: abutment, class: "abutment" });
    }
    if (amount) add(picture, "path", { d: ring(halfAngle, -halfAngle, inner, outer), class: "ghost" });
    const pose = looks.loaded ? pieces(picture, looks, inner, outer, pixel) : mirrored(picture, halves, looks, inner, outer, pixel);
    handles(picture, state, outer, pixel);
    return pose;
  }

  /** Draw the halves of an arch under its own weight, which move alike. */
  function mirrored(picture, halves, { state, voussoirs, balance, joints, amount }, inner, outer, pixel) {
    const { halfAngle, eta, mu, weight } = state;
    const faces = amount ? mechanism.pieces(joints) : [[halfAngle, 0]];
    const groups = halves.map((half, side) => faces.map((piece) =>
      stones(add(half, "g"), voussoirs ? cut(piece, halfAngle, voussoirs, side) : forTheEye(piece, halfAngle), inner, outer)));
    const lines = add(picture, "g");
    forces(lines, { halfAngle, eta, mu, weight, voussoirs, balance });
    const marks = halves.map((_, side) =>
      faces.map(() => add(picture, "g", { class: "marks", "data-side": side })));
    const still = halves.map((_, side) => add(picture, "g", { transform: `scale(${side ? -1 : 1} 1)` }));
    if (amount) {
      joints.forEach((joint, i) => {
        for (const side of [0, 1]) {
          if (side && joint.angle === 0) continue;
          mark(i === 0 ? still[side] : marks[side][i - 1], joint, inner, outer, pixel);
        }
      });
    }
    return (share) => {
      // The lines belong to the arch at rest.
      lines.setAttribute("opacity", amount ? 1 - 0.6 * share : 1);
      const { motions } = amount ? mechanism.pose(joints, eta, share * amount) : { motions: [] };
      motions.forEach((motion, i) => {
        const [c, s] = [Math.cos(motion.turn), Math.sin(motion.turn)];
        const matrix = `matrix(${c} ${s} ${-s} ${c} ${SCALE * motion.x} ${-SCALE * motion.y})`;
        groups.forEach((half, side) => {
          half[i].setAttribute("transform", matrix);
          marks[side][i].setAttribute("transform", (side ? "scale(-1 1) " : "") + matrix);
        });
      });
    };
  }

  /** Draw voussoirs of a loaded arch, each of which moves on its own. */
  function pieces(picture, { loaded: { rest, falls, angles }, amount }, inner, outer, pixel) {
    const groups = angles.slice(1).map((to, i) => {
      const group = add(picture, "g");
      add(group, "path", { d: ring(to, angles[i], inner, outer), class: `stone shade-${i % 3}` });
      return group;
    });
    const line = add(picture, "path", { d: pathOf(rest.margin > -VERGE ? rest.line.map(({ angle, radius }) => at(angle, radius)) : []), class: "thrust" });
    const marks = amount ? falls.joints.map((joint) => {
      const group = add(picture, "g");
      mark(group, joint, inner, outer, pixel);
      return { group, piece: joint.joint - 1 };
    }) : [];
    return (share) => {
      line.setAttribute("opacity", amount ? 1 - 0.6 * share : 1);
      const places = groups.map((_, i) => (amount ? turned(falls.motions[i], share * amount) : ""));
      groups.forEach((group, i) => group.setAttribute("transform", places[i]));
      marks.forEach(({ group, piece }) => group.setAttribute("transform", places[piece] ?? ""));
    };
  }

  /** A motion about the centre that its rates have. */
  function turned([x, y, turn], amount) {
    if (Math.abs(turn) < TURNLESS) return `translate(${SCALE * x * amount} ${-SCALE * y * amount})`;
    return `rotate(${(-turn * amount * 180) / Math.PI} ${(-SCALE * y) / turn} ${(-SCALE * x) / turn})`;
  }

  /** Fill from the extrados to the road. */
  function above({ halfAngle, fill }, outer) {
    const angles = Array.from({ length: SAMPLES + 1 }, (_, i) => halfAngle * ((2 * i) / SAMPLES - 1));
    const [[x]] = [at(halfAngle, outer)];
    const road = -SCALE * (outer + fill);
    return pathOf([...angles.map((angle) => at(angle, outer)), [x, road], [-x, road]]) + "Z";
  }

  /** Where a load acts and where its arrow begins, over r, y upwards. */
  function arrowOf({ load, ...arch }, voussoirs, outer) {
    const x = load.place * loaded.widthOf(arch, voussoirs);
    const y = Math.sqrt(Math.max(0, outer ** 2 - x ** 2));
    return { x, y, high: SHORTEST + (LONGER * load.share) / (load.share + MIDDLING) };
  }

  /** What may be dragged: the load and the road of the fill, or in a corner what they are dragged from. */
  function handles(picture, state, outer, pixel) {
    const { width, height, x: left, y: top } = picture.viewBox.baseVal;
    const [x0, y0] = [left + (width - pixel * picture.clientWidth) / 2, top + (height - pixel * picture.clientHeight) / 2];
    const handle = (kind, x, y) => add(picture, "g", { class: `lay ${kind}`, "data-lay": kind, transform: `translate(${x} ${y})` });
    const grip = (group, [x, y, wide, high]) => add(group, "rect", { x, y, width: wide, height: high, class: "grip" });
    const arrow = (group, high, words, aside = 1) => {
      add(group, "path", { d: `M0 ${-high}V${-8 * pixel}` });
      add(group, "path", { d: `M0 0L${5 * pixel} ${-10 * pixel}H${-5 * pixel}Z`, class: "head" });
      const text = { x: aside * 8 * pixel, y: -high + 10 * pixel, "font-size": 13 * pixel, "text-anchor": aside > 0 ? "start" : "end" };
      add(group, "text", text, words);
      grip(group, [-14 * pixel, -high - 6 * pixel, 28 * pixel, high + 12 * pixel]);
    };
    if (state.load) {
      const { x, y, high } = arrowOf(state, state.voussoirs, outer);
      arrow(handle("load", SCALE * x, -SCALE * y), SCALE * high, `${+(100 * state.load.share).toPrecision(3)} %`, x > 0 ? -1 : 1);
    } else arrow(handle("load idle", x0 + 20 * pixel, y0 + 44 * pixel), 34 * pixel, "load");
    if (!loaded.takesFill(state.halfAngle)) return;
    const road = (group, wide, words) => {
      add(group, "path", { d: `M${-wide} 0H${wide}` });
      if (words) add(group, "text", { x: -wide, y: 16 * pixel, "font-size": 13 * pixel }, words);
      grip(group, [-wide - 6 * pixel, -14 * pixel, 2 * wide + 12 * pixel, 34 * pixel]);
    };
    if (state.fill) road(handle("fill-road", 0, -SCALE * (outer + state.fill)), SCALE * outer * Math.sin(state.halfAngle), "");
    else road(handle("fill-road idle", x0 + 24 * pixel, y0 + 62 * pixel), 16 * pixel, "fill");
  }

  /** Lay a load or fill by dragging, with a mouse or a finger; `get` tells the state, `change` it. */
  function listen(picture, get, change) {
    let drag = null;
    const wide = () => loaded.widthOf(get(), get().voussoirs);
    const outer = () => 1 + get().eta / 2;
    const beside = (x) => Math.abs(x) > 1.05 * wide();
    /** The load whose arrow begins here; beside the arch or beneath it none. */
    const load = ([x, y]) => {
      const place = Math.min(EDGE, Math.max(-EDGE, x / wide()));
      const high = y - Math.sqrt(Math.max(0, outer() ** 2 - (place * wide()) ** 2));
      if (beside(x) || high < 0) return { load: null };
      const share = Math.min(1, Math.max(0, (high - SHORTEST) / LONGER));
      return { load: { place, share: Math.min(MOST, (MIDDLING * share) / (1 - share)) } };
    };
    const fill = ([, y]) => ({ fill: Math.min(1, Math.max(0, y - outer())) });
    /** What comes from the corner has a size until it is dropped. */
    const fresh = {
      load: ([x]) => ({ load: beside(x) ? null : { place: Math.min(EDGE, Math.max(-EDGE, x / wide())), share: FRESH } }),
      "fill-road": ([x, y]) => ({ fill: beside(x) ? 0 : Math.min(1, Math.max(FRESH, y - outer())) }),
    };
    const tailOf = (state) => {
      const { x, y, high } = arrowOf(state, state.voussoirs, outer());
      return [x, y + high];
    };
    picture.addEventListener("pointerdown", (event) => {
      const [kind, idle] = event.target.closest("[data-lay]")?.dataset.lay.split(" ") ?? [];
      if (!kind || event.button !== 0) return;
      // The words above may change their height: places are those of the picture as it was grasped.
      const matrix = picture.getScreenCTM().inverse();
      const placeOf = ({ clientX, clientY }) => {
        const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix);
        return [x / SCALE, -y / SCALE];
      };
      const start = placeOf(event);
      const from = idle ? start : kind === "load" ? tailOf(get()) : [0, outer() + get().fill];
      const lay = idle ? fresh[kind] : kind === "load" ? load : fill;
      drag = (moved) => lay(placeOf(moved).map((value, i) => value + from[i] - start[i]));
      picture.dataset.held = "";
      picture.setPointerCapture(event.pointerId);
    });
    picture.addEventListener("pointermove", (event) => drag && change(drag(event)));
    for (const end of ["pointerup", "pointercancel"]) picture.addEventListener(end, () => {
      if (!drag) return;
      drag = null;
      delete picture.dataset.held;
      change({});
    });
    // A load follows a finger; beside it the finger scrolls the page.
    picture.addEventListener("touchstart", (event) => {
      if (event.target.closest("[data-lay]")) event.preventDefault();
    }, { passive: false });
  }

  /** Fit the picture to the arch, its motion and what lies on it. Returns the size of a pixel. */
  function fit(picture, state, inner, outer, reach) {
    const { halfAngle, fill, load } = state;
    const wide = halfAngle > Math.PI / 2 ? outer : outer * Math.sin(halfAngle);
    const low = Math.min(inner * Math.cos(halfAngle), outer * Math.cos(halfAngle));
    const rim = SCALE * (0.06 + reach);
    const arrow = load ? arrowOf(state, state.voussoirs, outer) : { y: 0, high: 0 };
    const high = Math.max(outer + fill, arrow.y + arrow.high);
    const [x, y] = [SCALE * (wide + 0.04) + rim, SCALE * high + rim * 0.6];
    // While something is dragged the picture stays as it is.
    if (picture.dataset.held === undefined) picture.setAttribute("viewBox", `${-x} ${-y} ${2 * x} ${y - SCALE * low + rim}`);
    const { width, height } = picture.viewBox.baseVal;
    return Math.max(width / picture.clientWidth, height / picture.clientHeight);
  }

  /** Voussoirs for the eye: the theory has a joint at every angle. */
  function forTheEye([lower, upper], halfAngle) {
    const count = Math.max(1, Math.round((lower - upper) / SPACING));
    return Array.from({ length: count }, (_, i) => {
      const [from, to] = [lower - ((lower - upper) * i) / count, lower - ((lower - upper) * (i + 1)) / count];
      return { from, to, shade: Math.round((from / halfAngle) * 37) % 3 };
    });
  }

  /** Voussoirs as built; the keystone of an odd number is whole, on the right half. */
  function cut([lower, upper], halfAngle, voussoirs, side) {
    const joints = theory.jointAngles(halfAngle, voussoirs).reverse();
    if (voussoirs % 2) joints.push(-joints.at(-1));
    const found = [];
    for (let i = 0; i + 1 < joints.length; i++) {
      const [from, to] = [joints[i], joints[i + 1]];
      const within = from <= lower + SLIVER && (from + to) / 2 >= upper - SLIVER;
      if (within && !(side && to < 0)) found.push({ from, to, shade: i % 3 });
    }
    return found;
  }

  function stones(group, voussoirs, inner, outer) {
    for (const { from, to, shade } of voussoirs) {
      add(group, "path", { d: ring(from, to, inner, outer), class: `stone shade-${shade}` });
    }
    return group;
  }

  /** Hinges as dots at the edge that stays closed, sliding joints as bars across. */
  function mark(group, { angle, kind }, inner, outer, pixel) {
    if (kind === "out" || kind === "in") {
      const d = pathOf([at(angle, inner), at(angle, outer)]);
      add(group, "path", { d, class: "slide slides" });
    } else if (kind !== "parts") {
      const [cx, cy] = at(angle, kind === "extrados" ? outer : inner);
      add(group, "circle", { cx, cy, r: 5 * pixel, class: `hinge hinge-${kind}` });
    }
  }

  /** Lines of thrust and friction: anywhere, or from joint to joint of voussoirs as built. */
  function forces(lines, { halfAngle, eta, mu, weight, voussoirs, balance }) {
    if (!balance) return;
    const { thrust, crownMoment } = balance;
    const level = theory.levelOf(eta, weight);
    const half = voussoirs
      ? theory.jointAngles(halfAngle, voussoirs)
      : Array.from({ length: SAMPLES + 1 }, (_, i) => (halfAngle * i) / SAMPLES);
    const angles = [...half.map((angle) => -angle).reverse(), ...(half[0] === 0 ? half.slice(1) : half)];
    const shown = (line) => {
      const points = [];
      for (const angle of angles) {
        // An overturning arch has no thrust: at its crown the lines have no place.
        if (theory.normalForce(Math.abs(angle), thrust) < FORCELESS) continue;
        const place = Math.min(OUTSIDE, Math.max(-OUTSIDE, line(Math.abs(angle))));
        points.push(at(angle, 1 - (place * eta) / 2));
      }
      return pathOf(points);
    };
    add(lines, "path", { d: shown((a) => theory.frictionLine(a, thrust, mu)), class: "friction" });
    add(lines, "path", { d: shown((a) => theory.thrustLine(a, thrust, crownMoment, eta, level)), class: "thrust" });
  }

  /** An arch of n voussoirs with straight faces as any blocks, between fixed abutments. */
  function blocks({ halfAngle, eta }, voussoirs) {
    const [inner, outer] = [1 - eta / 2, 1 + eta / 2];
    const place = (angle, radius, beyond = 0) =>
      [radius * Math.sin(angle) + beyond * Math.cos(angle), radius * Math.cos(angle) - beyond * Math.sin(angle)];
    const faces = Array.from({ length: voussoirs + 1 }, (_, i) => {
      const angle = halfAngle * ((2 * i) / voussoirs - 1);
      return [place(angle, inner), place(angle, outer)];
    });
    const stones = faces.slice(1).map((face, i) => [face[0], face[1], faces[i][1], faces[i][0]]);
    const abutments = [-1, 1].map((side) => {
      const [near, far] = [0, side * SPRINGING].map((beyond) => [inner, outer].map((radius) => place(side * halfAngle, radius, beyond)));
      return side > 0 ? [far[0], far[1], near[1], near[0]] : [near[0], near[1], far[1], far[0]];
    });
    return [...stones.map((corners) => ({ corners, fixed: false })), ...abutments.map((corners) => ({ corners, fixed: true }))];
  }

  return { draw, blocks, listen };
})();
