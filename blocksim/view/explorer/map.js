"use strict";
/* Picture of the map: friction to the right, with a strip for unbounded friction, thickness up. */

const mapPicture = (() => {
  const { add, pathOf, marker } = svg;
  const LABEL_HEIGHT = 10; // pixels
  const NAME = [15, 8]; // pixels to the sides of a region's name and above its middle
  const MARK = 6; // pixels around an arch
  const AWAY = 46; // pixels from a region too thin for its name to the name
  const EDGE = 24; // pixels that names keep from the frame
  const VIEWS = {
    whole: { mu: [0, 4], eta: [0, 2] },
    middle: { mu: [1.2, 2.4], eta: [0.6, 1.2] }, // Fig. 11
    thin: { mu: [0, 1], eta: [0, 0.25] },
  };

  const MOST = 16; // times that the map is enlarged

  /** The part of the map that a view shows: one with a name, or "least mu,most mu,least eta,most eta". */
  function boxOf(view) {
    if (VIEWS[view]) return VIEWS[view];
    const ends = view.split(",").map(Number);
    if (ends.length !== 4 || ends.some((end) => !(end >= 0 && end <= 4))) return null;
    const box = { mu: ends.slice(0, 2), eta: ends.slice(2) };
    const wide = ([least, most], all) => most - least > 0.99 * all / MOST && most <= all;
    return wide(box.mu, 4) && wide(box.eta, 2) ? box : null;
  }

  /** The view that shows a part of the map `times` as large, or shifted, kept on the map.
      A point stays where it is seen: `mu` and `eta`, at shares of the picture. */
  function viewAround({ mu, eta }, [acrossShare, upShare], per) {
    const part = (all, value, share) => {
      const size = Math.min(all, Math.max(all / MOST, all * per));
      const least = Math.min(all - size, Math.max(0, value - share * size));
      return [least, least + size].map((end) => +end.toFixed(6));
    };
    const [friction, thickness] = [part(4, mu, acrossShare), part(2, eta, upShare)];
    if (friction[1] - friction[0] > 3.999) return "whole";
    return [...friction, ...thickness].join(",");
  }

  /** Places on a picture of this width, and what lies there. */
  function frameOf(width, view, tallest) {
    const narrow = width < 480;
    const height = Math.round(Math.min(width * (narrow ? 1.05 : 0.8), tallest));
    const [left, top, bottom, gap, strip, right] = [narrow ? 48 : 52, 10, 46, 8, narrow ? 22 : 32, 50];
    const across = width - left - gap - strip - right;
    const up = height - top - bottom;
    const stripLeft = left + across + gap;
    const box = boxOf(view) ?? VIEWS.whole;
    const { mu: [leastMu, mostMu], eta: [leastEta, mostEta] } = box;
    const [perMu, perEta] = [across / (mostMu - leastMu), up / (mostEta - leastEta)];
    return {
      width, height, left, top, across, up, strip, stripLeft, narrow, ...box,
      x: (mu) => (mu === Infinity ? stripLeft + strip / 2 : left + (mu - leastMu) * perMu),
      y: (eta) => top + up - (eta - leastEta) * perEta,
      muAt: (x) => (x > left + across + gap / 2 ? Infinity : leastMu + (x - left) / perMu),
      etaAt: (y) => leastEta + (top + up - y) / perEta,
      shows: (mu, eta) => (mu === Infinity || (mu >= leastMu && mu <= mostMu)) && eta >= leastEta && eta <= mostEta,
    };
  }

  /** The map without what changes: regions, lines, axes. Returns groups, under and over the names,
      for what does. */
  function drawBase(picture, frame, map, modes, results) {
    const { x, y, left, top, across, up, strip, stripLeft } = frame;
    picture.replaceChildren();
    picture.setAttribute("viewBox", `0 0 ${frame.width} ${frame.height}`);
    const inside = clipped(picture, "map-clip", { x: left, y: top, width: across, height: up });
    const atInfinity = clipped(picture, "strip-clip", { x: stripLeft, y: top, width: strip, height: up });
    const line = (points) => pathOf(points.map(([mu, eta]) => [x(mu), y(eta)]));
    const style = (mode) => `--colour:${modes[mode].colour};--tint:${modes[mode].tint}`;
    const overStrip = (eta) => `M${stripLeft} ${y(eta)}h${strip}`;

    for (const region of map.regions) {
      const [floor, ceiling] = [region.bottom, region.top].map((edge) => edge.map((eta, i) => [region.mu[i], eta]));
      add(inside, "path", { d: line([...floor, ...ceiling.reverse()]) + "Z", class: "region", style: style(region.mode) });
    }
    for (const [mode, from, to] of [["rrr", 0, map.overturning], ["r", map.overturning, 2]]) {
      const box = { x: stripLeft, y: y(to), width: strip, height: y(from) - y(to) };
      add(atInfinity, "rect", { ...box, class: "region", style: style(mode) });
    }
    let labelled = Infinity;
    for (const { degrees, points, unbounded } of map.iso) {
      if (points.length) add(inside, "path", { d: line(points), class: "iso" });
      add(atInfinity, "path", { d: overStrip(unbounded), class: "iso" });
      if (!frame.shows(Infinity, unbounded) || labelled - y(unbounded) < LABEL_HEIGHT) continue;
      labelled = y(unbounded);
      add(picture, "text", { x: stripLeft + strip + 3, y: labelled + 4, class: "iso-label" }, `${degrees}°`);
    }
    for (const { name, points } of map.lines) add(inside, "path", { d: line(points), class: `border ${name}` });
    add(atInfinity, "path", { d: overStrip(map.overturning), class: "border" });
    drawAxes(picture, frame);
    const under = add(picture, "g");
    const taken = results.map((row) => ({ x: x(row.place), y: y(row.eta), sides: MARK, ends: MARK }));
    for (const { mu, eta, shift } of map.landmarks) taken.push({ x: x(mu) + shift[0], y: y(eta) - shift[1] - 4, sides: MARK, ends: MARK });
    for (const region of map.regions) nameRegion(picture, frame, region, style(region.mode), taken);
    const [low, high] = [y(Math.max(map.overturning, frame.eta[0])), y(frame.eta[1])];
    if (low - high > 2 * NAME[1]) {
      const place = { x: x(Infinity), y: (low + high) / 2 + 5 };
      add(picture, "text", { ...place, class: "region-label", style: style("r") }, "r");
    }
    for (const { name, mu, eta, shift } of map.landmarks) {
      if (!frame.shows(mu, eta)) continue;
      add(picture, "circle", { cx: x(mu), cy: y(eta), r: 3, class: "landmark" });
      add(picture, "text", { x: x(mu) + shift[0], y: y(eta) - shift[1], class: "landmark-label" }, name);
    }
    return { under, over: add(picture, "g") };
  }

  function clipped(picture, id, box) {
    add(add(picture, "clipPath", { id }), "rect", box);
    return add(picture, "g", { "clip-path": `url(#${id})` });
  }

  /** Write a mode where it fits and its region has most room; one that fits nowhere is led to by a
      line. Names keep clear of what is `taken`, and are taken then. */
  function nameRegion(picture, frame, { mode, mu, bottom, top }, style, taken) {
    const [aside, above] = NAME;
    const columns = mu.map((m, i) => ({
      x: frame.x(m),
      low: Math.min(frame.y(bottom[i]), frame.top + frame.up),
      high: Math.max(frame.y(top[i]), frame.top),
    })).filter(({ x, low, high }) => low > high && x > frame.left + EDGE && x < frame.left + frame.across - EDGE);
    if (!columns.length) return;
    const free = (x, y, sides, ends) => taken.every((mark) => Math.abs(mark.x - x) > sides + mark.sides || Math.abs(mark.y - y) > ends + mark.ends);
    const fits = ({ x, low, high }) => free(x, (low + high) / 2, aside, above) && columns.every((other) =>
      Math.abs(other.x - x) > aside || (other.low > (low + high) / 2 + above && other.high < (low + high) / 2 - above));
    // Of columns with as much room, the one nearest the middle of the picture.
    const room = ({ x, low, high }) => (low - high) * (1 - 0.6 * Math.abs((x - frame.left) / frame.across - 0.5));
    const led = ({ x, low, high }) => {
      const y = (low + high) / 2;
      return free(x, y - AWAY, aside, above) && free(x, y - AWAY / 2, MARK, AWAY / 2 + 2 * MARK);
    };
    const middle = columns[columns.length >> 1];
    const nearest = [...columns].sort((a, b) => Math.abs(a.x - middle.x) - Math.abs(b.x - middle.x));
    const inside = columns.filter(fits).sort((a, b) => room(b) - room(a))[0];
    const { x, low, high } = inside ?? nearest.find(led) ?? middle;
    const y = (low + high) / 2 - (inside ? 0 : AWAY);
    if (!inside) add(picture, "path", { d: `M${x} ${(low + high) / 2}V${y + above + 2}`, class: "leader", style });
    add(picture, "text", { x, y: y + 5, class: "region-label", style }, mode);
    taken.push({ x, y, sides: aside, ends: above });
  }

  function drawAxes(picture, frame) {
    const { x, y, left, top, across, up, strip, stripLeft, narrow, mu, eta } = frame;
    const bottom = top + up;
    add(picture, "rect", { x: left, y: top, width: across, height: up, class: "frame" });
    add(picture, "rect", { x: stripLeft, y: top, width: strip, height: up, class: "frame" });
    for (const value of ticks(mu)) {
      add(picture, "path", { d: `M${x(value)} ${bottom}v4`, class: "tick" });
      add(picture, "text", { x: x(value), y: bottom + 17, class: "tick-label middle" }, value);
    }
    add(picture, "text", { x: x(Infinity), y: bottom + 17, class: "tick-label middle" }, "∞");
    for (const value of ticks(eta)) {
      add(picture, "path", { d: `M${left} ${y(value)}h-4`, class: "tick" });
      add(picture, "text", { x: left - 7, y: y(value) + 4, class: "tick-label end" }, value);
    }
    const side = `translate(${narrow ? 12 : 14} ${top + up / 2}) rotate(-90)`;
    add(picture, "text", { x: left, y: bottom + 38, class: "axis-label" }, "friction coefficient μ");
    add(picture, "text", { transform: side, class: "axis-label middle" }, "thickness over radius η");
  }

  /** Four or five round numbers in a range. */
  function ticks([least, most]) {
    const step = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.25, 0.5, 1].find((size) => (most - least) / size <= 6);
    const first = Math.ceil(least / step - 1e-9);
    const count = Math.floor(most / step + 1e-9) - first;
    return Array.from({ length: count + 1 }, (_, i) => +((first + i) * step).toFixed(3));
  }

  /** What changes: results, the line of equal half-angle, the point looked at. */
  function drawPoint(layer, frame, { state, critical, verdict, iso, results, modes, unnamed }) {
    const { x, y, left, top, across, up, strip, stripLeft } = frame;
    layer.under.replaceChildren();
    layer.over.replaceChildren();
    const line = pathOf(iso.map(([mu, eta]) => [x(mu), y(eta)]));
    add(layer.under, "path", { d: line, class: "iso-here", "clip-path": "url(#map-clip)" });
    if (state.mu === Infinity && critical.eta !== null) {
      const level = `M${stripLeft} ${y(critical.eta)}h${strip}`;
      add(layer.under, "path", { d: level, class: "iso-here", "clip-path": "url(#strip-clip)" });
    }
    for (const row of results) {
      if (!frame.shows(row.place, row.eta)) continue;
      const [cx, cy] = [x(row.place), y(row.eta)];
      if (row.miss) add(layer.over, "circle", { cx, cy, r: 9, class: "miss" });
      marker(layer.over, row.mode ? modes[row.mode] : unnamed, cx, cy, 4.5);
      if (row.beyond) add(layer.over, "path", { d: `M${cx + 7} ${cy - 4}l5 4l-5 4`, class: "beyond" });
    }
    const within = (least, most, value) => Math.min(most, Math.max(least, value));
    const cx = state.mu === Infinity ? x(state.mu) : within(left, left + across, x(state.mu));
    const level = (eta) => within(top, top + up, y(eta));
    const cy = level(state.eta);
    const handle = add(layer.over, "g", { class: `handle ${verdict}` });
    if (!frame.shows(state.mu, state.eta)) {
      // Out of view: an arrow at the edge, towards it.
      const beyond = (value, [least, most]) => (value < least ? -1 : value > most && value < Infinity ? 1 : 0);
      const towards = Math.atan2(-beyond(state.eta, frame.eta) || 0, beyond(state.mu, frame.mu)) * (180 / Math.PI);
      add(handle, "path", { d: "M9 0L-7 -8V8Z", transform: `translate(${cx} ${cy}) rotate(${towards})`, class: "off" });
      return;
    }
    if (critical.eta !== null) {
      const reserve = add(layer.over, "path", { d: `M${cx} ${cy}V${level(critical.eta)}`, class: "reserve" });
      layer.over.insertBefore(reserve, handle);
    }
    for (const [r, name] of [[20, "grip"], [8, "halo"], [8, "ring"], [2, "dot"]]) {
      add(handle, "circle", { cx, cy, r, class: name });
    }
  }

  return { VIEWS, boxOf, viewAround, frameOf, drawBase, drawPoint };
})();
