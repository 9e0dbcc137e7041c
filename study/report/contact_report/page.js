// The page: tables, sections and what the reader chooses.

const data = JSON.parse(document.getElementById("data").textContent);
const results = data.results;
results.forEach((result, i) => (result.id = `r${i}`));
const several = results.length > 1;

const peaks = new Map();
function pressurePeak(result) {
  if (!peaks.has(result)) {
    const found = result.pressure.gear.map((stored) => unpack(stored).reduce((a, b) => Math.max(a, b), 0));
    peaks.set(result, ticks(0, Math.max(...found, 1), 8).reduce((a, b) => Math.max(a, b), Math.max(...found, 1)));
  }
  return peaks.get(result);
}

const torqueOf = (result) => nearest(result.torques, state.torque);
const torqueWords = (result) => `${written(result.torques[torqueOf(result)])} N m`;
const positionWords = (result) => `mesh position ${written(result.positions[nearest(result.positions, state.position)])}`;
const title = (text, result) => (several ? `${text}, ${result.name}` : text);

function table(parent, heads, rows, caption) {
  const node = element("table", "numbers", parent);
  if (caption) element("caption", "", node, caption);
  const head = element("tr", "", element("thead", "", node));
  for (const text of heads) element("th", "", head, text);
  const body = element("tbody", "", node);
  for (const cells of rows) {
    const row = element("tr", "", body);
    cells.forEach((text, i) => element("td", heads[i] === "variable" ? "variable" : "", row, text));
  }
  return node;
}

function section(id, name) {
  const node = element("section", "", page);
  node.id = id;
  element("h2", "", node, name);
  const link = element("a", "", contents, name);
  link.href = `#${id}`;
  link.addEventListener("click", (event) => { event.preventDefault(); node.scrollIntoView(); });
  return node;
}

function slider(key, name, values, unit) {
  const box = element("label", "slider", bar);
  element("span", "", box, name);
  const input = element("input", "", box);
  Object.assign(input, { type: "range", min: 0, max: values.length - 1, step: 1, id: `slide-${key}`, disabled: values.length < 2 });
  const words = element("output", "", box);
  input.addEventListener("input", () => state.set(key, values[Number(input.value)]));
  state.on([key], () => {
    const i = nearest(values, state[key]);
    input.value = i;
    words.textContent = `${written(values[i])}${unit}`;
  });
  return values;
}

const union = (lists) => [...new Set(lists.flat())].sort((a, b) => a - b);

// Choices that the address gives: report.html#torque=150&position=0.25
let given = new URLSearchParams(location.hash.slice(1));
const speeds = union(results.map((result) => (result.friction ? result.friction.speeds : [])));
const torques = union(results.map((result) => result.torques));
const longest = results.reduce((a, b) => (b.positions.length > a.positions.length ? b : a)).positions;
const chosen = (key, values, own) => (given.has(key) ? values[nearest(values, Number(given.get(key)))] : own);
state.torque = chosen("torque", torques, torques[Math.floor((torques.length - 1) / 2)]);
state.speed = chosen("speed", speeds, speeds[Math.floor((speeds.length - 1) / 2)] ?? NaN);
state.position = chosen("position", longest, longest[0]);

window.addEventListener("hashchange", () => {
  given = new URLSearchParams(location.hash.slice(1));
  for (const [key, values] of [["torque", torques], ["speed", speeds], ["position", longest]]) {
    if (given.has(key)) state.set(key, chosen(key, values, state[key]));
  }
});

const header = element("header", "", document.body);
element("h1", "", header, "Contact report");
element("p", "case-title", header, data.title);
const contents = element("nav", "", document.body);
const bar = element("div", "sliders", document.body);
slider("torque", "torque", torques, " N m");
slider("position", "mesh position", longest, "");
const play = element("button", "", bar, "▶");
play.title = "roll through the mesh";
let rolling = 0;
play.addEventListener("click", () => {
  play.textContent = rolling ? "▶" : "❚❚";
  if (rolling) { clearInterval(rolling); rolling = 0; return; }
  rolling = setInterval(() => state.set("position", longest[(nearest(longest, state.position) + 1) % longest.length]), 120);
});
if (speeds.length) slider("speed", "speed", speeds, " 1/min");
const page = element("main", "", document.body);

function summary() {
  const node = section("summary", "Summary");
  for (const result of results) {
    const box = element("div", "result", node);
    if (several) element("h3", "", box, result.name);
    if (result.title !== data.title) element("p", "", box, result.title);
    table(box, ["", ""], result.head).classList.add("plain");
    if (result.misalignment.length) {
      table(box, ["torque [N m]", "E [mm]", "P [mm]", "G [mm]", "Sigma [°]"], result.misalignment, "Misalignment over the torque").classList.add("right");
      element("p", "small", box, "Variables: misalignment/offset, pinion_axial, gear_axial, shaft_angle.");
    }
    for (const note of result.notes) element("p", "note", box, note);
    if (!result.notes.length) element("p", "small", box, "No notes: no number is implausible, and no model leaves its range.");
    if (result.torque_count > result.torques.length) element("p", "small", box, `Pictures and charts over the mesh cycle show ${result.torques.length} of ${result.torque_count} torques.`);
  }
}

function numbers() {
  const node = section("numbers", "Numbers");
  for (const result of results) {
    const loaded = result.loaded_numbers;
    const wide = element("div", "wide", node);
    table(wide, ["under load", "unit", ...loaded.torques.map((t) => `${t} N m`), "variable"], loaded.rows.map(([name, unit, path, ...values]) => [name, unit, ...values, path]), several ? result.name : "");
    table(wide, ["without load", "unit", "value", "variable"], result.unloaded_numbers.map(([name, unit, path, value]) => [name, unit, value, path]));
  }
}

function teeth() {
  const node = section("teeth", "Teeth in mesh");
  for (const result of results) {
    if (result.scene) new Teeth(node, result);
    else element("p", "none", node, title("No picture of the teeth: the result has no case whose tooth surfaces exist", result));
  }
}

function range(stored, levels) {
  const values = unpack(stored).filter(Number.isFinite).sort();
  const step = ticks(values[0], values[values.length - 1], levels);
  const width = step.length > 1 ? step[1] - step[0] : 1;
  const low = Math.floor(values[0] / width + 1e-9) * width, high = Math.ceil(values[values.length - 1] / width - 1e-9) * width;
  return { low, high, levels: Math.max(Math.round((high - low) / width), 1) };
}

function easeOff() {
  const node = section("ease-off", "Ease-off");
  const grid = element("div", "grid", node);
  for (const result of results) {
    const stored = result.fields.ease_off;
    const field = { raster: raster(stored), ...range(stored, 14), map: "viridis", unit: "µm", lines: true };
    new FlankPicture(grid, result, "gear", { id: "ease_off", title: title("Ease-off, gear flank", result), source: "ease_off/ease_off", keys: [], field: () => field, words: () => "positive where there is a gap; dashed: boundary of the common flank" });
  }
}

function line(group, points, attributes) {
  const n = points.length / 2;
  const path = Array.from({ length: n }, (_, i) => `${points[i].toFixed(3)},${(-points[n + i]).toFixed(3)}`).join(" ");
  svg("polyline", { points: path, fill: "none", ...attributes }, group);
}

function pattern() {
  const node = section("pattern", "Contact pattern without load");
  const grid = element("div", "grid", node);
  for (const result of results) {
    const marks = result.marks;
    for (const member of ["gear", "pinion"]) {
      const own = marks.members[member];
      new FlankPicture(grid, result, member, {
        id: "lines", title: title(`Contact lines and path of contact, ${member}`, result), source: "unloaded/line_lengthwise, path_lengthwise", keys: [],
        marks: (group, picture) => {
          const all = unpack(own.lines), [, count, n] = own.lines.shape;
          for (let i = 0; i < count; i++) {
            const points = [...all.slice(i * n, (i + 1) * n), ...all.slice((count + i) * n, (count + i + 1) * n)];
            line(group, points, { stroke: marks.carrying[i] ? "#0072B2" : "#b8b8b8", "stroke-width": 1.2 * picture.unit });
          }
          for (const stored of own.ranges) line(group, unpack(stored), { stroke: "#0072B2", "stroke-width": 2.5 * picture.unit });
          for (const stored of own.paths) line(group, unpack(stored), { stroke: "#D55E00", "stroke-width": 4 * picture.unit });
        },
        words: () => `lines within a gap of ${written(marks.thickness)} µm; blue: the pair that carries, grey: before and after; orange: path of contact`,
      });
    }
    for (const member of ["gear", "pinion"]) {
      const own = marks.members[member];
      if (!own.print) { element("p", "none", grid, title("No marking print: the flanks do not touch without load", result)); continue; }
      new FlankPicture(grid, result, member, { id: "print", title: title(`Marking print of ${written(marks.thickness)} µm, ${member}`, result), source: "unloaded/least_gap", keys: [], field: () => ({ raster: raster(own.print), flat: true }) });
    }
    for (const member of ["gear", "pinion"]) {
      const own = marks.members[member];
      if (!own.light) continue;
      const peak = Math.max(1e-9, ...unpack(own.light));
      new FlankPicture(grid, result, member, { id: "light", title: title(`Pattern at light load, ${written(marks.light_torque)} N m, ${member}`, result), source: "light_load/pressure", keys: [], field: () => ({ raster: raster(own.light), low: 0, high: peak, map: "pressure", unit: "MPa", positive: true }) });
    }
  }
}

function pressureField(result, member) {
  const stored = result.pressure[member][torqueOf(result)], peak = pressurePeak(result);
  return unpack(stored).some((v) => v > 0) ? { raster: raster(stored), low: 0, high: peak, map: "pressure", unit: "MPa", positive: true } : null;
}

function bands(group, picture) {
  const { result, member } = picture, segments = segmentsNow(result), peak = pressurePeak(result);
  segments.forEach((segment, i) => {
    const ends = segmentEnds(result, member, segments, i).map(([t, h]) => project(picture.plane, t, h));
    const [first, , second] = ends;
    const tint = segment.edge ? "#7b3294" : css(colour("pressure", segment.pressure / peak));
    const node = svg("line", { x1: first[0], y1: -first[1], x2: second[0], y2: -second[1], stroke: tint, "stroke-width": Math.max(2 * (segment.half || 0), 2.5 * picture.unit), class: "band" }, group);
    node.addEventListener("pointermove", (event) => {
      event.stopPropagation();
      showHint(event, [segment.edge ? `edge, ${written(segment.force)} N` : `${written(segment.pressure)} MPa`, `${written(segment.force)} N on ${written(segment.length)} mm, half width ${written(segment.half)} mm`, `tooth pair ${segment.tooth}`, "loaded/pressure, force, length, half_width, tooth"].join("\n"));
    });
  });
}

function pressure() {
  const node = section("pressure", "Contact under load");
  const grid = element("div", "grid", node);
  for (const result of results) {
    for (const member of ["gear", "pinion"]) {
      new FlankPicture(grid, result, member, {
        id: "pressure", title: title(`Greatest pressure over the mesh cycle, ${member}`, result), source: "loaded/pressure", field: () => pressureField(result, member),
        words: () => torqueWords(result),
      });
    }
    for (const member of ["gear", "pinion"]) {
      new FlankPicture(grid, result, member, {
        id: "bands", title: title(`Pressure at the mesh position, ${member}`, result), source: "loaded/pressure, half_width", keys: ["torque", "position"], marks: bands,
        words: () => {
          const found = segmentsNow(result), pairs = [...new Set(found.map((s) => s.tooth))];
          return found.length ? `${torqueWords(result)}, ${positionWords(result)}: ${pairs.length} tooth pair${pairs.length > 1 ? "s" : ""}, each on its own tooth; violet: tooth edges` : `${torqueWords(result)}, ${positionWords(result)}: no certified solution`;
        },
      });
    }
    for (const chart of result.charts.contact) lineChart(grid, result, { ...chart, title: title(chart.title, result) });
  }
}

function charts(id, name, key) {
  if (!results.some((result) => result.charts[key])) return;
  const node = section(id, name), grid = element("div", "grid", node);
  for (const result of results) {
    for (const chart of result.charts[key] || []) lineChart(grid, result, { ...chart, title: title(chart.title, result) });
    if (!result.charts[key]) element("p", "none", grid, `${result.name} has none.`);
  }
}

const FRICTION = {
  sliding_velocity: ["Sliding velocity", "m/s", "orange"],
  pv: ["Pressure × sliding velocity", "MPa m/s", "pressure"],
  friction_coefficient: ["Friction coefficient", "", "orange"],
  film_thickness: ["Film thickness", "µm", "green"],
  lambda_ratio: ["Lambda ratio", "", "green"],
  flash_temperature: ["Flash temperature", "K", "pressure"],
};

function frictionField(result, name) {
  const [, unit, map] = FRICTION[name], i = torqueOf(result), k = nearest(result.friction.speeds, state.speed);
  const load = raster(result.pressure.gear[i]), peak = Math.max(...load.values), factor = result.friction.speeds[k];
  if (name === "sliding_velocity") {
    const stored = result.fields.sliding_velocity, own = range(stored, 14), scale = (v) => v * factor;
    return { raster: raster(stored), factor, low: scale(own.low), high: scale(own.high), levels: own.levels, map, unit, lines: true };
  }
  if (!(peak > 0)) return null;
  const mask = { raster: load, above: 0.03 * peak };
  if (name === "pv") {
    const sliding = unpack(result.fields.sliding_velocity), values = load.values.map((p, n) => p * sliding[n] * factor);
    return { raster: { shape: load.shape, values }, low: 0, high: values.reduce((a, b) => (b > a ? b : a), 0), map, unit, mask };
  }
  const stored = result.friction.fields[name][i][k];
  if (!stored) return null;
  const found = raster(stored), carried = found.values.filter((v, n) => load.values[n] > mask.above && Number.isFinite(v)).sort();
  const at = (share) => carried[Math.floor(share * (carried.length - 1))];
  if (!carried.length) return null;
  return { raster: found, low: at(0.01), high: at(0.99), map, unit, mask };
}

function friction() {
  if (!results.some((result) => result.friction)) {
    const node = section("friction", "Friction and efficiency");
    element("p", "none", node, "No friction: the result was made without a speed (easeoff run CASE --speed ...).");
    return;
  }
  const node = section("friction", "Friction and efficiency");
  for (const result of results) {
    if (several) element("h3", "", node, result.name);
    if (!result.friction) { element("p", "none", node, `${result.name} has no friction: it was made without a speed.`); continue; }
    const own = result.friction, at = own.condition;
    element("p", "small", node, `${own.models}; pictures at ${written(at.temperature)} °C and Rq ${written(at.roughness)} µm, charts over the mesh cycle at ${written(at.speed)} / min.`);
    const grid = element("div", "grid", node);
    for (const name of ["sliding_velocity", "pv", ...Object.keys(own.fields)]) {
      const source = { sliding_velocity: "friction/sliding_velocity", pv: "loaded/pressure × friction/sliding_velocity" }[name] || `friction/${name}`;
      new FlankPicture(grid, result, "gear", {
        id: name, title: title(`${FRICTION[name][0]}, gear flank`, result), source, keys: ["torque", "speed"], field: () => frictionField(result, name),
        words: () => `${name === "sliding_velocity" ? "" : torqueWords(result) + ", "}${written(own.speeds[nearest(own.speeds, state.speed)])} / min`,
      });
    }
    for (const chart of result.charts.friction) lineChart(grid, result, { ...chart, title: title(chart.title, result) });
    if (own.map) efficiencyMap(grid, own.map, at);
    const wide = element("div", "wide", node);
    table(wide, own.table.heads, own.table.rows).classList.add("right");
    element("p", "small", wide, `Variables: ${own.table.variables.join(", ")}.` + (own.table.left ? ` ${own.table.left} more conditions are in the result.` : ""));
  }
}

function caseTables() {
  const node = section("case", "Case");
  const seen = new Set();
  for (const result of results) {
    const text = JSON.stringify(result.case);
    if (seen.has(text)) { element("p", "small", node, `${result.name}: the same case.`); continue; }
    seen.add(text);
    if (several) element("h3", "", node, result.name);
    if (!result.case.length) element("p", "none", node, "The result keeps no case that can be read.");
    const wide = element("div", "wide", node);
    for (const one of result.case) table(wide, [one.title, "unit", ...one.columns, "key"], one.rows.map(([name, unit, key, ...values]) => [name, unit, ...values, key]));
  }
}

// Numbers of all results over torque, side by side.
function comparison() {
  if (!several) return;
  const node = section("comparison", "Comparison"), grid = element("div", "grid", node);
  for (const name of Object.keys(results[0].over_torque)) {
    const { title, unit, source } = results[0].over_torque[name];
    const series = results.filter((result) => result.over_torque[name]).map((result, number) => ({ name: result.name, x: result.over_torque[name].x, y: result.over_torque[name].y, number }));
    lineChart(grid, results[0], { id: `compare_${name}`, title: `${title} over torque`, source, x: "torque at the pinion [N m]", y: unit ? `[${unit}]` : "", series, by: "" });
  }
}

summary();
comparison();
numbers();
teeth();
easeOff();
pattern();
pressure();
charts("error", "Transmission error", "error");
charts("root", "Root stress", "root");
if (!results.some((result) => result.charts.root)) element("p", "small none", page, "Root stress: the results have none; the model fe computes it.");
friction();
caseTables();
const footer = element("footer", "", document.body);
footer.textContent = `easeoff ${data.version}. The words under a title name the variables of the result that a picture or number shows (group/variable, or group.attribute). Values of pictures are rounded to 1/131000 of their range, those of charts to seven digits.`;
document.body.dataset.ready = "yes";
