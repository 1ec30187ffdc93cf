// One cursor and one time axis for all figures against time in a part of the page, and for its player. Panels of a figure carry their
// limits (`data-time`, `data-values`) and the names of their curves; values are read from the curves as drawn.
"use strict";

/** Most that a time axis can be stretched: a curve is drawn to a tenth of a pixel. */
const MOST_ZOOM = 50;

/** The part of a figure under one pair of axes. */
class Panel {
  constructor(root) {
    this.root = root;
    this.clips = [...root.querySelectorAll("svg")];
    const clip = this.clips[this.clips.length - 1];
    [this.left, this.top, this.width, this.height] = ["x", "y", "width", "height"].map((name) => Number(clip.getAttribute(name)));
    this.whole = root.dataset.time.split(" ").map(Number);
    this.values = root.dataset.values.split(" ").map(Number);
    this.log = "log" in root.dataset;
    this.svg = root.closest("svg.figure");
    this.ticks = root.querySelector(".ticks");
    this.drawn = this.ticks.innerHTML;
    this.names = [...this.svg.querySelectorAll("[data-at]")];
    this.cursor = add(clip, "path", { class: "cursor" });
    this.show(this.whole);
  }

  /** Place of a time of the whole axis (px of the drawing), as curves are drawn. */
  at = (time, [from, to] = this.whole) => this.left + (this.width * (time - from)) / (to - from);

  /** Time under a pointer; null outside the axes. */
  timeOf(event) {
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    const inside = x >= this.left && x <= this.left + this.width && y >= this.top && y <= this.top + this.height;
    return inside ? this.from + ((this.to - this.from) * (x - this.left)) / this.width : null;
  }

  /** Shows the times from..to. */
  show([from, to]) {
    [this.from, this.to] = [from, to];
    const [x0, x1] = [this.at(from), this.at(to)];
    for (const clip of this.clips) clip.setAttribute("viewBox", `${x0} ${this.top} ${x1 - x0} ${this.height}`);
    if (from === this.whole[0] && to === this.whole[1]) this.ticks.innerHTML = this.drawn;
    else this.drawTicks();
    for (const name of this.names) {
      const time = Number(name.dataset.at);
      name.style.display = time < from || time > to ? "none" : "";
      name.setAttribute("transform", `translate(${this.at(time, [from, to]) - this.at(time)} 0)`);
    }
  }

  drawTicks() {
    const span = this.to - this.from;
    const power = 10 ** Math.floor(Math.log10((span * 80) / this.width));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= (span * 80) / this.width);
    const [stroke, ...numbers] = this.ticks.children;
    const sample = numbers[0]?.cloneNode();
    numbers.forEach((number) => number.remove());
    let strokes = "";
    for (let k = Math.ceil(this.from / step); k * step <= this.to; k += 1) {
      const x = this.at(k * step, [this.from, this.to]);
      strokes += `M${x} ${this.top + this.height}v5`;
      if (!sample) continue;
      const number = this.ticks.appendChild(sample.cloneNode());
      number.setAttribute("x", x);
      number.textContent = (k * step).toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "\u2212");
    }
    stroke.setAttribute("d", strokes);
  }

  /** Draws the cursor, which scales with the axis. */
  point(time) {
    this.cursor.setAttribute("d", time === null ? "" : `M${this.at(time)} ${this.top}v${this.height}`);
  }

  /** Name, colour and words of each curve and bar at a time. */
  read(time) {
    const x = this.at(time);
    return [...this.root.querySelectorAll("[data-name]")].reverse().flatMap((group) => {
      const path = group.querySelector("path");
      if (!path) {
        const bars = [...group.querySelectorAll("rect")].map((bar) => ["x", "width"].map((name) => Number(bar.getAttribute(name))));
        return [{ name: group.dataset.name, colour: group.firstChild?.getAttribute("fill"), words: bars.some(([a, b]) => a <= x && x <= a + b) ? "yes" : "no" }];
      }
      path.points ??= pointsOf(path.getAttribute("d"));
      const value = valueAt(path.points, x);
      return value === null ? [] : [{ name: group.dataset.name, colour: path.getAttribute("stroke"), words: this.valueOf(value) }];
    });
  }

  valueOf(y) {
    const [low, high] = this.log ? this.values.map(Math.log10) : this.values;
    const value = high - ((high - low) * (y - this.top)) / this.height;
    // what a tenth of a pixel tells
    const shown = this.log ? (10 ** value).toPrecision(3) : value.toFixed(Math.max(0, 3 - Math.ceil(Math.log10(high - low))));
    return Number(shown).toString();
  }
}

/** Points of a path of M and l, as figures write it; null between two lines. */
function pointsOf(path) {
  let [x, y] = [0, 0];
  return [...path.matchAll(/([Ml])(-?[\d.]+) (-?[\d.]+)/g)].flatMap(([, command, across, down]) => {
    const begins = command === "M";
    [x, y] = begins ? [Number(across), Number(down)] : [x + Number(across), y + Number(down)];
    return begins ? [null, [x, y]] : [[x, y]];
  });
}

/** Height of a line at x, between its points. */
function valueAt(points, x) {
  const next = points.findIndex((point, k) => point && point[0] >= x && (point[0] === x || points[k - 1]));
  if (next < 0) return null;
  const [after, before] = [points[next], points[next - 1]];
  if (after[0] === x || !before) return after[1];
  return before[0] > x ? null : before[1] + ((after[1] - before[1]) * (x - before[0])) / (after[0] - before[0]);
}

/** The figures of a part of the page, and its player. */
class Timeline {
  constructor(figures, player) {
    this.player = player;
    this.figures = figures.map((root) => ({ root, panels: [...root.querySelectorAll(".panel")].map((panel) => new Panel(panel)) }));
    this.panels = this.figures.flatMap(({ panels }) => panels);
    this.whole = [Math.min(...this.panels.map((panel) => panel.whole[0])), Math.max(...this.panels.map((panel) => panel.whole[1]))];
    this.window = this.whole;
    for (const figure of this.figures) this.listen(figure);
    player?.root.addEventListener("time", ({ detail }) => this.point(detail));
    this.point(player ? player.time : null);
  }

  point(time) {
    this.time = time;
    for (const panel of this.panels) panel.point(time);
  }

  /** Shows from..to in every figure, within its own times. */
  zoom([from, to]) {
    const [first, last] = this.whole;
    const span = Math.min(Math.max(to - from, (last - first) / MOST_ZOOM), last - first);
    const start = Math.min(Math.max((from + to - span) / 2, first), last - span);
    this.window = [start, start + span];
    const all = span === last - first;
    for (const panel of this.panels) panel.show(all ? panel.whole : this.window);
    for (const { root } of this.figures) root.classList.toggle("zoomed", !all);
  }

  /** Values of every figure at a time; none at null. */
  read(time) {
    // what is visible is asked before anything is written, so that the page is laid out once
    const visible = ({ svg }) => svg.getBoundingClientRect().width > 0;
    const figures = this.figures.map(({ root, panels }) => ({ root, shown: panels.filter(visible) }));
    for (const { root, shown } of figures) {
      const box = root.querySelector(".values") ?? put(root, "div", "values");
      box.replaceChildren();
      box.hidden = time === null;
      if (time === null) continue;
      put(box, "b", "", `${time.toFixed(2)} s`);
      for (const panel of shown) {
        put(box, "i", "", panel.root.dataset.label);
        for (const { name, colour, words } of panel.read(time)) {
          const line = put(box, "span");
          put(line, "span", "swatch").style.background = colour;
          line.append(name);
          put(line, "b", "", words);
        }
      }
      // beside the cursor, on the side that has more room
      const panel = shown[0];
      if (!panel) continue;
      const share = (panel.at(time, [panel.from, panel.to]) / panel.svg.viewBox.baseVal.width) * 100;
      box.style.left = share < 55 ? `${share + 1.5}%` : "";
      box.style.right = share < 55 ? "" : `${101.5 - share}%`;
    }
  }

  listen({ root, panels }) {
    let begin = null;
    const timeOf = (event) => panels.map((panel) => panel.timeOf(event)).find((time) => time !== null) ?? null;
    root.addEventListener("pointermove", (event) => {
      const time = timeOf(event);
      if (time === null) return;
      for (const panel of this.panels) panel.point(time);
      this.read(time);
    });
    root.addEventListener("pointerleave", () => (this.point(this.time), this.read(null)));
    root.addEventListener("pointerdown", (event) => (begin = event.button === 0 && event.pointerType === "mouse" ? timeOf(event) : null));
    // a drag chooses times, a click a time
    root.addEventListener("click", (event) => {
      const time = timeOf(event);
      const [from, to] = begin === null || time === null ? [0, 0] : [Math.min(begin, time), Math.max(begin, time)];
      begin = null;
      if (time === null) return;
      if (to - from > 0.01 * (this.window[1] - this.window[0])) return this.zoom([from, to]);
      if (this.player) this.player.seek(time);
      else this.point(time);
      remember(this.player, time);
    });
    root.addEventListener("dblclick", () => this.zoom(this.whole));
    root.addEventListener("wheel", (event) => {
      const time = timeOf(event);
      // a wheel alone scrolls the page; a pinch on a touchpad comes as a wheel with Ctrl
      if (time === null || !(event.ctrlKey || event.shiftKey)) return;
      event.preventDefault();
      const factor = Math.exp(0.002 * (event.deltaY || event.deltaX));
      this.zoom(this.window.map((end) => time + factor * (end - time)));
    }, { passive: false });
  }
}

/** Writes the moment shown into the page's address: #t=6.83, or #part&t=6.83 of a further player. */
function remember(player, time) {
  const part = player && player !== players[0] ? `${player.root.closest(".part").id}&` : "";
  try {
    history.replaceState(null, "", `#${part}t=${time.toFixed(2)}`);
  } catch {
    // a page inside a notebook has no address of its own
  }
}

/** Goes to the moment that the address names. */
function follow() {
  const [, part, time] = decodeURIComponent(location.hash).match(/^#(?:(.+)&)?t=([\d.]+)$/) ?? [];
  const player = part ? players.find(({ root }) => root.closest(".part").id === part) : players[0];
  if (time === undefined || !player) return;
  player.seek(Number(time));
  player.root.scrollIntoView();
}

/** Joins the figures of a part of the page with its players. */
function joinFigures(root) {
  for (const part of root.querySelectorAll(".part, .summary")) {
    const figures = [...part.querySelectorAll("figure")].filter((figure) => figure.querySelector(".panel"));
    const player = players.find(({ root }) => part.contains(root));
    // figures of one experiment share their times; others stand for themselves
    for (const group of player ? [figures] : figures.map((figure) => [figure])) if (group.length > 0) new Timeline(group, player);
  }
  for (const [k, figure] of root.querySelectorAll("figure").entries()) {
    const caption = figure.querySelector("figcaption") ?? put(figure, "figcaption");
    const button = put(caption, "button", "save", "SVG");
    button.title = "save the figure as an SVG file";
    button.addEventListener("click", () => {
      const picture = figure.querySelector("svg.figure").cloneNode(true);
      picture.querySelectorAll(".cursor").forEach((line) => line.remove());
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([picture.outerHTML], { type: "image/svg+xml" }));
      link.download = `figure-${k + 1}.svg`;
      link.click();
      URL.revokeObjectURL(link.href);
    });
  }
}

joinFigures(document);
addEventListener("hashchange", follow);
follow();
