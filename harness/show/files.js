/* What a person takes away: a link with the sliders' values, a scene file, signals, a picture. */

/* Positions of the sliders that were moved, as the end of an address: `#speed=500&value_0=250`. */
function addressOf(found) {
  const moved = Object.entries(found).filter(([, slider]) => slider.input.value !== slider.own);
  return `#${new URLSearchParams(moved.map(([name, slider]) => [name, slider.input.value]))}`;
}

/* Move the sliders to where an address has them. */
function takeAddress(found, address) {
  for (const [name, value] of new URLSearchParams(address.slice(1))) {
    const slider = found[name];
    if (!slider || !/^\d+$/.test(value) || Number(value) > Number(slider.input.max)) continue;
    slider.input.value = value;
    slider.input.dispatchEvent(new Event("input"));
  }
}

function saved(name, url) {
  make("a", { href: url, download: name }).click();
}

/* A value as TOML has it; tables within a line. */
function toml(value) {
  if (Array.isArray(value)) return `[${value.map(toml).join(", ")}]`;
  return typeof value === "object" ? `{ ${tomlPairs(value).join(", ")} }` : JSON.stringify(value);
}

function tomlPairs(table) {
  return Object.entries(table).filter(([, value]) => value !== undefined)
    .map(([key, value]) => `${key} = ${toml(value)}`);
}

const times = (value, factor) =>
  Array.isArray(value) ? value.map((each) => times(each, factor)) : value * factor;

/* The scene with the values of the sliders. */
function sceneOf({ data, settings: { factors, variant, speed } }) {
  const scene = structuredClone(data.scene);
  data.sliders.forEach(({ keys, value }, k) => {
    if (factors[k] === value) return;
    for (const [path, base] of keys) {
      const table = path.slice(0, -1).reduce((found, key) => found[key], scene);
      table[path.at(-1)] = times(base, factors[k]);
    }
  });
  data.tracks.forEach((labels, k) => {
    const count = data.tokens[variant].weights[k];
    if (count === data.tokens[0].weights[k]) return;
    data.balancers.forEach(({ label }, i) => labels.includes(label)
      && Object.assign(scene.balancer[i], { count, angles: undefined, speeds: undefined }));
    if (scene.run) scene.run.record = undefined; // it may name weights that are gone
  });
  const { operation } = scene;
  if (speed !== data.speed) (operation.run_up ?? operation)[operation.run_up ? "to" : "speed"] = speed;
  return scene;
}

/* A scene as a file for `autobalancer run`. */
function sceneFile(scene) {
  const tables = Object.entries(scene).filter(([, value]) => typeof value === "object");
  const alone = Object.fromEntries(Object.entries(scene).filter(([, v]) => typeof v !== "object"));
  const parts = tables.flatMap(([name, value]) => Array.isArray(value)
    ? value.map((each) => [`[[${name}]]`, ...tomlPairs(each)].join("\n"))
    : [[`[${name}]`, ...tomlPairs(value)].join("\n")]);
  return [tomlPairs(alone).join("\n"), ...parts].join("\n\n") + "\n";
}

function saveScene(machine) {
  saved("scene.toml", `data:text/plain,${encodeURIComponent(sceneFile(sceneOf(machine)))}`);
}

/* The samples that the page remembers, as CSV in SI units. */
function samplesAsCsv(machine) {
  const { history, stations, weights } = machine;
  const places = stations.map((_, k) => k);
  const columns = [history.time, ...places.flatMap((k) => [history.x[k], history.y[k]]),
    ...history.angles];
  const names = ["time", ...stations.flatMap((name) => [`${name}.x`, `${name}.y`]),
    ...weights.map(({ name }) => name)];
  const rows = machine.last(REMEMBERED, ...columns);
  const lines = Array.from(rows[0], (_, k) => rows.map((row) => row[k]).join());
  return [names.join(), ...lines].join("\n");
}

function saveCsv(machine) {
  saved("signals.csv", `data:text/csv,${encodeURIComponent(samplesAsCsv(machine))}`);
}

function savePicture(canvas) {
  saved("machine.png", canvas.toDataURL("image/png"));
}
