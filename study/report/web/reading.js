// Arrays of the data: 16 bits between two ends, or single precision; and small helpers for all pictures.

const known = new WeakMap();

function unpack(stored) {
  if (known.has(stored)) return known.get(stored);
  const raw = atob(stored.data);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  let values = null;
  if ("step" in stored) {
    const codes = new Uint16Array(bytes.buffer);
    values = Float32Array.from(codes, (code) => (code === 65535 ? NaN : stored.low + stored.step * code));
  } else {
    values = new Float32Array(bytes.buffer);
  }
  known.set(stored, values);
  return values;
}

const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes, parent, text) {
  const node = document.createElementNS(SVG, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.append(node);
  return node;
}

function element(name, className, parent, text) {
  const node = document.createElement(name);
  if (className) node.className = className;
  if (text !== undefined) node.textContent = text;
  if (parent) parent.append(node);
  return node;
}

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

// Number with four digits that count.
function written(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e6) return value.toExponential(3).replace(/\.?0*e\+/, "·10^").replace(/\^(\d+)$/, (_, power) => [...power].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]).join(""));
  if (size >= 1000) return value.toFixed(0);
  if (size > 0 && size < 1e-3) return value.toExponential(2);
  return String(Number(value.toPrecision(4)));
}

// Round numbers between two ends, about so many.
function ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(span / count));
  const step = [1, 2, 2.5, 5, 10].map((f) => f * power).find((s) => span / s <= count) || 10 * power;
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step + 0);
  return found;
}

function nearest(values, wanted) {
  let best = 0;
  values.forEach((value, i) => {
    if (Math.abs(value - wanted) < Math.abs(values[best] - wanted)) best = i;
  });
  return best;
}

// Colour maps: red, green, blue from the low to the high end.
const MAPS = {
  pressure: [[255, 255, 204], [254, 217, 118], [254, 153, 60], [240, 59, 32], [189, 0, 38], [128, 0, 38]],
  ease_off: [[255, 255, 255], [217, 230, 240], [169, 200, 223], [111, 163, 200]],
  green: [[247, 252, 245], [199, 233, 192], [116, 196, 118], [35, 139, 69], [0, 82, 33]],
  blue: [[247, 251, 255], [198, 219, 239], [107, 174, 214], [33, 113, 181], [8, 64, 129]],
  orange: [[255, 245, 235], [253, 208, 162], [253, 141, 60], [217, 72, 1], [140, 45, 4]],
  metal: [[5, 80, 140], [90, 160, 205], [247, 247, 247], [225, 140, 100], [160, 50, 20]],
  viridis: [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [190, 205, 45]],
};

function colour(name, share) {
  const map = MAPS[name];
  const place = clamp(share, 0, 1) * (map.length - 1);
  const i = Math.min(Math.floor(place), map.length - 2);
  return map[i].map((low, k) => low + (place - i) * (map[i + 1][k] - low));
}

const css = (rgb) => `rgb(${rgb.map(Math.round).join(",")})`;

// What the reader chose; those who draw are told when it changes.
const state = {
  torque: NaN,
  speed: NaN,
  position: 0,
  readers: [],
  on(keys, draw) {
    this.readers.push([keys, draw]);
    draw();
  },
  set(key, value) {
    this[key] = value;
    for (const [keys, draw] of this.readers) if (keys.includes(key)) draw();
  },
};

const hint = element("div", "hint", document.body);

function showHint(event, text) {
  hint.textContent = text;
  hint.style.display = "block";
  const room = window.innerWidth - hint.offsetWidth - 8;
  hint.style.left = `${clamp(event.clientX + 14, 4, Math.max(room, 4))}px`;
  hint.style.top = `${Math.max(event.clientY - hint.offsetHeight - 12, 4)}px`;
}

const hideHint = () => (hint.style.display = "none");
