// The view of the body: what is chosen, playing, and the particle under the pointer.

/** 256 colours between the samples of a map, three bytes each. */
function colourTable(samples) {
  const table = new Uint8Array(256 * 3);
  for (let i = 0; i < 256; i += 1) {
    const place = (i / 255) * (samples.length - 1);
    const lower = Math.min(samples.length - 2, Math.floor(place));
    for (let c = 0; c < 3; c += 1) {
      table[3 * i + c] = Math.round(samples[lower][c] + (place - lower) * (samples[lower + 1][c] - samples[lower][c]));
    }
  }
  return table;
}

/** Part of the largest magnitude from which a sign counts as more than noise. */
const BOTH_SIGNS = 0.02;

class View {
  /** `onMoment` is called with the time of each frame that is shown. */
  constructor(onMoment) {
    this.onMoment = onMoment;
    this.frames = new Frames();
    this.scene = new Scene(element("scene"));
    this.overlay = new Overlay(element("overlay"));
    this.camera = new Camera(this.frames.bounds(), DATA.is_solid);
    this.place = 0;
    this.number = this.frames.count - 1;
    this.mapChoice = "";
    this.picked = null;
    this.side = 1;
    this.isPlaying = false;
    this.isWaiting = false;
  }

  async start() {
    await this.frames.prepare();
    if (this.frames.faces) this.scene.setFaces(this.frames.faces);
    this.#controls();
    this.#pointer();
    this.#keys();
    new ResizeObserver(() => this.resize()).observe(element("stage"));
    this.resize();
    await this.show(this.number);
    this.chooseField(Math.max(0, DATA.frames.fields.findIndex((f) => f.name === "equivalent_plastic_strain")));
    // The rest in the background, so that playing does not wait.
    for (let i = 0; i < this.frames.count; i += 1) {
      await this.frames.load(i);
      await new Promise((done) => { setTimeout(done, 0); });
    }
  }

  /** Shows a frame. */
  async show(number) {
    this.wanted = number;
    const frame = await this.frames.load(number);
    if (this.wanted !== number) return;
    this.number = number;
    this.frame = frame;
    element("frame").value = number;
    const kept = this.frames.index.kept[number];
    element("moment").textContent = `t = ${withUnit(frame.time, "s", 4)}   step ${kept.step}   frame ${number + 1} of ${this.frames.count}`;
    this.#upload();
    this.onMoment(frame.time);
  }

  #upload() {
    this.values = this.frames.values(this.frame, this.place);
    this.scene.setParticles(this.frame.positions, this.values);
    this.#pick();
    this.redraw();
  }

  chooseField(place) {
    this.place = place;
    element("field").value = place;
    const [low, high] = this.frames.range(place, null);
    this.scale = scaleFor(this.field.unit, Math.max(Math.abs(low), Math.abs(high)));
    element("range-unit").textContent = this.scale.unit;
    this.setRange(...this.#suited([low, high]));
    this.#upload();
  }

  get field() {
    return DATA.frames.fields[this.place];
  }

  /** Symmetric about zero if both signs occur, from zero if the values come near it. */
  #suited([low, high]) {
    const magnitude = Math.max(Math.abs(low), Math.abs(high));
    this.hasBothSigns = low < -BOTH_SIGNS * magnitude && high > BOTH_SIGNS * magnitude;
    if (this.hasBothSigns) return [-magnitude, magnitude];
    return low >= 0 && high > 0 && low < 0.3 * high ? [0, high] : [low, high];
  }

  /** Values of the first and the last colour, SI units. */
  setRange(low, high) {
    this.range = [low, high];
    const shown = (value) => String(Number((value * this.scale.factor).toPrecision(5)));
    element("low").value = shown(low);
    element("high").value = shown(high);
    this.#colours();
    this.redraw();
  }

  #colours() {
    const wanted = this.mapChoice || (this.hasBothSigns ? "blue-red" : "viridis");
    const [, samples] = DATA.colour_maps.find(([name]) => name === wanted);
    this.colours = colourTable(samples);
    this.scene.setColours(this.colours);
  }

  resize() {
    const stage = element("stage");
    this.camera.resize(stage.clientWidth, stage.clientHeight);
    this.redraw();
  }

  /** Draws at the next occasion. */
  redraw() {
    if (this.isWaiting || !this.frame || !this.colours) return;
    this.isWaiting = true;
    requestAnimationFrame(() => { this.isWaiting = false; this.draw(); });
  }

  draw() {
    const look = {
      camera: this.camera,
      range: this.range,
      scale: this.scale,
      colours: this.colours,
      field: this.field,
      radius: this.radius,
      clip: this.clip,
      isFaces: this.isFaces,
      hasEdges: element("mesh").checked,
      moment: `t = ${withUnit(this.frame.time, "s", 4)}`,
      walls: [],
      planeWalls: [],
      outlines: element("undeformed").checked ? DATA.undeformed : [],
      picked: this.picked,
    };
    if (element("walls").checked) {
      const walls = DATA.obstacles.flatMap((obstacle) => {
        const moved = obstacle.displacements[this.number] ?? [0, 0, 0];
        return obstacle.walls.map((wall) => ({ ...wall, line: wall.line.map((x) => x.map((v, i) => v + moved[i])) }));
      });
      if (DATA.is_solid) look.walls = walls.map((wall) => wall.line); else look.planeWalls = walls;
    }
    this.scene.draw(look);
    this.overlay.draw(look);
  }

  get radius() {
    return 0.5 * DATA.spacing * Number(element("size").value);
  }

  get isFaces() {
    return element("shape").value === "faces" && !this.clip;
  }

  /** Normal and offset of the clip plane; what is beyond it is not shown. */
  get clip() {
    const choice = element("clip").value;
    if (choice === "") return null;
    const axis = Number(choice);
    const { low, high } = this.camera.bounds;
    const at = low[axis] + Number(element("clip-at").value) * (high[axis] - low[axis]);
    const sign = element("clip-flip").checked ? -this.side : this.side;
    // Layers that lie on the plane, but for rounding, are shown as a whole.
    const plane = [0, 0, 0, sign * at + 0.01 * DATA.spacing];
    plane[axis] = sign;
    return plane;
  }

  // --- what is under the pointer

  #pick() {
    this.picked = null;
    element("tip").hidden = true;
    if (!this.pointer || !this.frame) return;
    const [px, py] = this.pointer;
    const { positions } = this.frame;
    const { clip } = this;
    const radius = Math.max(this.isFaces ? 0.5 * DATA.spacing * this.camera.scale : this.radius * this.camera.scale, 4);
    let best = -Infinity;
    for (let i = 0; i < this.values.length; i += 1) {
      const [x, y, z] = [positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]];
      if (clip && clip[0] * x + clip[1] * y + clip[2] * z > clip[3]) continue;
      const [sx, sy, depth] = this.camera.project(x, y, z);
      const distance = Math.hypot(sx - px, sy - py);
      if (distance > radius) continue;
      // Pixels in front of the plane of the picture: the surface of a ball, or the nearest disc.
      const front = DATA.is_solid ? depth * this.camera.scale + Math.sqrt(radius * radius - distance * distance) : -distance;
      if (front > best) {
        best = front;
        this.picked = { index: i, x: sx, y: sy, radius };
      }
    }
    if (this.picked) this.#tell(px, py);
  }

  #tell(px, py) {
    const { index } = this.picked;
    const length = scaleFor("m", this.camera.size);
    // About a millionth of the picture, for all three alike.
    const decimals = Math.max(0, 5 - exponentOf(this.camera.size * length.factor));
    const rows = [["particle", String(this.frames.particle(index))]];
    ["x", "y", "z"].slice(0, DATA.frames.axes).forEach((name, axis) => {
      const value = this.frame.positions[3 * index + axis] * length.factor;
      rows.push([name, `${tickText(value, decimals)} ${length.unit}`]);
    });
    rows.push([this.field.label, `${digits(this.values[index] * this.scale.factor)} ${this.scale.unit}`.trim()]);
    const tip = element("tip");
    tip.replaceChildren(...rows.flat().map((text) => make("span", {}, text)));
    tip.hidden = false;
    const { width, height } = this.camera;
    tip.style.left = `${px + 16 + tip.offsetWidth > width ? px - 12 - tip.offsetWidth : px + 16}px`;
    tip.style.top = `${Math.max(4, Math.min(py + 12, height - tip.offsetHeight - 4))}px`;
  }

  #pointer() {
    const canvas = element("scene");
    let last = null;
    const place = (event) => {
      const rect = canvas.getBoundingClientRect();
      return [event.clientX - rect.left, event.clientY - rect.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      last = place(event);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const here = place(event);
      if (last) {
        const [dx, dy] = [here[0] - last[0], here[1] - last[1]];
        last = here;
        const isTurning = DATA.is_solid && !event.shiftKey && (event.buttons & 1) === 1;
        if (isTurning) this.camera.rotate(dx, dy); else this.camera.pan(dx, dy);
        this.pointer = null;
      } else {
        this.pointer = here;
      }
      this.#pick();
      this.redraw();
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { last = null; });
    canvas.addEventListener("pointerleave", () => {
      this.pointer = null;
      this.#pick();
      this.redraw();
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.camera.zoom(Math.exp(-event.deltaY * 0.0015), ...place(event));
      this.#pick();
      this.redraw();
    }, { passive: false });
    canvas.addEventListener("dblclick", () => { this.camera.reset(); this.redraw(); });
  }

  // --- keys, buttons and lists

  #keys() {
    element("scene").addEventListener("keydown", (event) => {
      const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      const isTurning = DATA.is_solid && !event.shiftKey;
      if (arrow && isTurning) this.camera.rotate(arrow[0] * 15, arrow[1] * 15);
      else if (arrow) this.camera.pan(arrow[0] * 25, arrow[1] * 25);
      else if (event.key === "+" || event.key === "=") this.camera.zoom(1.2);
      else if (event.key === "-") this.camera.zoom(1 / 1.2);
      else if (event.key === "Home" || event.key === "0") this.camera.reset();
      else if (event.key === " ") this.play(!this.isPlaying);
      else if (event.key === ",") this.step(-1);
      else if (event.key === ".") this.step(1);
      else return;
      event.preventDefault();
      this.redraw();
    });
  }

  step(by) {
    this.play(false);
    const { count } = this.frames;
    return this.show((this.number + by + count) % count);
  }

  play(isPlaying) {
    this.isPlaying = isPlaying && this.frames.count > 1;
    const button = element("play");
    button.textContent = this.isPlaying ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(this.isPlaying));
    clearTimeout(this.timer);
    if (this.isPlaying) this.#advance(this.number === this.frames.count - 1 ? 0 : this.number);
  }

  async #advance(number) {
    const started = performance.now();
    await this.show(number);
    if (!this.isPlaying) return;
    // The last frame stays for a moment before the film starts again.
    const pause = number === this.frames.count - 1 ? 800 : 1000 / Number(element("speed").value);
    this.timer = setTimeout(() => this.#advance((number + 1) % this.frames.count), Math.max(0, pause - (performance.now() - started)));
  }

  #controls() {
    const on = (id, name, call) => element(id).addEventListener(name, call);
    const redraw = () => { this.#pick(); this.redraw(); };
    DATA.frames.fields.forEach((field, place) => element("field").append(make("option", { value: place }, field.label)));
    element("map").append(make("option", { value: "" }, "automatic"), ...DATA.colour_maps.map(([name]) => make("option", { value: name }, name)));
    if (this.frames.faces) {
      element("shape").append(make("option", { value: "faces" }, DATA.is_solid ? "surface" : "cells"));
    } else {
      element("shape-line").hidden = element("mesh-line").hidden = true;
      element("shape-line").style.display = element("mesh-line").style.display = "none";
    }
    element("shape").append(make("option", { value: "particles" }, "particles"));
    const show = (id, isShown) => { if (!isShown) element(id).style.display = "none"; };
    show("clip-box", DATA.is_solid);
    show("walls-line", DATA.obstacles.length > 0);
    show("undeformed-line", DATA.undeformed.length > 0);
    element("undeformed").checked = DATA.undeformed.length > 0;
    const views = DATA.is_solid ? [...Object.keys(VIEWS), "oblique"] : [];
    for (const name of views) {
      const button = make("button", { type: "button" }, name);
      button.addEventListener("click", () => { this.camera.look(name); this.redraw(); });
      element("views").append(button);
    }
    const whole = make("button", { type: "button", title: "Show everything (Home)" }, "Fit");
    whole.addEventListener("click", () => { this.camera.reset(); this.redraw(); });
    element("views").append(whole);
    element("frame").max = this.frames.count - 1;

    on("field", "change", (event) => this.chooseField(Number(event.target.value)));
    on("map", "change", (event) => { this.mapChoice = event.target.value; this.#colours(); this.redraw(); });
    on("shape", "change", redraw);
    on("clip", "change", (event) => {
      // What is towards the reader goes.
      this.side = this.camera.rows[6 + Number(event.target.value)] >= 0 ? 1 : -1;
      redraw();
    });
    for (const id of ["size", "clip-at"]) on(id, "input", redraw);
    for (const id of ["mesh", "walls", "undeformed", "clip-flip"]) on(id, "change", redraw);
    const typed = () => {
      const [low, high] = ["low", "high"].map((id) => Number(element(id).value.replace(",", ".").replace("\u2212", "-")) / this.scale.factor);
      if (Number.isFinite(low) && Number.isFinite(high) && low < high) this.setRange(low, high); else this.setRange(...this.range);
    };
    for (const id of ["low", "high"]) on(id, "change", typed);
    on("range-frame", "click", () => this.setRange(...this.#suited(this.frames.range(this.place, this.number))));
    on("range-all", "click", () => this.setRange(...this.#suited(this.frames.range(this.place, null))));
    on("frame", "input", (event) => { this.play(false); this.show(Number(event.target.value)); });
    on("previous", "click", () => this.step(-1));
    on("next", "click", () => this.step(1));
    on("play", "click", () => this.play(!this.isPlaying));
    on("save-picture", "click", () => this.#savePicture());
    on("save-frame", "click", () => download(`${DATA.case}-${this.field.name}-frame-${this.frames.index.kept[this.number].number}.csv`, this.csv(), "text/csv"));
  }

  #savePicture() {
    this.draw();
    const [scene, overlay] = [element("scene"), element("overlay")];
    const canvas = make("canvas", { width: scene.width, height: scene.height });
    const pen = canvas.getContext("2d");
    pen.drawImage(scene, 0, 0);
    pen.drawImage(overlay, 0, 0, scene.width, scene.height);
    canvas.toBlob((blob) => download(`${DATA.case}-${this.field.name}-frame-${this.frames.index.kept[this.number].number}.png`, blob));
  }

  /** Positions and the chosen field of this frame, SI units. */
  csv() {
    const axes = ["x", "y", "z"].slice(0, DATA.frames.axes);
    const header = ["particle", ...axes.map((axis) => labelled(axis, "m")), labelled(this.field.label, this.field.unit)];
    const rows = Array.from(this.values, (value, i) =>
      [this.frames.particle(i), ...axes.map((_, axis) => this.frame.positions[3 * i + axis]), value].join(","));
    return [header.map(csvCell).join(","), ...rows, ""].join("\n");
  }
}
