/* The machine on the page: its settings, its motion, and what is remembered of it. */

const TURN = 2 * Math.PI;
const SAMPLES = 16; // of the motion in a revolution at the highest speed of the slider
const NEGLIGIBLE = 1e-3; // of a sample's time
const REMEMBERED = 8192; // samples
const FADING = Math.exp(-1 / REMEMBERED); // of the largest displacement, a sample

class Machine {
  constructor(module, data) {
    Object.assign(this, { module, data, built: new Map() });
    this.step = TURN / (SAMPLES * data.window.high);
    this.stations = data.stations.map((_, k) =>
      data.numbered ? `rotor.station[${k + 1}]` : "rotor");
    this.planes = [...new Set(data.balancers.map((b) => b.plane))];
    this.settings = this.scenes();
    this.restart();
  }

  /* Settings as the scene has them. */
  scenes() {
    const { data } = this;
    return { factors: data.sliders.map((s) => s.value), variant: 0, speed: data.speed };
  }

  /* Whether the values that the stability was worked out for still hold. */
  asScene() {
    const { factors, variant } = this.settings;
    return !variant && factors.every((factor, k) => factor === this.data.sliders[k].value);
  }

  /* -- settings ------------------------------------------------------------------------------ */

  /* Go on with other settings from where the machine is; as before, where the units refuse them. */
  change(settings) {
    const next = { ...this.settings, ...settings };
    const onlySpeed = Object.keys(settings).every((key) => key === "speed");
    if (onlySpeed && this.free) {
      this.settings = next;
      return;
    }
    const { time } = this;
    const state = this.state();
    try {
      this.begin(next, this.placed(next, state), time);
    } catch (error) {
      this.begin(this.settings, this.placed(this.settings, state), time);
      throw error;
    }
  }

  /* From the scene's own start, at the speed of the settings. */
  restart() {
    const { speed } = this.settings;
    const own = speed === this.data.speed; // as it always is under a motor
    this.begin(this.settings, own ? {} : { speed, acceleration: 0, rise_time: 0 }, 0);
    this.forget();
  }

  /* From the scene's own start and standstill to the speed of the settings. */
  runUp() {
    const { speed } = this.settings;
    const { motor, rate } = this.data;
    const start = motor ? { "motor.speed0": 0 }
      : { speed: 0, acceleration: rate, rise_time: speed / rate };
    if (this.data.profile.length > 2) start["corner[1].time"] = 0; // nor those behind
    this.begin(this.settings, start, 0);
    this.forget();
  }

  /* Begin with values of variables, at a time [s]. */
  begin(settings, values, time) {
    const units = this.unitsOf(settings.variant);
    units.begin({ ...this.sliderValues(settings), ...values }, time);
    if (this.units !== units) this.listen(units);
    this.settings = settings;
    this.changes = values["unbalance_change[1].time"] === 0 ? [] : this.data.changes;
    // a rotor that speeds up by itself, or by its motor, takes no speed from outside
    this.free = !this.data.motor && !(units.value("rise_time") > 0);
    this.sampled = time;
    this.told = 0;
    this.pushed = false;
    this.left = 0; // of the unbalance, as it is said
    this.read();
  }

  /* Units of the token with that number. */
  unitsOf(variant) {
    if (!this.built.has(variant)) {
      this.built.set(variant, new Units(this.module, this.data.tokens[variant].token));
    }
    return this.built.get(variant);
  }

  /* Values of the variables whose slider was moved. */
  sliderValues(settings) {
    const values = {};
    this.data.sliders.forEach((slider, k) => {
      if (settings.factors[k] === slider.value) return;
      for (const [name, base] of Object.entries(slider.base)) {
        values[name] = base * settings.factors[k];
      }
    });
    return values;
  }

  /* Where everything is: of each output the start value that it goes on from. */
  state() {
    const { names } = this.units;
    const starts = names.filter((n) => n.endsWith("0") && this.units.index.has(n.slice(0, -1)));
    const values = this.units.reader(starts.map((name) => name.slice(0, -1)))();
    return Object.fromEntries(starts.map((name, k) => [name, values[k]]));
  }

  /* Start values of the units of other settings: weights that leave or join included. */
  placed(settings, state) {
    const { index } = this.unitsOf(settings.variant);
    const kept = Object.fromEntries(Object.entries(state).filter(([name]) => index.has(name)));
    for (const { label } of this.data.balancers) {
      const angles = [];
      for (let k = 1; index.has(`${label}.weight[${k}].angle0`); k++) {
        const name = `${label}.weight[${k}].angle0`;
        kept[name] ??= widestGap(angles);
        kept[`${label}.weight[${k}].speed0`] ??= 0;
        angles.push(kept[name]);
      }
    }
    if (this.data.motor) return kept;
    if (index.has("unbalance_change[1].time")) kept["unbalance_change[1].time"] = 0; // nor later ones
    const speed = this.now.speed;
    const top = settings.speed > speed ? settings.speed : 0;
    return { ...kept, speed, acceleration: 0, rise_time: 0, "coupling.top_speed": top };
  }

  /* -- motion -------------------------------------------------------------------------------- */

  /* Go to a time [s], for at most so many milliseconds; whether it was enough.  Samples are evenly
     spread; a picture between two of them is a step of its own. */
  advance(time, budget) {
    const late = performance.now() + budget;
    while (time - this.time > NEGLIGIBLE * this.step) {
      if (performance.now() > late) return false;
      const next = this.sampled + this.step;
      this.stepTo(next - time < NEGLIGIBLE * this.step ? next : time, next);
    }
    return true;
  }

  stepTo(until, next) {
    const begins = this.time === this.sampled;
    if (this.free) this.drive(begins);
    if (begins && (this.pushed || this.push)) this.pressOn();
    this.units.advance(until);
    this.read();
    if (until === next) this.remember();
  }

  /* Change the speed towards that of the settings; how fast is chosen as a sample begins. */
  drive(begins) {
    const { speed } = this.now;
    const { rate } = this.data;
    const before = this.told;
    if (begins) {
      const wanted = (this.settings.speed - speed) / this.step;
      this.told = Math.max(-rate, Math.min(rate, wanted));
    }
    if (this.told || before) this.units.set({ speed, acceleration: this.told });
  }

  /* Push the rotor over one sample; the one after it lets it go. */
  kick() {
    this.push = true;
  }

  pressOn() {
    const force = this.push ? this.data.kick / this.step : 0;
    const plane = this.planes.length ? this.planes[0] : 1;
    this.units.set({ [`rotor.plane[${plane}].F_x`]: force });
    this.pushed = this.push;
    this.push = false;
  }

  /* -- what is seen -------------------------------------------------------------------------- */

  get time() {
    return this.units.time;
  }

  /* The unbalance now, where it has changed, in the rotor's axes [kg m]; else undefined. */
  get changed() {
    return this.changes.filter(([at]) => at <= this.time).at(-1)?.slice(1);
  }

  /* Direction of the unbalance in the rotor; null where it has no one. */
  get heavy() {
    const { changed } = this;
    if (!changed) return this.data.heavy;
    return Math.hypot(...changed) ? Math.atan2(changed[1], changed[0]) : null;
  }

  /* Read what the page shows from these units. */
  listen(units) {
    this.units = units;
    const weights = units.names.filter((name) => /\.weight\[\d+\]\.angle$/.test(name));
    this.places = [...this.stations, ...this.planes.map((k) => `rotor.plane[${k}]`)];
    const facts = ["rotor.angle", "rotor.speed", "coupling.error", "coupling.steps"];
    this.clearances = units.names.filter((name) => name.endsWith(".clearance"));
    this.waves = units.names.filter((name) => name.endsWith(".wave_xi"))
      .map((name) => name.slice(0, -".wave_xi".length));
    this.readAll = units.reader([...facts, ...this.places.flatMap((p) => [`${p}.x`, `${p}.y`]),
      ...this.waves.flatMap((w) => [`${w}.wave_xi`, `${w}.wave_eta`]), ...weights,
      ...this.clearances]);
    this.readCarrier = this.data.carrier ? units.reader(this.data.carrier.points.flatMap((k) =>
      [`rotor.station[${k + 1}].x`, `rotor.station[${k + 1}].y`])) : () => [];
    const { tub } = this.data;
    this.readTub = tub ? units.reader(["x", "y"].map((axis) =>
      `rotor.station[${tub.point + 1}].${axis}`)) : () => [0, 0];
    this.readStops = this.data.stops.length ? units.reader(this.stopNames()) : () => [];
    const before = new Map(this.weights?.map(({ name }, k) => [name, this.history.angles[k]]));
    this.weights = weights.map((name) => ({
      name, label: name.split(".")[0], number: Number(name.match(/\[(\d+)\]/)[1]),
    }));
    if (!this.history) this.forget();
    const missing = this.history.time.map(() => NaN);
    this.history.angles = weights.map((name) => before.get(name) ?? [...missing]);
  }

  forget() {
    this.filled = this.largest = 0;
    const row = () => [];
    this.history = { time: [], x: this.places.map(row), y: this.places.map(row),
      angles: this.weights.map(row) };
  }

  read() {
    const [angle, speed, error, steps, ...rest] = this.readAll();
    const pairs = this.places.map((_, k) => ({ x: rest[2 * k], y: rest[2 * k + 1] }));
    const first = 2 * this.places.length, last = first + 2 * this.waves.length;
    const waves = Object.fromEntries(this.waves.map((w, k) =>
      [w, rest.slice(first + 2 * k, first + 2 * k + 2)]));
    const angles = rest.slice(last, rest.length - this.clearances.length);
    const clearance = Math.min(...rest.slice(rest.length - this.clearances.length));
    this.now = { angle, speed, error, steps, pairs, waves, angles, clearance,
      stops: this.stopsNow(), carrier: this.carrierNow(), tub: this.readTub() };
  }

  /* Displacements of the body that carries the rotor, below both supports. */
  carrierNow() {
    const [x1, y1, x2, y2] = this.readCarrier();
    return [{ x: x1, y: y1 }, { x: x2, y: y2 }];
  }

  /* x and y of all points, which move across stops, then what each stop says. */
  stopNames() {
    const { stops, points } = this.data;
    const names = Array.from({ length: points }, (_, k) =>
      this.data.numbered ? `rotor.station[${k + 1}]` : "rotor");
    return [...names.flatMap((n) => [`${n}.x`, `${n}.y`]), ...stops.flatMap((_, k) =>
      ["force_x", "force_y", "touches"].map((what) => `rotor.stop[${k + 1}].${what}`))];
  }

  /* Of every stop the displacement across it, its force, and how often it was touched. */
  stopsNow() {
    const values = this.readStops(), { stops, points } = this.data;
    return stops.map(({ rows }, k) => {
      const [x, y] = rows.map((row, axis) =>
        row.reduce((sum, part, point) => sum + part * values[2 * point + axis], 0));
      const [fx, fy, touches] = values.slice(2 * points + 3 * k, 2 * points + 3 * k + 3);
      return { x, y, force: Math.hypot(fx, fy), touches };
    });
  }

  remember() {
    const { time, x, y, angles } = this.history;
    time.push(this.time);
    this.now.pairs.forEach((pair, k) => {
      x[k].push(pair.x);
      y[k].push(pair.y);
      this.largest = Math.max(this.largest, Math.hypot(pair.x, pair.y));
    });
    this.largest *= FADING;
    this.sampled = this.time;
    this.now.angles.forEach((angle, k) => angles[k].push(angle));
    this.filled++;
    if (time.length >= 2 * REMEMBERED) { // seldom: every row is moved
      for (const row of [time, ...x, ...y, ...angles]) row.splice(0, REMEMBERED);
    }
  }

  /* The last `count` samples of rows of the history, oldest first. */
  last(count, ...rows) {
    return rows.map((row) => row.slice(-Math.min(count, REMEMBERED)));
  }
}

/* The middle of the widest gap between angles on a circle [rad]. */
function widestGap(angles) {
  if (!angles.length) return 0;
  const sorted = angles.map((a) => ((a % TURN) + TURN) % TURN).sort((a, b) => a - b);
  const gaps = sorted.map((a, k) => (sorted[k + 1] ?? sorted[0] + TURN) - a);
  const widest = gaps.indexOf(Math.max(...gaps));
  return sorted[widest] + gaps[widest] / 2;
}
