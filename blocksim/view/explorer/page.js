"use strict";
/* The page: what is looked at, what is said of it, and how it is chosen. */

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const words = wordsWith(data.modes);
  const { number, degrees } = words;
  const { assess, underLoad, verdictOf } = knowing;
  const DEGREE = Math.PI / 180;
  const MOVED = 0.16; // largest displacement drawn, over r
  const FALLING = 2200, RESTING = 700, RETURNING = 500; // the motion shown, again and again [ms]
  const LINE_POINTS = 120;
  const TALLEST = 560, LOW = 520; // of the map, and a window called low [pixels]
  const PHONE = 600; // widest window that is a phone's [pixels]
  const STRIDES = 200; // of an arrow key across the map
  const FEW = 60; // most voussoirs of the slider; beyond is the continuous arch
  const { CLOSER } = zooming;
  const NEAR = 12; // pixels within which a result is meant
  const RANGES = { alpha: [1, 178], mu: [0.001, 1000], eta: [1e-6, 2], voussoirs: [3, 10000], at: [0, 1], lesson: [1, lesson.count],
    fill: [0, 1], place: [-0.99, 0.99], share: [0, 10] }; // of arches
  const ON_MAP = { mu: [0.01, data.largestMu], eta: [1e-4, 2] };

  const find = (id) => document.getElementById(id);
  const FIRST = { halfAngle: null, mu: 1.2, eta: 0.3, weight: "centreline", voussoirs: 27, asBuilt: false, view: "whole", at: null, lesson: 0, embed: false,
    load: null, fill: 0 };
  const BARE = { load: null, fill: 0 };
  const state = { ...FIRST };
  let lastFriction = data.largestMu; // that was not infinite
  let frame, layer, drawn, seen, setPose;
  let [amount, drawing] = [0, false];
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  let playing = !still.matches;
  let moved = playing ? 0 : 1; // share of the motion shown

  /* Showing it. */

  function update(change) {
    Object.assign(state, change);
    if (state.mu < Infinity) lastFriction = state.mu;
    // What lies on it lies on voussoirs.
    if (!loaded.takesFill(state.halfAngle)) state.fill = 0;
    if (change.asBuilt === false) Object.assign(state, BARE);
    if (state.load || state.fill) state.asBuilt = true;
    address.write(state);
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(() => {
      drawing = false;
      show();
    });
  }

  function show() {
    const both = { continuous: assess(state, false), built: assess(state, true) };
    seen = state.asBuilt ? both.built : both.continuous;
    const bare = verdictOf(seen);
    if (state.load || state.fill) seen = { ...seen, ...underLoad(state) };
    const verdict = verdictOf(seen);
    const moves = (!seen.stands || seen.verge) && seen.joints.length > 0;
    put("verdict", words.headline(state, seen));
    find("verdict").className = `verdict ${verdict}`;
    put("because", words.because(state, seen));
    put("joints", words.ofJoints(state, seen));
    const found = results().filter(isHere).map(words.ofResult);
    put("simulated", found.join(" "));
    find("simulated").hidden = !found.length;
    for (const [arch, known] of Object.entries(both)) showFigures(arch, known);
    for (const id of ["bare-map", "bare-figures"]) find(id).hidden = !seen.loaded;
    if (drawn.weight !== state.weight || drawn.view !== state.view) drawMap();
    showControls();
    drawMapPoint(bare);
    const reach = MOVED * Math.min(1, 1.2 * Math.sin(Math.min(state.halfAngle, Math.PI / 2)));
    amount = !moves ? 0 : seen.loaded ? reach : mechanism.amountFor(seen.joints, state.eta, reach);
    setPose = archPicture.draw(find("arch"), { state, ...seen, amount, reach });
    setPose(moved);
    find("play").disabled = !moves;
    showScrubber();
    find("code").value = `<iframe src="${location.href.split("#")[0]}#${address.textOf({ ...state, lesson: 0, embed: true })}" ` +
      `width="900" height="640" title="Does the arch stand?"></iframe>`;
    document.body.classList.toggle("embedded", state.embed);
    document.body.classList.toggle("learning", state.lesson > 0);
    lesson.show(find("lesson"), state.lesson, look, learn);
    find("arch").setAttribute("aria-label", `${parameters()}. ${words.headline(state, seen)}. ${words.ofJoints(state, seen)}`);
  }

  const parameters = () =>
    `α = ${degrees(state.halfAngle)}, μ = ${number(state.mu)}, η = ${number(state.eta)}, ` +
    `${words.which(seen.voussoirs)}, weight ${state.weight === "sector" ? "of true sectors" : "along the centreline"}${words.laid(state, seen)}`;

  function put(id, text) {
    const line = text.replace(/\s+/g, " ");
    // Untouched where nothing changed, so that screen readers stay silent.
    if (find(id).textContent !== line) find(id).textContent = line;
  }

  function showFigures(arch, known) {
    const { critical, friction, joints, betaS, mode } = known;
    const uses = (kind) => joints.some((joint) => joint.kind === kind);
    put(`${arch}-verdict`, words.shortVerdict(state, known));
    put(`${arch}-eta`, critical.eta === 0 ? "any" : critical.eta === null ? "none up to 2" : number(critical.eta, 6));
    put(`${arch}-mu`, number(friction === Infinity ? null : friction, 6));
    put(`${arch}-h`, number(critical.eta === null ? null : critical.thrust, 6));
    put(`${arch}-r`, degrees(uses("intrados") ? critical.betaR : null));
    put(`${arch}-s`, degrees(uses("in") ? betaS : null));
    // Where none stands, the mode is that of the thickest; thinner ones may fall otherwise.
    const when = critical.eta === null ? " at η = 2" : "";
    find(`${arch}-mode`).replaceChildren(...(mode === null ? ["–"] : [modeName(mode), when]));
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
    find(state.asBuilt ? "built" : "continuous").checked = true;
    find("stones").value = state.asBuilt ? state.voussoirs : FEW + 1;
    find("stones").setAttribute("aria-valuetext", words.which(seen.voussoirs));
    if (document.activeElement !== find("voussoirs")) find("voussoirs").value = state.voussoirs;
    const named = state.view in mapPicture.VIEWS;
    find("view").value = named ? state.view : "part";
    find("part").hidden = named;
    find("nearer").disabled = per() < 1.01 / 16;
    find("farther").disabled = state.view === "whole";
    find("weight").value = state.weight;
    for (const [id, { of }] of Object.entries(LAID)) {
      const value = +of(state).toPrecision(5);
      find(id).value = value;
      if (document.activeElement !== find(`${id}-number`)) find(`${id}-number`).value = value;
    }
    for (const id of ["fill", "fill-number"]) find(id).disabled = !loaded.takesFill(state.halfAngle);
    find("least").disabled = !seen.critical.eta;
    const off = !frame.shows(state.mu, state.eta);
    find("off-view").hidden = !off;
    if (off) {
      find("off-view").firstElementChild.textContent =
        `The arch shown, at μ = ${number(state.mu)} and η = ${number(state.eta)}, lies outside ` +
        `${state.view === "whole" ? "the map" : "this part of the map"}: the arrow points to it.`;
      find("whole").hidden = state.view === "whole";
    }
  }

  const results = () => data.results.filter((row) => row.weight === state.weight);

  /** Whether the arch looked at is that of a result. */
  function isHere(row) {
    const near = (one, other) => one === other || Math.abs(one - other) < 1e-9 * Math.abs(other);
    return state.asBuilt && row.voussoirs === state.voussoirs && near(row.mu ?? Infinity, state.mu) &&
      near(row.eta, state.eta) && near(row.alpha * DEGREE, state.halfAngle);
  }

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
    // Where the window is low, the whole map is to be seen at once.
    const upright = innerWidth <= PHONE && innerHeight > innerWidth;
    const tallest = innerHeight < LOW ? Math.max(220, innerHeight - 60) : upright ? Math.max(240, 0.4 * innerHeight) : TALLEST;
    frame = mapPicture.frameOf(box.clientWidth, state.view, tallest);
    drawn = { weight: state.weight, view: state.view };
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
      showScrubber();
    }
    if (playing) requestAnimationFrame(step);
  }

  function setPlaying(value) {
    playing = value;
    state.at = playing || still.matches ? null : moved;
    started = null;
    find("play").textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(step);
  }

  /** Where the slider stands: to the middle the arch gets thinner, down to its least thickness; beyond, it falls. */
  function showScrubber() {
    const { eta } = seen.critical;
    const most = mostHere();
    const spare = seen.loaded ? (most ? within([0, 1], 1 - state.load.share / most) : 0) : eta ? within([0, 1], state.eta / eta - 1) : 0;
    const slider = find("scrub");
    slider.value = amount > 0 ? 0.5 + moved / 2 : 0.5 - spare / 2;
    slider.disabled = !amount && (seen.loaded ? !most : !eta);
    const [first, last] = seen.loaded ? ["no load", "the most"] : ["thick", "least"];
    put("scrub-first", first);
    put("scrub-middle", last);
    const rests = seen.loaded ? `${Math.round(100 * (1 - spare))} % of what it bears` : `${Math.round(100 * spare)} % thicker than needed`;
    slider.setAttribute("aria-valuetext", amount > 0 ? `falls, ${Math.round(100 * moved)} % of the way` : rests);
  }

  /** The largest load at its place; null where there is none, or no largest. */
  function mostHere() {
    const factor = seen.loaded?.bears?.factor;
    return factor > 0 && factor < Infinity ? factor : null;
  }

  function scrub(value) {
    const { eta } = seen.critical;
    moved = Math.max(0, 2 * value - 1);
    setPlaying(false);
    if (seen.loaded) {
      const { load } = state;
      const share = !mostHere() ? load?.share : value < 0.5 ? 2 * value * mostHere() : Math.max(load.share, mostHere());
      return update({ at: moved, load: load && { ...load, share } });
    }
    const least = eta === null ? state.eta : eta;
    update({ at: moved, eta: value < 0.5 ? Math.min(2, least * (2 - 2 * value)) : Math.min(state.eta, least) });
  }

  /* The lesson. */

  /** Look at an arch of the lesson; "least" is its least thickness. */
  function look(arch) {
    const eta = arch.eta === "least" ? theory.leastThickness(arch.halfAngle, arch.mu, arch.weight).eta : arch.eta;
    moved = arch.at ?? (still.matches ? 1 : 0);
    setPlaying(arch.at === undefined && !still.matches);
    update({ ...BARE, ...arch, eta, at: arch.at ?? null });
  }

  function learn(step) {
    update({ lesson: step });
    if (step) look(lesson.shown(step));
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

  /** Results under the pointer, the nearest first. */
  function resultsNear({ x, y }) {
    const far = (row) => Math.hypot(frame.x(row.place) - x, frame.y(row.eta) - y);
    return results().filter((row) => frame.shows(row.place, row.eta) && far(row) < NEAR).sort((a, b) => far(a) - far(b));
  }

  const chooseResult = (row) => update({
    ...BARE, mu: row.mu ?? Infinity, eta: row.eta, halfAngle: row.alpha * DEGREE, weight: row.weight,
    voussoirs: row.voussoirs, asBuilt: true,
  });

  /** Choose a result from the table, and bring it into view. */
  function showResult(row) {
    if (!frame.shows(row.place, row.eta)) update({ view: "whole" });
    chooseResult(row);
    find("map-box").scrollIntoView({ block: "center", behavior: still.matches ? "auto" : "smooth" });
  }

  function tell(event) {
    const point = pointAt(event);
    const tip = find("tip");
    tip.hidden = !point.inside;
    if (!point.inside) return;
    const rows = resultsNear(point);
    if (rows.length) {
      tip.replaceChildren(...rows.flatMap((row, i) => [
        ...(i ? [document.createElement("br")] : []), `${row.scenario}, ${row.engine}, n = ${row.voussoirs}`, document.createElement("br"),
        `${row.found}${row.beyond ? `; beyond the map, at μ = ${number(row.mu)}` : ""}`]));
    } else {
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

  /** Share of the map that is shown, along friction. */
  const per = () => (frame.mu[1] - frame.mu[0]) / data.largestMu;

  /** A place of the picture: what is there, and at which shares of it. */
  function spotAt({ x, y }) {
    const shares = [(x - frame.left) / frame.across, (frame.top + frame.up - y) / frame.up].map((share) => within([0, 1], share));
    const [{ mu, eta }] = [frame];
    return { mu: mu[0] + shares[0] * (mu[1] - mu[0]), eta: eta[0] + shares[1] * (eta[1] - eta[0]), shares };
  }

  /** Where zooming keeps the map still: the point looked at if it is shown, else the middle. */
  const middleOfView = () => spotAt(frame.shows(state.mu, state.eta) && state.mu < Infinity
    ? { x: frame.x(state.mu), y: frame.y(state.eta) }
    : { x: frame.left + frame.across / 2, y: frame.top + frame.up / 2 });

  /** Show the map so many times larger; a spot of it goes to these shares of the picture. */
  function zoom(times, spot, shares = spot.shares) {
    const before = state.view;
    update({ view: mapPicture.viewAround(spot, shares, per() / times) });
    if (state.view === before) return false;
    drawMap(); // what follows before the page is drawn again reckons with it
    update({});
    return true;
  }

  function listenToMap() {
    const map = find("map");
    let [dragging, dragged] = [false, false];
    const pinching = zooming.listen(map, { isInside: (event) => pointAt(event).inside, spotAt, zoom });
    const pick = (event) => {
      const { mu, eta } = pointAt(event);
      choose(mu, eta);
    };
    map.addEventListener("pointerdown", (event) => {
      const point = pointAt(event);
      dragging = dragged = event.button === 0 && point.inside && !resultsNear(point).length;
      if (!dragging) return;
      map.setPointerCapture(event.pointerId);
      pick(event);
    });
    // On the map a finger moves the point, up and down, too; beside it, it scrolls the page. CSS cannot
    // say that of a part of a picture.
    map.addEventListener("touchstart", (event) => {
      const point = pointAt(event.touches[0]);
      if (point.inside && !resultsNear(point).length) event.preventDefault();
    }, { passive: false });
    map.addEventListener("pointermove", (event) => {
      if (pinching()) dragging = false;
      if (dragging) pick(event);
      if (dragging || event.pointerType !== "touch") tell(event);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      map.addEventListener(end, (event) => {
        dragging = false;
        if (event.pointerType === "touch") find("tip").hidden = true;
      });
    }
    map.addEventListener("pointerleave", () => (find("tip").hidden = true));
    map.addEventListener("click", (event) => {
      const point = pointAt(event);
      const [row] = resultsNear(point);
      if (dragged || !point.inside) return;
      if (row) chooseResult(row);
      else pick(event);
    });
    map.addEventListener("keydown", (event) => {
      const closer = { "+": CLOSER, "=": CLOSER, "-": 1 / CLOSER }[event.key];
      if (closer) zoom(closer, middleOfView());
      if (event.key === "0") update({ view: "whole" });
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

  /** What may lie on the arch: how it is read of a state, and put into it. */
  const LAID = {
    press: { range: "share", of: ({ load }) => load?.share ?? 0, as: (share) => ({ load: share || state.load ? { place: state.load?.place ?? 0, share } : null }) },
    place: { range: "place", of: ({ load }) => load?.place ?? 0, as: (place) => ({ load: { share: state.load?.share ?? 0, place } }) },
    fill: { range: "fill", of: ({ fill }) => fill, as: (fill) => ({ fill }) },
  };

  function listenToControls() {
    archPicture.listen(find("arch"), () => state, (change) => update(change));
    for (const [id, { range, as }] of Object.entries(LAID)) {
      const box = find(`${id}-number`);
      [box.min, box.max] = RANGES[range];
      box.title = `from ${box.min} to ${box.max}`;
      for (const input of [find(id), box]) input.addEventListener("input", () => {
        const value = input.valueAsNumber;
        if (within(RANGES[range], value) === value) update(as(value));
      });
      box.addEventListener("blur", () => update({}));
    }
    find("unload").addEventListener("click", () => update(BARE));
    const set = {
      alpha: (value) => ({ halfAngle: value * DEGREE }), mu: (mu) => ({ mu }), eta: (eta) => ({ eta }),
    };
    const voussoirs = find("voussoirs");
    [voussoirs.min, voussoirs.max] = RANGES.voussoirs;
    voussoirs.title = `a whole number from ${voussoirs.min} to ${voussoirs.max}`;
    voussoirs.addEventListener("input", () => voussoirs.validity.valid && voussoirs.value && update({ voussoirs: voussoirs.valueAsNumber, asBuilt: true }));
    voussoirs.addEventListener("blur", () => update({}));
    find("stones").addEventListener("input", (event) => {
      const voussoirs = +event.target.value;
      update(voussoirs > FEW ? { asBuilt: false } : { voussoirs, asBuilt: true });
    });
    for (const leaving of ["to-own", "carry"]) find(leaving).addEventListener("click", () => address.flush(state));
    find("carry").addEventListener("click", () => own.open(archPicture.blocks(state, Math.min(FEW, state.asBuilt ? state.voussoirs : FEW)), state.mu));
    for (const name of ["continuous", "built"]) {
      find(name).addEventListener("change", () => update({ asBuilt: name === "built" }));
    }
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
      update({ mu: event.target.checked ? Infinity : lastFriction }));
    find("least").addEventListener("click", () => update({ eta: seen.critical.eta }));
    find("weight").addEventListener("change", (event) => update({ weight: event.target.value }));
    find("view").addEventListener("change", (event) => event.target.value !== "part" && update({ view: event.target.value }));
    find("nearer").addEventListener("click", () => zoom(CLOSER, middleOfView()));
    find("farther").addEventListener("click", () => zoom(1 / CLOSER, middleOfView()));
    find("whole").addEventListener("click", () => update({ view: "whole" }));
    for (const button of document.querySelectorAll("[data-save]")) {
      const picture = button.dataset.save;
      button.addEventListener("click", () =>
        exporting.save(find(picture), [words.headline(state, seen), parameters()], picture, button.dataset.kind));
    }
    find("scrub").addEventListener("input", (event) => scrub(+event.target.value));
    find("learn").addEventListener("click", () => learn(1));
    find("code").addEventListener("focus", (event) => event.target.select());
    find("play").addEventListener("click", () => {
      setPlaying(!playing);
      address.write(state);
    });
    still.addEventListener("change", () => {
      moved = 1;
      setPlaying(!still.matches);
      update({});
    });
    for (const button of document.querySelectorAll("[data-row]")) {
      button.addEventListener("click", () => showResult(data.results[+button.dataset.row]));
    }
  }

  for (const [mode, style] of Object.entries(data.modes)) svg.marker(find(`legend-${mode}`), style, 0, 0, 6);
  for (const row of data.results) {
    row.beyond = row.mu !== null && row.mu > data.largestMu;
    row.place = row.mu === null ? Infinity : Math.min(row.mu, data.largestMu);
  }

  /** Take the arch from the page's address; without one, the widest that stands at the point. */
  function arrive() {
    Object.assign(state, FIRST, address.read(location.hash, RANGES, mapPicture.boxOf));
    state.halfAngle ??= theory.atPoint(state.eta, state.mu, state.weight).halfAngle;
    if (state.mu < Infinity) lastFriction = state.mu;
    if (state.at !== null) [moved, playing] = [state.at, false];
  }

  arrive();
  find("acts").open = Boolean(state.load || state.fill);
  drawMap();
  show();
  listenToMap();
  listenToControls();
  setPlaying(playing);
  const wide = document.querySelector(".scroll");
  if (wide) {
    new ResizeObserver(() => {
      find("sideways").hidden = wide.scrollWidth <= wide.clientWidth;
    }).observe(wide);
  }
  new ResizeObserver(() => {
    const width = find("map-box").clientWidth;
    if (width === frame.width || width === 0) return; // 0 while the window closes
    drawMap();
    show();
  }).observe(find("map-box"));
  addEventListener("hashchange", (event) => {
    if (own.turn(event)) return;
    arrive();
    show();
  });
  addEventListener("pagehide", () => address.flush(state));
  own.start();
})();
