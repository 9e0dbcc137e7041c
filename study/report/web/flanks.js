// Flank pictures: rasters and contact segments on a flank, true to scale, toe on the left and tip at the top.

const PIXELS = 720; // across a picture
const places = new Map(); // fractions of the flank at each pixel, by picture size and flank

function project(plane, t, h) {
  return [0, 1].map((k) => plane[k][0] + plane[k][1] * t + plane[k][2] * h + plane[k][3] * t * h);
}

// Fractions of a point [mm] of the plane: Newton's method on the bilinear map.
function fractions(plane, x, y) {
  let t = 0.5, h = 0.5;
  for (let i = 0; i < 4; i++) {
    const [px, py] = project(plane, t, h);
    const a = plane[0][1] + plane[0][3] * h, b = plane[0][2] + plane[0][3] * t;
    const c = plane[1][1] + plane[1][3] * h, d = plane[1][2] + plane[1][3] * t;
    const determinant = a * d - b * c;
    t += (d * (x - px) - b * (y - py)) / determinant;
    h += (a * (y - py) - c * (x - px)) / determinant;
  }
  return [t, h];
}

// Value of a raster at fractions, linear between its nodes; NaN beside them.
function sample(raster, t, h) {
  const [n, m] = raster.shape;
  if (!(t >= -1e-9 && t <= 1 + 1e-9 && h >= -1e-9 && h <= 1 + 1e-9)) return NaN;
  const x = clamp(t, 0, 1) * (n - 1), y = clamp(h, 0, 1) * (m - 1);
  const i = Math.min(Math.floor(x), n - 2), j = Math.min(Math.floor(y), m - 2);
  const u = x - i, v = y - j, at = i * m + j, values = raster.values;
  return (1 - u) * ((1 - v) * values[at] + v * values[at + 1]) + u * ((1 - v) * values[at + m] + v * values[at + m + 1]);
}

const raster = (stored) => (stored ? { shape: stored.shape, values: unpack(stored) } : null);

class FlankPicture {
  // `field()` gives the raster, mask and scale for what the reader chose, or null; `marks(group)` draws lines.
  constructor(parent, result, member, options) {
    Object.assign(this, { result, member, options });
    const flank = result.flanks[member];
    this.plane = flank.plane;
    [this.x0, this.x1, this.y0, this.y1] = flank.window;
    const margin = options.small ? 0 : 0.035 * (this.x1 - this.x0); // for the names of the edges
    [this.x0, this.x1] = [this.x0 - margin, this.x1 + margin];
    const wide = this.x1 - this.x0, high = this.y1 - this.y0;
    this.box = options.small ? element("figure", "small-flank", parent) : figure(parent, options.title, options.source);
    this.box.id = `${result.id}-${options.id}-${member}`;
    this.box.classList.add("flank");
    this.stage = element("div", "stage", this.box);
    this.canvas = element("canvas", "", this.stage);
    this.canvas.width = options.small ? PIXELS / 3 : PIXELS;
    this.canvas.height = Math.round((this.canvas.width * high) / wide);
    this.layer = document.createElement("canvas");
    [this.layer.width, this.layer.height] = [this.canvas.width, this.canvas.height];
    this.drawing = svg("svg", { viewBox: `${this.x0} ${-this.y1} ${wide} ${high}`, role: "img", "aria-label": options.title }, this.stage);
    this.unit = wide / this.canvas.width;
    this.outline(flank);
    this.group = svg("g", {}, this.drawing);
    this.foot = element("div", "foot", this.box);
    this.drawing.addEventListener("pointermove", (event) => this.point(event));
    this.drawing.addEventListener("pointerleave", hideHint);
    state.on(options.keys || ["torque"], () => this.draw());
  }

  outline(flank) {
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([t, h]) => project(this.plane, t, h));
    const line = 1.6 * this.unit;
    for (const stored of flank.common) {
      const points = unpack(stored), n = points.length / 2;
      const path = Array.from({ length: n }, (_, i) => `${points[i].toFixed(3)},${(-points[n + i]).toFixed(3)}`).join(" ");
      svg("polygon", { points: path, fill: "none", stroke: "#6b6b6b", "stroke-width": line, "stroke-dasharray": `${5 * line} ${3 * line}` }, this.drawing);
    }
    svg("polygon", { points: corners.map(([x, y]) => `${x},${-y}`).join(" "), fill: "none", stroke: "#222", "stroke-width": 1.3 * line }, this.drawing);
    if (this.options.small) return;
    const size = 17 * this.unit;
    for (const [name, t, h, anchor, dx, dy] of [["toe", 0, 0.5, "end", -0.4, 0.3], ["heel", 1, 0.5, "start", 0.4, 0.3], ["root", 0.5, 0, "middle", 0, 1.05], ["tip", 0.5, 1, "middle", 0, -0.4]]) {
      const [x, y] = project(this.plane, t, h);
      svg("text", { x: x + dx * size, y: -y + dy * size, "text-anchor": anchor, "font-size": size, class: "edge" }, this.drawing, name);
    }
  }

  // Fractions at each pixel, found once for all pictures of this flank.
  pixels() {
    const key = `${this.result.id} ${this.member} ${this.canvas.height}`;
    if (!places.has(key)) {
      const { width, height } = this.canvas, found = new Float32Array(2 * width * height);
      for (let j = 0, k = 0; j < height; j++) {
        for (let i = 0; i < width; i++, k += 2) {
          const x = this.x0 + ((i + 0.5) / width) * (this.x1 - this.x0), y = this.y1 - ((j + 0.5) / height) * (this.y1 - this.y0);
          [found[k], found[k + 1]] = fractions(this.plane, x, y);
        }
      }
      places.set(key, found);
    }
    return places.get(key);
  }

  draw() {
    this.field = this.options.field ? this.options.field() : null;
    const context = this.canvas.getContext("2d");
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.fillStyle = "#fff";
    context.beginPath();
    for (const [t, h] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
      const [x, y] = project(this.plane, t, h);
      context.lineTo((x - this.x0) / this.unit, (this.y1 - y) / this.unit);
    }
    context.fill();
    if (this.field) this.paint(context);
    this.group.replaceChildren();
    if (this.field && this.field.named) this.nameLevels();
    if (this.options.marks) this.options.marks(this.group, this);
    this.foot.replaceChildren();
    if (this.field && !this.field.flat) this.bar();
    const words = this.options.words ? this.options.words() : "";
    element("span", "", this.foot, words + (this.options.field && !this.field ? ": no certified mesh position carries on contact lines" : ""));
  }

  value(t, h) {
    const { raster, mask, factor = 1 } = this.field;
    if (mask && !(sample(mask.raster, t, h) > mask.above)) return NaN;
    const found = factor * sample(raster, t, h);
    return this.field.positive && !(found > this.field.low + 1e-3 * (this.field.high - this.field.low)) ? NaN : found;
  }

  paint(context) {
    const { width, height } = this.canvas, places = this.pixels(), image = context.createImageData(width, height);
    const { low, high, map, levels = 20, lines = false, flat } = this.field, band = new Int16Array(width * height);
    const shades = flat ? [] : Array.from({ length: levels }, (_, i) => colour(map, (i + 0.5) / levels));
    for (let k = 0; k < band.length; k++) {
      const t = places[2 * k], h = places[2 * k + 1];
      const value = t >= 0 && t <= 1 && h >= 0 && h <= 1 ? this.value(t, h) : NaN;
      band[k] = -1;
      if (!Number.isFinite(value)) continue;
      if (flat) {
        if (value < 0) { band[k] = 0; image.data.set([127, 178, 214, 255], 4 * k); }
        continue;
      }
      band[k] = clamp(Math.floor(((value - low) / (high - low || 1)) * levels), 0, levels - 1);
      const [r, g, b] = shades[band[k]];
      image.data.set([r, g, b, 255], 4 * k);
    }
    if (lines || flat) {
      for (let k = 0; k + width < band.length; k++) {
        const next = band[k] !== band[k + 1] || band[k] !== band[k + width];
        if (next && band[k] >= 0 && (flat || (band[k + 1] >= 0 && band[k + width] >= 0))) image.data.set(flat ? [0, 114, 178, 255] : [60, 60, 60, 255], 4 * k);
      }
    }
    this.layer.getContext("2d").putImageData(image, 0, 0);
    context.save();
    if (lines && this.result.flanks[this.member].common.length) this.common(context);
    context.drawImage(this.layer, 0, 0);
    context.restore();
  }

  // Values of the lines between bands, along the middle of the flank and across it, where there is room: clear of each
  // other and of the boundary. A line that has none there is named elsewhere, if it has room.
  nameLevels() {
    const { low, high, levels } = this.field, size = 13 * this.unit, taken = [], named = new Set();
    const step = (high - low) / levels, band = ([t, h]) => Math.floor((this.value(t, h) - low) / step);
    const steps = Array.from({ length: 241 }, (_, k) => k / 240);
    const along = (h) => steps.map((t) => [t, h]), across = (t) => steps.map((h) => [t, h]);
    const name = (way, once) => {
      for (let k = 0; k + 1 < way.length; k++) {
        const [a, b] = [band(way[k]), band(way[k + 1])], level = Math.max(a, b);
        if (!Number.isFinite(a) || !Number.isFinite(b) || a === b || (once && named.has(level))) continue;
        const [x, y] = project(this.plane, ...way[k]), words = written(low + step * level);
        const wide = (0.3 * words.length + 0.25) * size, high = 0.6 * size;
        if (taken.some(([u, v]) => Math.abs(u - x) < 3 * size && Math.abs(v - y) < 1.5 * size)) continue;
        if (![-1, 1].every((i) => [-1, 1].every((j) => this.clear(x + i * wide, y + j * high)))) continue;
        taken.push([x, y]);
        named.add(level);
        svg("text", { x, y: -y + 0.35 * size, "text-anchor": "middle", "font-size": size, class: "level", style: `--level: ${20 * this.unit}px` }, this.group, words);
      }
    };
    for (const way of [along(0.5), ...[0.12, 0.5, 0.88].map(across)]) name(way, false);
    for (const way of [...[0.06, 0.25, 0.75, 0.94].map(across), along(0.25), along(0.75)]) name(way, true);
  }

  // Whether a point [mm] of the plane lies on the flank, and on the common flank if there is one.
  clear(x, y) {
    const [t, h] = fractions(this.plane, x, y);
    if (!(t > 0 && t < 1 && h > 0 && h < 1)) return false;
    const { common } = this.result.flanks[this.member];
    let crossings = 0;
    for (const stored of common) {
      const points = unpack(stored), n = points.length / 2;
      for (let i = 0, j = n - 1; i < n; j = i++) {
        const [ax, ay, bx, by] = [points[i], points[n + i], points[j], points[n + j]];
        if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) crossings++;
      }
    }
    return !common.length || crossings % 2 === 1;
  }

  // Nothing is drawn beyond the common flank.
  common(context) {
    context.beginPath();
    for (const stored of this.result.flanks[this.member].common) {
      const points = unpack(stored), n = points.length / 2;
      for (let i = 0; i < n; i++) context[i ? "lineTo" : "moveTo"]((points[i] - this.x0) / this.unit, (this.y1 - points[n + i]) / this.unit);
    }
    context.clip();
  }

  bar() {
    const { low, high, map, unit, levels = 20 } = this.field;
    const drawing = svg("svg", { viewBox: "0 0 320 26", class: "bar" }, this.foot);
    for (let i = 0; i < levels; i++) svg("rect", { x: 14 + (i * 292) / levels, y: 0, width: 292 / levels + 0.3, height: 9, fill: css(colour(map, (i + 0.5) / levels)) }, drawing);
    for (const tick of ticks(low, high, 6)) svg("text", { x: 14 + ((tick - low) / (high - low || 1)) * 292, y: 22, "text-anchor": "middle" }, drawing, written(tick));
    element("span", "unit", this.foot, unit);
  }

  point(event) {
    const frame = this.drawing.getBoundingClientRect();
    const x = this.x0 + ((event.clientX - frame.left) / frame.width) * (this.x1 - this.x0);
    const y = this.y1 - ((event.clientY - frame.top) / frame.height) * (this.y1 - this.y0);
    const [t, h] = fractions(this.plane, x, y);
    if (!(t >= 0 && t <= 1 && h >= 0 && h <= 1)) return hideHint();
    const place = `${(100 * t).toFixed(0)} % from the toe, ${(100 * h).toFixed(0)} % from the root of the ${this.member}`;
    let told = this.options.read ? this.options.read(x, y) : "";
    if (this.field && !told) {
      const value = this.value(t, h);
      if (this.field.flat) told = value < 0 ? "printed" : "not printed";
      else told = Number.isFinite(value) ? `${written(value)} ${this.field.unit}` : "nothing here";
    }
    showHint(event, [told, place, this.options.source].filter(Boolean).join("\n"));
  }
}

// Loaded segments at the chosen torque and mesh position, as bands of their true length and width.
function segmentsNow(result) {
  const s = result.segments, i = nearest(result.torques, state.torque), k = nearest(result.positions, state.position);
  const found = [];
  const all = Object.fromEntries(["tooth", "edge", "pressure", "half_width", "length", "force"].map((n) => [n, unpack(s[n])]));
  for (let n = s.start[i][k]; n < s.start[i][k + 1]; n++) {
    found.push({ n, tooth: all.tooth[n], edge: all.edge[n] > 0 || !Number.isFinite(all.pressure[n]), pressure: all.pressure[n], half: all.half_width[n], length: all.length[n], force: all.force[n] });
  }
  return found;
}

// Ends of a segment: half-way to its neighbours on the same line; beyond the last one as far as before it.
function segmentEnds(result, member, segments, i) {
  const places = unpack(result.segments.places[member]), count = places.length / 2;
  const at = (k) => [places[segments[k].n], places[count + segments[k].n]];
  const same = (k) => k >= 0 && k < segments.length && segments[k].tooth === segments[i].tooth && segments[k].edge === segments[i].edge && Math.abs(segments[k].length - segments[i].length) < 1e-3 * segments[i].length + 1e-4;
  const [t, h] = at(i);
  const step = (k) => (same(k) ? [(at(k)[0] - t) / 2, (at(k)[1] - h) / 2] : null);
  const before = step(i - 1), after = step(i + 1);
  const first = before || (after ? after.map((d) => -d) : [0, 0]), second = after || (before ? before.map((d) => -d) : [0, 0]);
  return [[t + first[0], h + first[1]], [t, h], [t + second[0], h + second[1]]];
}
