// Runs before the page's own script: notes whatever goes wrong.
window.trouble = [];
addEventListener("error", (event) => trouble.push(String(event.message)));
addEventListener("unhandledrejection", (event) => trouble.push(String(event.reason)));
for (const level of ["error", "warn"]) console[level] = (...words) => trouble.push(words.join(" "));
