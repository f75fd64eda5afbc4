// The body in WebGL 2: particles as balls or discs, cells or faces, planes of obstacles.

const PARTICLE_VERTEX = `#version 300 es
precision highp float;
in vec2 corner; in vec3 place; in float value;
uniform mat3 rows; uniform vec3 centre; uniform vec2 scale; uniform vec2 shift; uniform float depth;
uniform float radius; uniform vec2 range; uniform vec4 clip; uniform sampler2D colours;
out vec2 v_corner; out vec3 v_colour; out float v_depth;
void main() {
  vec3 seen = (place - centre) * rows;
  v_corner = corner;
  v_colour = texture(colours, vec2((clamp((value - range.x) / (range.y - range.x), 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  v_depth = seen.z;
  bool is_cut = dot(clip.xyz, place) > clip.w;
  gl_Position = is_cut ? vec4(2.0, 2.0, 2.0, 1.0) : vec4((seen.xy + corner * radius) * scale + shift, -seen.z * depth, 1.0);
}`;

const PARTICLE_FRAGMENT = `#version 300 es
precision highp float;
in vec2 v_corner; in vec3 v_colour; in float v_depth;
uniform float depth; uniform float radius; uniform bool is_shaded;
out vec4 colour;
void main() {
  float r = length(v_corner);
  float edge = max(fwidth(r), 1e-4);
  float cover = 1.0 - smoothstep(1.0 - edge, 1.0 + edge, r);
  if (cover <= 0.0) discard;
  float height = sqrt(max(0.0, 1.0 - r * r));
  float light = is_shaded ? 0.62 + 0.42 * max(0.0, dot(vec3(v_corner, height), vec3(-0.35, 0.5, 0.79))) : 1.0;
  gl_FragDepth = 0.5 - 0.5 * (v_depth + height * radius) * depth;
  colour = vec4(v_colour * light, cover);
}`;

const FACE_VERTEX = `#version 300 es
precision highp float;
in vec3 place; in float value;
uniform mat3 rows; uniform vec3 centre; uniform vec2 scale; uniform vec2 shift; uniform float depth;
uniform float nearer;
out vec3 v_seen; out float v_value;
void main() {
  v_seen = (place - centre) * rows;
  v_value = value;
  gl_Position = vec4(v_seen.xy * scale + shift, -v_seen.z * depth - nearer, 1.0);
}`;

const FACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 v_seen; in float v_value;
uniform vec2 range; uniform bool is_shaded; uniform vec4 plain; uniform sampler2D colours;
out vec4 colour;
void main() {
  float place = clamp((v_value - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 base = texture(colours, vec2((place * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  vec3 normal = normalize(cross(dFdx(v_seen), dFdy(v_seen)));
  float light = is_shaded ? 0.62 + 0.42 * abs(dot(normal, vec3(-0.35, 0.5, 0.79))) : 1.0;
  colour = plain.a > 0.0 ? plain : vec4(base * light, 1.0);
}`;

/** A colour like #1a2b3c as three numbers of 0 to 1. */
function rgb(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

class Scene {
  /** Throws an error with a message for the user if the browser cannot. */
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This browser offers no WebGL 2, so the body cannot be drawn here. Switch on hardware acceleration, or open the file in a current Firefox, Chrome, Edge or Safari. Tables and curves below do not need it.");
    this.gl = gl;
    this.canvas = canvas;
    this.balls = this.#program(PARTICLE_VERTEX, PARTICLE_FRAGMENT);
    this.faces = this.#program(FACE_VERTEX, FACE_FRAGMENT);
    this.places = gl.createBuffer();
    this.values = gl.createBuffer();
    this.colours = gl.createTexture();
    this.ballArray = this.#array(this.balls, { corner: [this.#quad(), 2, 0], place: [this.places, 3, 1], value: [this.values, 1, 1] });
    this.faceArray = this.#array(this.faces, { place: [this.places, 3, 0], value: [this.values, 1, 0] });
    this.triangles = { count: 0 };
    this.edges = { count: 0 };
    this.wallPlaces = gl.createBuffer();
    this.wallArray = this.#array(this.faces, { place: [this.wallPlaces, 3, 0] });
    this.count = 0;
  }

  #program(vertex, fragment) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      throw new Error(`The body cannot be drawn: ${gl.getProgramInfoLog(program)}`);
    }
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i += 1) {
      const { name } = gl.getActiveUniform(program, i);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
  }

  #quad() {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    // A little larger than the ball, for its smooth edge.
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1.2, -1.2, 1.2, -1.2, -1.2, 1.2, 1.2, 1.2]), gl.STATIC_DRAW);
    return buffer;
  }

  #array({ program }, attributes) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    for (const [name, [buffer, size, divisor]] of Object.entries(attributes)) {
      const at = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
      gl.vertexAttribDivisor(at, divisor);
    }
    gl.bindVertexArray(null);
    return array;
  }

  #indices(numbers) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    return { buffer, count: numbers.length };
  }

  /** Quadrilaterals between particles, four indices each. */
  setFaces(corners) {
    const quads = corners.length / 4;
    const triangles = new Uint32Array(6 * quads);
    const edges = new Uint32Array(8 * quads);
    for (let q = 0; q < quads; q += 1) {
      const [a, b, c, d] = corners.subarray(4 * q, 4 * q + 4);
      triangles.set([a, b, c, a, c, d], 6 * q);
      edges.set([a, b, b, c, c, d, d, a], 8 * q);
    }
    this.triangles = this.#indices(triangles);
    this.edges = this.#indices(edges);
  }

  setParticles(positions, values) {
    const { gl } = this;
    this.count = values.length;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.values);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
  }

  /** 256 colours, three bytes each. */
  setColours(bytes) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, gl.LINEAR);
    for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, key, gl.CLAMP_TO_EDGE);
  }

  /** Draws everything. `look`: camera, range, radius (m), clip (plane or null), isFaces, hasEdges, walls (lines in space). */
  draw(look) {
    const { gl } = this;
    const { camera } = look;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [camera.width, camera.height].map((n) => Math.max(1, Math.round(n * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(...rgb(css("--stage")), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    if (look.isFaces && this.triangles.count > 0) this.#drawFaces(look); else this.#drawBalls(look);
    this.#drawWalls(look);
  }

  #use({ program, uniforms }, { camera, range }) {
    const { gl } = this;
    gl.useProgram(program);
    gl.uniformMatrix3fv(uniforms.rows, false, camera.rows);
    gl.uniform3fv(uniforms.centre, camera.centre);
    gl.uniform2f(uniforms.scale, (2 * camera.scale) / camera.width, (2 * camera.scale) / camera.height);
    const [x, y] = camera.middle;
    gl.uniform2f(uniforms.shift, (2 * x) / camera.width - 1, 1 - (2 * y) / camera.height);
    gl.uniform1f(uniforms.depth, 1 / (3 * camera.size));
    gl.uniform2f(uniforms.range, range[0], range[1] > range[0] ? range[1] : range[0] + 1e-30);
    gl.uniform1i(uniforms.colours, 0);
    gl.uniform1i(uniforms.is_shaded, camera.isSolid ? 1 : 0);
    return uniforms;
  }

  #drawBalls(look) {
    const { gl } = this;
    const uniforms = this.#use(this.balls, look);
    gl.uniform1f(uniforms.radius, look.radius);
    gl.uniform4fv(uniforms.clip, look.clip ?? [0, 0, 0, 1]);
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    gl.bindVertexArray(this.ballArray);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }

  #drawFaces(look) {
    const { gl } = this;
    const uniforms = this.#use(this.faces, look);
    gl.bindVertexArray(this.faceArray);
    gl.uniform1f(uniforms.nearer, 0);
    gl.uniform4f(uniforms.plain, 0, 0, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles.buffer);
    gl.drawElements(gl.TRIANGLES, this.triangles.count, gl.UNSIGNED_INT, 0);
    if (!look.hasEdges) return;
    gl.uniform1f(uniforms.nearer, 2e-4);
    gl.uniform4f(uniforms.plain, 0, 0, 0, 0.3);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.edges.buffer);
    gl.drawElements(gl.LINES, this.edges.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
  }

  #drawWalls(look) {
    if (look.walls.length === 0) return;
    const { gl } = this;
    const uniforms = this.#use(this.faces, look);
    const tint = rgb(css("--wall"));
    gl.bindVertexArray(this.wallArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.wallPlaces);
    gl.uniform1f(uniforms.nearer, 0);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    for (const line of look.walls) {
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(line.flat()), gl.DYNAMIC_DRAW);
      gl.uniform4f(uniforms.plain, ...tint, 0.8);
      gl.drawArrays(gl.LINE_STRIP, 0, line.length);
      const isClosed = line.length > 3 && line[0].every((x, i) => x === line[line.length - 1][i]);
      if (!isClosed) continue;
      gl.depthMask(false);
      gl.uniform4f(uniforms.plain, ...tint, 0.16);
      gl.drawArrays(gl.TRIANGLE_FAN, 0, line.length - 1);
      gl.depthMask(true);
    }
    gl.disable(gl.BLEND);
  }
}
