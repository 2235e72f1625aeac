/* The compiled units: one composite in the library's memory, spoken to by its variables' names. */

/* What the units refuse, in their own words. */
class Refusal extends Error {}

const FAILED = 2; // this status of unit.h, or above
const POINTER = 4, DOUBLE = 8; // bytes

async function compiledUnits(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return WebAssembly.compile(bytes);
}

class Units {
  constructor(module, token) {
    this.calls = new WebAssembly.Instance(module).exports;
    const text = new TextEncoder().encode(`${token}\0`);
    const at = this.calls.room(text.length);
    new Uint8Array(this.calls.memory.buffer, at).set(text);
    this.unit = this.calls.instantiate(at);
    if (!this.unit) throw new Refusal(this.words());
    this.names = Array.from({ length: this.calls.count(this.unit) }, (_, k) =>
      this.text(this.calls.name(this.unit, k)));
    this.index = new Map(this.names.map((name, k) => [name, k]));
    this.readers = new Map();
    this.references = this.calls.room(POINTER * this.names.length);
    this.values = this.calls.room(DOUBLE * this.names.length);
  }

  text(at) {
    const bytes = new Uint8Array(this.calls.memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  words() {
    return this.text(this.calls.words());
  }

  done(status) {
    if (status >= FAILED) throw new Refusal(this.words());
  }

  /* Write value references and values of a mapping by name; how many they are. */
  put(values) {
    const names = Object.keys(values);
    const buffer = this.calls.memory.buffer;
    new Uint32Array(buffer, this.references, names.length).set(names.map((n) => this.reference(n)));
    new Float64Array(buffer, this.values, names.length).set(Object.values(values));
    return names.length;
  }

  reference(name) {
    if (!this.index.has(name)) throw new Refusal(`${name}: the units have no such variable`);
    return this.index.get(name);
  }

  /* Start at a time [s] with these values in place of the scene's. */
  begin(values, time) {
    const count = this.put(values);
    this.done(this.calls.begin(this.unit, this.references, count, this.values, time));
    this.time = time;
  }

  set(values) {
    const count = this.put(values);
    this.done(this.calls.set(this.unit, this.references, count, this.values));
  }

  /* Step to a time [s]. */
  advance(until) {
    this.done(this.calls.advance(this.unit, until));
    this.time = until;
  }

  value(name) {
    return this.reader([name])()[0];
  }

  /* A function that reads these variables into the same array again and again. */
  reader(names) {
    const key = names.join();
    if (!this.readers.has(key)) this.readers.set(key, this.newReader(names));
    return this.readers.get(key);
  }

  newReader(names) {
    const at = this.calls.room(POINTER * names.length);
    const values = this.calls.room(DOUBLE * names.length);
    const references = names.map((name) => this.reference(name));
    new Uint32Array(this.calls.memory.buffer, at, names.length).set(references);
    return () => {
      this.done(this.calls.get(this.unit, at, names.length, values));
      return new Float64Array(this.calls.memory.buffer, values, names.length);
    };
  }
}
