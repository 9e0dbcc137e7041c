// Charts: curves over one quantity, and the map of efficiencies. The pointer reads values off and chooses a part.

const CHART = { width: 560, height: 270, left: 74, right: 14, top: 12, bottom: 44 };
const OTHERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#8a6d00", "#56B4E9"];

function figure(parent, title, source) {
  const box = element("figure", "", parent);
  const caption = element("figcaption", "", box);
  element("b", "", caption, title);
  if (source) element("code", "", caption, source);
  return box;
}

// Least and greatest value to draw, with some room, from zero where the values come near it.
function extent(values) {
  let low = Math.min(...values), high = Math.max(...values);
  if (low > 0 && low < 0.4 * high) low = 0;
  const extra = Math.max(0.06 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high), 1e-9));
  return [low !== 0 ? low - extra : low, high + extra];
}

class LineChart {
  // `result` gives torques, positions and the pinion's teeth; a series of `by` "each" has an owner with its own.
  constructor(parent, result, chart) {
    this.box = figure(parent, chart.title, chart.source);
    this.box.id = `${result.id}-${chart.id}`;
    this.box.classList.add("curves");
    if (!chart.series.length) {
      element("p", "none", this.box, "Nothing to draw: no certified mesh position has a value.");
      return;
    }
    Object.assign(this, { result, chart });
    this.left = CHART.left;
    this.wide = CHART.width - CHART.left - (chart.second ? CHART.left : CHART.right);
    this.high = CHART.height - CHART.top - CHART.bottom;
    this.series = chart.series.map((one) => ({ ...one, x: unpack(one.x), y: unpack(one.y) }));
    const xs = this.series.flatMap((one) => [...one.x].filter((x, i) => Number.isFinite(one.y[i])));
    this.whole = [Math.min(...xs), Math.max(...xs)];
    this.shown = [...this.whole];
    this.discrete = chart.id === "te_orders";
    this.marked = this.discrete || this.series.some((one) => one.x.length < 12);
    this.drawing = svg("svg", { viewBox: `0 0 ${CHART.width} ${CHART.height}`, class: "chart", role: "img", "aria-label": chart.title }, this.box);
    this.legend();
    this.pointers();
    state.on(["torque"], () => this.draw());
    if (chart.cycle) state.on(["position"], () => this.cursor());
  }

  px(x) { return ((x - this.shown[0]) / (this.shown[1] - this.shown[0] || 1)) * this.wide; }
  py(y) {
    const share = (y - this.y0) / (this.y1 - this.y0);
    return (this.chart.down ? share : 1 - share) * this.high;
  }

  tint(one) {
    const { by, per } = this.chart, count = this.result.torques.length;
    if (by === "torque") return css(colour("viridis", count > 1 ? one.number / (count - 1) : 0.3));
    if (by === "each") return OTHERS[results.indexOf(one.owner) % OTHERS.length];
    return OTHERS[(by === "only" ? one.number % per : one.number) % OTHERS.length];
  }

  // Whether a series is of the chosen torque.
  own(one) {
    const { by, per } = this.chart;
    const number = by === "only" ? Math.floor(one.number / per) : one.number;
    return number === nearest((one.owner || this.result).torques, state.torque);
  }

  legend() {
    const legend = element("div", "legend", this.box);
    this.entries = this.series.map((one) => {
      const entry = element("span", "", legend);
      element("i", "", entry).style.background = this.tint(one);
      entry.append(one.name);
      return entry;
    });
    this.back = element("button", "back", legend, "whole curve");
    this.back.addEventListener("click", () => this.zoom(this.whole));
  }

  zoom(shown) {
    this.shown = [...shown];
    this.draw();
  }

  axes() {
    const { left, wide, high } = this, { chart } = this, top = CHART.top, bottom = top + high;
    for (const y of ticks(this.y0, this.y1, 6)) {
      svg("line", { x1: left, x2: left + wide, y1: top + this.py(y), y2: top + this.py(y), class: "grid" }, this.drawing);
      svg("text", { x: left - 6, y: top + this.py(y) + 4, "text-anchor": "end" }, this.drawing, written(y));
    }
    for (const x of ticks(...this.shown, 8)) {
      svg("line", { x1: left + this.px(x), x2: left + this.px(x), y1: bottom, y2: bottom + 4, class: "axis" }, this.drawing);
      const words = written(x), last = this.px(x) + 4.5 * words.length > CHART.width - left;
      svg("text", { x: last ? CHART.width - 1 : left + this.px(x), y: bottom + 17, "text-anchor": last ? "end" : "middle" }, this.drawing, words);
    }
    svg("line", { x1: left, x2: left + wide, y1: bottom, y2: bottom, class: "axis" }, this.drawing);
    const turn = chart.cycle && this.result.teeth ? `, 1 is ${(360 / this.result.teeth).toFixed(2)}° of the pinion` : "";
    svg("text", { x: left + wide / 2, y: CHART.height - 6, "text-anchor": "middle" }, this.drawing, chart.x + turn);
    const middle = top + high / 2;
    svg("text", { x: 13, y: middle, "text-anchor": "middle", transform: `rotate(-90 13 ${middle})` }, this.drawing, chart.y);
    if (!chart.second) return;
    const { factor, label } = chart.second, right = left + wide;
    for (const y of ticks(this.y0 * factor, this.y1 * factor, 6)) {
      svg("line", { x1: right, x2: right + 4, y1: top + this.py(y / factor), y2: top + this.py(y / factor), class: "axis" }, this.drawing);
      svg("text", { x: right + 7, y: top + this.py(y / factor) + 4 }, this.drawing, written(y));
    }
    svg("text", { x: CHART.width - 6, y: middle, "text-anchor": "middle", transform: `rotate(-90 ${CHART.width - 6} ${middle})` }, this.drawing, label);
  }

  draw() {
    const { by } = this.chart, alone = by === "only" || by === "each";
    this.visible = this.series.filter((one) => !alone || this.own(one));
    this.series.forEach((one, i) => {
      this.entries[i].style.display = this.visible.includes(one) ? "" : "none";
      this.entries[i].className = by === "torque" && this.own(one) ? "chosen" : "";
    });
    const zoomed = this.shown[0] > this.whole[0] || this.shown[1] < this.whole[1];
    this.back.style.display = zoomed ? "" : "none";
    const inside = (x) => x >= this.shown[0] - 1e-12 && x <= this.shown[1] + 1e-12;
    const ys = (by === "each" ? this.visible : this.series).flatMap((one) => [...one.y].filter((y, i) => Number.isFinite(y) && inside(one.x[i])));
    [this.y0, this.y1] = extent(ys.length ? ys : [0, 1]);
    this.drawing.replaceChildren();
    this.axes();
    this.plot = svg("svg", { x: this.left, y: CHART.top, width: this.wide, height: this.high, overflow: zoomed ? "hidden" : "visible" }, this.drawing);
    for (const one of this.visible) this.curve(one);
    this.line = svg("line", { y1: 0, y2: this.high, class: "cursor" }, this.plot);
    this.cursor();
    this.reading = svg("g", {}, this.plot);
  }

  curve(one) {
    const chosen = this.chart.by === "torque" && (this.own(one) || this.series.length === 1);
    const group = svg("g", { class: chosen ? "series chosen" : "series" }, this.plot);
    let path = "", broken = true;
    one.y.forEach((y, i) => {
      if (Number.isFinite(y)) {
        path += `${broken ? "M" : "L"}${this.px(one.x[i]).toFixed(1)},${this.py(y).toFixed(1)}`;
        broken = false;
        if (this.marked) svg("circle", { cx: this.px(one.x[i]), cy: this.py(y), r: 3, fill: this.tint(one) }, group);
      } else broken = true;
    });
    svg("path", { d: path, stroke: this.tint(one), fill: "none", ...this.dashes(one) }, group);
  }

  // Curves of several results are told apart where they coincide: each later one has gaps that show those below.
  dashes(one) {
    if (this.discrete) return { "stroke-dasharray": "2 3" };
    const number = one.owner ? results.indexOf(one.owner) : this.chart.id.startsWith("compare_") ? one.number : 0;
    return number ? { "stroke-dasharray": ["", "9 6", "3 5", "12 4 3 4", "1 4", "6 2"][number % 6] } : {};
  }

  cursor() {
    if (!this.chart.cycle) return this.line.style.display = "none";
    const at = this.px(this.result.positions[nearest(this.result.positions, state.position)]);
    this.line.style.display = at >= -1e-9 && at <= this.wide + 1e-9 ? "" : "none";
    this.line.setAttribute("x1", at);
    this.line.setAttribute("x2", at);
  }

  // The pointer reads the values of all curves; dragging chooses what of the abscissa is shown, a double click all of it.
  pointers() {
    const at = (event) => {
      const frame = this.drawing.getBoundingClientRect();
      const share = (((event.clientX - frame.left) / frame.width) * CHART.width - this.left) / this.wide;
      return this.shown[0] + clamp(share, 0, 1) * (this.shown[1] - this.shown[0]);
    };
    let start = null, band = null;
    this.drawing.addEventListener("pointerdown", (event) => {
      if (event.button || event.pointerType === "touch") return;
      start = at(event);
      this.drawing.setPointerCapture(event.pointerId);
      band = svg("rect", { y: 0, height: this.high, width: 0, class: "chosen-part" }, this.plot);
    });
    this.drawing.addEventListener("pointermove", (event) => {
      const x = at(event);
      if (start !== null) {
        band.setAttribute("x", this.px(Math.min(start, x)));
        band.setAttribute("width", Math.abs(this.px(x) - this.px(start)));
      }
      this.read(event, x);
    });
    this.drawing.addEventListener("pointerup", (event) => {
      if (start === null) return;
      const [low, high] = [start, at(event)].sort((a, b) => a - b), wide = this.px(high) - this.px(low);
      start = null;
      band.remove();
      if (wide > 0.03 * this.wide) this.zoom([low, high]);
    });
    this.drawing.addEventListener("dblclick", () => this.zoom(this.whole));
    this.drawing.addEventListener("pointerleave", () => { this.reading.replaceChildren(); hideHint(); });
  }

  read(event, x) {
    this.reading.replaceChildren();
    const { second } = this.chart, rows = [];
    let place = x;
    for (const one of this.visible) {
      const i = nearest(Array.from(one.x), x), y = one.y[i];
      if (!Number.isFinite(y)) continue;
      place = one.x[i];
      rows.push(`${one.name}: ${written(y)}${second ? `, ${written(second.factor * y)} µm` : ""}`);
      svg("circle", { cx: this.px(place), cy: this.py(y), r: 4, fill: this.tint(one), stroke: "#fff" }, this.reading);
    }
    const turn = this.chart.cycle && this.result.teeth ? `, pinion ${((360 / this.result.teeth) * place).toFixed(2)}°` : "";
    if (rows.length) showHint(event, [`${this.chart.x} ${written(place)}${turn}`, ...rows, this.chart.source].join("\n"));
  }
}

// Efficiencies as a table with coloured cells: torque to the right, speed upwards.
function efficiencyMap(parent, map, condition) {
  const box = figure(parent, "Efficiency over torque and speed [%]", "friction/efficiency");
  const values = unpack(map.values), outside = map.outside && unpack(map.outside), rows = map.torques.length, columns = map.speeds.length;
  const finite = [...values].filter(Number.isFinite);
  const low = Math.min(...finite), high = Math.max(...finite);
  const table = element("table", "heat", box);
  const head = element("tr", "", table);
  element("th", "", head, "N m \\ 1/min");
  for (const speed of map.speeds) element("th", "", head, written(speed));
  map.torques.forEach((torque, i) => {
    const row = element("tr", "", table);
    element("th", "", row, written(torque));
    for (let j = 0; j < columns; j++) {
      const value = values[i * columns + j];
      const cell = element("td", "", row, Number.isFinite(value) ? value.toFixed(2) : "–");
      cell.title = `friction/efficiency at ${written(torque)} N m, ${written(map.speeds[j])} 1/min`;
      if (outside && outside[i * columns + j] >= map.told) {
        cell.className = "outside";
        cell.title += `\n${(100 * outside[i * columns + j]).toFixed(0)} % of the power loss outside the range of the friction formula (friction/extrapolated_share)`;
      }
      if (Number.isFinite(value)) cell.style.backgroundColor = css(colour("green", 0.05 + 0.45 * (value - low) / (high - low || 1)));
    }
  });
  element("p", "small", box, `at ${written(condition.temperature)} °C, Rq ${condition.roughness} µm`);
  if (outside && outside.some((share) => share >= map.told)) {
    element("p", "small", box, `hatched: ${100 * map.told} % of the power loss or more lies outside the range of the friction formula (friction/extrapolated_share)`);
  }
  return rows;
}
