// Curves over a common axis: zoom by dragging, values at the cursor, export.

// Colours that readers with any colour vision can tell apart (Okabe and Ito), for light and dark paper.
const CURVES = {
  light: ["#0072b2", "#d55e00", "#009e73", "#b8578f", "#c98500", "#3a9bd4", "#3c3c3c", "#8c564b"],
  dark: ["#56a8e0", "#f0833a", "#2cc295", "#e08fc0", "#f0b03c", "#8fd0ff", "#d0d4d8", "#c99a8c"],
};

function theme() {
  return document.documentElement.dataset.theme === "dark" ? "dark" : "light";
}

function css(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

class Chart {
  /** `onTime` is called with a time that was clicked. */
  constructor(diagram, onTime) {
    this.diagram = diagram;
    this.onTime = onTime;
    this.isOverTime = diagram.x.unit === "s" && diagram.x.label === "time";
    this.hidden = new Set();
    this.window = null;
    this.cursor = null;
    this.moment = null;
    this.drag = null;
    this.canvas = make("canvas", { tabindex: "0", role: "img", "aria-label": `${diagram.title}: ${labelled(diagram.y.label, diagram.y.unit)} over ${labelled(diagram.x.label, diagram.x.unit)}. Left and right move the cursor, Escape shows everything.` });
    const all = make("button", { type: "button", title: "Show the whole range" }, "All");
    const csv = make("button", { type: "button", title: "Save these curves in SI units" }, "CSV");
    all.addEventListener("click", () => this.zoom(null));
    csv.addEventListener("click", () => download(`${DATA.case}-${diagram.title}.csv`, this.csv(), "text/csv"));
    this.at = make("output", { class: "at" });
    this.legend = make("div", { class: "legend" });
    this.node = make("article", { class: "chart" }, make("header", {}, make("h3", {}, diagram.title), this.at, all, csv), this.canvas, this.legend);
    this.values = diagram.series.map(() => make("output"));
    this.swatches = diagram.series.map((series, i) => {
      const swatch = make("span", { class: series.is_dashed ? "swatch dashed" : "swatch" });
      const button = make("button", { type: "button", "aria-pressed": "true" }, swatch, series.label, this.values[i]);
      button.addEventListener("click", () => {
        if (!this.hidden.delete(i)) this.hidden.add(i);
        button.setAttribute("aria-pressed", String(!this.hidden.has(i)));
        this.draw();
      });
      this.legend.append(button);
      return swatch;
    });
    if (diagram.stride > 1) this.node.append(make("p", { class: "note" }, `Every ${diagram.stride}th row; history.csv has all.`));
    this.#listen();
  }

  /** Coordinates and values of a curve. */
  #curve(i) {
    const series = this.diagram.series[i];
    return [this.diagram.abscissas[series.abscissa], series.values];
  }

  #visible() {
    return this.diagram.series.map((_, i) => i).filter((i) => !this.hidden.has(i));
  }

  /** The window shown, in SI units: [left, right, bottom, top]. */
  #limits() {
    let [left, right, bottom, top] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const i of this.#visible()) {
      const [x, y] = this.#curve(i);
      for (let k = 0; k < x.length; k += 1) {
        const isOutside = this.window && (x[k] < this.window[0] || x[k] > this.window[1]);
        left = Math.min(left, x[k]);
        right = Math.max(right, x[k]);
        if (!isOutside && y[k] !== null) {
          bottom = Math.min(bottom, y[k]);
          top = Math.max(top, y[k]);
        }
      }
    }
    if (!(left < right)) [left, right] = Number.isFinite(left) ? [left - 0.5, left + 0.5] : [0, 1];
    if (!Number.isFinite(bottom)) [bottom, top] = [0, 1];
    if (bottom > 0 && bottom < 0.4 * top) bottom = 0;
    const room = top > bottom ? 0.05 * (top - bottom) : 0.05 * Math.abs(top) || 1;
    if (bottom !== 0) bottom -= room;
    top += room;
    if (this.window) {
      [left, right] = this.window;
      if (this.window.length === 4) [, , bottom, top] = this.window;
    }
    return [left, right, bottom, top];
  }

  zoom(limits) {
    this.window = limits;
    this.draw();
  }

  /** Marks the time of the frame in the view. */
  mark(time) {
    this.moment = time;
    this.draw();
  }

  draw() {
    const { canvas } = this;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (width === 0) return;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const [left, right, bottom, top] = this.#limits();
    const xs = scaleFor(this.diagram.x.unit, Math.max(Math.abs(left), Math.abs(right)));
    const ys = scaleFor(this.diagram.y.unit, Math.max(Math.abs(bottom), Math.abs(top)));
    const yTicks = ticks(bottom * ys.factor, top * ys.factor, height / 45);
    pen.font = "12px system-ui, sans-serif";
    const labels = yTicks.values.map((v) => tickText(v, yTicks.decimals));
    const margin = Math.ceil(Math.max(...labels.map((t) => pen.measureText(t).width))) + 10;
    const box = { x: margin, y: 24, w: width - margin - 12, h: height - 24 - 38 };
    this.frame = { box, left, right, bottom, top };
    const px = (x) => box.x + ((x - left) / (right - left)) * box.w;
    const py = (y) => box.y + box.h - ((y - bottom) / (top - bottom)) * box.h;
    const colours = CURVES[theme()];

    pen.fillStyle = css("--soft");
    pen.textBaseline = "alphabetic";
    pen.fillText(labelled(this.diagram.y.label, ys.unit), 0, 13);
    pen.lineWidth = 1;
    pen.strokeStyle = css("--grid");
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    yTicks.values.forEach((v, i) => {
      const y = Math.round(py(v / ys.factor)) + 0.5;
      pen.beginPath(); pen.moveTo(box.x, y); pen.lineTo(box.x + box.w, y); pen.stroke();
      pen.fillText(labels[i], box.x - 6, y);
    });
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const xTicks = ticks(left * xs.factor, right * xs.factor, box.w / 80);
    for (const v of xTicks.values) {
      const x = Math.round(px(v / xs.factor)) + 0.5;
      pen.beginPath(); pen.moveTo(x, box.y); pen.lineTo(x, box.y + box.h); pen.stroke();
      pen.fillText(tickText(v, xTicks.decimals), x, box.y + box.h + 5);
    }
    pen.fillText(labelled(this.diagram.x.label, xs.unit), box.x + box.w / 2, box.y + box.h + 22);
    pen.strokeStyle = css("--line");
    pen.strokeRect(box.x + 0.5, box.y + 0.5, box.w, box.h);

    pen.save();
    pen.beginPath(); pen.rect(box.x, box.y, box.w, box.h); pen.clip();
    if (this.isOverTime && this.moment !== null) {
      pen.strokeStyle = css("--soft");
      pen.setLineDash([3, 3]);
      pen.beginPath(); pen.moveTo(px(this.moment), box.y); pen.lineTo(px(this.moment), box.y + box.h); pen.stroke();
      pen.setLineDash([]);
    }
    pen.lineJoin = "round";
    for (const i of this.#visible()) {
      const series = this.diagram.series[i];
      const [x, y] = this.#curve(i);
      pen.strokeStyle = pen.fillStyle = colours[i % colours.length];
      pen.lineWidth = 1.5;
      pen.setLineDash(series.is_dashed ? [6, 4] : []);
      pen.beginPath();
      let isDown = false;
      for (let k = 0; k < x.length; k += 1) {
        if (y[k] === null) { isDown = false; continue; }
        if (isDown) pen.lineTo(px(x[k]), py(y[k])); else pen.moveTo(px(x[k]), py(y[k]));
        isDown = true;
      }
      pen.stroke();
      pen.setLineDash([]);
      if (series.has_markers) {
        for (let k = 0; k < x.length; k += 1) {
          if (y[k] === null) continue;
          pen.beginPath(); pen.arc(px(x[k]), py(y[k]), 2.6, 0, 7); pen.fill();
        }
      }
    }
    if (this.drag?.to) {
      const { from, to } = this.drag;
      const isBand = Math.abs(to[1] - from[1]) < 12;
      const [y0, y1] = isBand ? [box.y, box.y + box.h] : [from[1], to[1]];
      pen.globalAlpha = 0.15;
      pen.fillStyle = css("--accent");
      pen.fillRect(from[0], y0, to[0] - from[0], y1 - y0);
      pen.globalAlpha = 1;
    }
    this.#drawCursor(pen, px, py, colours, xs, ys);
    pen.restore();
    this.swatches.forEach((swatch, i) => { swatch.style.borderColor = colours[i % colours.length]; });
  }

  #drawCursor(pen, px, py, colours, xs, ys) {
    this.at.textContent = "";
    this.values.forEach((output) => { output.textContent = ""; });
    if (this.cursor === null) return;
    const { box } = this.frame;
    let shown = null;
    for (const i of this.#visible()) {
      const [x, y] = this.#curve(i);
      const k = nearestIndex(x, this.cursor);
      if (k < 0) continue;
      shown ??= x[k];
      if (y[k] === null) continue;
      this.values[i].textContent = `${digits(y[k] * ys.factor)} ${ys.unit}`.trim();
      pen.fillStyle = colours[i % colours.length];
      pen.beginPath(); pen.arc(px(x[k]), py(y[k]), 3.2, 0, 7); pen.fill();
    }
    if (shown === null) return;
    this.at.textContent = `${digits(shown * xs.factor)} ${xs.unit}`.trim();
    pen.strokeStyle = css("--soft");
    pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(px(shown), box.y); pen.lineTo(px(shown), box.y + box.h); pen.stroke();
  }

  #listen() {
    const { canvas } = this;
    const place = (event) => {
      const rect = canvas.getBoundingClientRect();
      return [event.clientX - rect.left, event.clientY - rect.top];
    };
    const value = ([x, y]) => {
      const { box, left, right, bottom, top } = this.frame;
      return [left + ((x - box.x) / box.w) * (right - left), bottom + ((box.y + box.h - y) / box.h) * (top - bottom)];
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.drag = { from: place(event), to: null };
    });
    canvas.addEventListener("pointermove", (event) => {
      const here = place(event);
      if (this.drag && Math.abs(here[0] - this.drag.from[0]) > 4) this.drag.to = here;
      [this.cursor] = value(here);
      this.draw();
    });
    canvas.addEventListener("pointerup", (event) => {
      const { drag } = this;
      this.drag = null;
      if (!drag) return;
      if (!drag.to) {
        if (this.isOverTime && this.onTime) this.onTime(value(place(event))[0]);
        return;
      }
      const [a, b] = [value(drag.from), value(drag.to)];
      const sort = (u, v) => (u < v ? [u, v] : [v, u]);
      const isBand = Math.abs(drag.to[1] - drag.from[1]) < 12;
      this.zoom(isBand ? sort(a[0], b[0]) : [...sort(a[0], b[0]), ...sort(a[1], b[1])]);
    });
    canvas.addEventListener("pointerleave", () => { this.cursor = null; this.draw(); });
    canvas.addEventListener("dblclick", () => this.zoom(null));
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.key === "Escape") this.zoom(null);
      if (!step) return;
      event.preventDefault();
      const { left, right } = this.frame;
      this.cursor = Math.min(right, Math.max(left, (this.cursor ?? left) + (step * (right - left)) / 100));
      this.draw();
    });
  }

  /** The curves in SI units over their common coordinate. */
  csv() {
    const { x, y, series } = this.diagram;
    const rows = new Map();
    series.forEach((_, i) => {
      const [xs, values] = this.#curve(i);
      xs.forEach((at, k) => {
        if (!rows.has(at)) rows.set(at, series.map(() => ""));
        rows.get(at)[i] = values[k] === null ? "" : String(values[k]);
      });
    });
    const header = [labelled(x.label, x.unit), ...series.map((s) => labelled(s.label, y.unit))];
    const lines = [...rows].sort((a, b) => a[0] - b[0]).map(([at, values]) => [at, ...values].join(","));
    return [header.map(csvCell).join(","), ...lines, ""].join("\n");
  }
}

/** Index of the nearest of ascending numbers; -1 if there is none. */
function nearestIndex(sorted, value) {
  let [low, high] = [0, sorted.length - 1];
  if (high < 0) return -1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (sorted[middle] < value) low = middle; else high = middle;
  }
  return Math.abs(sorted[low] - value) <= Math.abs(sorted[high] - value) ? low : high;
}
