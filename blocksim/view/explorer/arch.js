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

  const at = (angle, radius) => [SCALE * radius * Math.sin(angle), -SCALE * radius * Math.cos(angle)];

  function ring(from, to, inner, outer) {
    const steps = Math.max(2, Math.ceil((from - to) / 0.02));
    const angles = Array.from({ length: steps + 1 }, (_, i) => to + ((from - to) * i) / steps);
    return pathOf([...angles.map((a) => at(a, outer)), ...angles.reverse().map((a) => at(a, inner))]) + "Z";
  }

  /** Draw an arch. Returns a function that moves its pieces, by a share of `amount` at the
      springing, 0 for one that stands. */
  function draw(picture, { state, voussoirs, balance, joints, amount, reach }) {
    const { halfAngle, eta, mu, weight } = state;
    const faces = amount ? mechanism.pieces(joints) : [[halfAngle, 0]];
    const [inner, outer] = [1 - eta / 2, 1 + eta / 2];
    picture.replaceChildren();
    const pixel = fit(picture, halfAngle, inner, outer, reach);
    const below = Math.min(SPRINGING * Math.min(halfAngle, 1), (Math.PI - halfAngle) * 0.7);
    const halves = [1, -1].map((side) => add(picture, "g", { transform: `scale(${side} 1)` }));
    for (const half of halves) {
      const abutment = ring(halfAngle + below, halfAngle, Math.max(inner - below / 3, 0), outer + below / 3);
      add(half, "path", { d: abutment, class: "abutment" });
    }
    if (amount) add(picture, "path", { d: ring(halfAngle, -halfAngle, inner, outer), class: "ghost" });
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

  /** Fit the picture to the arch and its motion. Returns the size of a pixel. */
  function fit(picture, halfAngle, inner, outer, reach) {
    const wide = halfAngle > Math.PI / 2 ? outer : outer * Math.sin(halfAngle);
    const low = Math.min(inner * Math.cos(halfAngle), outer * Math.cos(halfAngle));
    const rim = SCALE * (0.06 + reach);
    const [x, y] = [SCALE * (wide + 0.04) + rim, SCALE * outer + rim * 0.6];
    const [width, height] = [2 * x, y - SCALE * low + rim];
    picture.setAttribute("viewBox", `${-x} ${-y} ${width} ${height}`);
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

  return { draw, blocks };
})();
