// Puts the page together.

const systemTheme = window.matchMedia("(prefers-color-scheme: dark)");

/** Settings of a file opened from a disk may not be kept; then the theme is that of the system. */
function remembered(value) {
  try {
    if (value !== undefined) localStorage.setItem("jstsph-theme", value);
    return localStorage.getItem("jstsph-theme") ?? "";
  } catch {
    return value ?? "";
  }
}

let view = null;
const charts = [];

function applyTheme() {
  const choice = element("theme").value;
  document.documentElement.dataset.theme = choice || (systemTheme.matches ? "dark" : "light");
  charts.forEach((chart) => chart.draw());
  view?.redraw();
}

function showCharts() {
  const onTime = (time) => view?.show(view.frames.nearest(time));
  for (const diagram of DATA.diagrams) {
    const chart = new Chart(diagram, onTime);
    charts.push(chart);
    element("charts").append(chart.node);
  }
  if (charts.length === 0) element("charts").append(make("p", { class: "message" }, "No history was recorded."));
  new ResizeObserver(() => charts.forEach((chart) => chart.draw())).observe(element("charts"));
}

async function showBody() {
  try {
    if (typeof DecompressionStream === "undefined") {
      throw new Error("This browser cannot unpack the frames (it has no DecompressionStream). Open the file in a current Firefox, Chrome, Edge or Safari. Tables and curves below do not need it.");
    }
    view = new View((time) => charts.forEach((chart) => chart.isOverTime && chart.mark(time)));
    await view.start();
  } catch (error) {
    view = null;
    document.querySelector(".viewer").classList.add("unavailable");
    element("no-view").hidden = false;
    element("no-view").textContent = error.message;
  }
}

element("theme").value = remembered();
applyTheme();
element("theme").addEventListener("change", (event) => { remembered(event.target.value); applyTheme(); });
systemTheme.addEventListener("change", applyTheme);
showSummary();
showCharts();
applyTheme();
showBody();
