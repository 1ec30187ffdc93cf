// The page of `stickslip view`. The program reads, checks, runs and draws; this script asks it and shows its answers.
"use strict";

/** Time that a slider rests before the filter runs (ms). */
const REST = 150;

class View {
  constructor(root) {
    this.find = (selector) => root.querySelector(selector);
    const { logs, mostMegabytes } = JSON.parse(this.find("script").textContent);
    this.most = mostMegabytes;
    /** Name of the log shown, number of its latest run, and the values that were changed. */
    this.log = null;
    this.run = 0;
    this.changed = {};
    this.connect();
    this.listen(root);
    this.list(logs);
  }

  /** Asks the program; its answer, or its words as an error. */
  async ask(what, question) {
    const body = JSON.stringify(question);
    const answer = await fetch(`/${what}${location.search}`, { method: "POST", body }).catch(() => {
      throw new Error("The program does not answer. Look at its terminal, and start it again.");
    });
    if (!answer.ok) throw new Error(await answer.text());
    const { answer: text, error } = await answer.json();
    if (error !== undefined) throw new Error(error);
    return text;
  }

  /** Does something, and shows what went wrong. */
  async attempt(doing) {
    this.fail("");
    await doing().catch((error) => this.fail(error.message));
  }

  fail(words) {
    const failed = this.find(".failed");
    failed.textContent = words;
    if (words) failed.scrollIntoView({ block: "center" });
  }

  say(words) {
    this.find(".said").textContent = words;
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/socket${location.search}`);
    socket.addEventListener("message", ({ data }) => {
      const { run, row, rows } = JSON.parse(data);
      if (run !== this.run || !this.running) return;
      this.find("progress").value = row / rows;
    });
    socket.addEventListener("close", () => setTimeout(() => this.connect(), 1000));
  }

  listen(root) {
    const files = this.find("input[type=file]");
    files.addEventListener("change", () => this.attempt(() => this.take([...files.files])));
    this.find(".run").addEventListener("click", () => this.runFilter());
    this.find(".keep").addEventListener("click", () => this.attempt(() => this.save()));
    addEventListener("dragover", (event) => (event.preventDefault(), root.classList.add("over")));
    addEventListener("dragleave", (event) => event.relatedTarget ?? root.classList.remove("over"));
    addEventListener("drop", (event) => {
      event.preventDefault();
      root.classList.remove("over");
      this.attempt(() => this.take([...event.dataTransfer.files]));
    });
  }

  /** Lists logs, and checks one after the other. */
  async list(names) {
    const list = this.find(".logs");
    const items = names.map((name) => {
      const button = put(put(list, "li"), "button", "", name);
      button.type = "button";
      button.addEventListener("click", () => this.attempt(() => this.open(name, button)));
      return { name, button, told: put(button, "span") };
    });
    if (list.children.length === 0) this.fail("No log is listed. Drop one, or start `stickslip view FOLDER`.");
    if (names.length === 1) await this.attempt(() => this.open(names[0], items[0].button));
    for (const { name, told } of items) {
      const words = ({ problems, warnings }) => `${problems} ${problems === 1 ? "problem" : "problems"}, ${warnings} ${warnings === 1 ? "warning" : "warnings"}`;
      const found = this.ask("check", { log: name }).then((text) => words(JSON.parse(text)));
      told.textContent = await found.catch(() => "cannot be read");
    }
  }

  /** Sends files to the program, and opens the log that they are. */
  async take(files) {
    const megabytes = files.reduce((sum, file) => sum + file.size, 0) / 1e6;
    if (megabytes > this.most) {
      throw new Error(`These files have ${megabytes.toFixed(0)} MB; the page takes at most ${this.most} MB. Put them into a folder, and start \`stickslip view FOLDER\`.`);
    }
    const texts = await Promise.all(files.map(async (file) => ({ name: file.name, text: await file.text() })));
    await this.list([JSON.parse(await this.ask("drop", { files: texts }))]);
  }

  async open(name, button) {
    const { findings, sliders, html } = JSON.parse(await this.ask("open", { log: name }));
    for (const other of this.find(".logs").querySelectorAll("button")) other.removeAttribute("aria-current");
    button.setAttribute("aria-current", "true");
    this.log = name;
    this.run += 1;
    this.running = this.hasRun = false;
    this.changed = {};
    this.find(".log").hidden = false;
    this.find("progress").value = 0;
    this.say("");
    this.showFindings(findings);
    this.find(".sliders").replaceChildren();
    for (const slider of sliders) this.addSlider(slider);
    this.show(html);
  }

  showFindings(findings) {
    for (const list of [".findings", ".fine"].map(this.find)) list.replaceChildren();
    for (const { severity, subject, found, advice } of findings) {
      const item = put(this.find(severity === "ok" ? ".fine" : ".findings"), "li", severity);
      put(item, "b", "", `${severity}, ${subject}: `);
      item.append(advice ? `${found}. ${advice[0].toUpperCase()}${advice.slice(1)}.` : `${found}.`);
    }
    if (this.find(".findings").children.length === 0) put(this.find(".findings"), "li", "", "Nothing was found that is wrong.");
  }

  addSlider({ key, label, value, range: [low, high], step, unit }) {
    const box = put(this.find(".sliders"), "label", "", label);
    const number = put(box, "span");
    const input = put(box, "input");
    const isSwitch = high === 1 && step === 1;
    input.type = isSwitch ? "checkbox" : "range";
    input.name = key;
    if (isSwitch) input.checked = value === 1;
    else Object.assign(input, { min: low, max: high, step: step ?? "any", value });
    const tell = (shown) => (number.textContent = isSwitch ? "" : `${Number(shown.toPrecision(3))}${unit}`);
    tell(value);
    input.addEventListener("input", () => {
      const place = step ? Number(input.value) : Number(Number(input.value).toPrecision(3));
      const now = isSwitch ? Number(input.checked) : Math.min(high, Math.max(low, place));
      tell(now);
      this.changed[key] = now;
      clearTimeout(this.waiting);
      this.waiting = setTimeout(() => this.runFilter(), REST);
    });
  }

  /** Runs the filter in place of a run that has not ended. */
  runFilter() {
    const { log } = this;
    const run = (this.run = Math.random());
    this.running = true;
    this.find("progress").value = 0;
    this.say("runs");
    this.attempt(async () => {
      const html = await this.ask("run", { log, run, changed: this.changed }).catch((error) => {
        // of a run that another has replaced nothing is said
        if (run !== this.run) return null;
        this.running = false;
        this.say("");
        throw error;
      });
      if (html === null || run !== this.run) return;
      this.running = false;
      this.find("progress").value = 1;
      this.say("done");
      this.show(html);
      this.hasRun = true;
    });
  }

  /** Shows a player and its figures, at the moment that was shown before. */
  show(html) {
    const time = this.hasRun ? players[0]?.time : undefined;
    const shown = this.find(".shown");
    shown.innerHTML = html;
    beginPlayers(shown);
    joinFigures(shown);
    if (time !== undefined) players[0]?.seek(time);
  }

  async save() {
    const text = await this.ask("scene", { log: this.log, changed: this.changed });
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
    link.download = "scene.toml";
    link.click();
    URL.revokeObjectURL(link.href);
    this.say("saved as scene.toml");
  }
}

new View(document.querySelector(".view"));
