/* The machine to scale, its displacement magnified: a front view of every plane, and a side view. */

const SHOWN_AS = 0.22; // of the rotor's radius: what the largest displacement is drawn as
const TRAIL = 3; // revolutions
const GAP = 0.2; // of a chamber's radius: a narrower gap is drawn wider, up to this
const LOBES = 0.08; // of a race's radius: smaller lobes are drawn larger, up to this
const TUB = 0.81; // of half of the picture: radius of a body around a planar rotor
const FRAME_AT = 0.97; // of half of the picture
const FARTHEST = 0.98; // of half of the picture: stops farther out are not drawn
const WITHIN = 0.9; // of a gap: what a displacement that is less is drawn within

/* Draws a machine; remembers how it magnifies. */
class Drawing {
  constructor(canvas, machine) {
    Object.assign(this, { canvas, machine, magnification: 0, turning: false });
    const { data } = machine;
    this.planes = frontPlanes(machine);
    this.span = Math.max(...data.stations) - Math.min(...data.stations);
    this.radius = Math.max(...this.planes.map((p) => p.radius));
  }

  draw(colours) {
    const { context, width, height } = cleared(this.canvas, colours.panel);
    this.context = context;
    this.colours = colours;
    this.magnify();
    const side = this.span > 0 ? 0.4 * height : 0;
    const wide = width / this.planes.length;
    const size = Math.min(wide, height - side - 22) / 2;
    this.planes.forEach((plane, k) =>
      this.front(plane, wide * (k + 0.5), (height - side - 18) / 2, size));
    if (side) this.side(0, height - side - 16, width, side);
    context.fillStyle = colours.faint;
    context.textAlign = "left";
    const wider = this.machine.data.balancers.filter((b) => b.chamber_radius)
      .map((b) => gapTimes(b, this.magnification)).filter((times) => times > 1);
    const lobed = this.machine.data.balancers.filter((b) => b.race?.length);
    const words = [`Displacement × ${shown(this.magnification)}`,
      ...wider.map((times) => `gap × ${shown(times)}`),
      ...lobed.map((b) => `lobes of ${b.label} × ${shown(lobeTimes(b))}`)];
    context.fillText(words.join(", "), 8, height - 8, width - 106); // beside the key
    if (this.machine.data.heavy !== null) this.key(width - 90, height - 8);
  }

  key(x, y) {
    const { context: c, colours } = this;
    c.fillStyle = colours.heavy;
    triangle(c, x, y - 10, 0, -1);
    c.fillStyle = colours.faint;
    c.fillText("heavy side", x + 12, y);
  }

  /* Follow the largest displacement: at once where it grows, so that the rotor stays in the picture,
     and so slowly where it falls that a motion that dies away is seen to do so; a liquid's gap is not
     drawn crossed before it is. */
  magnify() {
    const { machine } = this;
    if (!machine.largest) return;
    const gaps = machine.data.balancers.filter((b) => b.chamber_radius).map((b) => {
      const gap = b.chamber_radius - b.float_radius;
      return (WITHIN * gap * gapTimes(b)) / Math.min(machine.largest, WITHIN * gap);
    });
    const wanted = Math.min((SHOWN_AS * this.radius) / machine.largest, ...gaps);
    const pace = wanted < this.magnification || !this.magnification ? 1 : 0.05;
    this.magnification += pace * (wanted - this.magnification);
  }

  samples() {
    const { machine } = this;
    const speed = Math.max(machine.now.speed, 0.2 * machine.data.speed);
    return Math.ceil((TRAIL * TURN) / (speed * machine.step));
  }

  /* -- along the axis -------------------------------------------------------------------------- */

  front(plane, cx, cy, size) {
    const { context: c, colours, machine, magnification: m } = this;
    const scale = (0.76 * size) / plane.radius;
    const { x, y } = machine.now.pairs[plane.place];
    const view = this.turning ? -machine.now.angle : 0;
    const point = (px, py) => {
      const [ct, st] = [Math.cos(view), Math.sin(view)];
      return [cx + scale * (ct * px - st * py), cy - scale * (st * px + ct * py)];
    };
    const centre = point(m * x, m * y);
    if (plane.supported && machine.data.tub) {
      this.tub(cx, cy, point(m * machine.now.tub[0], m * machine.now.tub[1]), centre, size);
    } else if (!this.turning && plane.supported) this.springs(cx, cy, centre, size);
    this.disc(plane, centre, scale, view);
    this.trail(plane, point);
    for (const b of plane.balancers) this.balancer(b, plane, centre, point(0, 0), scale, view);
    if (plane.supported && !this.span) this.stops(point, scale, size);
    c.strokeStyle = colours.faint;
    cross(c, cx, cy, 6);
    c.fillStyle = colours.ink;
    dot(c, ...centre, 3);
    c.fillStyle = colours.faint;
    c.textAlign = "center";
    c.fillText(plane.title, cx, cy + size + 8);
  }

  /* Springs along x and y from the frame to the shaft. */
  springs(cx, cy, [x, y], size) {
    const { context: c, colours } = this;
    const reach = FRAME_AT * size;
    c.strokeStyle = colours.faint;
    c.lineWidth = 1.5;
    spring(c, cx - reach, cy, x, y, 9);
    spring(c, cx, cy + reach, x, y, 9);
    feet(c, cx, cy, reach);
  }

  /* The body around a planar rotor: springs from the frame to it, and from it to the shaft. */
  tub(cx, cy, [bx, by], [x, y], size) {
    const { context: c, colours, machine } = this, { tub } = machine.data;
    const [reach, edge] = [FRAME_AT * size, TUB * size];
    c.strokeStyle = colours.faint;
    if (!this.turning) {
      c.lineWidth = 1.5;
      spring(c, bx - edge, by, x, y, 9);
      spring(c, bx, by + edge, x, y, 9);
      if (tub.feet) {
        spring(c, cx - reach, cy, bx - edge, by, 4);
        spring(c, cx, cy + reach, bx, by + edge, 4);
        feet(c, cx, cy, reach);
      }
    }
    c.lineWidth = 4;
    circle(c, bx, by, edge);
    c.lineWidth = 1;
    c.fillStyle = colours.faint;
    c.textAlign = "center";
    c.fillText(tub.name, bx, by - edge - 5);
  }

  /* Stops around the axis at their gap, and how far the rotor has come across each; one that is
     farther out than the picture is left out. */
  stops(point, scale, size) {
    const { context: c, colours, machine, magnification: m } = this;
    machine.data.stops.forEach(({ kind, gap }, k) => {
      const { x, y, force } = machine.now.stops[k];
      const reach = m * gap * scale;
      if (!(reach < FARTHEST * size)) return;
      c.strokeStyle = c.fillStyle = force ? colours.heavy : colours.ink;
      c.lineWidth = force ? 4 : 2;
      if (kind === "ring") {
        circle(c, ...point(0, 0), reach);
      } else {
        for (const side of [-1, 1]) {
          const ends = [-0.4, 0.4].map((part) => (kind === "x"
            ? point(side * m * gap, part * m * gap) : point(part * m * gap, side * m * gap)));
          line(c, ...ends[0], ...ends[1]);
        }
      }
      c.lineWidth = 1;
      dot(c, ...point(m * x, m * y), 4);
    });
  }

  disc(plane, [x, y], scale, view) {
    const { context: c, colours, machine } = this;
    const radius = plane.radius * scale;
    const angle = machine.now.angle + view;
    c.fillStyle = colours.body;
    c.strokeStyle = colours.faint;
    c.globalAlpha = 0.75;
    dot(c, x, y, radius);
    c.globalAlpha = 1;
    circle(c, x, y, radius);
    for (let k = 0; k < 3; k++) { // spokes show that it turns
      const a = angle + (k * TURN) / 3;
      line(c, x + 0.12 * radius * Math.cos(a), y - 0.12 * radius * Math.sin(a),
        x + 0.3 * radius * Math.cos(a), y - 0.3 * radius * Math.sin(a));
    }
    const { heavy } = machine;
    if (heavy === null) return;
    const [ux, uy] = [Math.cos(angle + heavy), -Math.sin(angle + heavy)];
    c.fillStyle = colours.heavy;
    triangle(c, x + (radius - 2) * ux, y + (radius - 2) * uy, ux, uy);
  }

  trail(plane, point) {
    const { context: c, colours, machine, magnification: m } = this;
    const { x, y } = machine.history;
    const now = machine.now.pairs[plane.place];
    const [xs, ys] = machine.last(this.samples(), x[plane.place], y[plane.place]);
    c.strokeStyle = colours.trail;
    c.lineWidth = 2;
    const pieces = 8;
    for (let piece = 0; piece < pieces; piece++) { // fades into the past
      c.globalAlpha = 0.15 + (0.85 * (piece + 1)) / pieces;
      const first = Math.floor((piece * xs.length) / pieces);
      const last = Math.min(xs.length - 1, Math.floor(((piece + 1) * xs.length) / pieces));
      c.beginPath();
      for (let k = first; k <= last; k++) c.lineTo(...point(m * xs[k], m * ys[k]));
      if (piece === pieces - 1) c.lineTo(...point(m * now.x, m * now.y));
      c.stroke();
    }
    c.globalAlpha = 1;
    c.lineWidth = 1;
  }

  balancer(b, plane, [x, y], [ox, oy], scale, view) {
    const { context: c, colours, machine } = this;
    if (b.chamber_radius) { // the float stays on the axis of rotation
      const gap = (b.chamber_radius - b.float_radius) * gapTimes(b, this.magnification);
      const float = (b.chamber_radius - gap) * scale;
      c.fillStyle = colours.liquid;
      c.globalAlpha = 0.8;
      c.beginPath();
      c.arc(x, y, b.chamber_radius * scale, 0, TURN);
      c.arc(ox, oy, float, 0, TURN, true);
      c.fill("evenodd");
      c.globalAlpha = 1;
      c.strokeStyle = colours.ink;
      circle(c, x, y, b.chamber_radius * scale);
      circle(c, ox, oy, float);
      return;
    }
    const turned = machine.now.angle + view;
    if (b.wall_radius) {
      this.ring(b, [x, y], scale, turned);
      return;
    }
    const [oxi, oeta] = [b.track_offset_xi * scale, b.track_offset_eta * scale];
    const tx = x + oxi * Math.cos(turned) - oeta * Math.sin(turned);
    const ty = y - oxi * Math.sin(turned) - oeta * Math.cos(turned);
    c.strokeStyle = colours.line;
    race(c, tx, ty, b, turned, scale);
    const nominal = Math.max(6, 0.07 * plane.radius * scale);
    machine.weights.forEach(({ label, number }, k) => {
      if (label !== b.label) return;
      const size = (b.radii[number - 1] ?? b.weight_radius) * scale || nominal;
      const angle = machine.now.angles[k] + turned;
      const arm = raceRadius(b, machine.now.angles[k]) * scale;
      const [wx, wy] = [tx + arm * Math.cos(angle), ty - arm * Math.sin(angle)];
      c.strokeStyle = colours.ink;
      if (b.kind === "pendulums") line(c, tx, ty, wx, wy);
      c.fillStyle = weightColour(colours, k);
      dot(c, wx, wy, size);
      circle(c, wx, wy, size);
      c.fillStyle = "#000";
      c.textAlign = "center";
      if (size >= 6) c.fillText(number, wx, wy + 4);
    });
  }

  /* A ring part filled: its free surface is a circle beside the wall's by (1 - f) y. */
  ring(b, [x, y], scale, turned) {
    const { context: c, colours, machine, magnification: m } = this;
    const [xi, eta] = machine.now.waves[b.label];
    const gap = b.wall_radius - b.inner_radius, share = 1 - (b.inner_radius / b.wall_radius) ** 2;
    const size = share * Math.hypot(xi, eta), shown = Math.min(m * size, 0.98 * gap);
    const by = size ? (scale * share * shown) / size : 0;
    const sx = x - by * (xi * Math.cos(turned) - eta * Math.sin(turned));
    const sy = y + by * (xi * Math.sin(turned) + eta * Math.cos(turned));
    c.fillStyle = size < gap ? colours.liquid : colours.heavy; // beyond, the wall is dry
    c.globalAlpha = 0.8;
    c.beginPath();
    c.arc(x, y, b.wall_radius * scale, 0, TURN);
    c.arc(sx, sy, b.inner_radius * scale, 0, TURN, true);
    c.fill("evenodd");
    c.globalAlpha = 1;
    c.strokeStyle = colours.ink;
    circle(c, x, y, b.wall_radius * scale);
    circle(c, sx, sy, b.inner_radius * scale);
  }

  /* -- across the axis: x upwards, y towards the eye as a slant ------------------------------- */

  side(left, top, width, height) {
    const { context: c, colours, machine, magnification: m } = this;
    const { data } = machine;
    const scale = Math.min((0.8 * width) / this.span, (0.4 * height) / this.radius);
    const middle = (Math.max(...data.stations) + Math.min(...data.stations)) / 2;
    const [cx, cy] = [left + width / 2, top + 0.45 * height];
    const at = (z, { x, y }) =>
      [cx + scale * (z - middle + 0.35 * m * y), cy - scale * (m * x - 0.2 * m * y)];
    const rest = { x: 0, y: 0 };
    c.strokeStyle = colours.faint;
    for (const number of data.supports) {
      const z = data.stations[number - 1];
      const [x, y] = at(z, machine.now.pairs[number - 1]);
      if (data.carrier) {
        spring(c, ...this.carrierAt(z, at, height), x, y, 4);
        continue;
      }
      const [gx] = at(z, rest);
      spring(c, gx, cy + 0.5 * height, x, y, 6);
      line(c, gx - 12, cy + 0.5 * height, gx + 12, cy + 0.5 * height);
    }
    if (data.carrier) this.carrier(at, cy + 0.5 * height, height);
    data.stops.forEach(({ kind, gap, z }, k) => {
      const { x, y, force } = machine.now.stops[k];
      if (!(m * gap * scale < FARTHEST * height)) return;
      c.strokeStyle = c.fillStyle = force ? colours.heavy : colours.ink;
      c.lineWidth = force ? 4 : 2;
      for (const side of [-1, 1]) {
        const [sx, sy] = at(z, kind === "y" ? { x: 0, y: side * gap } : { x: side * gap, y: 0 });
        line(c, sx - 9, sy, sx + 9, sy);
      }
      c.lineWidth = 1;
      dot(c, ...at(z, { x, y }), 3);
    });
    c.strokeStyle = colours.faint;
    c.setLineDash([4, 4]);
    line(c, ...at(Math.min(...data.stations), rest), ...at(Math.max(...data.stations), rest));
    c.setLineDash([]);
    const along = machine.stations.map((_, k) => [data.stations[k], machine.now.pairs[k]]);
    for (const plane of this.planes) along.push([plane.z, machine.now.pairs[plane.place]]);
    along.sort((a, b) => a[0] - b[0]);
    c.strokeStyle = colours.ink;
    c.lineWidth = 3;
    c.beginPath();
    for (const [z, pair] of along) c.lineTo(...at(z, pair));
    c.stroke();
    c.lineWidth = 1.5;
    for (const plane of this.planes) {
      const [x, y] = at(plane.z, machine.now.pairs[plane.place]);
      c.fillStyle = colours.body;
      c.globalAlpha = 0.75;
      c.beginPath();
      c.ellipse(x, y, 0.22 * plane.radius * scale, plane.radius * scale, 0, 0, TURN);
      c.fill();
      c.globalAlpha = 1;
      c.stroke();
    }
    c.fillStyle = colours.ink;
    machine.stations.forEach((_, k) => dot(c, ...at(data.stations[k], machine.now.pairs[k]), 4));
    c.lineWidth = 1;
  }

  /* Where the body that carries the rotor is drawn, below a place of the shaft. */
  carrierAt(z, at, height) {
    const { carrier } = this.machine.data, [first, last] = this.machine.now.carrier;
    const part = (z - carrier.z[0]) / (carrier.z[1] - carrier.z[0]);
    const [x, y] = at(z, { x: first.x + part * (last.x - first.x),
      y: first.y + part * (last.y - first.y) });
    return [x, y + 0.28 * height];
  }

  /* That body as a bar, on its own feet. */
  carrier(at, ground, height) {
    const { context: c, colours, machine } = this, { carrier } = machine.data;
    const places = [...carrier.z, ...carrier.feet, carrier.middle];
    const ends = [Math.min(...places), Math.max(...places)];
    for (const z of carrier.feet) {
      const [gx] = at(z, { x: 0, y: 0 });
      spring(c, gx, ground, ...this.carrierAt(z, at, height), 4);
      line(c, gx - 12, ground, gx + 12, ground);
    }
    c.lineWidth = 7;
    line(c, ...this.carrierAt(ends[0], at, height), ...this.carrierAt(ends[1], at, height));
    c.lineWidth = 1;
    const [x, y] = this.carrierAt((ends[0] + ends[1]) / 2, at, height);
    c.textAlign = "center";
    c.fillStyle = colours.faint;
    c.fillText(carrier.name, x, y + 16);
  }
}

/* How many times wider the gap is drawn than it is: no more than displacements are. */
function gapTimes({ chamber_radius, float_radius }, magnification = Infinity) {
  const most = (GAP * chamber_radius) / (chamber_radius - float_radius);
  return Math.max(1, Math.min(most, magnification));
}

/* How many times larger the lobes of a race are drawn than they are. */
function lobeTimes(b) {
  const largest = b.race.reduce((sum, lobe) => sum + lobe.amplitude, 0);
  return largest ? Math.max(1, (LOBES * b.track_radius) / largest) : 1;
}

/* Distance of a weight at an angle in the rotor from the middle of its race, as it is drawn. */
function raceRadius(b, angle) {
  if (!b.race?.length) return b.track_radius;
  const times = lobeTimes(b);
  return b.race.reduce((rho, lobe) =>
    rho + times * lobe.amplitude * Math.cos(lobe.lobes * (angle - lobe.angle)), b.track_radius);
}

/* The path of the weights' centres. */
function race(c, x, y, b, turned, scale) {
  if (!b.race?.length) {
    circle(c, x, y, b.track_radius * scale);
    return;
  }
  c.beginPath();
  for (let k = 0; k <= 360; k++) {
    const angle = (TURN * k) / 360, rho = raceRadius(b, angle) * scale;
    c.lineTo(x + rho * Math.cos(angle + turned), y - rho * Math.sin(angle + turned));
  }
  c.stroke();
}

/* What a front view shows: each plane with balancers; of a bare rotor its first station. */
function frontPlanes(machine) {
  const { data } = machine;
  const reach = (b) => (b.chamber_radius ?? b.wall_radius ?? b.track_radius) + (b.weight_radius ?? 0);
  const several = data.stations.length > 1;
  if (!data.balancers.length) {
    const radius = several ? 0.15 * (Math.max(...data.stations) - Math.min(...data.stations)) : 1;
    return [{ place: 0, z: data.stations[0], balancers: [], radius, supported: true,
      title: several ? "station 1" : "" }];
  }
  return machine.planes.map((number, k) => {
    const balancers = data.balancers.filter((b) => b.plane === number);
    const radius = 1.2 * Math.max(...balancers.map(reach));
    const title = several ? balancers.map((b) => b.label).join(", ") : "";
    return { place: machine.stations.length + k, z: balancers[0].z, balancers, radius, title,
      supported: !several };
  });
}

function line(c, x1, y1, x2, y2) {
  c.beginPath();
  c.moveTo(x1, y1);
  c.lineTo(x2, y2);
  c.stroke();
}

function circle(c, x, y, radius) {
  c.beginPath();
  c.arc(x, y, radius, 0, TURN);
  c.stroke();
}

function dot(c, x, y, radius) {
  c.beginPath();
  c.arc(x, y, radius, 0, TURN);
  c.fill();
}

/* With its tip at x, y, along u. */
function triangle(c, x, y, ux, uy) {
  const [long, half] = [11, 7];
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(x - long * ux - half * uy, y - long * uy + half * ux);
  c.lineTo(x - long * ux + half * uy, y - long * uy - half * ux);
  c.fill();
}

/* The frame, where springs along x and y stand on it. */
function feet(c, cx, cy, reach) {
  c.lineWidth = 3;
  line(c, cx - reach, cy - 14, cx - reach, cy + 14);
  line(c, cx - 14, cy + reach, cx + 14, cy + reach);
  c.lineWidth = 1;
}

function cross(c, x, y, size) {
  line(c, x - size, y, x + size, y);
  line(c, x, y - size, x, y + size);
}

function spring(c, x1, y1, x2, y2, coils) {
  const [dx, dy] = [x2 - x1, y2 - y1];
  const length = Math.hypot(dx, dy) || 1;
  const [nx, ny] = [(-dy / length) * 5, (dx / length) * 5];
  c.beginPath();
  c.moveTo(x1, y1);
  for (let k = 0; k < 2 * coils; k++) {
    const part = 0.1 + (0.6 * (k + 0.5)) / (2 * coils);
    const side = k % 2 ? 1 : -1;
    c.lineTo(x1 + part * dx + side * nx, y1 + part * dy + side * ny);
  }
  c.lineTo(x1 + 0.72 * dx, y1 + 0.72 * dy);
  c.lineTo(x2, y2);
  c.stroke();
}
