/* Sliders: each says its value, and what it changes goes to the machine at once. */

const PACES = [0.02, 50]; // revolutions shown a second
const POSITIONS = 1000; // of a slider

function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/* A slider under its name; `say` gives its words, `set` takes its value and may refuse it. */
class Slider {
  constructor(id, label, { low, high, log = false, values = null, value, say, set }) {
    Object.assign(this, { low, high, log, values, say, set });
    const max = values ? values.length - 1 : POSITIONS;
    this.input = make("input", { type: "range", id, min: 0, max, step: 1 });
    this.output = make("output", { htmlFor: id });
    const name = make("label", { htmlFor: id }, make("span", { textContent: label }), this.output);
    this.element = make("div", { className: "control" }, name, this.input);
    this.show(value);
    this.own = this.input.value; // as the scene has it
    this.input.addEventListener("input", () => this.set(this.read()));
    // a finger that scrolls the page has first touched the slider
    this.input.addEventListener("pointerdown", () => (this.before = this.value));
    this.input.addEventListener("pointercancel", () => this.set(this.before));
  }

  read() {
    const position = Number(this.input.value);
    if (this.values) return this.values[position];
    const part = position / POSITIONS;
    return this.log ? this.low * (this.high / this.low) ** part
      : this.low + (this.high - this.low) * part;
  }

  show(value) {
    this.value = value;
    const part = this.log ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    const position = this.values ? this.values.indexOf(value) : Math.round(POSITIONS * part);
    // a value that the slider stands at stays as it is said
    if (Number(this.input.value) !== position) this.input.value = position;
    this.output.value = this.say(value);
    this.input.setAttribute("aria-valuetext", this.output.value);
  }
}

function speedWords(speed) {
  return `${shown(speed, "rad/s")} = ${shown((speed * 60) / TURN)} rpm`;
}

/* What a slider of the scene's values says of a factor. */
function saying({ base, unit, value }) {
  const bases = [...new Set(Object.values(base))];
  return (factor) => bases.length === 1 ? shown(factor * bases[0], unit)
    : `${shown(factor / value)} × the scene's`;
}

/* All sliders of a page, by name; `change` takes settings of the machine, `pace` revolutions a second. */
function sliders(machine, view, change) {
  const { data } = machine;
  const { low, high } = data.window;
  const found = {};
  if (!data.motor) {
    found.speed = new Slider("speed", "Speed", {
      low, high, value: data.speed,
      say: speedWords,
      set: (speed) => change({ speed }),
    });
  }
  data.sliders.forEach((slider, k) => {
    const [least, most] = slider.range;
    found[`value_${k}`] = new Slider(`value_${k}`, slider.label, {
      low: least, high: most, log: slider.log, value: slider.value, say: saying(slider),
      set: (factor) => {
        const factors = [...machine.settings.factors];
        factors[k] = factor;
        change({ factors });
      },
    });
  });
  data.tracks.forEach((labels, k) => {
    const values = [...new Set(data.tokens.map(({ weights }) => weights[k]))].sort((a, b) => a - b);
    if (values.length < 2) return;
    const name = data.tracks.length > 1 ? `Weights: ${labels[0]}`
      : labels.length > 1 ? "Weights on every track" : "Weights";
    found[`weights_${k}`] = new Slider(`weights_${k}`, name, {
      values, value: data.tokens[0].weights[k], say: String,
      set: (count) => {
        const wanted = [...data.tokens[machine.settings.variant].weights];
        wanted[k] = count;
        change({ variant: data.tokens.findIndex(({ weights }) => `${weights}` === `${wanted}`) });
      },
    });
  });
  found.pace = new Slider("pace", "Shown", {
    low: PACES[0], high: Math.max(PACES[1], view.pace), log: true, value: view.pace,
    say: (pace) => `${shown(pace)} rev/s, time × ${shown((pace * TURN) / data.speed)}`,
    set: (pace) => {
      view.pace = pace;
      found.pace.show(pace);
    },
  });
  return found;
}

/* Show the machine's settings on its sliders. */
function showSettings(found, { settings, data }) {
  found.speed?.show(settings.speed);
  settings.factors.forEach((factor, k) => found[`value_${k}`].show(factor));
  data.tokens[settings.variant].weights.forEach((count, k) => found[`weights_${k}`]?.show(count));
}

const KINDS = {
  weights: { good: "balances", unstable: "does not balance", unknown: "not known" },
  ring: { good: "stable", unstable: "unstable: waves grow", unknown: "not known" },
  liquid: { good: "bends less than without liquid", poor: "bends more", unstable: "unstable" },
};

/* The strip of what is stable, and its words; moves its marker. */
function strip({ window: { low, high, ends, kinds, words }, balancers, left_behind }) {
  const part = (speed) => `${(100 * (speed - low)) / (high - low)}%`;
  const marker = make("div", { className: "marker" });
  const box = make("div", { id: "strip", role: "img" });
  const said = make("p", { id: "strip_words" });
  const meanings = KINDS[balancers.some((b) => b.track_radius) ? "weights"
    : balancers.some((b) => b.wall_radius) ? "ring" : "liquid"];
  let from = low;
  const spans = ends.map((end, k) => {
    const piece = make("div", { className: `part ${kinds[k]}` });
    Object.assign(piece.style, { left: part(from), width: part(low + end - from) });
    box.append(piece);
    const words = `${shown(from, "rad/s")} to ${shown(end, "rad/s")} ${meanings[kinds[k]]}`;
    from = end;
    return words;
  });
  box.append(marker);
  const keys = Object.keys(meanings).filter((kind) => kinds.includes(kind)).map((kind) =>
    make("span", { className: "meaning" }, make("span", { className: `key ${kind}` }), meanings[kind]));
  const note = make("span", { textContent: "" });
  said.append(...(ends.length ? [`By ${words}: `, ...keys, note] : [`No stability known: ${words}.`]));
  if (left_behind) said.append(make("br", {}), left_behind);
  box.setAttribute("aria-label", spans.join("; ") || words);
  box.hidden = !ends.length;
  let shownAt = null;
  const show = (speed, asScene) => {
    const at = part(Math.min(high, Math.max(low, speed)));
    if (at !== shownAt) marker.style.left = shownAt = at;
    const words = asScene || !ends.length ? "" : " Greyed: worked out for the scene's own values.";
    box.classList.toggle("stale", !asScene);
    if (note.textContent !== words) note.textContent = words;
  };
  return { box, said, show };
}
