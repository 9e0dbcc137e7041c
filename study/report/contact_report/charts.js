// Charts: curves over one quantity, and the map of efficiencies. The pointer reads off values.

const CHART = { width: 560, height: 270, left: 62, right: 14, top: 12, bottom: 44 };
const OTHERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#8a6d00", "#56B4E9"];

function figure(parent, title, source) {
  const box = element("figure", "", parent);
  const caption = element("figcaption", "", box);
  element("b", "", caption, title);
  if (source) element("code", "", caption, source);
  return box;
}

function lineChart(parent, result, chart) {
  const box = figure(parent, chart.title, chart.source);
  box.id = `${result.id}-${chart.id}`;
  if (!chart.series.length) {
    element("p", "none", box, "Nothing to draw: no certified mesh position has a value.");
    return;
  }
  const { width, height, left, right, top, bottom } = CHART;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "chart", role: "img", "aria-label": chart.title }, box);
  const series = chart.series.map((one) => ({ ...one, x: unpack(one.x), y: unpack(one.y) }));
  const xs = series.flatMap((one) => [...one.x].filter((x, i) => Number.isFinite(one.y[i])));
  const ys = series.flatMap((one) => [...one.y].filter(Number.isFinite));
  const x0 = Math.min(...xs), x1 = Math.max(...xs);
  let y0 = Math.min(...ys), y1 = Math.max(...ys);
  if (y0 > 0 && y0 < 0.4 * y1) y0 = 0;
  const least = 1e-3 * Math.max(Math.abs(y0), Math.abs(y1), 1e-9);
  const extra = Math.max(0.06 * (y1 - y0), least);
  y1 += extra;
  if (y0 !== 0) y0 -= extra;
  const px = (x) => left + ((x - x0) / (x1 - x0 || 1)) * (width - left - right);
  const py = (y) => height - bottom - ((y - y0) / (y1 - y0)) * (height - top - bottom);
  for (const y of ticks(y0, y1, 6)) {
    svg("line", { x1: left, x2: width - right, y1: py(y), y2: py(y), class: "grid" }, drawing);
    svg("text", { x: left - 6, y: py(y) + 4, "text-anchor": "end" }, drawing, written(y));
  }
  for (const x of ticks(x0, x1, 8)) {
    svg("line", { x1: px(x), x2: px(x), y1: height - bottom, y2: height - bottom + 4, class: "axis" }, drawing);
    svg("text", { x: px(x), y: height - bottom + 17, "text-anchor": "middle" }, drawing, written(x));
  }
  svg("line", { x1: left, x2: width - right, y1: height - bottom, y2: height - bottom, class: "axis" }, drawing);
  svg("text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, drawing, chart.x);
  const middle = (top + height - bottom) / 2;
  svg("text", { x: 13, y: middle, "text-anchor": "middle", transform: `rotate(-90 13 ${middle})` }, drawing, chart.y);
  const discrete = chart.id === "te_orders";
  const marked = discrete || series.some((one) => one.x.length < 12);
  const ofTorque = (one) => (chart.by === "only" ? Math.floor(one.number / chart.per) : one.number);
  const torqueCount = result.torques.length;
  const tint = (one) => {
    if (chart.by === "torque") return css(colour("viridis", torqueCount > 1 ? one.number / (torqueCount - 1) : 0.3));
    return OTHERS[(chart.by === "only" ? one.number % chart.per : one.number) % OTHERS.length];
  };
  const lines = series.map((one) => {
    let path = "", broken = true;
    one.y.forEach((y, i) => {
      if (Number.isFinite(y)) {
        path += `${broken ? "M" : "L"}${px(one.x[i]).toFixed(1)},${py(y).toFixed(1)}`;
        broken = false;
      } else broken = true;
    });
    const group = svg("g", { class: "series" }, drawing);
    svg("path", { d: path, stroke: tint(one), fill: "none", ...(discrete ? { "stroke-dasharray": "2 3" } : {}) }, group);
    if (marked) {
      one.y.forEach((y, i) => {
        if (Number.isFinite(y)) svg("circle", { cx: px(one.x[i]), cy: py(y), r: 3, fill: tint(one) }, group);
      });
    }
    return group;
  });
  const overCycle = chart.x === "mesh position";
  const cursor = svg("line", { y1: top, y2: height - bottom, class: "cursor" }, drawing);
  const legend = element("div", "legend", box);
  const entries = series.map((one) => {
    const entry = element("span", "", legend);
    element("i", "", entry).style.background = tint(one);
    entry.append(one.name);
    return entry;
  });
  const draw = () => {
    const chosen = nearest(result.torques, state.torque);
    series.forEach((one, i) => {
      const own = ofTorque(one) === chosen;
      if (chart.by === "only") {
        lines[i].style.display = entries[i].style.display = own ? "" : "none";
      } else if (chart.by === "torque") {
        lines[i].setAttribute("class", own || series.length === 1 ? "series chosen" : "series");
        entries[i].className = own ? "chosen" : "";
      }
    });
    if (overCycle) {
      const at = result.positions[nearest(result.positions, state.position)];
      cursor.setAttribute("x1", px(at));
      cursor.setAttribute("x2", px(at));
    } else cursor.style.display = "none";
  };
  state.on(["torque", "position"], draw);
  drawing.addEventListener("pointermove", (event) => {
    const frame = drawing.getBoundingClientRect();
    const x = x0 + (((event.clientX - frame.left) / frame.width) * width - left) / (width - left - right) * (x1 - x0);
    const shown = series.filter((one, i) => lines[i].style.display !== "none");
    const rows = shown.map((one) => {
      const i = nearest(Array.from(one.x), x);
      return [one.x[i], `${one.name}: ${written(one.y[i])}`];
    });
    if (rows.length) showHint(event, [`${chart.x} ${written(rows[0][0])}`, ...rows.map((row) => row[1]), chart.source].join("\n"));
  });
  drawing.addEventListener("pointerleave", hideHint);
}

// Efficiencies as a table with coloured cells: torque to the right, speed upwards.
function efficiencyMap(parent, map, condition) {
  const box = figure(parent, "Efficiency over torque and speed [%]", "friction/efficiency");
  const values = unpack(map.values), rows = map.torques.length, columns = map.speeds.length;
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
      cell.title = `friction/efficiency at ${written(torque)} N m, ${written(map.speeds[j])} / min`;
      if (Number.isFinite(value)) cell.style.background = css(colour("green", 0.05 + 0.45 * (value - low) / (high - low || 1)));
    }
  });
  element("p", "small", box, `at ${written(condition.temperature)} °C, Rq ${written(condition.roughness)} µm`);
  return rows;
}
