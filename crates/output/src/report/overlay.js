// What is drawn over the body: colour bar, scale, axes, walls and outlines of plane cases.

/** Distance of the hatches that tell the solid side of a wall, and their extent across it, pixels. */
const HATCH = [7, 8];

class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
  }

  /** `look` as for the scene, and field, colours, moment (text), outlines, hatched walls, picked particle. */
  draw(look) {
    const { canvas } = this;
    const { camera } = look;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(camera.width * ratio);
    canvas.height = Math.round(camera.height * ratio);
    this.pen = canvas.getContext("2d");
    this.pen.scale(ratio, ratio);
    this.pen.font = "12px system-ui, sans-serif";
    this.look = look;
    this.#lines();
    if (look.picked) this.#ring(look.picked);
    this.#colourBar();
    this.#scaleBar();
    this.#axes();
    this.#text(look.moment, 12, 18, "left");
  }

  #text(text, x, y, align) {
    this.pen.textAlign = align;
    this.pen.textBaseline = "alphabetic";
    this.pen.fillStyle = css("--ink");
    this.pen.fillText(text, x, y);
  }

  #path(line) {
    const { pen, look } = this;
    pen.beginPath();
    line.forEach((point, i) => {
      const [x, y] = look.camera.project(...point);
      if (i === 0) pen.moveTo(x, y); else pen.lineTo(x, y);
    });
    pen.stroke();
  }

  #lines() {
    const { pen, look } = this;
    pen.lineJoin = "round";
    pen.strokeStyle = css("--soft");
    pen.lineWidth = 1;
    pen.setLineDash([5, 4]);
    look.outlines.forEach((line) => this.#path(line));
    pen.setLineDash([]);
    pen.strokeStyle = css("--wall");
    for (const wall of look.planeWalls) {
      pen.lineWidth = 2;
      this.#path(wall.line);
      if (wall.is_hatched) this.#hatch(wall.line.map((point) => look.camera.project(...point)));
    }
  }

  /** Oblique strokes on the right of a line, where it is in the picture. */
  #hatch(line) {
    const { pen } = this;
    const { width, height } = this.look.camera;
    const [distance, extent] = HATCH;
    pen.lineWidth = 0.8;
    pen.beginPath();
    let before = 0;
    for (let i = 1; i < line.length; i += 1) {
      const [from, to] = [line[i - 1], line[i]];
      const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
      const length = Math.hypot(dx, dy);
      if (length === 0) continue;
      const [ax, ay] = [dx / length, dy / length];
      // The part of the line that can be seen, as distances from its start.
      let [start, end] = [0, length];
      for (const [at, step, most] of [[from[0], ax, width], [from[1], ay, height]]) {
        if (Math.abs(step) < 1e-12) {
          if (at < -10 || at > most + 10) end = -1;
          continue;
        }
        const ends = [(-10 - at) / step, (most + 10 - at) / step].sort((a, b) => a - b);
        start = Math.max(start, ends[0]);
        end = Math.min(end, ends[1]);
      }
      const first = Math.ceil((before + start) / distance) * distance - before;
      for (let s = first; s <= end; s += distance) {
        const [x, y] = [from[0] + s * ax, from[1] + s * ay];
        pen.moveTo(x, y);
        pen.lineTo(x + extent * (-ay - 0.8 * ax), y + extent * (ax - 0.8 * ay));
      }
      before += length;
    }
    pen.stroke();
  }

  #ring(picked) {
    const { pen } = this;
    pen.strokeStyle = css("--ink");
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.arc(picked.x, picked.y, Math.max(picked.radius, 3) + 1.5, 0, 7);
    pen.stroke();
  }

  #colourBar() {
    const { pen, look } = this;
    const { camera, range, scale, colours, field } = look;
    const height = Math.min(300, camera.height - 150);
    const [x, y, width] = [camera.width - 88, (camera.height - height) / 2, 16];
    for (let i = 0; i < height; i += 1) {
      const c = 3 * Math.round((255 * (height - 1 - i)) / (height - 1));
      pen.fillStyle = `rgb(${colours[c]},${colours[c + 1]},${colours[c + 2]})`;
      pen.fillRect(x, y + i, width, 1.5);
    }
    pen.strokeStyle = css("--wall");
    pen.lineWidth = 1;
    pen.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
    const [low, high] = range.map((value) => value * scale.factor);
    if (high > low) {
      const marks = ticks(low, high, height / 45);
      for (const value of marks.values) {
        const at = y + height * (1 - (value - low) / (high - low));
        pen.beginPath(); pen.moveTo(x + width, at); pen.lineTo(x + width + 4, at); pen.stroke();
        this.#text(tickText(value, marks.decimals), x + width + 7, at + 4, "left");
      }
    } else {
      this.#text(digits(low, 4), x + width + 7, y + height / 2, "left");
    }
    this.#text(labelled(field.label, scale.unit), camera.width - 12, y - 12, "right");
  }

  #scaleBar() {
    const { pen, look } = this;
    const { camera } = look;
    const raw = 140 / camera.scale;
    const power = 10 ** Math.floor(Math.log10(raw));
    const length = [5, 2, 1].map((m) => m * power).find((l) => l <= raw) ?? power;
    const pixels = length * camera.scale;
    const [x, y] = [camera.middle[0] - pixels / 2, camera.height - 18];
    pen.strokeStyle = css("--ink");
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(x, y - 4); pen.lineTo(x, y + 4); pen.moveTo(x, y); pen.lineTo(x + pixels, y); pen.moveTo(x + pixels, y - 4); pen.lineTo(x + pixels, y + 4);
    pen.stroke();
    const scale = scaleFor("m", length);
    this.#text(`${Number((length * scale.factor).toPrecision(3))} ${scale.unit}`, x + pixels + 8, y + 4, "left");
  }

  #axes() {
    const { pen, look } = this;
    const { camera } = look;
    const [x, y] = [40, camera.height - 40];
    pen.strokeStyle = css("--ink");
    pen.lineWidth = 1.5;
    ["x", "y", "z"].slice(0, camera.isSolid ? 3 : 2).forEach((name, axis) => {
      const [dx, dy] = [camera.rows[axis], -camera.rows[3 + axis]];
      if (Math.hypot(dx, dy) < 0.05) return;
      pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + 24 * dx, y + 24 * dy); pen.stroke();
      this.#text(name, x + 32 * dx, y + 32 * dy + 4, "center");
    });
  }
}
