"use strict";
/* Hands on the map: they make it larger and shift it. */

const zooming = (() => {
  const CLOSER = 1.6; // times the map is larger after a click on +

  /**
   * Zoom by the wheel, by two fingers and by a double click; shift by two fingers or the right button.
   *
   * `isInside` tells whether an event is on the map. `spotAt` returns what is at a place of the picture.
   * `zoom` makes the map so many times larger about a spot, and tells whether that was possible.
   * Returns what tells whether two fingers are at work.
   */
  function listen(map, { isInside, spotAt, zoom }) {
    const placeOf = (event) => {
      const box = map.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    map.addEventListener("wheel", (event) => {
      if (!isInside(event)) return;
      // At the ends the page scrolls.
      if (zoom(2 ** (-event.deltaY / (event.deltaMode ? 10 : 300)), spotAt(placeOf(event)))) event.preventDefault();
    }, { passive: false });
    map.addEventListener("dblclick", (event) => {
      if (isInside(event)) zoom(event.shiftKey ? 1 / CLOSER : CLOSER, spotAt(placeOf(event)));
    });
    map.addEventListener("contextmenu", (event) => isInside(event) && event.preventDefault());
    const down = new Map();
    let held = null;
    /** Middle of the fingers or of the mouse, and how far they are apart. */
    const grasp = () => {
      const places = [...down.values()];
      const [one, other] = [places[0], places.at(-1)];
      return { x: (one.x + other.x) / 2, y: (one.y + other.y) / 2, apart: Math.hypot(one.x - other.x, one.y - other.y) };
    };
    const hold = () => {
      const now = down.size ? grasp() : null;
      held = now && { ...now, spot: spotAt(now) };
    };
    map.addEventListener("pointerdown", (event) => {
      if (event.pointerType !== "touch" && event.button !== 2) return;
      if (!isInside(event)) return;
      down.set(event.pointerId, placeOf(event));
      map.setPointerCapture(event.pointerId);
      hold();
    });
    map.addEventListener("pointermove", (event) => {
      if (!down.has(event.pointerId)) return;
      down.set(event.pointerId, placeOf(event));
      if (event.pointerType === "touch" && down.size !== 2) return;
      const now = grasp();
      const spread = down.size === 2 && held.apart > 0 ? now.apart / held.apart : 1;
      zoom(spread, held.spot, spotAt(now).shares);
      held = { ...now, spot: held.spot };
    });
    for (const end of ["pointerup", "pointercancel"]) {
      map.addEventListener(end, (event) => {
        down.delete(event.pointerId);
        hold();
      });
    }
    return () => down.size > 1;
  }

  return { CLOSER, listen };
})();
