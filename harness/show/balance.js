/* How well the machine is balanced: what is left of the unbalance, and what the weights can hold. */

const SETTLED = 0.01; // of the unbalance
const FADED = 0.95; // of what was left before, each time that it is said in motion

/* What a slider has made of a value of the scene. */
function factorOf({ data, settings }, label) {
  const k = data.sliders.findIndex((slider) => slider.label === label);
  return k < 0 ? 1 : settings.factors[k];
}

/* Largest unbalance that the weights can hold [kg m]; of one plane. */
function capacity(machine) {
  const { data, settings } = machine;
  const label = (labels) => data.tracks.length > 1 ? `Mass of a weight: ${labels[0]}` : "Mass of a weight";
  return data.tokens[settings.variant].capacities.reduce(
    (sum, held, k) => sum + held * factorOf(machine, label(data.tracks[k])), 0);
}

/* The rotor's unbalance, as its slider has it or as it has changed, in its axes [kg m]. */
function unbalance({ units, changed }) {
  if (changed) return changed;
  const [size, angle] = units.reader(["rotor.unbalance", "rotor.unbalance_angle"])();
  return [size * Math.cos(angle), size * Math.sin(angle)];
}

/* The balance of a rotor with one plane: words, or none where nothing is known. */
function balanceWords(machine) {
  const { data, units, now: { speed } } = machine;
  const labels = data.tracks.flat();
  if (!units.index.has("rotor.unbalance") || !labels.length) return "";
  const [xi, eta] = unbalance(machine);
  const whole = Math.hypot(xi, eta);
  const moments = units.reader(labels.flatMap((l) => [`${l}.moment_xi`, `${l}.moment_eta`]))();
  const sum = (first) => moments.reduce((s, m, k) => (k % 2 === first ? s + m : s), 0);
  const left = Math.hypot(xi + sum(0), eta + sum(1));
  const fades = machine.time === machine.leftAt ? 1 : FADED; // not while the motion is held
  machine.left = Math.max(left, fades * (machine.left ?? 0)); // weights swing through the right place
  machine.leftAt = machine.time;
  const holds = capacity(machine);
  if (whole > holds) {
    return `The weights are used up: they can hold ${shown(holds, "kg m")} of ${shown(whole, "kg m")}.`;
  }
  const reached = data.grades.find((g) => g >= (1000 * machine.left * speed) / data.mass);
  const grade = reached ? `G${reached}` : `worse than G${data.grades.at(-1)}`;
  const used = `the weights use ${shown((100 * whole) / holds)} % of what they can hold`;
  const now = machine.left <= SETTLED * whole ? "Balanced" : "Not balanced now";
  return `${now}: ${shown(machine.left, "kg m")} left of ${shown(whole, "kg m")}, ${grade}; ${used}.`;
}
