// Shows what a tracker thinks while it tracks. Each message of the socket is one row: the estimate's columns, what was measured, some
// particles; lengths in m, angles in rad, times in s. The newest one is drawn, others are dropped. A message {silent} gives the age (s) of
// the row before it.
"use strict";

/** Time without a row after which the page says so (ms). */
const SILENCE = 2000;
/** Intervals of the camera without a pose from which it counts as off: one lost pose is none. */
const LOST = 3;
/** Time that the history shows (s). */
const MINUTE = 60;

class Live {
  constructor(root) {
    this.find = (selector) => root.querySelector(selector);
    this.root = root;
    this.data = JSON.parse(this.find("script").textContent);
    this.newest = null;
    /** Time of the latest row (ms), null before the first one. */
    this.latest = null;
    /** Time of the latest camera pose, and the camera's usual interval (s). */
    this.seen = this.interval = null;
    this.past = [];
    this.drawStage();
    setInterval(() => this.listen(), 500);
    this.connect();
  }

  drawStage() {
    const { data } = this;
    this.svg = this.find(".stage svg");
    this.world = add(this.svg, "g", { transform: "scale(1 -1)" });
    let grid = "";
    for (let mm = -2000; mm <= 2000; mm += 10) grid += `M${mm} -2000v4000M-2000 ${mm}h4000`;
    add(this.world, "path", { d: grid, class: "grid" });
    this.truth = addBody(this.world, data.object, "truth");
    this.cloud = add(this.world, "g", { class: "cloud" });
    this.cloud.style.setProperty("--colour", data.colour);
    this.bodies = [];
    this.fixels = data.fixels.map((fixel, k) => {
      const group = addBody(this.world, fixel, "fixel");
      add(group, "text", { transform: `translate(${fixel.middle[0]} ${fixel.middle[1]}) scale(1 -1)`, dy: "0.35em" }).textContent = k + 1;
      return group;
    });
    this.fingers = data.fingers.map((finger) => addBody(this.world, finger, "pusher"));
    this.touched = [this.fingers[0], ...this.fixels, ...this.fingers.slice(1)];
    this.ghost = addBody(this.world, data.object, "ghost", data.colour);
    for (const group of [this.truth, ...this.fingers, this.ghost]) moveTo(group, null);
    this.view = data.view.slice();
    this.frame();
  }

  /** The picture: the fixels, and all that has been seen of object and fingers. */
  frame() {
    const [left, low, right, high] = this.view;
    const room = 0.05 * Math.max(right - left, high - low) + 1;
    const width = Math.max(right - left + 2 * room, (high - low + 2 * room) / 0.7);
    const height = Math.max(high - low + 2 * room, 0.62 * width);
    const [x, y] = [(left + right - width) / 2, (low + high - height) / 2];
    this.svg.setAttribute("viewBox", `${x} ${-y - height} ${width} ${height}`);
    this.svg.style.aspectRatio = `${width} / ${height}`;
    this.svg.style.setProperty("--letter", `${width / 32}px`);
  }

  include(pose) {
    if (!pose) return;
    const [x, y, r] = [1000 * pose[0], 1000 * pose[1], 1.2 * this.data.reach];
    const [left, low, right, high] = this.view;
    const wider = [Math.min(left, x - r), Math.min(low, y - r), Math.max(right, x + r), Math.max(high, y + r)];
    if (wider.some((side, k) => side !== this.view[k])) {
      this.view = wider;
      this.frame();
    }
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/socket${location.search}`);
    socket.addEventListener("message", (event) => {
      const message = JSON.parse(event.data);
      this.latest = performance.now() - 1000 * (message.silent ?? 0);
      if (message.silent !== undefined) return this.listen();
      if (this.newest === null) requestAnimationFrame(() => this.draw());
      this.newest = message;
    });
    socket.addEventListener("open", () => this.say("waiting for rows"));
    socket.addEventListener("close", () => {
      this.latest = null;
      this.say("no connection");
      setTimeout(() => this.connect(), 1000);
    });
  }

  say(words, more = "") {
    this.find(".badge").textContent = words + more;
    this.root.dataset.state = words;
  }

  /** Says for how long no row has come, if that is long; returns true then. */
  listen() {
    const silent = this.latest === null ? 0 : performance.now() - this.latest;
    // a row that waits to be drawn comes first
    const isSilent = this.newest === null && silent > SILENCE;
    this.find(".stage").classList.toggle("silent", isSilent);
    if (isSilent) this.say("no rows", ` for ${Math.floor(silent / 1000)} s`);
    return isSilent;
  }

  draw() {
    const row = this.newest;
    this.newest = null;
    const { estimate } = row;
    const known = estimate.x !== null ? [estimate.x, estimate.y, estimate.theta] : null;
    const place = (group, pose) => (pose ? moveTo(group, 1e5 * pose[0], 1e5 * pose[1], 1e4 * pose[2]) : moveTo(group, null));
    place(this.truth, row.object);
    this.fingers.forEach((finger, k) => place(finger, row.fingers[k]));
    place(this.ghost, known);
    for (const pose of [row.object, ...row.fingers, known]) this.include(pose);
    while (this.bodies.length < row.particles.length) this.bodies.push(add(this.cloud, "path", { d: this.data.object.line }));
    this.bodies.forEach((body, k) => place(body, row.particles[k]));
    const silent = this.look(row);
    this.find(".stage").classList.toggle("blind", silent !== null);
    if (!this.listen()) {
      if (silent === null) this.say("camera on");
      else this.say("camera off", Number.isFinite(silent) ? ` for ${silent.toFixed(1)} s` : "");
    }
    this.find(".clock").textContent = `${estimate.time.toFixed(2)} s`;
    this.root.dataset.time = estimate.time;
    this.touch(row);
    this.tell(row);
    this.remember(estimate, silent !== null);
  }

  /** Time since the camera's latest pose (s), null while it delivers. */
  look({ object, estimate: { time } }) {
    if (object !== null) {
      const passed = time - this.seen;
      // an occlusion is no interval of the camera
      if (this.seen !== null && passed > 0) this.interval = Math.min(passed, this.interval === null ? passed : 1.1 * this.interval);
      this.seen = time;
      return null;
    }
    const silent = this.seen === null ? Infinity : time - this.seen;
    return silent > LOST * (this.interval ?? 0) ? silent : null;
  }

  /** The spread of the last minute, shaded while the camera was off. */
  remember({ time, std_x, std_y }, dark) {
    if (this.past.length > 0 && time < this.past.at(-1).time) this.past = [];
    this.past.push({ time, dark, spread: std_x === null ? null : 1000 * Math.hypot(std_x, std_y) });
    while (this.past[0].time < time - MINUTE) this.past.shift();
    const known = this.past.filter(({ spread }) => spread !== null);
    const most = 1.2 * Math.max(0.1, ...known.map(({ spread }) => spread));
    const x = (at) => (100 * (at - time)) / MINUTE + 100;
    const step = (row, k) => `M${x(this.past[Math.max(k - 1, 0)].time)} 0H${x(row.time)}V30H${x(this.past[Math.max(k - 1, 0)].time)}Z`;
    this.find(".history .dark").setAttribute("d", this.past.flatMap((row, k) => (row.dark ? [step(row, k)] : [])).join(""));
    this.find(".history .line").setAttribute("d", known.map((row, k) => `${k ? "L" : "M"}${x(row.time)} ${30 * (1 - row.spread / most)}`).join(""));
    this.find(".most").textContent = `spread in the last minute, axis from 0 to ${most.toPrecision(2)} mm`;
  }

  touch({ estimate, tactile }) {
    this.touched.forEach((body, k) => {
      const guess = k === 0 ? estimate.contact_pusher : estimate[`contact_${k}`];
      body.style.setProperty("--guess", guess ?? 0);
      // sensors: of the fixels, then of the pusher and the other fingers
      const sensor = k === 0 ? this.fixels.length : k > this.fixels.length ? k : k - 1;
      body.classList.toggle("touching", tactile[sensor] === true);
    });
  }

  /** Where the particles are, in words. */
  places({ modes, mode_weight, mode_x, mode_y, mode_theta }) {
    if (modes === null || modes === undefined) return ["–", ""];
    if (modes < 2 || mode_weight === null) return ["1 place", ""];
    const at = `${(1000 * mode_x).toFixed(0)}, ${(1000 * mode_y).toFixed(0)} mm, ${((180 / Math.PI) * mode_theta).toFixed(0)}°`;
    return [`${modes} places`, `${(100 * mode_weight).toFixed(0)} % at ${at}`];
  }

  tell({ estimate, count, missed, collapses, latency_ms }) {
    const spread = (key, unit, scale) => (estimate[`std_${key}`] === null ? "–" : `± ${(scale * estimate[`std_${key}`]).toFixed(2)}${unit}`);
    const shown = [
      ["x", `${(1000 * estimate.x).toFixed(1)} mm`, spread("x", " mm", 1000)],
      ["y", `${(1000 * estimate.y).toFixed(1)} mm`, spread("y", " mm", 1000)],
      ["θ", `${((180 / Math.PI) * estimate.theta).toFixed(1)}°`, spread("theta", "°", 180 / Math.PI)],
      ...["mu_s", "mu_p", "mu_f"].map((key) => [key, estimate[key]?.toFixed(3) ?? "–", spread(key, "", 1)]),
      ["spread", estimate.std_x === null ? "–" : `${(1000 * Math.hypot(estimate.std_x, estimate.std_y)).toFixed(2)} mm`, ""],
      ["particles", String(count), estimate.ess === null ? "" : `${estimate.ess.toFixed(0)} effective`],
      ["they are in", ...this.places(estimate)],
      ["collapses", String(collapses), ""],
      ["answer took", `${latency_ms.toFixed(2)} ms`, missed === null ? "" : `${missed} late`],
    ];
    const body = this.find("tbody");
    while (body.rows.length < shown.length) {
      const line = body.insertRow();
      put(line, "th");
      put(line, "td");
      put(line, "td");
    }
    shown.forEach((words, k) => words.forEach((word, cell) => (body.rows[k].cells[cell].textContent = word)));
  }
}

document.querySelectorAll(".live").forEach((root) => new Live(root));
