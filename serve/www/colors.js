// Colours that the common colour-vision deficiencies keep apart: those of the program's own plots
// ("inferno" of matplotlib, 9 nodes; Okabe and Ito), and a diverging one from blue to orange.

const INFERNO = ["#000004", "#210c4a", "#570f6d", "#8a226a", "#bc3754", "#e45a31", "#f98e09", "#f9cb35", "#fcffa4"];
const DIVERGING = ["#08306b", "#2171b5", "#6baed6", "#c6dbef", "#f2f2f2", "#fdd0a2", "#fd8d3c", "#d94801", "#7f2704"];

function table(nodes) {
  const rgb = nodes.map((c) => [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16)));
  const out = new Uint8Array(256 * 3);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (rgb.length - 1);
    const k = Math.min(Math.floor(at), rgb.length - 2);
    for (let c = 0; c < 3; ++c) out[3 * i + c] = Math.round(rgb[k][c] + (at - k) * (rgb[k + 1][c] - rgb[k][c]));
  }
  return out;
}
const TABLES = { sequential: table(INFERNO), diverging: table(DIVERGING), grey: table(["#000000", "#ffffff"]) };

// From a value to one of 256 colours; `table` holds them as red, green, blue.
export class ColorScale {
  constructor(low, high, kind = "sequential") {
    this.low = low;
    this.high = high > low ? high : low + 1;
    this.table = TABLES[kind];
  }
  place(value) {
    const fraction = (value - this.low) / (this.high - this.low);
    return Math.round(255 * Math.min(1, Math.max(0, fraction)));
  }
  css(place) {
    return `rgb(${this.table[3 * place]} ${this.table[3 * place + 1]} ${this.table[3 * place + 2]})`;
  }
}

// From 0 unless that would waste half of the colours; around 0 for differences. upto: what is above
// has the last colour.
export function scaleOf(values, { around0 = false, upto = Infinity } = {}) {
  let low = Infinity, high = -Infinity;
  for (const v of values) {
    if (v === null) continue;
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  if (low > high) return new ColorScale(0, 1);
  high = Math.max(low, Math.min(high, upto));
  if (around0) {
    const reach = Math.max(3, Math.abs(low), Math.abs(high));
    return new ColorScale(-reach, reach, "diverging");
  }
  // A value that is the same everywhere gives one colour, on a scale that begins or ends at 0.
  if (high - low <= 1e-6 * Math.max(Math.abs(low), Math.abs(high))) return new ColorScale(Math.min(0, low), Math.max(0, high));
  if (low > 0 && low < 0.5 * high) low = 0;
  return new ColorScale(low, high);
}
