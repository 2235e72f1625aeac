/* The page: frames, buttons, keys. */

const FRAME = 1000 / 60; // ms
const BUDGET = 0.6 * FRAME; // of a frame for the motion; the rest is for drawing
const LONGEST = 100; // ms: a page that was hidden goes on from where it was
const SLOW = 0.1; // of the pace
const FAR = 10; // times the rotor's radius: displacements are taken as small
const KEYS = { " ": "start", s: "slow", u: "run_up", k: "kick", t: "turning", r: "restart" };

const element = (id) => document.getElementById(id);

class Page {
  constructor(module, data) {
    this.data = data;
    this.module = module;
    const running = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.view = { pace: data.pace, slow: false, running, place: 0 };
    this.machine = new Machine(module, data);
    this.drawing = new Drawing(element("machine"), this.machine);
    this.cost = { frame: FRAME, took: 0, moved: 0 };
    this.said = {};
    this.controls();
    this.placeChoice();
    this.buttons();
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => (this.colours = palette()));
    this.colours = palette();
    this.shownTime = this.machine.time;
    this.frames = 0;
    requestAnimationFrame((now) => this.frame(now));
  }

  controls() {
    this.sliders = sliders(this.machine, this.view, (settings) => this.change(settings));
    this.strip = strip(this.data);
    const [own, ...others] = Object.values(this.sliders); // the speed, or the motor's torque
    const rest = others.map((slider) => slider.element);
    const first = make("div", { className: "wide" }, own.element, this.strip.box, this.strip.said);
    element("controls").append(first, ...rest);
    showSettings(this.sliders, this.machine);
    takeAddress(this.sliders, location.hash);
  }

  placeChoice() {
    const { stations } = this.data;
    if (stations.length < 2) return;
    this.machine.stations.forEach((_, k) => element("place").append(
      make("option", { value: k, textContent: `station ${k + 1}, z = ${shown(stations[k], "m")}` })));
    element("place").addEventListener("change", (event) =>
      (this.view.place = Number(event.target.value)));
    element("place_label").hidden = false;
  }

  /* -- what a person does -------------------------------------------------------------------- */

  buttons() {
    const toggled = (id, key, holder) => () => {
      holder[key] = !holder[key];
      element(id).setAttribute("aria-pressed", holder[key]);
    };
    const actions = {
      start: () => (this.view.running = !this.view.running),
      slow: toggled("slow", "slow", this.view),
      turning: toggled("turning", "turning", this.drawing),
      run_up: () => this.begun(() => this.machine.runUp()),
      restart: () => this.begun(() => this.machine.restart()),
      kick: () => this.machine.kick(),
      link: () => this.link(),
      scene: () => saveScene(this.machine),
      csv: () => saveCsv(this.machine),
      picture: () => savePicture(element("machine")),
    };
    for (const [id, action] of Object.entries(actions)) {
      element(id).addEventListener("click", () => {
        action();
        this.showRunning();
      });
    }
    this.showRunning();
    addEventListener("keydown", (event) => this.key(event));
  }

  /* The address with the sliders' values, also in the clipboard where the browser allows it; the button says which. */
  link() {
    location.hash = addressOf(this.sliders);
    const say = (words) => (element("link").textContent = words);
    const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject();
    copied.then(() => say("Copied"), () => say("In the address"));
    setTimeout(() => say("Copy link"), 2000);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    const id = KEYS[event.key.toLowerCase()];
    if (id && !target.closest(event.key === " " ? "button, summary, select" : "select")) {
      if (!event.repeat) element(id).click();
      event.preventDefault();
    } else if (["ArrowLeft", "ArrowRight"].includes(event.key) && !target.closest("input, select")) {
      const { input } = Object.values(this.sliders)[0];
      input.value = Number(input.value) + (event.key === "ArrowRight" ? 10 : -10);
      input.dispatchEvent(new Event("input"));
      event.preventDefault();
    }
  }

  showRunning() {
    const words = this.view.running ? "Pause" : "Start";
    if (element("start").textContent !== words) element("start").textContent = words;
  }

  change(settings) {
    this.refused(() => this.machine.change(settings));
    showSettings(this.sliders, this.machine);
  }

  begun(begin) {
    if (this.refused(begin)) this.view.running = true;
    this.shownTime = this.machine.time;
  }

  /* Do what the units may refuse; their words are shown until something else is done. */
  refused(action) {
    this.refuse("");
    try {
      action();
      return true;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.refuse(error.message);
      return false;
    }
  }

  refuse(words) {
    element("refusal").textContent = words;
    element("refusal").hidden = !words;
  }

  /* -- frames -------------------------------------------------------------------------------- */

  frame(now) {
    const passed = Math.min(LONGEST, now - (this.last ?? now));
    this.last = now;
    if (this.view.running && passed > 0) this.move(passed);
    this.drawing.draw(this.colours);
    // signals change little from frame to frame: one picture a frame
    const { machine, colours, view } = this;
    [
      () => plotVibration(element("vibration"), colours, machine, view.place),
      () => machine.weights.length && plotAngles(element("angles"), colours, machine),
      () => plotSpectrum(element("spectrum"), colours, machine, view.place),
      () => this.facts(),
    ][this.frames % 4]();
    element("angles").hidden = !machine.weights.length;
    this.strip.show(machine.now.speed, machine.asScene());
    this.frames++;
    requestAnimationFrame((next) => this.frame(next));
  }

  /* Move the machine by what a frame shows. */
  move(passed) {
    const { pace, slow } = this.view;
    const factor = (pace * (slow ? SLOW : 1) * TURN) / this.data.speed;
    this.shownTime += (factor * passed) / 1000;
    const [before, began] = [this.machine.time, performance.now()];
    try {
      const enough = this.machine.advance(this.shownTime, BUDGET);
      if (!enough) this.shownTime = this.machine.time;
      const warning = this.machine.units.words();
      if (warning) this.refuse(warning);
      this.stopFar();
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.view.running = false;
      this.showRunning();
      this.refuse(error.message);
    }
    const took = performance.now() - began;
    const moved = this.machine.time - before;
    const { cost } = this; // the clock is coarse: only sums over many frames tell
    cost.frame += 0.05 * (passed - cost.frame);
    cost.took = 0.99 * cost.took + took;
    cost.moved = 0.99 * cost.moved + moved;
  }

  /* A motion that grows without bound ends in words, long before it ends in infinity. */
  stopFar() {
    const { now } = this.machine;
    const far = Math.max(...now.pairs.map(({ x, y }) => Math.hypot(x, y)));
    if (far <= FAR * this.drawing.radius) return;
    this.view.running = false;
    this.showRunning();
    this.refuse(`Paused: the displacement, ${shown(far, "m", true)}, is more than ${FAR} times the ` +
      "rotor's radius, and the equations are for small ones. The rotor is unstable at this speed, " +
      "or was driven too hard: change it and restart.");
  }

  facts() {
    const { now, time, stations } = this.machine;
    const { x, y } = now.pairs[this.view.place];
    const speedup = (1000 * this.cost.moved) / (this.cost.took || Infinity);
    const words = balanceWords(this.machine);
    if (element("balance").textContent !== words) element("balance").textContent = words;
    this.write("facts", {
      Time: shown(time, "s"),
      "Speed now": speedWords(now.speed),
      [stations.length > 1 ? "At that station" : "Displacement"]:
        shown(Math.hypot(x, y), "m", true),
      ...(this.machine.clearances.length && { Clearance: shown(now.clearance, "m", true) }),
      ...Object.fromEntries(this.data.stops.map(({ label, gap }, k) =>
        [capital(label), stopWords(gap, now.stops[k])])),
    });
    this.write("details", {
      "Error, estimated": shown(now.error),
      "Steps": shown(now.steps),
      "Frames a second": shown(Math.round(1000 / this.cost.frame)),
      "Can run at": speedup ? `${shown(speedup)} × real time` : "not measured yet",
    });
  }

  /* Values under their names, in the list with that id. */
  write(id, rows) {
    for (const [name, value] of Object.entries(rows)) {
      const said = (this.said[name] ??= this.fact(id, name));
      if (said.textContent !== value) said.textContent = value;
    }
  }

  /* Room for a value under its name. */
  fact(id, name) {
    const said = make("dd");
    element(id).append(make("div", {}, make("dt", { textContent: name }), said));
    return said;
  }
}

const data = JSON.parse(element("data").textContent);
compiledUnits(element("units").textContent)
  .then((module) => (window.autobalancer = new Page(module, data)))
  .catch((error) => {
    element("refusal").textContent = `The units do not run in this browser: ${error.message}`;
    element("refusal").hidden = false;
    throw error;
  });
