// Plays experiments back. Each <section class="player"> holds its controls and its data: lengths in 0.01 mm, angles in 1e-4 rad, times in
// ms, errors in 0.001 mm and 0.001 degrees, columns of equal length with null where nothing is known. Nothing is loaded.
"use strict";

const SVG = "http://www.w3.org/2000/svg";
const LOWEST = 0.01; // smallest error on the strip (mm)

/** A new SVG element in a parent. */
function add(parent, name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return parent.appendChild(element);
}

/** A new HTML element in a parent. */
function put(parent, name, className, text) {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}

/** A body: its inside and its boundary, moved together. */
function addBody(parent, shape, className, colour) {
  const group = add(parent, "g", { class: className });
  add(group, "path", { d: shape.area, class: "area" });
  add(group, "path", { d: shape.line, class: "line" });
  if (colour) group.style.setProperty("--colour", colour);
  return group;
}

/** Moves a body to a pose in the units of the data; without one it is not shown. */
function moveTo(group, x, y, theta) {
  const known = x !== null && x !== undefined;
  group.style.display = known ? "" : "none";
  if (known) group.setAttribute("transform", `translate(${x / 100} ${y / 100}) rotate(${(theta * 1e-4 * 180) / Math.PI})`);
}

const at = (pose, row) => [pose.x[row], pose.y[row], pose.theta[row]];
const fixed = (value, scale, decimals) => (value === null ? "–" : (Math.abs(value) / scale).toFixed(decimals));

class Player {
  constructor(root) {
    this.root = root;
    this.find = (selector) => root.querySelector(selector);
    this.data = JSON.parse(this.find("script").textContent);
    this.rows = this.data.time.length;
    this.stage = this.find(".stage");
    this.slider = this.find("input[type=range]");
    this.playing = null;
    this.guesser = this.data.methods.find((method) => method.contact);
    root.classList.toggle("bare", this.data.methods.length === 0);
    this.drawStage();
    this.drawStrip();
    this.fillReadout();
    this.listen();
    this.show(this.data.poster);
  }

  drawStage() {
    const { data } = this;
    const [left, low, width, height] = data.view;
    this.svg = this.find(".stage svg");
    this.whole = `${left} ${-low - height} ${width} ${height}`;
    this.svg.setAttribute("viewBox", this.whole);
    this.svg.style.aspectRatio = `${width} / ${height}`;
    const world = add(this.svg, "g", { transform: "scale(1 -1)" });
    let grid = "";
    for (let x = Math.ceil(left / 10) * 10 - 200; x < left + width + 200; x += 10) grid += `M${x} ${low - 200}v${height + 400}`;
    for (let y = Math.ceil(low / 10) * 10 - 200; y < low + height + 200; y += 10) grid += `M${left - 200} ${y}h${width + 400}`;
    add(world, "path", { d: grid, class: "grid" });
    for (const way of data.feet.length > 0 ? [data.truth, ...data.fingerPoses] : [data.truth]) {
      const trail = way.x.flatMap((x, row) => (x === null ? [] : [`${x / 100} ${way.y[row] / 100}`]));
      if (trail.length > 1) add(world, "path", { d: `M${trail.join("L")}`, class: "trail" });
    }
    this.truth = addBody(world, data.object, "truth");
    for (const [x, y] of data.feet) add(this.truth, "circle", { cx: x / 100, cy: y / 100, r: 0.06 * data.reach, class: "foot" });
    add(this.truth, "path", { d: "M-3 0H3M0 -3V3", class: "line" });
    this.clouds = data.methods.map((method) => {
      const group = add(world, "g", { class: "cloud" });
      group.style.setProperty("--colour", method.colour);
      const count = method.cloud ? Math.max(...method.cloud.map((row) => row.length / 3)) : 0;
      return { group, bodies: Array.from({ length: count }, () => add(group, "path", { d: data.object.line })) };
    });
    this.fixels = data.fixels.map((fixel, k) => {
      const group = addBody(world, fixel, "fixel");
      const place = `translate(${fixel.middle[0]} ${fixel.middle[1]}) scale(1 -1)`;
      add(group, "text", { transform: place, dy: "0.35em" }).textContent = k + 1;
      return group;
    });
    this.fingers = data.fingers.map((finger) => addBody(world, finger, "pusher"));
    this.ghosts = data.methods.map((method) => {
      const ghost = addBody(world, data.object, "ghost", method.colour);
      if (method.dashes) ghost.lastChild.style.strokeDasharray = method.dashes;
      return ghost;
    });
    // in the order of their contacts
    this.bodies = [this.fingers[0], ...this.fixels, ...this.fingers.slice(1)];
    for (const k of data.order) world.append(this.ghosts[k]);
    const length = [50, 20, 10, 5, 2, 1].find((mm) => mm <= 0.15 * width) ?? 1;
    const bar = add(this.svg, "g", { class: "scale" });
    add(bar, "path", { d: `M${left + 0.04 * width} ${-low - 0.05 * height}h${length}` });
    add(bar, "text", { x: left + 0.04 * width + length / 2, y: -low - 0.06 * height }).textContent = `${length} mm`;
    this.svg.style.setProperty("--letter", `${width / 32}px`);
  }

  /** Errors against time, with the dark rows shaded and the contacts named. */
  drawStrip() {
    const { data } = this;
    const strip = this.find(".strip svg");
    const errors = data.methods.flatMap((method) => method.error.filter((error) => error !== null));
    const top = Math.log10(Math.max(2, 1.3e-3 * errors.reduce((most, error) => Math.max(most, error), 0)));
    const bottom = Math.log10(LOWEST);
    const y = (mm) => 100 * (1 - (Math.log10(Math.max(mm, LOWEST)) - bottom) / (top - bottom));
    for (const [from, to] of data.dark) {
      // a row speaks of the time since the one before it
      const x = this.place(Math.max(from - 1, 0));
      add(strip, "rect", { class: "dark", x, y: 0, width: this.place(to - 1) - x, height: 100 });
    }
    for (let decade = bottom + 1; decade < top; decade += 1) {
      add(strip, "path", { class: "grid", d: `M0 ${y(10 ** decade)}H1000` });
      put(this.find(".strip"), "span", "decade", `${10 ** Math.round(decade)} mm`).style.top = `${y(10 ** decade)}%`;
    }
    this.curves = data.methods.map((method) => {
      const known = (row) => (method.error[row] ?? null) !== null;
      const point = (row) => `${this.place(row).toFixed(1)} ${y(method.error[row] / 1000).toFixed(1)}`;
      const rows = [...method.error.keys()].filter(known);
      const curve = add(strip, "g", { class: "curve" });
      curve.style.setProperty("--colour", method.colour);
      const line = add(curve, "path", { d: rows.map((row) => `${known(row - 1) ? "L" : "M"}${point(row)}`).join("") });
      if (method.dashes) line.style.strokeDasharray = method.dashes;
      // between two rows without an error there is no line to draw
      const alone = rows.filter((row) => !known(row - 1) && !known(row + 1));
      if (alone.length > 0) add(curve, "path", { class: "dots", d: alone.map((row) => `M${point(row)}h0`).join("") });
      return curve;
    });
    for (const k of data.order) strip.append(this.curves[k]);
    for (const [row] of data.marks) add(strip, "path", { class: "mark", d: `M${this.place(row)} 0V100` });
    this.head = add(strip, "path", { class: "head", d: "M0 0V100" });
    const names = this.find(".marks");
    this.marks = data.marks.map(([row, name]) => {
      const button = put(names, "button", "", name);
      button.type = "button";
      button.title = `go to: ${name}`;
      button.addEventListener("click", () => this.jump(row));
      return { button, row };
    });
    this.arrangeMarks();
  }

  /** Names of contacts over their instants, on further lines where they would cover each other. */
  arrangeMarks() {
    const names = this.find(".marks");
    const room = names.clientWidth;
    const lines = [];
    for (const { button, row } of this.marks) {
      const width = button.offsetWidth;
      const left = Math.min(Math.max((this.place(row) / 1000) * room - width / 2, 0), room - width);
      let line = lines.findIndex((end) => end + 4 <= left);
      if (line < 0) line = lines.push(0) - 1;
      lines[line] = left + width;
      button.style.left = `${left}px`;
      button.style.bottom = `${line * 1.7}em`;
    }
    names.style.height = `${Math.max(1, lines.length) * 1.7}em`;
  }

  /** Where a row stands on the strip, 0 to 1000. */
  place(row) {
    const time = this.data.time;
    const span = time[this.rows - 1] - time[0] || 1;
    return (1000 * (time[Math.min(Math.max(row, 0), this.rows - 1)] - time[0])) / span;
  }

  fillReadout() {
    const body = this.find(".readout tbody");
    this.cells = this.data.methods.map((method, k) => {
      const line = put(body, "tr");
      const label = put(put(line, "th"), "label");
      const box = put(label, "input");
      box.type = "checkbox";
      box.checked = true;
      box.addEventListener("change", () => {
        for (const element of [this.ghosts[k], this.clouds[k].group, this.curves[k]]) element.classList.toggle("off", !box.checked);
      });
      put(label, "span", "swatch").style.background = method.colour;
      label.append(method.name);
      return [put(line, "td"), put(line, "td")];
    });
    const list = this.find(".contacts");
    this.chips = this.data.touches.map((touch) => {
      const item = put(list, "li");
      put(item, "b", "", touch.name);
      return { item, words: put(item, "span") };
    });
  }

  listen() {
    this.slider.addEventListener("input", () => this.jump(Number(this.slider.value)));
    this.find(".play").addEventListener("click", () => this.toggle());
    for (const [name, step] of [[".back", -1], [".next", 1]]) this.find(name).addEventListener("click", () => this.jump(this.row + step));
    this.find(".view").addEventListener("change", () => this.show(this.row));
    const strip = this.find(".strip");
    const scrub = (event) => {
      const box = strip.getBoundingClientRect();
      const time = this.data.time[0] + ((event.clientX - box.left) / box.width) * (this.data.time[this.rows - 1] - this.data.time[0]);
      this.seek(time / 1000);
    };
    strip.addEventListener("pointerdown", (event) => (strip.setPointerCapture(event.pointerId), scrub(event)));
    strip.addEventListener("pointermove", (event) => event.buttons && scrub(event));
    this.root.addEventListener("keydown", (event) => {
      if (event.target.closest("select, .readout, .marks") || event.ctrlKey || event.altKey || event.metaKey) return;
      const far = event.shiftKey ? 10 : 1;
      const rows = { ArrowLeft: this.row - far, ArrowRight: this.row + far, Home: 0, End: this.rows - 1 };
      if (event.key in rows) this.jump(rows[event.key]);
      else if (event.key === " " && !event.target.closest("button")) this.toggle();
      else return;
      event.preventDefault();
    });
    // which ends with the player, where another takes its place
    new ResizeObserver(() => this.arrangeMarks()).observe(strip);
  }

  /** Time shown (s). */
  get time() {
    return this.data.time[this.row] / 1000;
  }

  /** Stops and shows the row at a time (s). */
  seek(time) {
    const row = this.data.time.findIndex((t) => t >= 1000 * time - 0.5);
    this.jump(row < 0 ? this.rows - 1 : row);
  }

  /** Stops and shows a row. */
  jump(row) {
    if (this.playing !== null) this.toggle();
    this.show(row);
  }

  toggle() {
    const button = this.find(".play");
    if (this.playing !== null) {
      cancelAnimationFrame(this.playing);
      this.playing = null;
    } else {
      if (this.row === this.data.poster || this.row === this.rows - 1) this.show(this.data.start);
      let last = null;
      let time = this.data.time[this.row];
      const tick = (now) => {
        time += last === null ? 0 : (now - last) * Number(this.find(".speed").value);
        last = now;
        let row = this.row;
        while (row + 1 < this.rows && this.data.time[row + 1] <= time) row += 1;
        if (row !== this.row) this.show(row);
        if (row + 1 < this.rows) this.playing = requestAnimationFrame(tick);
        else this.toggle();
      };
      this.playing = requestAnimationFrame(tick);
    }
    const runs = this.playing !== null;
    button.textContent = runs ? "❚❚ pause" : "▶ play";
    button.setAttribute("aria-pressed", String(runs));
  }

  show(wanted) {
    const { data } = this;
    const row = (this.row = Math.min(Math.max(wanted, 0), this.rows - 1));
    const blind = data.hidden[row] === 1;
    this.stage.classList.toggle("blind", blind);
    moveTo(this.truth, ...at(data.truth, row));
    this.fingers.forEach((finger, k) => moveTo(finger, ...at(data.fingerPoses[k], row)));
    data.methods.forEach((method, k) => {
      moveTo(this.ghosts[k], ...at(method.pose, row));
      const cloud = method.cloud ? method.cloud[row] : [];
      this.clouds[k].bodies.forEach((body, j) => {
        const [dx, dy, turn] = cloud.slice(3 * j, 3 * j + 3);
        moveTo(body, dx === undefined ? null : method.pose.x[row] + dx, method.pose.y[row] + dy, method.pose.theta[row] + turn);
      });
      this.cells[k][0].textContent = fixed(method.error[row], 1000, 2);
      this.cells[k][1].textContent = fixed(method.turn[row], 1000, 2);
    });
    this.showContacts(row);
    const seconds = (data.time[row] / 1000).toFixed(2);
    const camera = blind ? "camera off" : "camera on";
    this.find(".clock").textContent = `${seconds} s · row ${data.stride * row}`;
    this.find(".badge").textContent = camera;
    this.slider.value = row;
    this.slider.setAttribute("aria-valuetext", `${seconds} s, ${camera}`);
    this.head.setAttribute("d", `M${this.place(row)} 0V100`);
    this.root.dataset.row = row;
    this.root.dispatchEvent(new CustomEvent("time", { detail: this.time }));
    this.zoom(row);
  }

  /** Which bodies touch: truly, by their sensor, and how probably according to each particle filter. */
  showContacts(row) {
    this.data.touches.forEach((touch, k) => {
      const known = touch.truth ? touch.truth[row] : null;
      const sensed = touch.sensed ? touch.sensed[row] : null;
      const guess = this.guesser ? this.guesser.contact[k][row] : null;
      const touches = known === 1 || (known === null && sensed === 1);
      const words = [known === null ? null : known ? "touches" : "apart", sensed === null ? null : `sensor ${sensed}`];
      if (guess !== null) words.push(`${this.guesser.name}: ${guess} %`);
      this.chips[k].words.textContent = words.filter((word) => word !== null).join(" · ") || "not known";
      this.chips[k].item.classList.toggle("touching", touches);
      const body = this.bodies[k];
      body.classList.toggle("touching", touches);
      body.style.setProperty("--guess", (guess ?? 0) / 100);
    });
  }

  /** The whole table, or near the object. */
  zoom(row) {
    const known = [this.data.truth, (this.guesser ?? this.data.methods[0])?.pose].find((pose) => pose && pose.x[row] !== null);
    const [x, y] = known ? at(known, row) : [];
    const near = this.find(".view").value === "near" && known !== undefined;
    const [, , width, height] = this.data.view;
    const size = 2.4 * this.data.reach;
    const scale = Math.min(1, size / Math.min(width, height));
    const [w, h] = [width * scale, height * scale];
    this.svg.setAttribute("viewBox", near ? `${x / 100 - w / 2} ${-y / 100 - h / 2} ${w} ${h}` : this.whole);
    this.find(".scale").style.display = near ? "none" : "";
  }
}

/** The players of the page. */
const players = [];

/** Begins the players of a part of the page, which take the place of those before. */
function beginPlayers(root) {
  players.splice(0, Infinity, ...[...root.querySelectorAll(".player:not(.live)")].map((player) => new Player(player)));
}

beginPlayers(document);
