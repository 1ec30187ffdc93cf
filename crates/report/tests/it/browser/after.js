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
