// The spectrum of a row with its band of two standard errors, what it is made of below it, and the
// row that it is compared with.
import { path, svg } from "./draw.js";
import { brief, displayUnit, tickLabels, ticks } from "./numbers.js";
import { nearest, readOut } from "./readout.js";

const WIDTH = 560, HEIGHT = 320, LEFT = 58, RIGHT = 10, TOP = 26, BOTTOM = 40;
export const CAUSES = [
  ['emitted', 'emitted'], ['sun_reflected', 'sun reflected'], ['sky_reflected', 'sky reflected'],
  ['surface_reflected', 'sea reflected'], ['interreflected', 'other parts reflected']
];

const band = (x, value, error) => path([
  ...value.map((v, k) => [x[k], v + 2 * error[k]]), ...value.map((v, k) => [x[k], v - 2 * error[k]]).reverse()]) + "Z";

export function causesOf(spectrum) {
  return CAUSES.map(([id, name]) => ({ id, name, value: spectrum[`spectral_${id}_w_sr_um`] ?? [] }))
    .filter((c) => c.value.some((v) => v !== 0));
}

// a: of the row; b: of the other one, or null. stacked: whether the causes add up to what is shown.
export function drawSpectrum(a, b, stacked, readout) {
  const reach = [a, b].filter(Boolean);
  let low = 0, high = 0;
  for (const s of reach)
    s.value.forEach((v, k) => {
      high = Math.max(high, v + 2 * s.value_stderr[k]);
      if (v < 0) low = Math.min(low, v - 2 * s.value_stderr[k]);
    });
  if (high <= low) high = low + 1;
  const lambda = reach.flatMap((s) => s.lambda_um);
  const left = Math.min(...lambda), right = Math.max(...lambda);
  const yTicks = ticks(low, high * 1.04, 5), xTicks = ticks(left, right, 7);
  const bottom = Math.min(low, yTicks[0]), top = Math.max(high * 1.04, yTicks.at(-1));
  const X = (l) => LEFT + ((l - left) / (right - left || 1)) * (WIDTH - LEFT - RIGHT);
  const Y = (v) => HEIGHT - BOTTOM - ((v - bottom) / (top - bottom)) * (HEIGHT - TOP - BOTTOM);
  const { unit, factor } = displayUnit(Math.max(high, -low), a.unit);
  const flat = (s) => s.lambda_um.map(X);

  const parts = [];
  xTicks.forEach((t, k) => parts.push(svg("line", { class: "grid", x1: X(t), x2: X(t), y1: TOP, y2: HEIGHT - BOTTOM }),
    svg("text", { class: "middle", x: X(t), y: HEIGHT - BOTTOM + 17 }, tickLabels(xTicks)[k])));
  yTicks.forEach((t, k) => parts.push(svg("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: Y(t), y2: Y(t) }),
    svg("text", { class: "end", x: LEFT - 6, y: Y(t) + 4 }, tickLabels(yTicks, factor)[k])));
  const inside = [];  // of the axes, whatever the errors are
  if (stacked) {
    let below = a.value.map(() => 0);
    for (const cause of causesOf(a)) {
      const above = below.map((v, k) => v + cause.value[k]);
      const x = flat(a);
      inside.push(svg("path", { class: `cause ${cause.id}`, "data-cause": cause.id,
        d: path([...above.map((v, k) => [x[k], Y(v)]), ...below.map((v, k) => [x[k], Y(v)]).reverse()]) + "Z" }));
      below = above;
    }
  }
  reach.forEach((s, k) => {
    const name = "ab"[k], x = flat(s), scale = (HEIGHT - TOP - BOTTOM) / (top - bottom);
    inside.push(svg("path", { class: `band ${name}`, d: band(x, s.value.map(Y), s.value_stderr.map((e) => e * scale)) }),
      svg("path", { class: `curve ${name}`, d: path(s.value.map((v, i) => [x[i], Y(v)])) }));
  });
  parts.push(svg("clipPath", { id: "spectrum-inside" }, svg("rect", { x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM })),
    svg("g", { "clip-path": "url(#spectrum-inside)" }, ...inside));
  const cross = svg("line", { class: "cross", y1: TOP, y2: HEIGHT - BOTTOM, x1: -9, x2: -9 });
  const summary = `${a.title} from ${brief(left)} to ${brief(right)} µm, greatest ${brief(Math.max(...a.value) * factor)} ${unit}`;
  const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "plot", role: "img", "aria-label": summary },
    ...parts, svg("text", { x: LEFT, y: 14 }, `${a.title} in ${unit}`),
    svg("text", { class: "middle", x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 5 }, "Wavelength in µm"), cross);
  // B is read at the wavelength nearest to that of A.
  return readOut(picture, {
    first: a.value.indexOf(Math.max(...a.value)),
    at: (x) => nearest(a.lambda_um.length, (k) => Math.abs(X(a.lambda_um[k]) - x)),
    step: (k, dx, dy) => Math.min(a.lambda_um.length - 1, Math.max(0, k + dx + dy)),
    say: (place) => {
      const um = a.lambda_um[place];
      for (const end of ["x1", "x2"]) cross.setAttribute(end, X(um));
      readout.textContent = reach.map((s, i) => {
        const k = nearest(s.lambda_um.length, (j) => Math.abs(s.lambda_um[j] - um));
        return `${reach.length > 1 ? `${"AB"[i]} ` : ""}${brief(s.lambda_um[k])} µm: ${brief(s.value[k] * factor)} ± ${brief(s.value_stderr[k] * factor, 2)} ${unit}`;
      }).join("; ");
    },
  });
}

// Which colour is what.
export function legend(entries) {
  const list = document.createElement("ul");
  list.className = "legend";
  for (const [name, text] of entries) {
    const item = document.createElement("li");
    const swatch = document.createElement("span");
    swatch.className = `swatch ${name}`;
    item.append(swatch, text);
    list.append(item);
  }
  return list;
}
