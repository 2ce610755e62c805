// Values all around the target at one elevation, bow up, starboard to the right.
import { path, svg } from "./draw.js";
import { brief, degrees, displayUnit, tickLabels, ticks } from "./numbers.js";
import { nearest, readOut } from "./readout.js";

const SIZE = 400, CENTER = SIZE / 2, RADIUS = 155;
const RAD = Math.PI / 180;

// cuts: one or two answers of /api/cut; azimuth: of the chosen viewpoint, or null.
export function drawCut(cuts, azimuth, readout) {
  let low = 0, high = 0;
  for (const cut of cuts)
    for (const points of [cut.point, cut.mark])
      points.value.forEach((v, k) => {
        high = Math.max(high, v + 2 * points.error[k]);
        if (v < 0) low = Math.min(low, v - 2 * points.error[k]);
      });
  if (high <= low) high = low + 1;
  const rings = ticks(low, high, 4);
  const bottom = Math.min(low, rings[0]), top = Math.max(high, rings.at(-1));
  const { unit, factor } = displayUnit(Math.max(high, -low), cuts[0].unit);
  const at = (angle, value) => {
    const r = RADIUS * Math.max(0, (value - bottom) / (top - bottom));
    return [CENTER + r * Math.sin(angle * RAD), CENTER - r * Math.cos(angle * RAD)];
  };
  const parts = [];
  for (const ring of rings)
    if (ring > bottom) parts.push(svg("circle", { class: ring === 0 ? "zero" : "grid", cx: CENTER, cy: CENTER, r: RADIUS * (ring - bottom) / (top - bottom) }));
  for (let angle = 0; angle < 360; angle += 30) {
    const [x, y] = at(angle, top), [lx, ly] = [CENTER + (RADIUS + 20) * Math.sin(angle * RAD), CENTER - (RADIUS + 17) * Math.cos(angle * RAD) + 4];
    const side = { 0: " bow", 180: " stern" }[angle] ?? "";
    parts.push(svg("line", { class: "grid", x1: CENTER, y1: CENTER, x2: x, y2: y }), svg("text", { class: "middle", x: lx, y: ly }, `${angle}°${side}`));
  }
  cuts.forEach((cut, k) => {
    const name = "ab"[k], { point, mark } = cut;
    const edge = (sign) => point.azimuth_deg.map((a, i) => at(a, point.value[i] + sign * 2 * point.error[i]));
    if (cut.interpolated && point.value.length > 2)
      parts.push(svg("path", { class: `band ${name}`, "fill-rule": "evenodd", d: `${path(edge(1))}Z${path(edge(-1))}Z` }));
    parts.push(svg("path", { class: `curve ${name}`, d: `${path(point.azimuth_deg.map((a, i) => at(a, point.value[i])))}Z` }));
    mark.azimuth_deg.forEach((a, i) => {
      const [x1, y1] = at(a, mark.value[i] - 2 * mark.error[i]), [x2, y2] = at(a, mark.value[i] + 2 * mark.error[i]), [cx, cy] = at(a, mark.value[i]);
      parts.push(svg("line", { class: `curve ${name}`, x1, y1, x2, y2 }), svg("circle", { class: `mark ${name}`, cx, cy, r: 3 }));
    });
  });
  const labels = tickLabels(rings, factor);
  rings.forEach((ring, k) => {
    if (ring <= bottom) return;
    const [x, y] = at(15, ring);
    parts.push(svg("text", { class: "middle halo", x, y: y + 4 }, labels[k]));
  });
  if (azimuth !== null) {
    const [x, y] = at(azimuth, top);
    parts.push(svg("line", { class: "cross", x1: CENTER, y1: CENTER, x2: x, y2: y }));
  }
  const summary = `${cuts[0].title} around the target at elevation ${degrees(cuts[0].elevation_deg)}, greatest ${brief(Math.max(...cuts[0].point.value) * factor)} ${unit}`;
  const here = svg("circle", { class: "here", cx: -9, cy: -9, r: 5 });
  const picture = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, class: "plot round", role: "img", "aria-label": summary },
    ...parts, svg("text", { x: 2, y: 13 }, `in ${unit}`), here);
  // B is read at the direction nearest to the azimuth of A.
  const along = cuts[0].point.azimuth_deg;
  const towards = (azimuths, angle) => nearest(azimuths.length, (k) => Math.abs(((azimuths[k] - angle + 540) % 360) - 180));
  return readOut(picture, {
    first: towards(along, azimuth ?? 0),
    at: (x, y) => towards(along, (Math.atan2(x - CENTER, CENTER - y) / RAD + 360) % 360),
    step: (k, dx, dy) => (((k + dx + dy) % along.length) + along.length) % along.length,
    say: (place) => {
      const [cx, cy] = at(along[place], cuts[0].point.value[place]);
      here.setAttribute("cx", cx);
      here.setAttribute("cy", cy);
      readout.textContent = cuts.map(({ point }, i) => {
        const k = towards(point.azimuth_deg, along[place]);
        return `${cuts.length > 1 ? `${"AB"[i]} ` : ""}${degrees(point.azimuth_deg[k])}: ${brief(point.value[k] * factor)} ± ${brief(point.error[k] * factor, 2)} ${unit}`;
      }).join("; ");
    },
  });
}
