// The dome of viewpoints around a target, seen from outside: each place has the colour of its
// nearest viewpoint, as far as that is near. Body axes: x to the bow, y to starboard, z up.

const RAD = Math.PI / 180;
const direction = (azimuth, elevation) => {
  const c = Math.cos(elevation * RAD);
  return [c * Math.cos(azimuth * RAD), c * Math.sin(azimuth * RAD), Math.sin(elevation * RAD)];
};
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// For each degree (or half of one) of azimuth and elevation the nearest viewpoint; -1: none is near.
class NearestTable {
  constructor(points) {
    this.points = points;
    this.perDegree = points.length > 3000 ? 2 : 1;
    this.width = 360 * this.perDegree;
    this.height = 180 * this.perDegree + 1;
    this.index = new Int32Array(this.width * this.height).fill(-1);
    const reach = NearestTable.reach(points);
    const cells = new Map();
    const key = (x, y, z) => (Math.floor((x + 2) / reach) * 4096 + Math.floor((y + 2) / reach)) * 4096 + Math.floor((z + 2) / reach);
    points.forEach((p, k) => {
      const at = key(...p);
      if (cells.has(at)) cells.get(at).push(k);
      else cells.set(at, [k]);
    });
    let lowest = 1;
    for (const p of points) lowest = Math.min(lowest, p[2]);
    const bottom = Math.max(-90, Math.asin(Math.max(-1, lowest)) / RAD - reach / RAD);
    for (let row = 0; row < this.height; ++row) {
      const elevation = row / this.perDegree - 90;
      if (elevation < bottom) continue;
      for (let column = 0; column < this.width; ++column) {
        const p = direction(column / this.perDegree, elevation);
        let best = -1, least = reach * reach;
        for (let dx = -1; dx <= 1; ++dx)
          for (let dy = -1; dy <= 1; ++dy)
            for (let dz = -1; dz <= 1; ++dz)
              for (const k of cells.get(key(p[0] + dx * reach, p[1] + dy * reach, p[2] + dz * reach)) ?? []) {
                const q = points[k];
                const d = (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2;
                if (d < least) [best, least] = [k, d];
              }
        this.index[row * this.width + column] = best;
      }
    }
  }
  // As far as a viewpoint stands for what is around it: 1.3 times the usual distance to the third
  // nearest one, but 3 to 40 degrees.
  static reach(points) {
    const some = points.filter((_, k) => k % Math.ceil(points.length / 60) === 0);
    const third = some.map((p) => {
      const nearest = [9, 9, 9];
      for (const q of points) {
        const d = Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
        if (d > 1e-6 && d < nearest[2]) {
          nearest[2] = d;
          nearest.sort((a, b) => a - b);
        }
      }
      return nearest[2];
    }).sort((a, b) => a - b);
    return Math.min(40 * RAD, Math.max(3 * RAD, 1.3 * third[third.length >> 1]));
  }
  at(p) {
    const elevation = Math.asin(Math.min(1, Math.max(-1, p[2]))) / RAD;
    const azimuth = Math.atan2(p[1], p[0]) / RAD + 360;
    const row = Math.round((elevation + 90) * this.perDegree);
    const column = Math.round(azimuth * this.perDegree) % this.width;
    return this.index[row * this.width + column];
  }
}

export class Hemisphere {
  // on.hover(index or -1), on.choose(index), on.turn(azimuth, elevation, zoom): a gesture has ended.
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.points = [];
    this.chosen = -1;
    this.turn = { azimuth: 180, elevation: 90, zoom: 1 };
    new ResizeObserver(() => this.paint()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
    this.listen();
  }

  setData(azimuth, elevation, value, scale) {
    const same = this.azimuth && azimuth.length === this.azimuth.length &&
      azimuth.every((a, k) => a === this.azimuth[k] && elevation[k] === this.elevation[k]);
    if (!same) {
      [this.azimuth, this.elevation] = [azimuth, elevation];
      this.points = azimuth.map((a, k) => direction(a, elevation[k]));
      this.nearest = new NearestTable(this.points);
    }
    this.place = value.map((v) => (v === null ? -1 : scale.place(v)));
    this.scale = scale;
    this.paint();
  }
  choose(index) {
    this.chosen = index;
    this.paint();
  }
  look(azimuth, elevation, zoom) {
    this.turn = { azimuth: ((azimuth % 360) + 360) % 360, elevation: Math.min(90, Math.max(0, elevation)), zoom: Math.min(8, Math.max(1, zoom)) };
    this.paint();
  }

  // Screen axes of the turned dome.
  axes() {
    const { azimuth, elevation } = this.turn;
    const towards = direction(azimuth, elevation);
    const up = [-Math.sin(elevation * RAD) * Math.cos(azimuth * RAD), -Math.sin(elevation * RAD) * Math.sin(azimuth * RAD), Math.cos(elevation * RAD)];
    const right = [towards[1] * up[2] - towards[2] * up[1], towards[2] * up[0] - towards[0] * up[2], towards[0] * up[1] - towards[1] * up[0]];
    return { towards, up, right };
  }
  // Zooming keeps the chosen viewpoint in place.
  geometry(size) {
    const { right, up } = this.axes();
    const radius = 0.36 * size * this.turn.zoom;
    const hold = this.turn.zoom > 1 && this.chosen >= 0 ? this.points[this.chosen] : null;
    const away = hold ? 1 - 1 / this.turn.zoom : 0;
    return { radius, x: size / 2 - (hold ? away * radius * dot(hold, right) : 0), y: size / 2 + (hold ? away * radius * dot(hold, up) : 0) };
  }

  paint() {
    if (!this.scale || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.paintNow();
    });
  }
  paintNow() {
    const shown = this.canvas.clientWidth;
    if (shown === 0) return;
    const ratio = Math.min(window.devicePixelRatio, this.dragging ? 1 : 2);
    const size = Math.round(shown * ratio);
    if (this.canvas.width !== size) this.canvas.width = this.canvas.height = size;
    const context = this.canvas.getContext("2d");
    const style = getComputedStyle(this.canvas);
    const picture = context.createImageData(size, size);
    const { towards, up, right } = this.axes();
    const { radius, x: cx, y: cy } = this.geometry(size);
    const table = this.scale.table;
    for (let j = 0; j < size; ++j)
      for (let i = 0; i < size; ++i) {
        const x = (i + 0.5 - cx) / radius, y = (cy - j - 0.5) / radius;
        const rest = 1 - x * x - y * y;
        if (rest < 0) continue;
        const z = Math.sqrt(rest);
        const p = [0, 1, 2].map((k) => x * right[k] + y * up[k] + z * towards[k]);
        const k = this.nearest.at(p);
        if (k < 0 || this.place[k] < 0) continue;
        const at = 4 * (j * size + i), color = 3 * this.place[k];
        picture.data[at] = table[color];
        picture.data[at + 1] = table[color + 1];
        picture.data[at + 2] = table[color + 2];
        picture.data[at + 3] = 255;
      }
    context.putImageData(picture, 0, 0);
    const flat = (p) => [cx + radius * dot(p, right), cy - radius * dot(p, up)];
    const visible = (p) => dot(p, towards) > -1e-3;
    this.paintGrid(context, ratio, style, flat, visible, radius, right);
    this.paintMarks(context, ratio, style, flat, visible, radius);
  }
  paintGrid(context, ratio, style, flat, visible, radius, right) {
    context.lineWidth = ratio;
    context.strokeStyle = style.getPropertyValue("--dome-grid");
    const line = (points) => {
      context.beginPath();
      let on = false;
      for (const p of points) {
        if (visible(p)) context[on ? "lineTo" : "moveTo"](...flat(p));
        on = visible(p);
      }
      context.stroke();
    };
    const steps = Array.from({ length: 121 }, (_, k) => k / 120);
    for (const elevation of [0, 30, 60]) line(steps.map((s) => direction(360 * s, elevation)));
    for (let azimuth = 0; azimuth < 360; azimuth += 30) line(steps.map((s) => direction(azimuth, 75 * s)));
    context.fillStyle = style.color;
    context.font = `${11 * ratio}px ${style.fontFamily}`;
    context.textBaseline = "middle";
    for (const [name, azimuth] of [["bow", 0], ["starboard", 90], ["stern", 180], ["port", 270]]) {
      const p = direction(azimuth, 0);
      if (!visible(p)) continue;
      const [x, y] = flat(p.map((v) => 1.09 * v));
      // Beside the dome where there is room; never cut off, and readable on any colour.
      const side = dot(p, right), wide = context.measureText(name).width;
      const begin = side > 0.4 ? x - 0.05 * radius : side < -0.4 ? x + 0.05 * radius - wide : x - wide / 2;
      const at = Math.min(this.canvas.width - wide - 2, Math.max(2, begin));
      context.strokeStyle = style.getPropertyValue("--panel");
      context.lineWidth = 3 * ratio;
      context.strokeText(name, at, y);
      context.fillText(name, at, y);
    }
  }
  paintMarks(context, ratio, style, flat, visible, radius) {
    const dense = radius * Math.sqrt(6 / this.points.length) < 9 * ratio;
    context.fillStyle = "rgb(255 255 255 / 75%)";
    context.strokeStyle = "rgb(0 0 0 / 75%)";
    context.lineWidth = 0.7 * ratio;
    if (!dense)
      for (const p of this.points) {
        if (!visible(p)) continue;
        context.beginPath();
        context.arc(...flat(p), 1.8 * ratio, 0, 7);
        context.fill();
        context.stroke();
      }
    const p = this.points[this.chosen];
    if (!p || !visible(p)) return;
    for (const [color, width] of [["#000000", 5], ["#ffffff", 2.5]]) {
      context.strokeStyle = color;
      context.lineWidth = width * ratio;
      context.beginPath();
      context.arc(...flat(p), 7 * ratio, 0, 7);
      context.stroke();
    }
  }

  // The viewpoint under the pointer; -1: none.
  under(event) {
    const box = this.canvas.getBoundingClientRect();
    const { towards, up, right } = this.axes();
    const { radius, x: cx, y: cy } = this.geometry(box.width);
    const x = (event.clientX - box.left - cx) / radius, y = (cy - event.clientY + box.top) / radius;
    const rest = 1 - x * x - y * y;
    if (rest < 0 || !this.nearest) return -1;
    return this.nearest.at([0, 1, 2].map((k) => x * right[k] + y * up[k] + Math.sqrt(rest) * towards[k]));
  }
  listen() {
    let from = null;
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, y: event.clientY, turn: { ...this.turn }, moved: false };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return this.on.hover(this.under(event));
      const dx = event.clientX - from.x, dy = event.clientY - from.y;
      if (!from.moved && Math.hypot(dx, dy) < 5) return undefined;
      from.moved = this.dragging = true;
      const perPixel = 150 / (canvas.clientWidth * from.turn.zoom);
      return this.look(from.turn.azimuth + dx * perPixel, from.turn.elevation + dy * perPixel, from.turn.zoom);
    });
    const end = (event) => {
      const was = from;
      from = null;
      this.dragging = false;
      if (!was) return;
      if (was.moved) {
        this.paint();
        this.on.turn();
      } else if (event.type === "pointerup") {
        const k = this.under(event);
        if (k >= 0) this.on.choose(k);
      }
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("pointerleave", () => this.on.hover(-1));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }
  key(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { azimuth, elevation, zoom } = this.turn;
    if (step && event.shiftKey) this.look(azimuth - 10 * step[0], elevation + 10 * step[1], zoom);
    else if (step) this.on.choose(this.next(step));
    else if (event.key === "+" || event.key === "=") this.look(azimuth, elevation, zoom * 1.3);
    else if (event.key === "-") this.look(azimuth, elevation, zoom / 1.3);
    else return;
    event.preventDefault();
    if (!step || event.shiftKey) this.on.turn();
  }
  // The nearest viewpoint to that side of the chosen one, on the screen.
  next([dx, dy]) {
    const { towards, up, right } = this.axes();
    const here = this.points[this.chosen];
    if (!here) return 0;
    let best = this.chosen, least = Infinity;
    this.points.forEach((p, k) => {
      if (dot(p, towards) < -0.05) return;
      const x = dot(p, right) - dot(here, right), y = dot(p, up) - dot(here, up);
      const along = x * dx + y * dy, across = Math.abs(x * dy) + Math.abs(y * dx);
      if (along > 1e-6 && along >= 0.8 * across && along * along + 4 * across * across < least)
        [best, least] = [k, along * along + 4 * across * across];
    });
    return best;
  }
}
