// Runs after the page's own script: uses the report as a reader would and writes down what was true.
(async () => {
  const verdict = {};
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const player = document.querySelector(".player");
  const find = (selector) => player.querySelector(selector);
  const drawing = () => find(".stage svg").outerHTML;
  const slider = find("input[type=range]");
  const scrub = (row) => {
    slider.value = row;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    return drawing();
  };
  const press = (key, options = {}) => player.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, ...options }));
  try {
    const [early, late] = [scrub(10), scrub(150)];
    verdict["scrubbing changes the drawing"] = early !== late && early.length > 1000;
    verdict["scrubbing back restores it"] = scrub(10) === early;
    verdict["row 10 is lit"] = !find(".stage").classList.contains("blind") && find(".badge").textContent === "camera on";
    const transform = find(".truth").getAttribute("transform");
    scrub(150);
    verdict["row 150 is occluded"] = find(".stage").classList.contains("blind") && find(".badge").textContent === "camera off";
    verdict["the object moved"] = find(".truth").getAttribute("transform") !== transform;
    const shade = find(".strip .dark");
    const shadeFrom = shade && Number(shade.getAttribute("x"));
    const shown = Number(slider.max) + 1;
    const data = JSON.parse(find("script").textContent);
    // from the last row that was seen on
    const expected = (1000 * (data.time[data.dark[0][0] - 1] - data.time[0])) / (data.time[shown - 1] - data.time[0]);
    verdict["occluded rows are shaded"] = Math.abs(shadeFrom - expected) < 1 && shade.getBoundingClientRect().width > 5;
    verdict["particles are drawn"] = find(".stage").querySelectorAll(".cloud path").length === 120;
    verdict["errors are shown"] = [...player.querySelectorAll(".readout td")].every((cell) => /^\d+\.\d\d$/.test(cell.textContent));
    verdict["contacts are shown"] = /particle filter: \d+ %/.test(find(".contacts").textContent);
    press("ArrowRight");
    press("ArrowRight", { shiftKey: true });
    verdict["arrow keys step"] = player.dataset.row === "161" && slider.value === "161";
    press("Home");
    verdict["Home goes to the start"] = player.dataset.row === "0";
    press(" ");
    await wait(1500);
    press(" ");
    const reached = Number(player.dataset.row);
    await wait(500);
    verdict["play plays and pauses"] = reached > 5 && Number(player.dataset.row) === reached;
    find(".view").value = "near";
    find(".view").dispatchEvent(new Event("change", { bubbles: true }));
    verdict["the view comes near"] = Number(find(".stage svg").getAttribute("viewBox").split(" ")[2]) < data.view[2];
    const box = find(".readout input");
    box.click();
    verdict["a method can be hidden"] = find(".ghost.off") !== null && getComputedStyle(find(".ghost.off")).display === "none";
    verdict["every control has a name"] = [...document.querySelectorAll("button, input, select")].every(
      (control) => control.getAttribute("aria-label") || control.textContent.trim() || control.closest("label"),
    );
    verdict["nothing was loaded"] = performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:"));
    const timed = [...document.querySelectorAll("figure")].filter((figure) => figure.querySelector(".panel"));
    const plot = (figure) => {
      const svg = [...figure.querySelectorAll(".panel")].find((panel) => panel.getBoundingClientRect().width > 0).querySelectorAll("svg");
      return svg[svg.length - 1];
    };
    const frame = (figure) => {
      const svg = figure.querySelector("svg.figure");
      const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
      const [x, y, width, height] = ["x", "y", "width", "height"].map((name) => scale * Number(plot(figure).getAttribute(name)));
      return { x: svg.getBoundingClientRect().x + x, y: svg.getBoundingClientRect().y + y + height / 2, width };
    };
    const on = (figure, type, share, more = {}) => {
      const { x, y, width } = frame(figure);
      const init = { clientX: x + share * width, clientY: y, bubbles: true, cancelable: true, pointerType: "mouse", button: 0, ...more };
      figure.querySelector("svg.figure").dispatchEvent(type.startsWith("pointer") ? new PointerEvent(type, init) : type === "wheel" ? new WheelEvent(type, init) : new MouseEvent(type, init));
    };
    const [from, to] = timed[0].querySelector(".panel").dataset.time.split(" ").map(Number);
    if (innerWidth > 640) {
      on(timed[0], "pointermove", 0.5);
      const read = timed.map((figure) => figure.querySelector(".values").textContent);
      verdict["hover reads every figure at one time"] = timed.length >= 3 && read.every((text) => text.startsWith(`${((from + to) / 2).toFixed(2)} s`));
      // the error of the particle filter is 0.2 mm along y, and 0.2 sin(row) along x
      const row = (15 * (from + to)) / 1;
      const shown = Number(read[0].match(/particle filter(\d\.\d+)/)[1]);
      const near = [Math.floor(row), Math.ceil(row)].map((k) => 0.2 * Math.hypot(Math.sin(k), 1));
      verdict["values are those of the data"] = shown > Math.min(...near) - 0.01 && shown < Math.max(...near) + 0.01;
      on(timed[0], "pointerdown", 0.25);
      on(timed[0], "click", 0.25);
      const moment = from + 0.25 * (to - from);
      const time = data.time[Number(player.dataset.row)] / 1000;
      verdict["a click moves the player"] = Math.abs(time - moment) < 0.05 && location.hash === `#t=${moment.toFixed(2)}`;
      on(timed[1], "pointerdown", 0.2);
      on(timed[1], "click", 0.7);
      const windows = timed.map((figure) => plot(figure).getAttribute("viewBox").split(" ").map(Number));
      verdict["a drag zooms every figure"] = windows.every(([, , width], k) => Math.abs(width / Number(plot(timed[k]).getAttribute("width")) - 0.5) < 0.01);
      on(timed[1], "wheel", 0.5, { deltaY: -200, ctrlKey: true });
      verdict["a pinch zooms further"] = Number(plot(timed[0]).getAttribute("viewBox").split(" ")[2]) < 0.9 * windows[0][2];
      on(timed[0], "dblclick", 0.5);
      verdict["a double click shows all"] = Number(plot(timed[2]).getAttribute("viewBox").split(" ")[2]) === Number(plot(timed[2]).getAttribute("width"));
      on(timed[0], "pointerleave", 0.5);
      location.hash = "#t=2.5";
      await wait(300);
      verdict["an address leads to a moment"] = Math.abs(data.time[Number(player.dataset.row)] / 1000 - 2.5) < 0.02;
      verdict["a figure can be saved"] = timed.every((figure) => figure.querySelector("button.save"));
      verdict["terms are explained"] = document.querySelectorAll("abbr[title]").length >= 4;
    }
    const figures = [...document.querySelectorAll("figure")];
    const letters = (figure) => {
      const seen = [...figure.querySelectorAll("svg.figure")].filter((svg) => svg.getBoundingClientRect().width > 0);
      const svg = seen.length === 1 && seen[0];
      return svg ? (Number(svg.getAttribute("font-size")) * svg.getBoundingClientRect().width) / svg.viewBox.baseVal.width : 0;
    };
    verdict["no figure is scrolled"] = figures.length >= 5 && figures.every((figure) => figure.scrollWidth <= figure.clientWidth);
    verdict["each figure is seen once, in letters to read"] = figures.every((figure) => letters(figure) >= 10.5 && letters(figure) <= 20);
    verdict["fits the width"] = document.documentElement.scrollWidth <= innerWidth;
  } catch (error) {
    trouble.push(String(error.stack));
  }
  verdict["no trouble"] = trouble.length === 0 || trouble;
  const text = document.createElement("pre");
  text.id = "verdict";
  text.textContent = JSON.stringify(verdict);
  document.body.append(text);
})();
