"use strict";
/* Pictures of the page as files: SVG complete in itself, or PNG of it. Light, whatever the page is. */

const exporting = (() => {
  const { add } = svg;
  const NAMESPACE = "http://www.w3.org/2000/svg";
  const LEAST_WIDTH = 640; // of a picture with its words [pixels]
  const MARGIN = 12, LINE = 20; // of the words below [pixels]
  const FINER = 3; // pixels of a PNG in one of the page
  const PAINTS = ["fill", "stroke"];
  const LENGTHS = ["stroke-width", "stroke-dasharray"];
  const KEPT = ["fill-opacity", "stroke-opacity", "stroke-linejoin", "paint-order", "opacity",
    "font-family", "font-size", "font-weight", "text-anchor"];

  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d", { willReadFrequently: true });
  const known = new Map();

  /** A colour as any program reads it. */
  function plainColour(colour) {
    if (colour === "none" || colour === "rgba(0, 0, 0, 0)") return "none";
    if (!known.has(colour)) {
      context.clearRect(0, 0, 1, 1);
      context.fillStyle = colour;
      context.fillRect(0, 0, 1, 1);
      const shares = [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
      known.set(colour, `#${shares.map((share) => share.toString(16).padStart(2, "0")).join("")}`);
    }
    return known.get(colour);
  }

  /** Put the page's style into the elements themselves. `pixel`: size of one in the picture's units. */
  function settle(element, pixel) {
    const style = getComputedStyle(element);
    const scaled = style.vectorEffect === "non-scaling-stroke" ? pixel : 1;
    const found = {};
    for (const name of PAINTS) found[name] = plainColour(style.getPropertyValue(name));
    for (const name of LENGTHS) {
      found[name] = style.getPropertyValue(name).replace(/[\d.]+(px)?/g, (length) => parseFloat(length) * scaled);
    }
    for (const name of KEPT) found[name] = style.getPropertyValue(name);
    return found;
  }

  /** A picture of the page as the text of an SVG file, with lines of words below it. */
  function textOf(picture, words) {
    const box = picture.getBoundingClientRect();
    const holder = document.createElement("div");
    holder.style.cssText = `position:absolute;left:-9999px;top:0;width:${box.width}px;color-scheme:light`;
    const copy = picture.cloneNode(true);
    holder.append(copy);
    document.body.append(holder);
    copy.querySelectorAll(".grip, .idle").forEach((grip) => grip.remove());
    const pixel = 1 / copy.getScreenCTM().a;
    const elements = [...copy.querySelectorAll("*")];
    const styles = elements.map((element) => settle(element, pixel));
    const ink = plainColour(getComputedStyle(holder).color);
    elements.forEach((element, i) => {
      for (const name of ["class", "style"]) element.removeAttribute(name);
      for (const [name, value] of Object.entries(styles[i])) element.setAttribute(name, value);
    });
    holder.remove();

    const scale = Math.max(1, LEAST_WIDTH / box.width);
    const [width, high] = [box.width * scale, box.height * scale];
    const height = high + 2 * MARGIN + LINE * words.length;
    const file = document.createElementNS(NAMESPACE, "svg");
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` })) file.setAttribute(name, value);
    add(file, "title", {}, words.join(". "));
    add(file, "rect", { width, height, fill: "#ffffff" });
    const place = { x: 0, y: 0, width, height: high, viewBox: copy.getAttribute("viewBox") };
    add(file, "svg", place).append(...copy.childNodes);
    words.forEach((line, i) => add(file, "text", {
      x: MARGIN, y: high + MARGIN + LINE * (i + 0.7), fill: ink, "font-size": 14, "font-family": "sans-serif",
      "font-weight": i ? "normal" : "bold",
    }, line));
    return { width, height, text: new XMLSerializer().serializeToString(file) };
  }

  function hand(address, name) {
    const link = document.createElement("a");
    link.href = address;
    link.download = name;
    link.click();
  }

  const dataOf = (text) => `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;

  /** Hand a picture over as a file. */
  async function save(picture, words, name, kind) {
    const { width, height, text } = textOf(picture, words);
    if (kind === "svg") return hand(dataOf(text), `${name}.svg`);
    const image = new Image();
    image.src = dataOf(text);
    await image.decode();
    const paper = document.createElement("canvas");
    [paper.width, paper.height] = [Math.round(width * FINER), Math.round(height * FINER)];
    paper.getContext("2d").drawImage(image, 0, 0, paper.width, paper.height);
    return hand(paper.toDataURL("image/png"), `${name}.png`);
  }

  return { save, hand };
})();
