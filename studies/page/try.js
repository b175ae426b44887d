// The sliders: a block that moves, its history, and where it stands on the overturning map.

const G = 9.81, SURVIVES = 0, DIRECT = 1, LATER = 2;
const MOST_ONSETS = 10, RATIOS = [0.2, 8], CELLS = [72, 56];
const part = name => document.getElementById(`try-${name}`);
const inputs = ["aspect", "width", "amplitude", "omega", "pulse"].map(part);
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function asked() {
  const [aspect, width, amplitude, omega, halfCycles] = inputs.map(input => Number(input.value));
  const alpha = Math.atan(1 / aspect), R = 0.5 * width * Math.hypot(1, aspect);
  return {
    aspect, width, amplitude, omega, halfCycles, alpha, p: Math.sqrt((0.75 * G) / R),
    eta: Math.max(1 - 1.5 * Math.sin(alpha) ** 2, 0),
  };
}

function answer(now, count = 600) {
  const shaking = pulse(now.amplitude, now.omega / now.p, now.halfCycles);
  const until = shaking.end + 8, times = Array.from({ length: count }, (_, i) => (until * i) / (count - 1));
  const found = rock(now.alpha, now.eta, shaking, until, times);
  return { ...found, times, until, shaking };
}

// a canvas that is sharp on every screen, in the units of the page
function sheet(name) {
  const canvas = part(name), scale = window.devicePixelRatio || 1;
  const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(wide * scale)) {
    canvas.width = Math.round(wide * scale);
    canvas.height = Math.round(high * scale);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, wide, high);
  pen.font = "12px system-ui, sans-serif";
  return { pen, wide, high };
}

function drawBlock(now, theta, shift, overturned) {
  const { pen, wide, high } = sheet("block"), reach = 1.1 * Math.hypot(1, now.aspect);
  const unit = Math.min(wide / (2 * reach), (high - 26) / reach), floor = high - 22;
  pen.fillStyle = colour("line");
  pen.fillRect(0, floor, wide, 22);
  pen.strokeStyle = colour("soft");
  const gap = 26, push = (((shift * unit) / now.width) % gap + gap) % gap;
  for (let x = push - gap; x < wide; x += gap) { // the base, as it moves under the block
    pen.beginPath();
    pen.moveTo(x, floor + 20);
    pen.lineTo(x + 10, floor + 4);
    pen.stroke();
  }
  const side = theta >= 0 ? 1 : -1, pivot = wide / 2 + (side * unit) / 2;
  pen.save();
  pen.translate(pivot, floor);
  pen.rotate(theta);
  pen.fillStyle = overturned ? "#D55E00" : colour("accent");
  pen.globalAlpha = 0.85;
  pen.fillRect(side > 0 ? -unit : 0, -now.aspect * unit, unit, now.aspect * unit);
  pen.restore();
}

// the titles of two axes, below and to the left
function title(pen, across, up, [left, foot], wide, high) {
  pen.fillText(across, (left + wide - pen.measureText(across).width) / 2, high - 6);
  pen.save();
  pen.translate(12, (foot + pen.measureText(up).width) / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText(up, 0, 0);
  pen.restore();
}

function drawHistory(now, found, place) {
  const { pen, wide, high } = sheet("history"), left = 58, foot = high - 24;
  const all = found.samples.map(theta => theta / now.alpha);
  const most = Math.min(Math.max(1.1 * Math.max(...all.map(Math.abs)), 0.02), 1.3);
  const x = tau => left + ((wide - left - 8) * tau) / found.until;
  const y = ratio => 6 + ((foot - 6) * (most - ratio)) / (2 * most);
  pen.fillStyle = colour("line");
  pen.fillRect(x(0), 6, x(found.shaking.end) - x(0), foot - 6);
  pen.fillStyle = pen.strokeStyle = colour("soft");
  for (const level of most > 1 ? [-1, 0, 1] : [0]) {
    pen.fillRect(left, y(level), wide - left - 8, 1);
    pen.fillText(level === 0 ? "0" : `${level < 0 ? "−" : ""}θcr`, 24, y(level) + 4);
  }
  title(pen, "time [s]", "rotation", [left, foot], wide, high);
  if (most <= 1) pen.fillText(`${(most / 1.1).toPrecision(2)} θcr`, left + 4, 18);
  pen.fillText("pulse", x(0) + 4, foot - 6);
  pen.strokeStyle = colour("paper");
  pen.beginPath();
  for (let k = 0; k <= 90; k++) {
    const height = Math.sin((now.halfCycles * Math.PI * k) / 90) * 0.3 * foot;
    pen.lineTo(x((found.shaking.end * k) / 90), y(0) - height);
  }
  pen.stroke();
  pen.fillText("0", left, high - 6);
  const end = `${(found.until / now.p).toPrecision(3)} s`;
  pen.fillText(end, wide - 8 - pen.measureText(end).width, high - 6);
  pen.strokeStyle = colour("ink");
  pen.lineWidth = 1.6;
  pen.save();
  pen.beginPath();
  pen.rect(left, 0, wide - left, foot);
  pen.clip();
  pen.beginPath();
  all.forEach((ratio, i) => pen.lineTo(x(found.times[i]), y(ratio)));
  pen.stroke();
  pen.restore();
  if (found.outcome === "overturned") {
    pen.fillStyle = "#D55E00";
    pen.fillText("overturned", Math.min(x(found.t) + 4, wide - 70), 32);
  }
  pen.fillStyle = "#D55E00";
  pen.fillRect(x(found.times[Math.min(place, found.times.length - 1)]), 6, 1.5, foot - 6);
}

let chart = { key: "", cells: new Uint8Array(CELLS[0] * CELLS[1]), done: 0 };
const ratioOf = i => RATIOS[0] + ((RATIOS[1] - RATIOS[0]) * (i + 0.5)) / CELLS[0];
const onsetsOf = j => 1 + ((MOST_ONSETS - 1) * (j + 0.5)) / CELLS[1];

// some more cells of the map, for as long as a frame has time
function chartOn(now) {
  const key = `${now.aspect} ${now.halfCycles}`;
  if (key !== chart.key) chart = { key, cells: chart.cells, done: 0 };
  const begin = performance.now();
  while (chart.done < chart.cells.length && performance.now() - begin < 12) {
    const i = chart.done % CELLS[0], j = Math.floor(chart.done / CELLS[0]);
    const shaking = pulse(onsetsOf(j) * Math.tan(now.alpha), ratioOf(i), now.halfCycles);
    const found = rock(now.alpha, now.eta, shaking, 0, [], 1 / 50);
    const over = found.outcome === "overturned";
    chart.cells[chart.done++] = over ? (found.impacts ? LATER : DIRECT) : SURVIVES;
  }
  return chart.done < chart.cells.length;
}

const LEFT = 40, BELOW = 40;

function drawMap(now) {
  const { pen, wide, high } = sheet("map"), left = LEFT, foot = high - BELOW;
  const [w, h] = [(wide - left) / CELLS[0], foot / CELLS[1]];
  const xOf = ratio => left + ((wide - left) * (ratio - RATIOS[0])) / (RATIOS[1] - RATIOS[0]);
  const yOf = onsets => foot - (foot * (onsets - 1)) / (MOST_ONSETS - 1);
  const by = part("by").value, engine = by !== "exact" && firstOf(now) >= 0;
  part("legend").hidden = engine;
  part("legend-engine").hidden = !engine;
  pen.save();
  pen.beginPath();
  pen.rect(left, 0, wide - left, foot);
  pen.clip();
  if (engine) drawCells(pen, now, by, xOf, yOf);
  const fills = [colour("paper"), "#8CC7EE", "#F5D58A"];
  for (let n = 0; n < (engine ? 0 : chart.done); n++) {
    pen.fillStyle = fills[chart.cells[n]];
    const [i, j] = [n % CELLS[0], Math.floor(n / CELLS[0])];
    pen.fillRect(left + i * w, foot - (j + 1) * h, w + 0.6, h + 0.6);
  }
  pen.restore();
  pen.strokeStyle = colour("line");
  pen.strokeRect(left, 0.5, wide - left - 1, foot);
  pen.fillStyle = colour("soft");
  for (const ratio of [1, 2, 4, 6, 8])
    pen.fillText(ratio, xOf(ratio) - 8, foot + 14);
  for (const onsets of [1, 4, 7, 10])
    pen.fillText(onsets, 22, Math.max(yOf(onsets) + 3, 10));
  title(pen, "frequency ω/p", "amplitude / onset", [left, foot], wide, high);
  const x = xOf(now.omega / now.p), y = yOf(now.amplitude / Math.tan(now.alpha));
  pen.strokeStyle = "#D55E00";
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(Math.min(Math.max(x, left), wide), Math.min(Math.max(y, 0), foot), 6, 0, 2 * Math.PI);
  pen.stroke();
}

const digits = (value, n = 3) => Number(value.toPrecision(n)).toString();
const degrees = angle => `${digits((angle * 180) / Math.PI)}°`;

function say(now, found) {
  const names = { aspect: digits(now.aspect), width: `${digits(now.width)} m`,
    amplitude: `${digits(now.amplitude)} g`, omega: `${digits(now.omega)} rad/s` };
  for (const [name, words] of Object.entries(names)) part(`${name}-says`).textContent = words;
  part("outcome").textContent = {
    "at rest": "It stays at rest.",
    overturned: found.impacts
      ? `It overturns after ${found.impacts} impact${found.impacts === 1 ? "" : "s"}.` : "It overturns at once.",
    rocked: `It survives; its largest rotation is ${(found.peak / now.alpha).toFixed(6)} θcr, `
      + `${degrees(found.peak)}.`,
  }[found.outcome] || "No answer.";
  const onset = Math.tan(now.alpha);
  part("known").textContent = `α = θcr = ${degrees(now.alpha)}, p = ${digits(now.p)} rad/s, onset ${digits(onset)} g; `
    + `the pulse: ${digits(now.amplitude / onset)} onsets, ω/p = ${digits(now.omega / now.p)}.`;
}

// what engines answered on a grid, and of that the block and the place that are nearest
const held = JSON.parse(part("cases").textContent), sources = Object.keys(held.peaks);
const nearestOf = (values, value, scale = x => x) => values.reduce((best, each, i) =>
  Math.abs(scale(each) - scale(value)) < Math.abs(scale(values[best]) - scale(value)) ? i : best, 0);

// where in the tables of peaks the nearest block's stand, row by row of an amplitude; -1: no such pulse
function firstOf(now) {
  if (!sources.length) return -1;
  const pulse = held.half_cycles.indexOf(now.halfCycles);
  const aspect = nearestOf(held.aspect, now.aspect, Math.log), width = nearestOf(held.width_m, now.width, Math.log);
  const block = (pulse * held.aspect.length + aspect) * held.width_m.length + width;
  return pulse < 0 ? -1 : block * held.onsets.length * held.omega_over_p.length;
}

const blockOf = first => {
  const block = first / (held.onsets.length * held.omega_over_p.length);
  return { width: held.width_m[block % held.width_m.length],
    aspect: held.aspect[Math.floor(block / held.width_m.length) % held.aspect.length] };
};

// a button that copies a command, named by what it does
function copying(command) {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", value: command, title: command, textContent: command.split(" ")[1] });
  button.dataset.copy = "";
  return button;
}

function sayEngines(now) {
  const first = firstOf(now);
  part("engines").hidden = first < 0;
  if (first < 0) return;
  const { width, aspect } = blockOf(first), R = 0.5 * width * Math.hypot(1, aspect);
  const i = nearestOf(held.omega_over_p, now.omega / now.p);
  const j = nearestOf(held.onsets, now.amplitude / Math.tan(now.alpha));
  const place = first + j * held.omega_over_p.length + i, exact = held.peaks.exact[place];
  const amplitude = held.onsets[j] / aspect, omega = held.omega_over_p[i] * Math.sqrt((0.75 * G) / R);
  const rest = held.rests[place] ? `, after ${held.rests[place]} s of rest, which no command asks for` : "";
  part("case").textContent = `H/B ${aspect}, B ${width} m, ${digits(amplitude)} g, ${digits(omega)} rad/s${rest}`;
  const words = peak => (peak === null ? "no result" : peak < 0 ? "overturns" : `${peak.toFixed(4)} θcr`);
  const off = peak => (!held.judged[place] ? "not judged: slides or lifts off" : peak === null || peak < 0 ? (peak === exact ? "" : "wrong")
    : exact < 0 ? "wrong" : `${peak < exact ? "−" : "+"}${digits(100 * Math.abs(peak / exact - 1), 2)} %`);
  part("answers").replaceChildren(...sources.map(source => {
    const line = document.createElement("tr"), peak = held.peaks[source][place];
    const head = document.createElement("th");
    head.scope = "row";
    head.textContent = source;
    line.append(head);
    for (const text of [words(peak), source === "exact" ? "" : off(peak)]) line.insertCell().textContent = text;
    const cell = line.insertCell(), write = peak && held.written.includes(source);
    const asks = commands(width, aspect, now.halfCycles, amplitude, omega, source, write);
    if (!rest) cell.append(...asks.map(copying));
    return line;
  }));
  part("go").onclick = () => put({ aspect, width, amplitude, omega });
}

// an engine's outcomes on the grid, beside the exact ones of the same cells
function drawCells(pen, now, source, xOf, yOf) {
  const first = firstOf(now), { omega_over_p: ratios, onsets } = held;
  const w = xOf(ratios[1]) - xOf(ratios[0]), h = yOf(onsets[0]) - yOf(onsets[1]);
  for (let n = 0; n < ratios.length * onsets.length; n++) {
    const [peak, exact] = [held.peaks[source][first + n], held.peaks.exact[first + n]];
    const [i, j] = [n % ratios.length, Math.floor(n / ratios.length)];
    pen.fillStyle = !held.judged[first + n] ? colour("line") : peak === null ? colour("ink") : peak < 0 ? (exact < 0 ? "#B9B9B9" : "#D55E00")
      : exact < 0 ? "#0072B2" : Math.abs(peak / exact - 1) > 0.1 ? "#F0E05A" : colour("paper");
    pen.fillRect(xOf(ratios[i]) - w / 2, yOf(onsets[j]) - h / 2, w + 0.6, h + 0.6);
  }
}

for (const source of sources.filter(name => name !== "exact")) part("by").add(new Option(source, source));
part("by").closest("label").hidden = sources.length < 2;

function put(values) {
  for (const [name, value] of Object.entries(values)) {
    const input = part(name);
    input.value = Math.min(Math.max(value, input.min), input.max);
  }
  change();
}

let state, began = 0, waiting = false, playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches;
function change() {
  const now = asked();
  state = { now, found: answer(now) };
  began = performance.now();
  say(now, state.found);
  sayEngines(now);
  next();
}

function next() {
  if (!waiting) requestAnimationFrame(frame);
  waiting = true;
}

// where the base has moved to, in metres: the integral of a sine, twice
function baseAt(now, seconds) {
  const t = Math.min(seconds, (now.halfCycles * Math.PI) / now.omega), a = now.amplitude * G;
  const speed = angle => (a / now.omega) * (1 - Math.cos(angle));
  return (a / now.omega) * (t - Math.sin(now.omega * t) / now.omega) + speed(now.omega * t) * (seconds - t);
}

function frame(clock) {
  waiting = false;
  const { now, found } = state, seconds = found.until / now.p;
  const crest = found.samples.reduce((best, theta, i, all) => (Math.abs(theta) > Math.abs(all[best]) ? i : best), 0);
  const passed = ((clock - began) / 1000) % (seconds + 1.5); // held at the end for a while
  const place = playing ? Math.round((Math.min(passed / seconds, 1)) * (found.times.length - 1)) : crest;
  const last = found.samples.length - 1, gone = place > last && found.outcome === "overturned";
  const theta = gone ? Math.sign(found.samples[last] || 1) * LYING : found.samples[Math.min(place, last)];
  drawBlock(now, theta, baseAt(now, (seconds * place) / (found.times.length - 1)), Math.abs(theta) > now.alpha && found.outcome === "overturned");
  drawHistory(now, found, place);
  const more = chartOn(now);
  drawMap(now);
  if (playing || more) next();
}

function fromMap(event) {
  const canvas = part("map"), box = canvas.getBoundingClientRect(), now = asked();
  const across = (event.clientX - box.left - LEFT) / (box.width - LEFT);
  const up = 1 - (event.clientY - box.top) / (box.height - BELOW);
  if (across < 0 || across > 1 || up < 0 || up > 1) return;
  put({ omega: (RATIOS[0] + across * (RATIOS[1] - RATIOS[0])) * now.p,
    amplitude: (1 + up * (MOST_ONSETS - 1)) * Math.tan(now.alpha) });
}

for (const input of inputs) input.addEventListener("input", change);
part("map").addEventListener("pointerdown", fromMap);
part("map").addEventListener("pointermove", event => { if (event.buttons) fromMap(event); });
part("by").addEventListener("input", next);
part("play").addEventListener("click", () => {
  playing = !playing;
  part("play").textContent = playing ? "Pause" : "Play";
  next();
});
part("play").textContent = playing ? "Pause" : "Play";
window.addEventListener("resize", next);
change();
