// Runs before the page's own script: notes whatever goes wrong.
window.trouble = [];
addEventListener("error", (event) => trouble.push(String(event.message)));
addEventListener("unhandledrejection", (event) => trouble.push(String(event.reason)));
for (const level of ["error", "warn"]) console[level] = (...words) => trouble.push(words.join(" "));
// On a busy machine a headless browser may draw no frame in its virtual time; timers always come.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);
window.cancelAnimationFrame = clearTimeout;
