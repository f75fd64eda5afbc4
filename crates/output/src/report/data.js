// What the file holds, and the frames, unpacked when they are needed.

const DATA = JSON.parse(document.getElementById("data").textContent);

function element(id) {
  return document.getElementById(id);
}

/** A new element with attributes and children; texts are never read as HTML. */
function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** Offers a file to the user. */
function download(name, content, type) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = make("a", { href: url, download: name.replace(/[^\w.-]+/g, "-") });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A cell of a comma-separated file. */
function csvCell(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** The bytes of a packed piece of the file. */
async function unpack(id) {
  const text = atob(element(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads arrays that stand one after the other, each as planes of bytes. */
class Planes {
  constructor(bytes, count) {
    this.bytes = bytes;
    this.count = count;
    this.at = 0;
  }

  #join(width) {
    const joined = new Uint8Array(width * this.count);
    for (let plane = 0; plane < width; plane += 1) {
      for (let i = 0; i < this.count; i += 1) joined[width * i + plane] = this.bytes[this.at + i];
      this.at += this.count;
    }
    return joined.buffer;
  }

  numbers([low, high]) {
    if (!DATA.frames.is_quantised) return new Float32Array(this.#join(4));
    const step = (high - low) / 65535;
    return Float32Array.from(new Uint16Array(this.#join(2)), (q) => low + q * step);
  }

  indices() {
    return new Uint32Array(this.#join(4));
  }
}

/** The frames of the report. */
class Frames {
  constructor() {
    this.index = DATA.frames;
    this.count = this.index.kept.length;
    this.cache = new Map();
  }

  /** Unpacks what does not change: undeformed positions and faces. */
  async prepare() {
    if (this.index.reference.length > 0) {
      const planes = new Planes(await unpack("reference"), this.index.particles);
      this.reference = this.index.reference.map((range) => planes.numbers(range));
    }
    if (this.index.particles < this.index.total_particles) {
      this.numbers = new Planes(await unpack("numbers"), this.index.particles).indices();
    }
    if (this.index.has_faces) {
      const bytes = await unpack("faces");
      this.faces = new Planes(bytes, bytes.length / 4).indices();
    }
  }

  /** Positions as x, y, z of each particle, and the stored arrays. */
  load(number) {
    if (!this.cache.has(number)) this.cache.set(number, this.#load(number));
    return this.cache.get(number);
  }

  async #load(number) {
    const kept = this.index.kept[number];
    const planes = new Planes(await unpack(`frame-${number}`), this.index.particles);
    const axes = kept.positions.map((range) => planes.numbers(range));
    const positions = new Float32Array(3 * this.index.particles);
    axes.forEach((values, axis) => {
      for (let i = 0; i < values.length; i += 1) positions[3 * i + axis] = values[i];
    });
    const stored = this.index.fields.map((field, place) =>
      field.source === "stored" ? planes.numbers(kept.fields[place]) : null);
    return { number, time: kept.time, positions, axes, fields: stored };
  }

  /** Values of a field in a frame that is loaded. */
  values(frame, place) {
    frame.fields[place] ??= this.#derived(frame, this.index.fields[place].source);
    return frame.fields[place];
  }

  #derived(frame, source) {
    if ("displacement" in source) {
      const axis = source.displacement;
      return frame.axes[axis].map((x, i) => x - this.reference[axis][i]);
    }
    const parts = source.magnitude.map((place) => this.values(frame, place));
    return parts[0].map((_, i) => Math.hypot(...parts.map((part) => part[i])));
  }

  /** Least and most value of a field in a frame, or in all (`null`). */
  range(place, number) {
    const ranges = number === null ? this.index.kept.map((kept) => kept.fields[place]) : [this.index.kept[number].fields[place]];
    return [Math.min(...ranges.map((r) => r[0])), Math.max(...ranges.map((r) => r[1]))];
  }

  /** Box around all frames: least and most coordinates. */
  bounds() {
    const low = [0, 0, 0];
    const high = [0, 0, 0];
    this.index.kept[0].positions.forEach((_, axis) => {
      low[axis] = Math.min(...this.index.kept.map((kept) => kept.positions[axis][0]));
      high[axis] = Math.max(...this.index.kept.map((kept) => kept.positions[axis][1]));
    });
    return { low, high };
  }

  /** The number in the run of a particle of the report. */
  particle(place) {
    return this.numbers ? this.numbers[place] : place;
  }

  /** The frame nearest to a time. */
  nearest(time) {
    let best = 0;
    this.index.kept.forEach((kept, i) => {
      if (Math.abs(kept.time - time) < Math.abs(this.index.kept[best].time - time)) best = i;
    });
    return best;
  }
}
