"use strict";
/* Pictures as SVG: the map, and one arch with its lines and its mechanism. */

const draw = (() => {
  const SVG = "http://www.w3.org/2000/svg";
  const SCALE = 100; // units of the arch's picture in a mean radius
  const SPACING = 0.13; // of the joints drawn for the eye [rad]
  const SPRINGING = 0.1; // of the abutments drawn [rad]
  const OUTSIDE = 2.4; // how far out of the arch, in half thicknesses, lines are drawn
  const FORCELESS = 1e-9;
  const SAMPLES = 240;
  const LABEL_HEIGHT = 10; // pixels

  function add(parent, name, attributes = {}, text = null) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== null) element.textContent = text;
    parent.append(element);
    return element;
  }

  const pathOf = (points) => "M" + points.map((p) => p.map((v) => +v.toFixed(2)).join(" ")).join("L");

  /* Shapes of points, so that colour never stands alone; of radius 1. */
  const regular = (corners, radius, turn) =>
    pathOf(Array.from({ length: corners }, (_, i) => {
      const angle = turn + (2 * Math.PI * i) / corners;
      return [radius * Math.sin(angle), -radius * Math.cos(angle)];
    })) + "Z";
  const CROSS = "M-.35-1H.35V-.35H1V.35H.35V1H-.35V.35H-1V-.35H-.35Z";
  const MARKERS = {
    o: regular(24, 1, 0), s: regular(4, 1.2, Math.PI / 4), D: regular(4, 1.2, 0),
    "^": regular(3, 1.3, 0), v: regular(3, 1.3, Math.PI), P: CROSS, X: CROSS, "*": regular(5, 1.2, 0),
  };

  function marker(parent, style, x, y, size, attributes = {}) {
    const turn = style.marker === "X" ? " rotate(45)" : "";
    return add(parent, "path", {
      d: MARKERS[style.marker], transform: `translate(${x} ${y})${turn} scale(${size})`,
      style: `--colour:${style.colour}`, class: "marker", ...attributes,
    });
  }

  /** Places on the map's picture: friction to the right with a strip for mu = infinity, eta up. */
  function mapFrame(width, largestMu) {
    const narrow = width < 480;
    const height = Math.round(Math.min(width * (narrow ? 1.05 : 0.8), 560));
    const [left, top, bottom, gap, strip, right] = [narrow ? 38 : 48, 10, 40, 8, narrow ? 22 : 32, 36];
    const across = width - left - gap - strip - right;
    const up = height - top - bottom;
    const stripLeft = left + across + gap;
    return {
      width, height, left, top, across, up, strip, stripLeft, narrow,
      x: (mu) =>
        mu === Infinity ? stripLeft + strip / 2 : left + (across * Math.min(mu, largestMu)) / largestMu,
      y: (eta) => top + up * (1 - eta / 2),
      mu: (x) => (x > left + across + gap / 2 ? Infinity : ((x - left) / across) * largestMu),
      eta: (y) => 2 * (1 - (y - top) / up),
    };
  }

  /** The map without what changes: regions, lines, axes. Returns groups, under and over the names,
      for what does. */
  function mapBase(svg, frame, map, data) {
    const { x, y, left, top, across, up, strip, stripLeft } = frame;
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${frame.width} ${frame.height}`);
    const place = ([mu, eta]) => [x(mu), y(eta)];
    const clip = add(add(svg, "defs"), "clipPath", { id: "map-clip" });
    add(clip, "rect", { x: left, y: top, width: across, height: up });
    add(clip, "rect", { x: stripLeft, y: top, width: strip, height: up });

    const inside = add(svg, "g", { "clip-path": "url(#map-clip)" });
    const modeStyle = (mode) => `--colour:${data.modes[mode].colour};--tint:${data.modes[mode].tint}`;
    for (const { mode, points } of map.regions) {
      add(inside, "path", { d: pathOf(points.map(place)) + "Z", class: "region", style: modeStyle(mode) });
    }
    for (const [mode, from, to] of [["rrr", 0, map.overturning], ["r", map.overturning, 2]]) {
      add(inside, "rect", {
        x: stripLeft, y: y(to), width: strip, height: y(from) - y(to), class: "region", style: modeStyle(mode),
      });
    }
    let labelled = Infinity;
    for (const { degrees, points, unbounded } of map.iso) {
      if (points.length) add(inside, "path", { d: pathOf(points.map(place)), class: "iso" });
      const level = y(unbounded);
      add(inside, "path", { d: `M${stripLeft} ${level}H${stripLeft + strip}`, class: "iso" });
      if (labelled - level < LABEL_HEIGHT) continue;
      add(svg, "text", { x: stripLeft + strip + 3, y: level + 4, class: "iso-label" }, `${degrees}°`);
      labelled = level;
    }
    for (const { name, points } of map.lines) {
      add(inside, "path", { d: pathOf(points.map(place)), class: `border ${name}` });
    }
    add(inside, "path", { d: `M${stripLeft} ${y(map.overturning)}H${stripLeft + strip}`, class: "border" });

    axes(svg, frame, data.largestMu);
    const under = add(svg, "g", { "clip-path": "url(#map-clip)" });
    for (const { mode, mu, eta, target } of map.labels) {
      const here = mu === null ? Infinity : mu;
      if (target) {
        add(svg, "path", { d: pathOf([place(target), [x(here), y(eta)]]), class: "leader", style: modeStyle(mode) });
      }
      add(svg, "text", { x: x(here), y: y(eta) + (target ? -4 : 5), class: "region-label", style: modeStyle(mode) }, mode);
    }
    for (const { name, mu, eta, shift } of map.landmarks) {
      add(svg, "circle", { cx: x(mu), cy: y(eta), r: 3, class: "landmark" });
      add(svg, "text", { x: x(mu) + shift[0], y: y(eta) - shift[1], class: "landmark-label" }, name);
    }
    return { under, over: add(svg, "g") };
  }

  function axes(svg, { x, y, left, top, across, up, strip, stripLeft, narrow }, largestMu) {
    add(svg, "rect", { x: left, y: top, width: across, height: up, class: "frame" });
    add(svg, "rect", { x: stripLeft, y: top, width: strip, height: up, class: "frame" });
    for (let mu = 0; mu <= largestMu; mu++) {
      add(svg, "path", { d: `M${x(mu)} ${top + up}v4`, class: "tick" });
      add(svg, "text", { x: x(mu), y: top + up + 17, class: "tick-label middle" }, mu);
    }
    add(svg, "text", { x: x(Infinity), y: top + up + 17, class: "tick-label middle" }, "∞");
    for (let eta = 0; eta <= 2; eta += 0.5) {
      add(svg, "path", { d: `M${left} ${y(eta)}h-4`, class: "tick" });
      add(svg, "text", { x: left - 7, y: y(eta) + 4, class: "tick-label end" }, eta);
    }
    const middle = left + across / 2;
    add(svg, "text", { x: middle, y: top + up + 34, class: "axis-label middle" }, "friction coefficient μ");
    const side = `translate(${narrow ? 10 : 14} ${top + up / 2}) rotate(-90)`;
    add(svg, "text", { transform: side, class: "axis-label middle" }, "thickness over radius η");
  }

  /** What changes on the map: results, the line of equal half-angle, the point looked at. */
  function mapPoint(layer, frame, { state, critical, verdict, iso, results, data }) {
    const { x, y } = frame;
    layer.under.replaceChildren();
    layer.over.replaceChildren();
    add(layer.under, "path", { d: pathOf(iso.map(([mu, eta]) => [x(mu), y(eta)])), class: "iso-here" });
    const [atX, atY] = [x(state.mu), y(state.eta)];
    if (state.mu === Infinity && critical.eta !== null) {
      const half = frame.strip / 2;
      add(layer.under, "path", { d: `M${atX - half} ${y(critical.eta)}h${2 * half}`, class: "iso-here" });
    }
    for (const row of results) {
      const style = row.mode ? data.modes[row.mode] : data.unnamed;
      const [px, py] = [x(row.place), y(row.eta)];
      if (row.miss) add(layer.over, "circle", { cx: px, cy: py, r: 9, class: "miss" });
      marker(layer.over, style, px, py, 4.5);
    }
    if (critical.eta !== null) {
      add(layer.over, "path", { d: `M${atX} ${atY}V${y(critical.eta)}`, class: "reserve" });
    }
    const handle = add(layer.over, "g", { class: `handle ${verdict}` });
    add(handle, "circle", { cx: atX, cy: atY, r: 20, class: "grip" });
    add(handle, "circle", { cx: atX, cy: atY, r: 8, class: "halo" });
    add(handle, "circle", { cx: atX, cy: atY, r: 8, class: "ring" });
    add(handle, "circle", { cx: atX, cy: atY, r: 2, class: "dot" });
  }

  /* The arch. Angles from the crown to the right; the picture's y points down. */
  const at = (angle, radius) => [SCALE * radius * Math.sin(angle), -SCALE * radius * Math.cos(angle)];

  function ring(from, to, inner, outer) {
    const steps = Math.max(2, Math.ceil((from - to) / 0.02));
    const angles = Array.from({ length: steps + 1 }, (_, i) => to + ((from - to) * i) / steps);
    return pathOf([...angles.map((a) => at(a, outer)), ...angles.reverse().map((a) => at(a, inner))]) + "Z";
  }

  /** Draw an arch. Returns a function that moves its pieces, by a share of `amount` at the
      springing, 0 for one that stands. */
  function arch(svg, { state, balance, joints, amount, reach }) {
    const { halfAngle, eta, mu, weight } = state;
    const [inner, outer] = [1 - eta / 2, 1 + eta / 2];
    svg.replaceChildren();
    const pixel = fit(svg, halfAngle, inner, outer, reach);
    const below = Math.min(SPRINGING, (Math.PI - halfAngle) * 0.7);
    const halves = [1, -1].map((side) => add(svg, "g", { transform: `scale(${side} 1)` }));
    for (const half of halves) {
      const abutment = ring(halfAngle + below, halfAngle, Math.max(inner - 0.03, 0), outer + 0.03);
      add(half, "path", { d: abutment, class: "abutment" });
    }
    if (amount) add(svg, "path", { d: ring(halfAngle, -halfAngle, inner, outer), class: "ghost" });
    const groups = halves.map((half) =>
      mechanism.pieces(joints).map((faces) => stones(add(half, "g"), faces, halfAngle, inner, outer)));
    const lines = add(svg, "g");
    forces(lines, { halfAngle, eta, mu, weight, balance });
    const marks = halves.map((_, side) =>
      mechanism.pieces(joints).map(() => add(svg, "g", { class: "marks", "data-side": side })));
    const still = halves.map((_, side) => add(svg, "g", { transform: `scale(${side ? -1 : 1} 1)` }));
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
      lines.setAttribute("opacity", 1 - 0.6 * share);
      const { motions } = mechanism.pose(joints, eta, share * amount);
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
  function fit(svg, halfAngle, inner, outer, reach) {
    const wide = halfAngle > Math.PI / 2 ? outer : outer * Math.sin(halfAngle);
    const low = Math.min(inner * Math.cos(halfAngle), outer * Math.cos(halfAngle));
    const rim = SCALE * (0.06 + reach);
    const [x, y] = [SCALE * (wide + 0.04) + rim, SCALE * outer + rim * 0.6];
    const [width, height] = [2 * x, y - SCALE * low + rim];
    svg.setAttribute("viewBox", `${-x} ${-y} ${width} ${height}`);
    return Math.max(width / svg.clientWidth, height / svg.clientHeight);
  }

  /** Voussoirs for the eye: the theory has a joint at every angle. */
  function stones(group, [lower, upper], halfAngle, inner, outer) {
    const count = Math.max(1, Math.round((lower - upper) / SPACING));
    for (let i = 0; i < count; i++) {
      const [from, to] = [lower - ((lower - upper) * i) / count, lower - ((lower - upper) * (i + 1)) / count];
      const shade = Math.round((from / halfAngle) * 37) % 3;
      add(group, "path", { d: ring(from, to, inner, outer), class: `stone shade-${shade}` });
    }
    return group;
  }

  /** Hinges as dots at the edge that stays closed, sliding joints as bars across. */
  function mark(group, { angle, kind }, inner, outer, pixel) {
    if (kind === "out" || kind === "in") {
      const d = pathOf([at(angle, inner), at(angle, outer)]);
      add(group, "path", { d, class: "slide" });
      add(group, "path", { d, class: "slide-core" });
    } else if (kind !== "parts") {
      const [cx, cy] = at(angle, kind === "extrados" ? outer : inner);
      add(group, "circle", { cx, cy, r: 5 * pixel, class: "hinge" });
    }
  }

  function forces(svg, { halfAngle, eta, mu, weight, balance }) {
    if (!balance) return;
    const { thrust, crownMoment } = balance;
    const level = theory.levelOf(eta, weight);
    const shown = (line) => {
      const points = [];
      for (let i = -SAMPLES; i <= SAMPLES; i++) {
        const angle = (halfAngle * i) / SAMPLES;
        // An overturning arch has no thrust: at its crown the lines have no place.
        if (theory.normalForce(Math.abs(angle), thrust) < FORCELESS) continue;
        const place = Math.min(OUTSIDE, Math.max(-OUTSIDE, line(Math.abs(angle))));
        points.push(at(angle, 1 - (place * eta) / 2));
      }
      return pathOf(points);
    };
    add(svg, "path", { d: shown((a) => theory.frictionLine(a, thrust, mu)), class: "friction" });
    add(svg, "path", { d: shown((a) => theory.thrustLine(a, thrust, crownMoment, eta, level)), class: "thrust" });
  }

  return { add, marker, mapFrame, mapBase, mapPoint, arch };
})();
