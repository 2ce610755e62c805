// The bar beneath a picture: its colours from the lowest value to the highest, with round numbers.
import { svg } from "./draw.js";
import { displayUnit, tickLabels, ticks } from "./numbers.js";

const WITHOUT_PREFIX = ["σ", "%", "K", "counts"];

// scale: a ColorScale; open: the last colour also stands for what is above; second: further numbers
// below, of a quantity that the first determines: {unit, at, labels}.
export function colorBar(scale, plain, open = false, second = null) {
  const width = 400, { unit, factor } = WITHOUT_PREFIX.includes(plain) ? { unit: plain, factor: 1 } : displayUnit(Math.max(Math.abs(scale.low), Math.abs(scale.high)), plain);
  const at = ticks(scale.low, scale.high, 5), labels = tickLabels(at, factor);
  const words = open ? `${unit} or more` : unit, long = width - Math.max(open ? 104 : 80, 34 + 7 * words.length);
  const x = (v) => 24 + long * (v - scale.low) / (scale.high - scale.low);
  const steps = Array.from({ length: 64 }, (_, k) => svg("rect", { x: 24 + long * k / 64, y: 2, width: long / 64 + 0.5, height: 12, fill: scale.css(Math.round(255 * k / 63)) }));
  return svg("svg", { viewBox: `0 0 ${width} ${second ? 52 : 34}`, class: "plot", role: "img", "aria-label": `Colours from ${labels[0]} to ${labels.at(-1)} ${words}` },
    ...steps, ...at.map((v, k) => svg("text", { class: "middle", x: x(v), y: 29 }, labels[k])), svg("text", { x: 30 + long, y: 13 }, words),
    ...(second ? [...second.at.map((v, k) => svg("text", { class: "middle", x: x(v), y: 47 }, second.labels[k])), svg("text", { x: 30 + long, y: 47 }, second.unit)] : []));
}
