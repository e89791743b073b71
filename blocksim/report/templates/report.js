"use strict";
// Each drawing holds poses of its blocks at even shares of the motion.
const SECONDS = 3;
const FADED = 0.1; // share of the motion at which the line of thrust is gone

/** Say of what is wider than the window that it scrolls. */
const tellSideways = () => {
  for (const wide of document.querySelectorAll(".wide")) {
    wide.previousElementSibling.hidden = wide.scrollWidth <= wide.clientWidth;
  }
};
tellSideways();
addEventListener("resize", tellSideways);

for (const figure of document.querySelectorAll(".motion")) {
  const slider = figure.querySelector("input");
  if (!slider) continue;
  const button = figure.querySelector("button");
  const frames = JSON.parse(figure.dataset.frames);
  const pieces = [...figure.querySelectorAll(".piece")];
  let started = null;

  const statics = figure.querySelector(".statics");

  const show = (share) => {
    // The line of thrust is that of the arch at rest.
    statics.style.opacity = Math.max(0, 1 - share / FADED);
    const place = share * (frames.length - 1);
    const index = Math.min(Math.floor(place), frames.length - 2);
    const rest = place - index;
    for (const piece of pieces) {
      const one = frames[index][piece.dataset.block];
      const two = frames[index + 1][piece.dataset.block];
      const [x, y, turn] = one.map((value, axis) => value + (two[axis] - value) * rest);
      piece.setAttribute(
        "transform",
        `translate(${x} ${y}) rotate(${turn} ${piece.dataset.x} ${piece.dataset.y})`,
      );
    }
  };
  const stop = () => {
    started = null;
    button.textContent = "Play";
  };
  const step = (now) => {
    if (started === null) return;
    const share = Math.min((now - started) / (1000 * SECONDS), 1);
    slider.value = share;
    show(share);
    if (share < 1) requestAnimationFrame(step);
    else stop();
  };
  button.addEventListener("click", () => {
    if (started !== null) {
      stop();
      return;
    }
    button.textContent = "Stop";
    const from = slider.value < 1 ? Number(slider.value) : 0;
    started = 0;
    requestAnimationFrame((now) => {
      if (started === null) return; // Stopped before the first picture.
      started = now - from * 1000 * SECONDS;
      step(now);
    });
  });
  slider.addEventListener("input", () => {
    stop();
    show(Number(slider.value));
  });
}
