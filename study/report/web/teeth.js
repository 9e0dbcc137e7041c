// Both members in mesh, turnable: WebGL with one mesh a tooth, turned into each tooth's place.

const VERTEX = `
attribute vec3 position, normal, tint;
uniform vec3 axis, origin, middle;
uniform float angle, size, aspect;
uniform mat3 view;
varying vec3 vNormal, vTint;
vec3 turned(vec3 v) {
  return v * cos(angle) + cross(axis, v) * sin(angle) + axis * dot(axis, v) * (1.0 - cos(angle));
}
void main() {
  vec3 place = view * (turned(position - origin) + origin - middle) / size;
  vNormal = view * turned(normal);
  vTint = tint;
  gl_Position = vec4(place.x / aspect, place.y, -0.1 * place.z, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
varying vec3 vNormal, vTint;
uniform float opacity;
void main() {
  float light = 0.42 + 0.58 * abs(dot(normalize(vNormal), normalize(vec3(0.25, 0.45, 0.85))));
  gl_FragColor = vec4(vTint * light, opacity);
}`;
const STEEL = { gear: [0.80, 0.82, 0.85], pinion: [0.66, 0.74, 0.84] };
const SHOWN = { gear: 4, pinion: 40 }; // teeth before and after the middle one, at most
const NEAR = { gear: 2, pinion: 1 }; // of those, the teeth that the first view holds whole
const BAND_HALF = 0.25; // least half width of a band as drawn [mm]
const LIFT = 0.06; // of a band above its flank [mm]

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };

class Grid {
  constructor(stored, outward = 1) {
    this.outward = outward;
    [this.m, this.n] = stored.shape;
    this.values = unpack(stored);
  }
  at(i, j) {
    const k = 3 * (i * this.n + j);
    return [this.values[k], this.values[k + 1], this.values[k + 2]];
  }
  point(t, h) {
    const x = clamp(t, 0, 1) * (this.m - 1), y = clamp(h, 0, 1) * (this.n - 1);
    const i = Math.min(Math.floor(x), this.m - 2), j = Math.min(Math.floor(y), this.n - 2), u = x - i, v = y - j;
    const [a, b, c, d] = [this.at(i, j), this.at(i, j + 1), this.at(i + 1, j), this.at(i + 1, j + 1)];
    return a.map((_, k) => (1 - u) * ((1 - v) * a[k] + v * b[k]) + u * ((1 - v) * c[k] + v * d[k]));
  }
  normal(i, j) {
    const a = this.at(Math.max(i - 1, 0), j), b = this.at(Math.min(i + 1, this.m - 1), j);
    const c = this.at(i, Math.max(j - 1, 0)), d = this.at(i, Math.min(j + 1, this.n - 1));
    return unit(times(minus(b, a), minus(d, c)).map((v) => v * this.outward));
  }
  triangles(tint, out) {
    for (let i = 0; i + 1 < this.m; i++) {
      for (let j = 0; j + 1 < this.n; j++) {
        for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) out.push(...this.at(i + a, j + b), ...this.normal(i + a, j + b), ...tint(i + a, j + b));
      }
    }
  }
}

class Teeth {
  constructor(parent, result) {
    this.result = result;
    this.scene = result.scene;
    this.box = figure(parent, `Teeth in mesh, ${result.name}`, "case, loaded/pressure");
    this.box.id = `${result.id}-teeth`;
    this.box.classList.add("teeth");
    const stage = element("div", "scene", this.box);
    this.canvas = element("canvas", "", stage);
    this.ends = Object.fromEntries(["toe", "heel"].map((name) => [name, element("span", "end", stage, name)]));
    this.canvas.width = 1400;
    this.canvas.height = 760;
    this.gl = this.canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) {
      this.canvas.remove();
      element("p", "none", this.box, "This browser has no WebGL, which draws the teeth in three dimensions.");
      return;
    }
    this.controls();
    this.prepare();
    state.on(["torque"], () => this.colourFlanks());
    state.on(["torque", "position"], () => this.draw());
  }

  controls() {
    const row = element("div", "row", this.box);
    this.see = element("select", "", row);
    for (const [value, name] of [["both", "both"], ["through", "gear, pinion transparent"], ["gear", "gear alone"], ["pinion", "pinion alone"]]) element("option", "", this.see, name).value = value;
    this.over = element("select", "", row);
    for (const [value, name] of [["now", "pressure at the mesh position"], ["cycle", "pressure over the mesh cycle"]]) element("option", "", this.over, name).value = value;
    for (const select of [this.see, this.over]) select.addEventListener("change", () => { this.colourFlanks(); this.draw(); });
    for (const [name, factor] of [["+", 1 / 1.25], ["−", 1.25]]) element("button", "", row, name).addEventListener("click", () => { this.size *= factor; this.draw(); });
    element("span", "small", row, "drag or use the arrow keys to turn, shift and drag to move; bands of contact are drawn at least 0.5 mm wide");
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("aria-label", "teeth in mesh; the arrow keys turn them");
    this.canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      if (!step) return;
      event.preventDefault();
      this.yaw += step[0];
      this.pitch = clamp(this.pitch + step[1], -1.55, 1.55);
      this.draw();
    });
    this.canvas.addEventListener("pointerdown", (event) => { this.canvas.setPointerCapture(event.pointerId); this.held = [event.clientX, event.clientY]; });
    this.canvas.addEventListener("pointerup", () => (this.held = null));
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.held) return;
      const dx = event.clientX - this.held[0], dy = event.clientY - this.held[1];
      this.held = [event.clientX, event.clientY];
      const [right, up] = this.view();
      if (event.shiftKey) {
        const scale = (2 * this.size) / this.canvas.clientHeight;
        this.middle = this.middle.map((value, k) => value - scale * (dx * right[k] - dy * up[k]));
      } else {
        this.yaw += dx * 0.008;
        this.pitch = clamp(this.pitch + dy * 0.008, -1.55, 1.55);
      }
      this.draw();
    });
  }

  // Right, up and towards the eye, in the global frame.
  view() {
    const towards = [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch)];
    const right = [-Math.sin(this.yaw), Math.cos(this.yaw), 0];
    return [right, times(towards, right), towards];
  }

  prepare() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.place = (name) => gl.getUniformLocation(program, name);
    ["position", "normal", "tint"].forEach((name, i) => {
      const at = gl.getAttribLocation(program, name);
      gl.enableVertexAttribArray(at);
      this[`of${i}`] = at;
    });
    this.members = {};
    for (const name of ["gear", "pinion"]) {
      const own = this.scene.members[name], rest = [];
      for (const stored of own.others) new Grid(stored).triangles(() => STEEL[name], rest);
      this.members[name] = { ...own, name, flankGrid: new Grid(own.flank, own.outward), grid: new Grid(own.grid, own.outward), places: unpack(own.places), rest: this.buffer(rest), flankBuffer: gl.createBuffer(), bands: gl.createBuffer() };
    }
    this.aim();
    this.fit();
  }

  // Turns the eye to the loaded flank of the gear as it stands in mesh, a little from above its tip.
  aim() {
    const gear = this.members.gear, i = Math.floor(gear.flankGrid.m / 2), j = Math.floor(gear.flankGrid.n / 2);
    const angle = this.angle(gear, 0), turn = (v) => this.turned(v, gear.axis, angle);
    const up = unit(minus(turn(gear.flankGrid.at(i, gear.flankGrid.n - 1)), turn(gear.flankGrid.at(i, 0))));
    const out = turn(gear.flankGrid.normal(i, j));
    // The pinion lies above the flank: past its end, on the side to which the flank faces, the contact can be seen.
    const along = this.members.pinion.axis, side = Math.sign(dot3(out, along));
    const eye = unit(out.map((v, k) => 0.75 * v + 0.3 * up[k] + 0.5 * side * along[k]));
    this.pitch = Math.asin(eye[2]);
    this.yaw = Math.atan2(eye[1], eye[0]);
  }

  // Centres the flanks next to the contact and lets them fill the picture.
  fit() {
    const [right, up] = this.view(), least = [Infinity, Infinity], greatest = [-Infinity, -Infinity];
    for (const member of Object.values(this.members)) {
      const grid = member.flankGrid, near = NEAR[member.name];
      for (let pair = -near; pair <= near; pair++) {
        const angle = this.angle(member, pair);
        for (const i of [0, grid.m - 1]) {
          for (const j of [0, grid.n - 1]) {
            const point = this.turned(minus(grid.at(i, j), member.origin), member.axis, angle).map((v, k) => v + member.origin[k]);
            [right, up].forEach((axis, k) => {
              least[k] = Math.min(least[k], dot3(axis, point));
              greatest[k] = Math.max(greatest[k], dot3(axis, point));
            });
          }
        }
      }
    }
    const [x, y] = least.map((v, k) => 0.5 * (v + greatest[k])), towards = times(right, up);
    const depth = dot3(towards, this.scene.middle), aspect = this.canvas.width / this.canvas.height;
    this.middle = right.map((v, k) => x * v + y * up[k] + depth * towards[k]);
    this.size = (1.04 / 2) * Math.max(greatest[1] - least[1], (greatest[0] - least[0]) / aspect);
  }

  turned(v, axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle), cross = times(axis, v), along = dot3(axis, v);
    return v.map((value, k) => value * c + cross[k] * s + axis[k] * along * (1 - c));
  }

  angle(member, pair) {
    const rotation = unpack(this.scene.rotation)[nearest(this.result.positions, state.position)];
    return member.turn + member.rate * (rotation - pair * this.scene.pitch);
  }

  buffer(values, buffer = this.gl.createBuffer()) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(values), this.gl.STATIC_DRAW);
    buffer.count = values.length / 9;
    return buffer;
  }

  colourFlanks() {
    const i = nearest(this.result.torques, state.torque), peak = pressurePeak(this.result);
    for (const member of Object.values(this.members)) {
      const field = raster(this.result.pressure[member.name][i]), grid = member.flankGrid, out = [], count = grid.m * grid.n;
      grid.triangles((a, b) => {
        const value = this.over.value === "cycle" ? sample(field, member.places[a * grid.n + b], member.places[count + a * grid.n + b]) : 0;
        return value > 0.01 * peak ? colour("pressure", value / peak).map((c) => c / 255) : STEEL[member.name];
      }, out);
      this.buffer(out, member.flankBuffer);
    }
  }

  // Bands of contact on both flanks of each pair, in the places where the teeth stand.
  bands() {
    const segments = segmentsNow(this.result), peak = pressurePeak(this.result);
    for (const member of Object.values(this.members)) {
      const out = [], grid = member.grid;
      if (this.over.value === "now") {
        segments.forEach((segment, k) => {
          const ends = segmentEnds(this.result, member.name, segments, k), points = ends.map(([t, h]) => grid.point(t, h)), [t, h] = ends[1];
          const normal = grid.normal(Math.round(clamp(t, 0, 1) * (grid.m - 1)), Math.round(clamp(h, 0, 1) * (grid.n - 1)));
          const across = unit(times(normal, minus(points[2], points[0])));
          const half = Math.max(segment.half || 0, BAND_HALF);
          const tint = segment.edge ? [0.5, 0.2, 0.6] : colour("pressure", segment.pressure / peak).map((c) => c / 255);
          const angle = this.angle(member, segment.tooth);
          const corner = (point, side) => {
            const moved = point.map((v, c) => v + LIFT * normal[c] + side * half * across[c] - member.origin[c]);
            return [...this.turned(moved, member.axis, angle).map((v, c) => v + member.origin[c]), ...this.turned(normal, member.axis, angle), ...tint];
          };
          const [a, b, c, d] = [corner(points[0], -1), corner(points[2], -1), corner(points[2], 1), corner(points[0], 1)];
          out.push(...a, ...b, ...c, ...a, ...c, ...d);
        });
      }
      this.buffer(out, member.bands);
    }
  }

  draw() {
    const gl = this.gl;
    this.bands();
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const [right, up, towards] = this.view();
    gl.uniformMatrix3fv(this.place("view"), false, [right[0], up[0], towards[0], right[1], up[1], towards[1], right[2], up[2], towards[2]]);
    gl.uniform3fv(this.place("middle"), this.middle);
    gl.uniform1f(this.place("size"), this.size);
    gl.uniform1f(this.place("aspect"), this.canvas.width / this.canvas.height);
    this.nameEnds([right, up]);
    const see = this.see.value;
    const shown = { gear: see !== "pinion", pinion: see !== "gear" };
    for (const name of ["gear", "pinion"]) {
      if (!shown[name]) continue;
      const clear = name === "pinion" && see === "through", member = this.members[name];
      const count = Math.min(2 * SHOWN[name] + 1, member.teeth), first = -Math.floor(count / 2);
      gl.uniform1f(this.place("opacity"), clear ? 0.45 : 1);
      clear ? gl.enable(gl.BLEND) : gl.disable(gl.BLEND);
      // What is transparent first fills the depth, so that its foremost surface alone is blended.
      for (const colours of clear ? [false, true] : [true]) {
        gl.colorMask(colours, colours, colours, colours);
        gl.depthFunc(colours && clear ? gl.LEQUAL : gl.LESS);
        for (let pair = first; pair < first + count; pair++) {
          for (const buffer of [member.rest, member.flankBuffer]) this.batch(buffer, member, this.angle(member, pair));
        }
      }
      gl.depthFunc(gl.LESS);
      if (!clear) this.batch(member.bands, member, 0);
    }
  }

  // Names of the ends of the gear's face, beside the middle tooth.
  nameEnds([right, up]) {
    const gear = this.members.gear, grid = gear.flankGrid, angle = this.angle(gear, 0), top = grid.n - 1;
    for (const [name, i, inner] of [["toe", 0, 4], ["heel", grid.m - 1, grid.m - 5]]) {
      const [end, before] = [grid.at(i, top), grid.at(inner, top)], beyond = end.map((v, k) => v + 0.8 * (v - before[k]) - gear.origin[k]);
      const place = this.turned(beyond, gear.axis, angle).map((v, k) => v + gear.origin[k] - this.middle[k]);
      const x = dot3(right, place) / this.size / (this.canvas.width / this.canvas.height), y = dot3(up, place) / this.size;
      Object.assign(this.ends[name].style, { left: `${50 + 50 * x}%`, top: `${50 - 50 * y}%`, display: Math.abs(x) < 0.97 && Math.abs(y) < 0.97 ? "" : "none" });
    }
  }

  batch(buffer, member, angle) {
    const gl = this.gl;
    if (!buffer.count) return;
    gl.uniform3fv(this.place("axis"), member.axis);
    gl.uniform3fv(this.place("origin"), member.origin);
    gl.uniform1f(this.place("angle"), angle);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    [0, 1, 2].forEach((i) => gl.vertexAttribPointer(this[`of${i}`], 3, gl.FLOAT, false, 36, 12 * i));
    gl.drawArrays(gl.TRIANGLES, 0, buffer.count);
  }
}
