// The page: tables, sections and what the reader chooses.

const data = JSON.parse(document.getElementById("data").textContent);
const results = data.results;
results.forEach((result, i) => (result.id = `r${i}`));
const several = results.length > 1;

// Greatest pressure of all results: their pictures have one scale.
let peak = 0;
function pressurePeak() {
  if (!peak) {
    for (const result of results) for (const stored of result.pressure.gear) peak = unpack(stored).reduce((a, b) => Math.max(a, b), peak);
    peak = ticks(0, Math.max(peak, 1), 8).reduce((a, b) => Math.max(a, b), Math.max(peak, 1));
  }
  return peak;
}

const torqueOf = (result) => nearest(result.torques, state.torque);
const torqueWords = (result) => `${written(result.torques[torqueOf(result)])} N m`;
const positionWords = (result) => `mesh position ${written(result.positions[nearest(result.positions, state.position)])}`;
const title = (text, result) => (several ? `${text}, ${result.name}` : text);

function table(parent, heads, rows, caption) {
  const node = element("table", "numbers", parent);
  if (caption) element("caption", "", node, caption);
  const head = element("tr", "", element("thead", "", node));
  for (const text of heads) element("th", text === "variable" ? "variable" : "", head, text);
  const body = element("tbody", "", node);
  for (const cells of rows) {
    const row = element("tr", "", body);
    cells.forEach((text, i) => {
      if (heads[i] !== "variable") return element("td", "", row, text);
      const cell = element("td", "variable", row);
      for (const part of text.split(/(?<=[/_])/)) cell.append(part, document.createElement("wbr")); // may end a line there
    });
  }
  return node;
}

// A table as the data hold it, with its variables below.
function storedTable(parent, one) {
  const wide = element("div", "wide", parent);
  table(wide, one.heads, one.rows, one.title).classList.add("right");
  if (one.variables?.length) element("p", "small variable-line", wide, `Variables: ${one.variables.join(", ")}.`);
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
const longest = results.reduce((a, b) => (b.positions.length > a.length ? b.positions : a), [0]);
const chosen = (key, values, own) => (given.has(key) && values.length ? values[nearest(values, Number(given.get(key)))] : own);
state.torque = chosen("torque", torques, torques[Math.floor((torques.length - 1) / 2)] ?? NaN);
state.speed = chosen("speed", speeds, speeds[Math.floor((speeds.length - 1) / 2)] ?? NaN);
state.position = chosen("position", longest, longest[0]);

window.addEventListener("hashchange", () => {
  given = new URLSearchParams(location.hash.slice(1));
  for (const [key, values] of [["torque", torques], ["speed", speeds], ["position", longest]]) {
    if (given.has(key)) state.set(key, chosen(key, values, state[key]));
  }
});

document.documentElement.style.setProperty("--title", JSON.stringify(`Contact report: ${data.title}`));
const header = element("header", "", document.body);
element("h1", "", header, "Contact report");
element("p", "case-title", header, data.author ? `${data.title}, by ${data.author}` : data.title);
const contents = element("nav", "", document.body);
const bar = element("div", "sliders", document.body);
if (results.length) {
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
} else bar.remove();
const named = element("label", "small names", contents);
const names = element("input", "", named);
Object.assign(names, { type: "checkbox", checked: true, id: "variable-names" });
named.append(" names of variables");
names.addEventListener("input", () => document.body.classList.toggle("nameless", !names.checked));
const page = element("main", "", document.body);

function summary() {
  if (!results.length && !data.notes.length) return;
  const node = section("summary", "Summary");
  for (const note of data.notes) element("p", "note", node, note);
  if (data.limits) storedTable(node, data.limits);
  for (const result of results) {
    const box = element("div", "result", node);
    if (several) element("h3", "", box, result.name);
    if (result.title !== data.title) element("p", "", box, result.title);
    table(box, ["", ""], result.head).classList.add("plain");
    const first = result.first_numbers;
    table(element("div", "wide", box), ["key numbers", "unit", ...first.torques.map((t) => `${t} N m`), "variable"], first.rows.map(([name, unit, path, ...values]) => [name, unit, ...values, path]));
    if (first.condition) element("p", "small", box, `${first.condition}.`);
    for (const one of result.misalignment) storedTable(box, one);
    for (const note of result.notes) element("p", "note", box, note);
    if (!result.notes.length) element("p", "small", box, "No automatic note.");
    if (result.torque_count > result.torques.length) element("p", "small", box, `Pictures and charts over the mesh cycle show ${result.torques.length} of ${result.torque_count} torques.`);
  }
}

function numbers() {
  if (!results.length) return;
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

function range(levels, ...stored) {
  const values = Float32Array.from(stored.flatMap((one) => [...unpack(one)].filter(Number.isFinite))).sort();
  const step = ticks(values[0], values[values.length - 1], levels);
  const width = step.length > 1 ? step[1] - step[0] : 1;
  const low = Math.floor(values[0] / width + 1e-9) * width, high = Math.ceil(values[values.length - 1] / width - 1e-9) * width;
  return { low, high, levels: Math.max(Math.round((high - low) / width), 1) };
}

function easeOff() {
  const node = section("ease-off", "Ease-off");
  const grid = element("div", "grid", node);
  const scale = range(14, ...results.map((result) => result.fields.ease_off));
  for (const result of results) {
    const field = { raster: raster(result.fields.ease_off), ...scale, map: "ease_off", unit: "µm", lines: true, named: true };
    new FlankPicture(grid, result, "gear", { id: "ease_off", title: title("Ease-off, gear flank", result), source: "ease_off/ease_off", keys: [], field: () => field, words: () => "positive where there is a gap; dashed: boundary of the common flank" });
  }
}

// Deviation from the design, in shades to both sides of zero, which the middle one has about it.
function departure(stored) {
  const most = unpack(stored).filter(Number.isFinite).reduce((a, v) => Math.max(a, Math.abs(v)), 1e-3);
  const step = ticks(0, most, 10)[1], count = Math.max(Math.ceil(most / step - 0.5), 1), reach = (count + 0.5) * step;
  return { raster: raster(stored), low: -reach, high: reach, levels: 2 * count + 1, map: "metal", unit: "µm", lines: true };
}

// The results that lack what a section shows, in one line.
function lacking(parent, has) {
  const names = results.filter((result) => !has(result)).map((result) => result.name);
  if (names.length && names.length < results.length) element("p", "small", parent, `None: ${names.join(", ")}.`);
}

function deviations() {
  if (!results.some((result) => Object.keys(result.deviations).length)) return;
  const node = section("deviations", "Deviations"), grid = element("div", "grid", node);
  for (const member of ["gear", "pinion"]) {
    for (const result of results) {
      const own = result.deviations[member];
      if (!own) continue;
      const field = departure(own.raster);
      new FlankPicture(grid, result, member, { id: "deviation", title: title(`Deviation of the ${member} flank`, result), source: own.source, keys: [], field: () => field, words: () => "from the design along the normal, positive where there is more metal; drawn on the common flank" });
    }
  }
  lacking(node, (result) => Object.keys(result.deviations).length);
}

function modifications() {
  if (!results.some((result) => result.modification)) return;
  const node = section("modification", "Modified ease-off");
  for (const result of results) {
    const own = result.modification;
    if (!own) continue;
    if (several) element("h3", "", node, result.name);
    const grid = element("div", "grid", node), field = departure(own.raster);
    new FlankPicture(grid, result, "gear", { id: "modification", title: "Addition to the ease-off, gear flank", source: "modification/modification", keys: [], field: () => field, words: () => "along the normal, positive where the gap grows" });
    storedTable(grid, { heads: ["term", "coefficient [µm]"], rows: own.terms, variables: ["modification/coefficient"] });
    for (const stage of own.stages) table(element("div", "wide", node), stage.heads, stage.rows, stage.title).classList.add("after-first");
  }
  lacking(node, (result) => result.modification);
}

// Flanks of all results: of two results those of one member stand side by side.
const sides = () => ["gear", "pinion"].flatMap((member) => results.map((result) => [result, member]));

function line(group, points, attributes) {
  const n = points.length / 2;
  const path = Array.from({ length: n }, (_, i) => `${points[i].toFixed(3)},${(-points[n + i]).toFixed(3)}`).join(" ");
  svg("polyline", { points: path, fill: "none", ...attributes }, group);
}

function pattern() {
  const node = section("pattern", "Contact pattern without load");
  const grid = element("div", "grid", node);
  for (const [result, member] of sides()) {
      const marks = result.marks, own = marks.members[member];
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
  for (const [result, member] of sides()) {
      const marks = result.marks, own = marks.members[member];
      if (!own.print) { element("p", "none", grid, title("No marking print: the flanks do not touch without load", result)); continue; }
      new FlankPicture(grid, result, member, { id: "print", title: title(`Marking print of ${written(marks.thickness)} µm, ${member}`, result), source: "unloaded/least_gap", keys: [], field: () => ({ raster: raster(own.print), flat: true }) });
    }
  for (const [result, member] of sides()) {
      const marks = result.marks, own = marks.members[member];
      if (!own.light) continue;
      const peak = Math.max(1e-9, ...unpack(own.light));
      new FlankPicture(grid, result, member, { id: "light", title: title(`Pattern at light load, ${written(marks.light_torque)} N m, ${member}`, result), source: "light_load/pressure", keys: [], field: () => ({ raster: raster(own.light), low: 0, high: peak, map: "pressure", unit: "MPa", positive: true }) });
  }
}

function pressureField(result, member, i = torqueOf(result)) {
  const stored = result.pressure[member][i], peak = pressurePeak();
  return unpack(stored).some((v) => v > 0) ? { raster: raster(stored), low: 0, high: peak, map: "pressure", unit: "MPa", positive: true } : null;
}

function bands(group, picture) {
  const { result, member } = picture, segments = segmentsNow(result), peak = pressurePeak();
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
  for (const [result, member] of sides()) {
      new FlankPicture(grid, result, member, {
        id: "pressure", title: title(`Greatest pressure over the mesh cycle, ${member}`, result), source: "loaded/pressure", field: () => pressureField(result, member),
        words: () => torqueWords(result),
      });
    }
  for (const [result, member] of sides()) {
      new FlankPicture(grid, result, member, {
        id: "bands", title: title(`Pressure at the mesh position, ${member}`, result), source: "loaded/pressure, half_width", keys: ["torque", "position"], marks: bands,
        words: () => {
          const found = segmentsNow(result), pairs = [...new Set(found.map((s) => s.tooth))];
          return found.length ? `${torqueWords(result)}, ${positionWords(result)}: ${pairs.length} tooth pair${pairs.length > 1 ? "s" : ""}, each on its own tooth; violet: tooth edges` : `${torqueWords(result)}, ${positionWords(result)}: no certified solution`;
        },
      });
    }
  drawCharts(grid, "contact");
  onPaper(node);
}

// Greatest pressure at every torque: on paper nobody moves a slider.
function onPaper(parent) {
  const box = element("div", "on-paper", parent);
  element("h3", "", box, "Greatest pressure over the mesh cycle at every torque, gear");
  const grid = element("div", "grid", box);
  for (const result of results) {
    result.torques.forEach((torque, i) => {
      new FlankPicture(grid, result, "gear", { id: `pressure-${i}`, title: title(`${written(torque)} N m`, result), keys: [], field: () => pressureField(result, "gear", i) });
    });
  }
}

// The same chart of all results, one after the other, before the next.
function drawCharts(grid, key) {
  const own = results.filter((result) => result.charts[key]);
  for (const id of new Set(own.flatMap((result) => result.charts[key].map((chart) => chart.id)))) {
    for (const result of own) {
      const chart = result.charts[key].find((one) => one.id === id);
      if (chart) new LineChart(grid, result, { ...chart, title: title(chart.title, result) });
    }
  }
}

function charts(id, name, key) {
  if (!results.some((result) => result.charts[key])) return;
  const node = section(id, name), grid = element("div", "grid", node);
  drawCharts(grid, key);
  lacking(node, (result) => result.charts[key]);
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
    const stored = result.fields.sliding_velocity, own = range(14, stored), scale = (v) => v * factor;
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
    element("p", "small none", page, "No friction: the result was made without a speed (easeoff run CASE --speed ...).");
    return;
  }
  const node = section("friction", "Friction and efficiency");
  for (const result of results) {
    if (several) element("h3", "", node, result.name);
    if (!result.friction) { element("p", "none", node, `${result.name} has no friction: it was made without a speed.`); continue; }
    const own = result.friction, at = own.condition;
    element("p", "small", node, `${own.models}; pictures at ${written(at.temperature)} °C and Rq ${at.roughness} µm, charts over the mesh cycle at ${written(at.speed)} 1/min.`);
    const grid = element("div", "grid", node);
    for (const name of ["sliding_velocity", "pv", ...Object.keys(own.fields)]) {
      const source = { sliding_velocity: "friction/sliding_velocity", pv: "loaded/pressure × friction/sliding_velocity" }[name] || `friction/${name}`;
      new FlankPicture(grid, result, "gear", {
        id: name, title: title(`${FRICTION[name][0]}, gear flank`, result), source, keys: ["torque", "speed"], field: () => frictionField(result, name),
        words: () => `${name === "sliding_velocity" ? "" : torqueWords(result) + ", "}${written(own.speeds[nearest(own.speeds, state.speed)])} 1/min`,
      });
    }
    for (const chart of result.charts.friction) new LineChart(grid, result, { ...chart, title: title(chart.title, result) });
    if (own.map) efficiencyMap(grid, own.map, at);
    const wide = element("div", "wide", node);
    table(wide, own.table.heads, own.table.rows).classList.add("right");
    element("p", "small variable-line", wide, `Variables: ${own.table.variables.join(", ")}.` + (own.table.left ? ` ${own.table.left} more conditions are in the result.` : ""));
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

// Numbers of all results at one torque, and their curves over torque and mesh position.
function comparison() {
  if (!several) return;
  const node = section("comparison", "Comparison");
  const wide = element("div", "wide", node);
  state.on(["torque"], () => compareNumbers(wide));
  const grid = element("div", "grid", node);
  for (const [key, id] of [["error", "te_mean"], ["contact", "max_pressure"]]) {
    const own = results.filter((result) => result.charts[key].some((chart) => chart.id === id));
    const series = own.flatMap((result) => result.charts[key].find((chart) => chart.id === id).series.map((one) => ({ ...one, owner: result, name: `${result.name}, ${written(result.torques[one.number])} N m` })));
    if (series.length) new LineChart(grid, results[0], { ...own[0].charts[key].find((chart) => chart.id === id), id: `compare_${id}`, by: "each", series });
  }
  for (const name of new Set(results.flatMap((result) => Object.keys(result.over_torque)))) {
    const own = results.filter((result) => result.over_torque[name]), { title, at, unit, source } = own[0].over_torque[name];
    const series = own.map((result) => ({ name: result.name, x: result.over_torque[name].x, y: result.over_torque[name].y, number: results.indexOf(result) }));
    if (series.some((one) => one.x.shape[0] > 1)) new LineChart(grid, results[0], { id: `compare_${name}`, title: `${title} over torque${at ? ` at ${at}` : ""}`, source, x: "torque at the pinion [N m]", y: unit ? `[${unit}]` : "", series, by: "" });
  }
}

function compareNumbers(wide) {
  wide.replaceChildren();
  const own = results.map((result) => {
    const loaded = result.loaded_numbers, at = nearest(loaded.torques.map(Number), result.torques[torqueOf(result)]), rows = new Map();
    for (const [name, unit, path, ...values] of loaded.rows) rows.set(name, [unit, values[at], path]);
    const efficiency = result.over_torque.efficiency;
    if (efficiency) rows.set(`efficiency at ${efficiency.at}`, ["%", unpack(efficiency.y)[nearest(Array.from(unpack(efficiency.x)), Number(loaded.torques[at]))].toFixed(2), efficiency.source]);
    for (const [name, unit, path, value] of result.unloaded_numbers) rows.set(`without load: ${name}`, [unit, value, path]);
    return { rows, head: `${result.name}, ${loaded.torques[at]} N m` };
  });
  const names = [...new Set(own.flatMap((one) => [...one.rows.keys()]))];
  const rows = names.map((name) => {
    const [unit, , path] = own.find((one) => one.rows.has(name)).rows.get(name);
    const values = own.map((one) => (one.rows.has(name) ? one.rows.get(name)[1] : "–")), [a, b] = values.map(Number);
    const change = /mesh position/.test(name) ? "" : changed(a, b, unit, values[0]);
    return [name, unit, ...values, ...(own.length === 2 ? [change] : []), ...(own.length > 3 ? [] : [path.replace(/ [×/].*/, "")])];
  });
  const alike = own.length > 1 ? rows.filter((row) => row.slice(2, 2 + own.length).every((value) => value === row[2])) : [];
  table(wide, ["", "unit", ...own.map((one) => one.head), ...(own.length === 2 ? ["difference"] : []), ...(own.length > 3 ? [] : ["variable"])], rows.filter((row) => !alike.includes(row))).classList.add(own.length > 3 ? "many" : "few");
  if (alike.length) element("p", "small", wide, `Alike in all: ${alike.map(([name, unit, value]) => `${name} ${value}${unit ? ` ${unit}` : ""}`).join("; ")}.`);
}

// Difference from the first number: of a share as it is, of anything else in per cent.
function changed(a, b, unit, words) {
  if (!Number.isFinite(a) || !Number.isFinite(b)) return "";
  const sign = b >= a ? "+" : "−", digits = (words.split(".")[1] || "").length;
  if (unit.startsWith("%")) return `${sign}${Math.abs(b - a).toFixed(digits)}`;
  if (a * b > 0 && b / a >= 10) return `× ${written(Number((b / a).toPrecision(3)))}`;
  return a ? `${sign}${Math.abs((100 * (b - a)) / a).toFixed(1)} %` : "";
}

function loadCases() {
  if (!data.load_cases.length) return;
  const node = section("load-cases", "Load cases");
  for (const one of data.load_cases) {
    if (data.load_cases.length > 1) element("h3", "", node, one.name);
    for (const each of one.tables) storedTable(node, each);
    for (const words of one.duty) element("p", "", node, words);
    for (const note of one.notes) element("p", "note", node, note);
  }
}

function supports() {
  if (!results.some((result) => result.supports.length)) return;
  const node = section("supports", "Supports");
  for (const result of results) {
    if (!result.supports.length) continue;
    if (several) element("h3", "", node, result.name);
    for (const one of result.supports) storedTable(node, one);
  }
  drawCharts(element("div", "grid", node), "supports");
  lacking(node, (result) => result.supports.length);
}

// A mark at fractions of a flank: a dot, or a cross.
function mark(group, picture, place, tint, cross) {
  if (place.some((value) => value === null)) return;
  const [x, y] = project(picture.plane, ...place), size = (cross ? 9 : 5) * picture.unit;
  if (!cross) return svg("circle", { cx: x, cy: -y, r: size, fill: tint }, group);
  svg("path", { d: `M${x - size},${-y}h${2 * size}M${x},${-y - size}v${2 * size}`, stroke: tint, "stroke-width": 2 * picture.unit }, group);
}

const signed = (value) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(3)}`;

function vhChecks() {
  if (!data.checks.length) return;
  const node = section("vh", "V-H check");
  data.checks.forEach((check, number) => {
    check.id = `v${number}`;
    element("h3", "", node, `${check.name}: ${check.title}, ${check.flank} flanks`);
    storedTable(node, check.table);
    element("p", "", node, check.total);
    for (const reason of check.reasons) element("p", "note", node, reason);
    const grid = element("div", "grid", node);
    for (const place of check.places) {
      if (!place.print) continue;
      new FlankPicture(grid, check, "gear", { id: `print-${place.name}`, title: `Pattern at the ${place.name}: V ${signed(place.v)}, H ${signed(place.h)} mm`, source: "print_excess", keys: [], field: () => ({ raster: raster(place.print), flat: true }), marks: (group, picture) => { mark(group, picture, place.wanted, "#D55E00", true); mark(group, picture, place.centre, "#222"); }, words: () => `print of ${written(check.thickness)} µm on the gear; dot: centre, cross: where it is wanted` });
    }
    if (check.grid) vhGrid(node, check);
  });
}

// Prints over V to the right and H upwards.
function vhGrid(node, check) {
  const box = figure(node, "Patterns over V and H", "grid_print_excess"), { v, h, cells } = check.grid;
  box.classList.add("vh-grid");
  const grid = element("div", "cells", box);
  grid.style.gridTemplateColumns = `auto repeat(${v.length}, minmax(0, 1fr))`;
  h.forEach((value, j) => {
    element("span", "small", grid, signed(value));
    v.forEach((_, i) => {
      const { print, centre } = cells[j][i];
      if (!print) { element("span", "none", grid, "no contact"); return; }
      new FlankPicture(grid, check, "gear", { id: `cell-${i}-${j}`, small: true, title: `V ${signed(v[i])}, H ${signed(value)} mm`, keys: [], field: () => ({ raster: raster(print), flat: true }), marks: (group, picture) => mark(group, picture, centre, "#222") });
    });
  });
  element("span", "", grid);
  for (const value of v) element("span", "small", grid, signed(value));
  element("p", "small", box, "V to the right, H upwards, in mm; toe on the left, tip at the top; dot: centre");
}

function wear() {
  if (!data.wear.length) return;
  const node = section("wear", "Wear");
  data.wear.forEach((worn, number) => {
    Object.assign(worn, { id: `w${number}`, torques: [NaN], positions: [0] });
    element("h3", "", node, `${worn.name}: ${worn.title}`);
    element("p", "small", node, worn.stop);
    const grid = element("div", "grid", node);
    for (const member of ["gear", "pinion"]) {
      const field = { raster: raster(worn.depth[member]), ...range(10, worn.depth[member]), map: "orange", unit: "µm", lines: true };
      new FlankPicture(grid, worn, member, { id: "depth", title: `Depth of wear at the end, ${member}`, source: "wear_depth", keys: [], field: () => field });
    }
    for (const chart of worn.charts) new LineChart(grid, worn, chart);
    storedTable(node, worn.table);
  });
}

function sweeps() {
  if (!data.sweeps.length) return;
  const node = section("sweep", "Sweep");
  for (const sweep of data.sweeps) {
    element("h3", "", node, `${sweep.name}: ${sweep.title}`);
    table(node, ["", ""], sweep.head).classList.add("plain");
    element("p", "", node, sweep.outcome);
    for (const reason of sweep.reasons) element("p", "note", node, reason);
    for (const one of sweep.tables) storedTable(node, one);
    for (const picture of sweep.pictures) element("img", "picture", node).src = picture;
  }
}

summary();
comparison();
loadCases();
numbers();
supports();
if (results.length) {
  teeth();
  easeOff();
}
deviations();
modifications();
if (results.length) pattern();
vhChecks();
if (results.length) {
  pressure();
  charts("error", "Transmission error", "error");
  charts("root", "Root stress", "root");
  if (!results.some((result) => result.charts.root)) element("p", "small none", page, "No root stress: the model of the teeth was not fe, which computes it.");
  friction();
}
wear();
sweeps();
if (results.length) caseTables();
const footer = element("footer", "", document.body);
footer.textContent = `easeoff ${data.version}. The words under a title name the variables of the result that a picture or number shows (group/variable, or group.attribute). Values of pictures are rounded to 1/131000 of their range, those of charts to seven digits.`;
document.body.dataset.ready = "yes";
