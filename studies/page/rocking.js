// The exact response of a block to a sine pulse, as `analytic.simulate` gives it. Time is in units
// of 1/p, acceleration in g; the rotation is folded to one side, y = s theta > 0. A classical
// Runge-Kutta step, cut at impacts and at the end of the pulse; uplifts come from the arcsine.

const TRAIN = 1e-4; // longest train of impacts that is summed
const LYING = Math.PI / 2;

function pulse(amplitude, omega, halfCycles) {
  const end = (halfCycles * Math.PI) / omega;
  return {
    amplitude, omega, end,
    at: t => (t < end ? amplitude * Math.sin(omega * t) : 0),
    // when the ground next exceeds an acceleration, from a time on
    exceeds(onset, t) {
      if (amplitude <= onset) return Infinity;
      const level = Math.asin(onset / amplitude), angle = omega * t;
      const within = angle - Math.PI * Math.floor(angle / Math.PI);
      if (within > level + 1e-14 && within < Math.PI - level - 1e-14) return t < end ? t : Infinity;
      const wait = within <= level + 1e-14 ? level - within : Math.PI + level - within;
      const found = t + Math.max(wait, 0) / omega;
      return found < end ? found : Infinity;
    },
  };
}

function rungeKutta(y, v, h, t, alpha, side, ground) {
  const fall = (y, t) => -(Math.sin(alpha - y) + side * ground(t) * Math.cos(alpha - y));
  const a1 = fall(y, t), a2 = fall(y + 0.5 * h * v, t + 0.5 * h);
  const a3 = fall(y + 0.5 * h * v + 0.25 * h * h * a1, t + 0.5 * h);
  const a4 = fall(y + h * v + 0.5 * h * h * a2, t + h);
  return [y + h * v + (h * h * (a1 + a2 + a3)) / 6, v + (h * (a1 + 2 * a2 + 2 * a3 + a4)) / 6];
}

// where a function that changes sign between low and high is zero
function root(f, low, high) {
  let below = f(low), above = f(high);
  for (let i = 0; i < 80 && high - low > 1e-15 * high; i++) {
    let x = low - (below * (high - low)) / (above - below);
    if (i % 3 === 2 || !(x > low && x < high)) x = 0.5 * (low + high);
    const found = f(x);
    if (found === 0) return x;
    if (found > 0 === below > 0) [low, below] = [x, found]; else [high, above] = [x, found];
  }
  return 0.5 * (low + high);
}

// the largest rotation still to come of a free block at (y, v), Infinity if it overturns, and how
// many impacts come before
function freePeak(y, v, alpha, eta) {
  const workTo = y => 2 * Math.sin(alpha - 0.5 * y) * Math.sin(0.5 * y);
  const barrier = workTo(alpha);
  let work = 0.5 * v * v + workTo(y);
  if (y >= alpha && (v >= 0 || work <= barrier)) return [Infinity, 0];
  if (v < 0) work *= eta * eta;
  const peak = alpha - 2 * Math.asin(Math.sqrt(0.5 * Math.max(barrier - work, 0)));
  return [work >= barrier ? Infinity : peak, v < 0 ? 1 : 0];
}

/**
 * Follow one response.
 * @param alpha slenderness atan(B/H) [rad]; eta: the velocity ratio of impacts
 * @param shaking from `pulse`
 * @param until time to follow it to, at least to the end of the pulse
 * @param times where to sample it, increasing
 * @param step largest step
 * @returns outcome, peak [rad], impacts (up to `until`, of a block that overturns all), and samples of theta [rad] up to where it is decided
 */
function rock(alpha, eta, shaking, until, times = [], step = 1 / 400) {
  const onset = Math.tan(alpha), last = Math.max(until, shaking.end), ground = shaking.at;
  const samples = [];
  let t = 0, y = 0, v = 0, side = 0, peak = 0, impacts = 0, longest = step, moved = false;
  const done = (outcome, ahead) => ({ outcome, peak: Math.max(peak, ahead), impacts, samples, t });
  for (let steps = 0; steps < 2e6; steps++) {
    if (side === 0) {
      const rise = shaking.exceeds(onset, t);
      while (samples.length < times.length && times[samples.length] <= Math.min(rise, last))
        samples.push(0);
      if (rise === Infinity) return done(moved ? "rocked" : "at rest", 0);
      [t, y, v, side, longest, moved] = [rise, 0, 0, -Math.sign(ground(rise)), step, true];
    }
    if (t >= last) {
      const [ahead, through] = freePeak(y, v, alpha, eta);
      if (ahead < Infinity) return done("rocked", ahead);
      impacts += through;
      return done("overturned", ahead);
    }
    const boundary = t < shaking.end ? shaking.end : last;
    const lands = t + longest >= boundary;
    let h = lands ? boundary - t : longest;
    // up to its end the pulse is one sine, at its end too
    const force = t < shaking.end
      ? time => shaking.amplitude * Math.sin(shaking.omega * time) : () => 0;
    const after = x => rungeKutta(y, v, x, t, alpha, side, force);
    let [end, rate] = after(h), hit = false, fallen = false;
    if (end <= 0 && (y > 0 || v > 0)) {
      const begin = y > 0 ? 0 : 1e-3 * h;
      h = root(x => after(x)[0], begin, h);
      [end, rate, hit] = [...after(h), true];
    } else if (end >= LYING) {
      h = root(x => after(x)[0] - LYING, 0, h);
      [end, rate, fallen] = [...after(h), true];
    }
    if (v > 0 && rate < 0) peak = Math.max(peak, after(root(x => after(x)[1], 0, h))[0]);
    while (samples.length < times.length && times[samples.length] <= t + h)
      samples.push(side * after(times[samples.length] - t)[0]);
    peak = Math.max(peak, y, end);
    [t, y, v] = [lands && !hit && !fallen ? boundary : t + h, end, rate];
    if (fallen) return done("overturned", Infinity);
    if (!hit) continue;

    impacts += 1;
    [side, y, v] = [-side, 0, -eta * v];
    const a = ground(t);
    const here = Math.sin(alpha) + side * a * Math.cos(alpha);
    const there = Math.sin(alpha) - side * a * Math.cos(alpha);
    const falls = here > 0 && there > 0;
    const wait = falls ? (2 * v * (1 / here + eta / there)) / (1 - eta * eta) : Infinity;
    const change = falls ? Math.abs(ground(t + wait) - a) * Math.cos(alpha) : Infinity;
    if (wait < TRAIN && change <= TRAIN * Math.min(here, there)) {
      t += wait;
      side = v = 0;
    } else if (v === 0) side = -Math.sign(a);
    // a short excursion takes short steps
    longest = here > 0 && v > 0 ? Math.min(step, (0.1 * v) / here) : step;
  }
  return done("failed", NaN);
}

// the words that ask a source about a pulse again, and that write it out where an engine can be
function commands(width, aspect, halfCycles, amplitude, omega, source, write) {
  const words = `--width ${width} --height ${width * aspect} --half-cycles ${halfCycles}`
    + ` --amplitude ${amplitude} --omega ${omega}`;
  const beside = source === "exact" ? "" : ` ${source}`;
  const compare = `rocking compare ${words} --sources exact${beside}`;
  return write ? [compare, `rocking export ${words} --engine ${source} --out DIR`] : [compare];
}
