"use strict";
/* Elements of SVG, and the shapes of points. */

const svg = (() => {
  const NAMESPACE = "http://www.w3.org/2000/svg";

  function add(parent, name, attributes = {}, text = null) {
    const element = document.createElementNS(NAMESPACE, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== null) element.textContent = text;
    parent.append(element);
    return element;
  }

  const pathOf = (points, digits = 2) =>
    (points.length ? "M" : "") + points.map((p) => p.map((v) => +v.toFixed(digits)).join(" ")).join("L");

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

  return { add, pathOf, marker };
})();
