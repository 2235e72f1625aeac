/* What a person takes away: a link with the sliders' values, the signals, a picture. */

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
