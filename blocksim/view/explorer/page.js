"use strict";
/* The page: what is looked at, what is said of it, and how it is chosen. */

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const words = wordsWith(data.modes);
  const { number, degrees } = words;
  const DEGREE = Math.PI / 180;
  const ON_THE_VERGE = 1e-7; // share of strength needed, this near to all of it
  const MOVED = 0.16; // largest displacement drawn, over r
  const FALLING = 2200, RESTING = 700, RETURNING = 500; // the motion shown, again and again [ms]
  const LINE_POINTS = 120;
  const STRIDES = 200; // of an arrow key across the map
  const NEAR = 12; // pixels within which a result is meant
  const RANGES = { alpha: [1, 178], mu: [0.001, 1000], eta: [1e-6, 2] }; // of arches
  const ON_MAP = { mu: [0.01, data.largestMu], eta: [1e-4, 2] };

  const find = (id) => document.getElementById(id);
  const state = { halfAngle: 120 * DEGREE, mu: 1.2, eta: 0.3, weight: "centreline" };
  let frame, layer, drawnWeight, seen, setPose;
  let [amount, drawing] = [0, false];
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  let playing = !still.matches;
  let moved = playing ? 0 : 1; // share of the motion shown

  /* What is known of the arch looked at. */

  function assess({ halfAngle, mu, eta, weight }) {
    const critical = theory.leastThickness(halfAngle, mu, weight);
    const balance = theory.equilibrium(halfAngle, mu, eta, weight);
    const verge = balance !== null && Math.abs(balance.share - 1) < ON_THE_VERGE;
    const stands = verge || (critical.eta !== null && eta >= critical.eta);
    // Thick enough and yet on the verge: it is friction that has nothing to spare.
    const slides = verge && critical.eta !== null && eta > critical.eta * (1 + 1e-6);
    const mode = slides ? "ss" : critical.mode;
    const betaS = slides ? theory.innerSliding(mu).betaS : critical.betaS;
    const joints = mechanism.activeJoints(mode, halfAngle, critical.betaR ?? 0, betaS ?? 0);
    const friction = theory.leastFriction(halfAngle, eta, weight);
    return { critical, balance, verge, stands, slides, mode, betaS, joints, friction };
  }

  /* Showing it. */

  function update(change) {
    Object.assign(state, change);
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(() => {
      drawing = false;
      show();
    });
  }

  function show() {
    seen = assess(state);
    const verdict = seen.stands ? "stands" : "collapses";
    const moves = !seen.stands || seen.verge;
    put("verdict", words.headline(state, seen));
    find("verdict").className = `verdict ${verdict}`;
    put("because", words.because(state, seen));
    put("joints", `${moves ? "As it falls" : "As it would fall at its least thickness"}: ${words.ofJoints(state, seen)}.`);
    showFigures();
    showControls();
    if (drawnWeight !== state.weight) drawMap();
    drawMapPoint(verdict);
    const reach = MOVED * Math.min(1, 1.2 * Math.sin(Math.min(state.halfAngle, Math.PI / 2)));
    amount = moves ? mechanism.amountFor(seen.joints, state.eta, reach) : 0;
    setPose = archPicture.draw(find("arch"), { state, ...seen, amount, reach });
    setPose(moved);
    find("play").disabled = !moves;
    find("arch").setAttribute("aria-label",
      `Arch of half-angle ${degrees(state.halfAngle)}, friction ${number(state.mu)}, ` +
      `thickness ${number(state.eta)}. ${words.headline(state, seen)}. ${words.ofJoints(state, seen)}.`);
  }

  function put(id, text) {
    const line = text.replace(/\s+/g, " ");
    // Untouched where nothing changed, so that screen readers stay silent.
    if (find(id).textContent !== line) find(id).textContent = line;
  }

  function showFigures() {
    const { critical, friction, mode } = seen;
    const uses = (kind) => seen.joints.some((joint) => kind.includes(joint.kind));
    put("figure-eta", number(critical.eta, 6));
    put("figure-mu", number(friction === Infinity ? null : friction, 6));
    put("figure-h", number(critical.thrust, 6));
    put("figure-r", degrees(uses(["intrados"]) ? critical.betaR : null));
    put("figure-s", degrees(uses(["in"]) ? seen.betaS : null));
    find("figure-mode").replaceChildren(modeName(mode), ` ${data.modes[mode].description}`);
  }

  function modeName(mode) {
    const name = document.createElement("b");
    name.className = "mode";
    name.style.setProperty("--colour", data.modes[mode].colour);
    name.textContent = mode;
    return name;
  }

  function showControls() {
    const values = { alpha: state.halfAngle / DEGREE, mu: state.mu, eta: state.eta };
    for (const [name, value] of Object.entries(values)) {
      const [slider, box] = [find(name), find(`${name}-number`)];
      const finite = value === Infinity ? data.largestMu : value;
      slider.value = finite;
      slider.setAttribute("aria-valuetext", value === Infinity ? "unbounded" : number(value));
      slider.disabled = box.disabled = value === Infinity;
      if (document.activeElement !== box) box.value = value === Infinity ? "" : +finite.toPrecision(5);
    }
    find("unbounded").checked = state.mu === Infinity;
    find("weight").value = state.weight;
    find("least").disabled = seen.critical.eta === null;
  }

  const results = () => data.results.filter((row) => row.weight === state.weight);

  function drawMapPoint(verdict) {
    const { halfAngle, weight } = state;
    const divide = theory.leastFriction(halfAngle, Infinity, weight);
    const iso = [];
    for (let i = 0; i <= LINE_POINTS && divide < data.largestMu; i++) {
      // Denser next to the divide, where the line is steep.
      const mu = divide * (1 + 1e-9) + (data.largestMu - divide) * (i / LINE_POINTS) ** 2;
      const { needed } = theory.leastThickness(halfAngle, mu, weight);
      if (i === 0) iso.push([mu, 2]); // sliding both ways, any thickness beyond is critical
      iso.push([mu, Math.min(needed, 3)]);
    }
    const { modes, unnamed } = data;
    const looks = { modes, unnamed, state, verdict, iso, critical: seen.critical, results: results() };
    mapPicture.drawPoint(layer, frame, looks);
  }

  function drawMap() {
    const box = find("map-box");
    frame = mapPicture.frameOf(box.clientWidth, find("view").value);
    drawnWeight = state.weight;
    layer = mapPicture.drawBase(find("map"), frame, data.maps[state.weight], data.modes, results());
  }

  /* Moving it. */

  let started = null;

  function step(now) {
    if (playing && amount > 0) {
      started ??= now;
      const time = (now - started) % (FALLING + RESTING + RETURNING);
      const back = Math.max(0, time - FALLING - RESTING) / RETURNING;
      moved = back > 0 ? (1 - back) ** 2 : Math.min(1, time / FALLING) ** 2;
      setPose(moved);
    }
    if (playing) requestAnimationFrame(step);
  }

  function setPlaying(value) {
    playing = value;
    started = null;
    find("play").textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(step);
  }

  /* Choosing it. */

  const within = ([least, most], value) => Math.min(most, Math.max(least, value));

  /** Point of the map under the pointer. */
  function pointAt(event) {
    const box = find("map").getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const mu = frame.muAt(x);
    return {
      x, y,
      inside: x >= frame.left && x <= frame.stripLeft + frame.strip && y >= frame.top && y <= frame.top + frame.up,
      mu: mu === Infinity ? mu : within(ON_MAP.mu, mu),
      eta: within(ON_MAP.eta, frame.etaAt(y)),
    };
  }

  /** Look at the arch of a point of the map: the widest that stands there. */
  function choose(mu, eta) {
    update({ mu, eta, halfAngle: theory.atPoint(eta, mu, state.weight).halfAngle });
  }

  const resultNear = ({ x, y }) =>
    results().find((row) => frame.shows(row.place, row.eta) && Math.hypot(frame.x(row.place) - x, frame.y(row.eta) - y) < NEAR);

  const chooseResult = (row) =>
    update({ mu: row.mu ?? Infinity, eta: row.eta, halfAngle: row.alpha * DEGREE, weight: row.weight });

  function tell(event) {
    const point = pointAt(event);
    const tip = find("tip");
    tip.hidden = !point.inside;
    if (!point.inside) return;
    const row = resultNear(point);
    if (row) tip.replaceChildren(row.scenario, document.createElement("br"), row.said);
    else {
      const { halfAngle, modes, critical } = theory.atPoint(point.eta, point.mu, state.weight);
      const names = modes.flatMap((mode, i) => [i ? ", " : "", modeName(mode)]);
      tip.replaceChildren(
        `η ${number(point.eta, 3)}  μ ${number(point.mu, 3)}`, document.createElement("br"),
        `α ${degrees(halfAngle)}  h ${number(critical.thrust, 3)}`, document.createElement("br"),
        ...names, ` ${words.shortly(modes[0])}`);
    }
    const [width, height] = [tip.offsetWidth, tip.offsetHeight];
    const left = point.x + 16 + width > frame.width ? point.x - 16 - width : point.x + 16;
    tip.style.left = `${Math.max(0, left)}px`;
    tip.style.top = `${Math.max(0, point.y - height - 10)}px`;
  }

  function listenToMap() {
    const map = find("map");
    let [dragging, dragged] = [false, false];
    const pick = (event) => {
      const { mu, eta } = pointAt(event);
      choose(mu, eta);
    };
    map.addEventListener("pointerdown", (event) => {
      const point = pointAt(event);
      // A finger scrolls the page unless it takes hold of the point; taps are clicks.
      const scrolls = event.pointerType === "touch" && !event.target.closest(".handle");
      dragging = dragged = !scrolls && event.button === 0 && point.inside && !resultNear(point);
      if (!dragging) return;
      map.setPointerCapture(event.pointerId);
      pick(event);
    });
    map.addEventListener("pointermove", (event) => {
      if (dragging) pick(event);
      if (event.pointerType !== "touch") tell(event);
    });
    for (const end of ["pointerup", "pointercancel"]) map.addEventListener(end, () => (dragging = false));
    map.addEventListener("pointerleave", () => (find("tip").hidden = true));
    map.addEventListener("click", (event) => {
      const point = pointAt(event);
      const row = resultNear(point);
      if (dragged || !point.inside) return;
      if (row) chooseResult(row);
      else pick(event);
    });
    map.addEventListener("keydown", (event) => {
      const [right, up] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
      if (!right && !up) return;
      event.preventDefault();
      const stride = (event.shiftKey ? 10 : 1) / STRIDES;
      const eta = within(ON_MAP.eta, state.eta + (frame.eta[1] - frame.eta[0]) * stride * up);
      if (state.mu === Infinity) return choose(right < 0 ? data.largestMu : Infinity, eta);
      const mu = state.mu + (frame.mu[1] - frame.mu[0]) * stride * right;
      return choose(mu > data.largestMu && right ? Infinity : within(ON_MAP.mu, mu), eta);
    });
  }

  function listenToControls() {
    const set = {
      alpha: (value) => ({ halfAngle: value * DEGREE }), mu: (mu) => ({ mu }), eta: (eta) => ({ eta }),
    };
    for (const name of Object.keys(set)) {
      find(name).addEventListener("input", (event) => update(set[name](+event.target.value)));
      const box = find(`${name}-number`);
      [box.min, box.max] = RANGES[name];
      box.title = `from ${box.min} to ${box.max}`;
      box.addEventListener("input", (event) => {
        const value = event.target.valueAsNumber;
        if (within(RANGES[name], value) === value) update(set[name](value));
      });
      box.addEventListener("blur", () => update({}));
    }
    find("unbounded").addEventListener("change", (event) =>
      update({ mu: event.target.checked ? Infinity : data.largestMu }));
    find("least").addEventListener("click", () => update({ eta: seen.critical.eta }));
    find("weight").addEventListener("change", (event) => update({ weight: event.target.value }));
    find("view").addEventListener("change", () => {
      drawMap();
      update({});
    });
    find("play").addEventListener("click", () => setPlaying(!playing));
    still.addEventListener("change", () => {
      moved = 1;
      setPlaying(!still.matches);
      update({});
    });
    for (const button of document.querySelectorAll("[data-row]")) {
      button.addEventListener("click", () => chooseResult(data.results[+button.dataset.row]));
    }
  }

  for (const [mode, style] of Object.entries(data.modes)) svg.marker(find(`legend-${mode}`), style, 0, 0, 6);
  for (const row of data.results) row.place = row.mu === null ? Infinity : Math.min(row.mu, data.largestMu);
  drawMap();
  state.halfAngle = theory.atPoint(state.eta, state.mu, state.weight).halfAngle;
  show();
  listenToMap();
  listenToControls();
  setPlaying(playing);
  new ResizeObserver(() => {
    const width = find("map-box").clientWidth;
    if (width === frame.width || width === 0) return; // 0 while the window closes
    drawMap();
    show();
  }).observe(find("map-box"));
})();
