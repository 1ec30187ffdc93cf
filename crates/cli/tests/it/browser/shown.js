// What the live page shows once it says STATE, or what it shows after 30 s: a promise of it.
new Promise((resolve) => {
  const begin = Date.now();
  const look = () => {
    const root = document.querySelector(".live");
    if (root?.dataset.state !== "STATE" && Date.now() - begin < 30000) return setTimeout(look, 50);
    const place = (name) => document.querySelector(`.${name}`)?.getAttribute("transform")?.match(/-?[0-9.]+(e-?[0-9]+)?/g).map(Number);
    const hidden = (name) => document.querySelector(`.${name}`)?.style.display === "none";
    resolve({
      state: root?.dataset.state,
      truth: place("truth"),
      ghost: place("ghost"),
      truthHidden: hidden("truth"),
      particles: document.querySelectorAll(".cloud path[transform]").length,
      names: [...document.querySelectorAll(".live tbody th")].map((cell) => cell.textContent),
      cells: [...document.querySelectorAll(".live tbody td")].map((cell) => cell.textContent),
      overflow: document.documentElement.scrollWidth - innerWidth,
    });
  };
  look();
});
