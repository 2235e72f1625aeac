/* Signals against time, and their spectrum. */

const WINDOW = 30; // revolutions shown, at the scene's speed
const LISTENED = 1024; // last samples that a spectrum is of
const FREQUENCIES = 400; // of a spectrum
const MARGIN = { left: 72, right: 30, top: 24, bottom: 20 };
const TITLE = 8; // where it begins: a phone has no more room
const APART = 11; // pixels from one number to the next

/* Axes over a cleared canvas; what maps values to pixels.  `scale` says how values are written: of
   a unit of length by its prefix, else as they are. */
function axes(canvas, colours, title, [x1, x2], [y1, y2], unit, scale = "") {
  const { context: c, width, height } = cleared(canvas, colours.panel);
  const [left, right] = [MARGIN.left, width - MARGIN.right];
  const [top, bottom] = [MARGIN.top, height - MARGIN.bottom];
  const px = (x) => left + ((x - x1) / (x2 - x1 || 1)) * (right - left);
  const py = (y) => bottom - ((y - y1) / (y2 - y1 || 1)) * (bottom - top);
  c.strokeStyle = colours.line;
  c.fillStyle = colours.faint;
  c.textAlign = "center";
  const room = (right - 24 - left) / (right - left || 1); // the unit stands behind
  const across = ticks(x1, x1 + room * (x2 - x1 || 1), Math.max(2, (right - left) / 100), 2);
  for (const x of across.values) {
    line(c, px(x), bottom, px(x), bottom + 4);
    c.fillText(x.toFixed(Math.max(0, -Math.floor(Math.log10(across.step)))), px(x), height - 4);
  }
  line(c, left, bottom, right, bottom);
  c.textAlign = "right";
  const upwards = scale ? ticks(y1, y2, 4, 3) : { step: 90, values: [-180, -90, 0, 90, 180] };
  for (const y of upwards.values) {
    line(c, left - 4, py(y), left, py(y));
    const words = Math.abs(y) < upwards.step / 2 ? "0" : shown(y, scale, true);
    c.fillText(words, left - 6, py(y) + 4);
  }
  c.textAlign = "left";
  c.fillText(`[${unit}]`, right - 6, height - 4);
  c.fillStyle = colours.ink;
  c.fillText(title, TITLE, 15);
  return { c, px, py, left, right, top, bottom, titled: TITLE + c.measureText(title).width };
}

/* Round values from one to another: about `most`, and no fewer than `least`. */
function ticks(low, high, most, least) {
  const within = (step) => {
    const [first, last] = [Math.ceil(low / step), Math.floor(high / step + 1e-9)];
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => (first + k) * step);
  };
  let step = niceStep(high - low || 1, most);
  while (within(step).length < least) step = niceStep(0.39 * step, 1);
  return { step, values: within(step) };
}

function curve({ c, px, py }, xs, ys, colour, wrap = Infinity) {
  c.strokeStyle = colour;
  c.lineWidth = 1.5;
  c.beginPath();
  for (let k = 0; k < xs.length; k++) {
    if (k && Math.abs(ys[k] - ys[k - 1]) > wrap) c.moveTo(px(xs[k]), py(ys[k]));
    else c.lineTo(px(xs[k]), py(ys[k]));
  }
  c.stroke();
  c.lineWidth = 1;
}

/* A dashed line at a value. */
function level({ c, py, left, right }, colours, value) {
  c.strokeStyle = colours.line;
  c.setLineDash([4, 4]);
  line(c, left, py(value), right, py(value));
  c.setLineDash([]);
}

function samplesShown(machine) {
  return Math.min(REMEMBERED, Math.ceil((WINDOW * TURN) / (machine.data.speed * machine.step)));
}

/* The times shown: from the first sample, or as many as there is room for. */
function timesShown(machine, times) {
  const span = samplesShown(machine) * machine.step;
  const end = Math.max(times.at(-1) ?? 0, span);
  return [end - span, end];
}

function plotVibration(canvas, colours, machine, place) {
  const { history } = machine;
  const [times, xs, ys] = machine.last(samplesShown(machine), history.time, history.x[place],
    history.y[place]);
  let largest = 0;
  xs.forEach((x, k) => (largest = Math.max(largest, Math.abs(x), Math.abs(ys[k]))));
  const height = 1.15 * (largest || 1);
  const title = "Displacement" + (largest ? `, within ± ${shown(largest, "m", true)}` : "");
  const area = axes(canvas, colours, title, timesShown(machine, times), [-height, height], "s",
    "m");
  named(area, colours, [["x", colours.x], ["y", colours.y]]);
  const speed = machine.free || machine.data.motor ? ""
    : prescribed(area, colours, machine.data.profile, timesShown(machine, times));
  level(area, colours, 0);
  curve(area, times, xs, colours.x);
  curve(area, times, ys, colours.y);
  rimmed(area.c, colours, speed, area.right - 4, area.bottom - 6, "right");
}

/* The speed that the scene prescribes, from 0 at the bottom. */
function prescribed(area, colours, profile, [begin, end]) {
  const top = Math.max(...profile.map(([, speed]) => speed));
  const at = (time) => {
    const k = profile.findIndex(([corner]) => corner > time);
    if (k < 1) return profile.at(k)[1];
    const [[t1, w1], [t2, w2]] = [profile[k - 1], profile[k]];
    return w1 + ((w2 - w1) * (time - t1)) / (t2 - t1);
  };
  const times = Array.from({ length: 201 }, (_, k) => begin + ((end - begin) * k) / 200);
  const across = { ...area, py: (speed) => area.bottom - 0.9 * (speed / top) * (area.bottom - area.top) };
  curve(across, times, times.map(at), colours.faint);
  return `speed, up to ${shown(top, "rad/s")}`;
}

/* Words with a rim that keeps them readable over curves. */
function rimmed(c, colours, words, x, y, align) {
  c.textAlign = align;
  c.strokeStyle = colours.panel;
  c.lineWidth = 4;
  c.strokeText(words, x, y);
  c.lineWidth = 1;
  c.fillStyle = colours.faint;
  c.fillText(words, x, y);
}

/* Names in their colours behind the title. */
function named({ c, titled }, colours, names) {
  let at = titled + 12;
  c.textAlign = "left";
  for (const [name, colour] of names) {
    c.fillStyle = colour;
    c.fillRect(at, 6, 12, 9);
    c.fillStyle = colours.ink;
    c.fillText(name, at + 16, 15);
    at += 40;
  }
}

/* What a track's label has at the first place at which all tracks differ, its first letter if there is none. */
function shortName(label, labels) {
  const place = [...label].findIndex((_, k) =>
    labels.every((l) => l[k]) && new Set(labels.map((l) => l[k])).size === labels.length);
  return place > 0 ? `${label[place]}.` : label[0];
}

function plotAngles(canvas, colours, machine) {
  const { history, data } = machine;
  const heavy = machine.heavy ?? 0;
  const title = data.heavy === null ? "Angles in the rotor, degrees"
    : "Angles from the heavy side, degrees";
  const [times, ...rows] = machine.last(samplesShown(machine), history.time, ...history.angles);
  const area = axes(canvas, colours, title, timesShown(machine, times), [-190, 250], "s");
  for (const value of [180, 0, -180]) level(area, colours, value);
  const ends = [];
  rows.forEach((row, k) => {
    const degrees = row.map((a) => (Math.atan2(Math.sin(a - heavy), Math.cos(a - heavy)) * 360) / TURN);
    curve(area, times, degrees, weightColour(colours, k), 180);
    if (degrees.length) ends.push([k, area.py(degrees.at(-1)) + 4]);
  });
  if (data.heavy !== null) {
    rimmed(area.c, colours, "180: light side", area.left + 2, area.py(180) - 3, "left");
    rimmed(area.c, colours, "0: heavy side", area.left + 2, area.py(0) - 3, "left");
  }
  const tracks = data.balancers.filter((b) => b.track_radius).map((b) => b.label);
  area.c.textAlign = "left";
  for (const [k, y] of apart(ends, area.top + 4, area.bottom + 4)) {
    area.c.fillStyle = weightColour(colours, k);
    const { label, number } = machine.weights[k];
    const end = Math.min(area.px(times.at(-1)) + 3, area.right + 3);
    area.c.fillText(tracks.length > 1 ? shortName(label, tracks) + number : number, end, y);
  }
}

/* Numbers at heights, moved as little as keeps them apart; all within two heights if they fit there. */
function apart(ends, top, bottom) {
  const moved = [...ends].sort(([, a], [, b]) => a - b);
  const gap = Math.min(APART, (bottom - top) / (moved.length - 1 || 1));
  let last = top - gap;
  for (const end of moved) end[1] = last = Math.max(end[1], last + gap);
  last = bottom + gap;
  for (const end of moved.reverse()) end[1] = last = Math.min(end[1], last - gap);
  return moved;
}

function plotSpectrum(canvas, colours, machine, place) {
  const { history } = machine;
  const [xs] = machine.last(LISTENED, history.x[place]);
  const highest = (1.5 * machine.data.window.high) / TURN;
  const frequencies = Float64Array.from({ length: FREQUENCIES }, (_, k) => (highest * k) / FREQUENCIES);
  const amplitudes = spectrum(xs, frequencies.map((f) => TURN * f * machine.step));
  const largest = Math.max(...amplitudes);
  const title = "Spectrum of x" + (largest ? `, up to ${shown(largest, "m", true)}` : "");
  const area = axes(canvas, colours, title, [0, highest], [0, 1.15 * (largest || 1)], "Hz",
    "m");
  const once = machine.now.speed / TURN;
  area.c.strokeStyle = area.c.fillStyle = colours.faint;
  area.c.setLineDash([2, 3]);
  line(area.c, area.px(once), area.top, area.px(once), area.bottom);
  area.c.setLineDash([]);
  const [words, beside] = ["once per revolution", area.px(once)];
  const fits = beside + 4 + area.c.measureText(words).width < area.right + MARGIN.right;
  curve(area, frequencies, amplitudes, colours.x);
  rimmed(area.c, colours, words, beside + (fits ? 4 : -4), area.top + 8, fits ? "left" : "right");
}

/* Amplitudes of evenly spaced samples at angles per sample [rad]: Hann window, Goertzel's recurrence. */
function spectrum(samples, angles) {
  const n = samples.length || 1;
  const mean = samples.reduce((sum, value) => sum + value, 0) / n;
  const windowed = samples.map((value, k) =>
    (value - mean) * (0.5 - 0.5 * Math.cos((TURN * (k + 0.5)) / n)));
  const weight = n / 2; // the sum of the window
  return angles.map((angle) => {
    const twice = 2 * Math.cos(angle);
    let [last, before] = [0, 0];
    for (let k = 0; k < windowed.length; k++) {
      const next = windowed[k] + twice * last - before;
      before = last;
      last = next;
    }
    const square = last * last + before * before - twice * last * before;
    return (2 * Math.sqrt(Math.max(0, square))) / weight;
  });
}
