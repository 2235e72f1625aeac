/* Numbers and colours as people read them. */

const PREFIXES = [[1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

/* Three digits and a unit; with `scaled` a prefix that keeps the number short. */
function shown(value, unit = "", scaled = false) {
  if (!Number.isFinite(value)) return `${value} ${unit}`.trim();
  let [size, prefix] = [1, ""];
  const [chosen, factor] = data.units[unit] ?? [unit, 1];
  if (chosen !== unit) return shown(value * factor, chosen);
  if (scaled && value !== 0) {
    [size, prefix] = PREFIXES.find(([s]) => Math.abs(value) >= s * 0.9995) ?? PREFIXES.at(-1);
  }
  const number = value / size;
  const large = Math.abs(number);
  const digits = large >= 1e7 || (large > 0 && large < 1e-3)
    ? number.toExponential(2) : String(Number(number.toPrecision(3)));
  return `${digits.replace("-", "−")} ${prefix}${unit}`.trim();
}

/* 1, 2 or 5 times a power of ten, about `span / count`. */
function niceStep(span, count) {
  const rough = span / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((n) => n * power >= rough * 0.999);
}

/* The style's colours, anew when the scheme changes. */
function palette() {
  const style = getComputedStyle(document.documentElement);
  const names = ["paper", "panel", "ink", "faint", "line", "x", "y", "liquid", "heavy", "trail",
    "body", "w1", "w2", "w3", "w4", "w5", "w6"];
  return Object.fromEntries(names.map((n) => [n, style.getPropertyValue(`--${n}`).trim()]));
}

/* How far a rotor has come towards a stop, and what the stop has felt. */
function stopWords(gap, { x, y, force, touches }) {
  const way = `${shown(Math.hypot(x, y), "m", true)} of ${shown(gap, "m", true)}`;
  return `${way}, ${force ? "in contact" : "apart"}, touches: ${shown(touches)}`;
}

function capital(words) {
  return words[0].toUpperCase() + words.slice(1);
}

function weightColour(colours, k) {
  return colours[`w${1 + (k % 6)}`];
}

/* A canvas's context in CSS pixels, cleared; its size follows the page.  Opaque: nothing behind it
   has to be drawn. */
function cleared(canvas, colour) {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const context = canvas.getContext("2d", { alpha: false });
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = colour;
  context.fillRect(0, 0, width, height);
  context.font = "12px system-ui, sans-serif";
  context.lineJoin = "round";
  return { context, width, height };
}
