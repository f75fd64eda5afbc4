// An orthographic camera: lengths in the picture can be compared.

/** Directions of view: rows are right, up and towards the reader. */
const VIEWS = {
  "x\u2013y": [1, 0, 0, 0, 1, 0, 0, 0, 1],
  "x\u2013z": [1, 0, 0, 0, 0, 1, 0, -1, 0],
  "y\u2013z": [0, 1, 0, 0, 0, 1, 1, 0, 0],
};

/** Turns about an axis of the picture (0 right, 1 up, 2 towards the reader). */
function turn(rows, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
  const turned = rows.slice();
  for (let k = 0; k < 3; k += 1) {
    turned[3 * a + k] = c * rows[3 * a + k] - s * rows[3 * b + k];
    turned[3 * b + k] = s * rows[3 * a + k] + c * rows[3 * b + k];
  }
  return turned;
}

class Camera {
  constructor(bounds, isSolid) {
    this.bounds = bounds;
    this.isSolid = isSolid;
    this.size = Math.hypot(...bounds.low.map((low, i) => bounds.high[i] - low)) || 1;
    this.width = 1;
    this.height = 1;
    this.look(isSolid ? "oblique" : "x\u2013y");
  }

  /** Looks along a named direction and shows everything. */
  look(name) {
    this.rows = VIEWS[name] ?? turn(turn(VIEWS["x\u2013z"], 1, -0.6), 0, 0.35);
    this.reset();
  }

  /** Shows everything, the direction unchanged. */
  reset() {
    this.centre = this.bounds.low.map((low, i) => 0.5 * (low + this.bounds.high[i]));
    this.isFitted = true;
    this.#fit();
  }

  /** Pixels per metre that show the whole body beside the colour bar. */
  #fit() {
    const half = [0, 1].map((axis) => {
      let sum = 0;
      for (let k = 0; k < 3; k += 1) sum += Math.abs(this.rows[3 * axis + k]) * 0.5 * (this.bounds.high[k] - this.bounds.low[k]);
      return Math.max(sum, 0.01 * this.size);
    });
    this.scale = Math.min((this.width - 220) / (2 * half[0]), (this.height - 110) / (2 * half[1]));
    this.scale = Math.max(this.scale, 1e-3 / this.size);
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    if (this.isFitted) this.#fit();
  }

  /** The pixel of the centre: to the left of the colour bar, above the scale bar. */
  get middle() {
    return [this.width / 2 - 45, this.height / 2 - 8];
  }

  /** Pixel coordinates and the depth towards the reader, m. */
  project(x, y, z) {
    const { rows, centre, scale } = this;
    const [dx, dy, dz] = [x - centre[0], y - centre[1], z - centre[2]];
    return [
      this.middle[0] + scale * (rows[0] * dx + rows[1] * dy + rows[2] * dz),
      this.middle[1] - scale * (rows[3] * dx + rows[4] * dy + rows[5] * dz),
      rows[6] * dx + rows[7] * dy + rows[8] * dz,
    ];
  }

  /** Moves the picture by pixels. */
  pan(dx, dy) {
    this.isFitted = false;
    for (let k = 0; k < 3; k += 1) this.centre[k] += (-dx * this.rows[k] + dy * this.rows[3 + k]) / this.scale;
  }

  rotate(dx, dy) {
    this.rows = turn(turn(this.rows, 1, -dx * 0.008), 0, -dy * 0.008);
  }

  /** Enlarges about a pixel. */
  zoom(factor, x = this.middle[0], y = this.middle[1]) {
    const limited = Math.min(1e5, Math.max(1e-2, this.scale * factor * this.size)) / this.size / this.scale;
    const [dx, dy] = [x - this.middle[0], y - this.middle[1]];
    this.pan(-dx * (1 - 1 / limited), -dy * (1 - 1 / limited));
    this.scale *= limited;
    this.isFitted = false;
  }
}
