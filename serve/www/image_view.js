// Paints one or two images of rows on one colour scale, and says what a pixel holds.
import { bandTemperature, kelvinTicks } from "./band_temperature.js";
import { colorBar } from "./color_bar.js";
import { ColorScale } from "./colors.js";
import { isMean, isShown, radianceOf, valuesOf } from "./image.js";
import { brief, withError } from "./numbers.js";
import { readOut } from "./readout.js";

const LONG_SIDE = 720;  // of the canvas, whose pixels are squares of it
const unitOf = ({ layer }) => (layer.unit === "1" ? "" : layer.unit.replace("m2", "m²"));

// Temperatures of blackbodies that fill a pixel, beside radiances or counts. null: of other values.
function kelvinOf({ layer, info, shown }, { low, high }) {
  if (shown || !["", "at_sensor", "counts"].includes(layer.name) || info.plain_band_um.length !== 2) return null;
  const gain = layer.counts_per_w_m2_sr ?? 1, offset = layer.offset_counts ?? 0;
  return kelvinTicks(info.plain_band_um, (low - offset) / gain, (high - offset) / gain, (radiance) => gain * radiance + offset);
}

// From the 1st to the 99th percentile, so that few hot pixels leave the others their colours; of
// values that are alike, from the smallest to the largest.
function rangeOfMost(pictures) {
  const sorted = Float32Array.from(pictures.flatMap(valuesOf)).sort();
  if (sorted.length === 0) return [0, 1];
  const tail = Math.floor(sorted.length / 100), low = sorted[tail], high = sorted[sorted.length - 1 - tail];
  return tail > 0 && low < high ? [low, high] : [sorted[0], sorted[sorted.length - 1]];
}

// As far below 0 as above it: to the 99th percentile of the magnitudes.
function rangeAroundZero(picture) {
  const sorted = Float32Array.from(valuesOf(picture), Math.abs).sort();
  const reach = sorted[sorted.length - 1 - Math.floor(sorted.length / 100)] || sorted[sorted.length - 1] || 1;
  return [-reach, reach];
}

function painted(picture, scale) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height];
  const context = canvas.getContext("2d"), pixels = context.createImageData(picture.width, picture.height);
  picture.value.forEach((value, k) => {
    if (!isShown(picture, k)) return;
    const color = 3 * scale.place(value);
    for (let c = 0; c < 3; ++c) pixels.data[4 * k + c] = scale.table[color + c];
    pixels.data[4 * k + 3] = 255;
  });
  context.putImageData(pixels, 0, 0);
  return canvas;
}

// Lines between pixels of different parts; one that the target fills less than half is of none.
function outlines({ width, height, parts }) {
  const least = parts.fraction.some((f) => f >= 0.5) ? 0.5 : 0;
  const of = (x, y) => (x < 0 || y < 0 || x >= width || y >= height || parts.fraction[y * width + x] < least ? 0 : parts.part[y * width + x]);
  const out = new Path2D();
  const line = (x, y, right, down) => {
    out.moveTo(x, y);
    out.lineTo(x + right, y + down);
  };
  for (let y = 0; y <= height; ++y)
    for (let x = 0; x <= width; ++x) {
      if (of(x, y) !== of(x - 1, y)) line(x, y, 0, 1);
      if (of(x, y) !== of(x, y - 1)) line(x, y, 1, 0);
    }
  return out;
}

export class ImageView {
  // figure: has two canvases, a .scale and a .readout.
  constructor(figure) {
    this.canvases = [...figure.querySelectorAll("canvas")];
    this.bar = figure.querySelector(".scale");
    this.readout = figure.querySelector(".readout");
    this.pictures = [];
    this.place = null;  // [column, row]
    const at = (which) => (x, y) => {
      const picture = this.pictures[which], canvas = this.canvases[which];
      return [Math.floor(x / canvas.width * picture.width), Math.floor(y / canvas.height * picture.height)];
    };
    const step = (_, dx, dy) => {
      const [x, y] = this.place ?? this.brightest();
      return [x + dx, y - dy];
    };
    this.canvases.forEach((canvas, which) => readOut(canvas, { first: null, at: at(which), step, say: (place) => this.say(place ?? this.place ?? this.brightest()) }));
  }

  // pictures: of image.js, one or two of one layer, or one difference; names: how they are told apart, [""] for one.
  show(pictures, { names, labels, grey, withOutlines }) {
    Object.assign(this, { pictures, names });
    this.scale = pictures[0].shown ? new ColorScale(...rangeAroundZero(pictures[0]), "diverging") : new ColorScale(...rangeOfMost(pictures), grey ? "grey" : "sequential");
    this.pixels = pictures.map((p) => painted(p, this.scale));
    this.lines = pictures.map((p) => (withOutlines ? outlines(p) : null));
    this.canvases.forEach((canvas, k) => {
      canvas.parentElement.hidden = !pictures[k];
      if (!pictures[k]) return;
      const { width, height } = pictures[k], factor = Math.max(1, Math.floor(LONG_SIDE / Math.max(width, height)));
      [canvas.width, canvas.height] = [width * factor, height * factor];
      canvas.setAttribute("aria-label", `${labels[k]}; arrows go from pixel to pixel, with shift ten at a time`);
    });
    this.bar.replaceChildren(colorBar(this.scale, unitOf(pictures[0]), false, kelvinOf(pictures[0], this.scale)));
    if (this.place) this.say(this.place);
    else this.readout.textContent = "A pixel is read out under the pointer, or with the arrow keys.";
    this.paint();
  }

  brightest() {
    const { value, width } = this.pictures[0];
    let best = 0;
    value.forEach((v, k) => {
      if (Math.abs(v) > Math.abs(value[best])) best = k;
    });
    return [best % width, Math.floor(best / width)];
  }

  say([x, y]) {
    const { width, height } = this.pictures[0];
    const [column, row] = this.place = [Math.min(width - 1, Math.max(0, x)), Math.min(height - 1, Math.max(0, y))];
    const words = this.pictures.map((p, k) => (column < p.width && row < p.height ? `${this.names[k]}${this.wordsOf(p, row * p.width + column)}` : `${this.names[k]}no such pixel`));
    this.readout.textContent = `Column ${column}, row ${row}: ${words.join("; ")}`;
    this.paint();
  }
  wordsOf(picture, k) {
    const { value, stderr, parts, info } = picture, shows = parts.part[k] > 0, difference = Boolean(picture.shown);
    const what = shows ? `${parts.names[parts.part[k] - 1]} (${parts.rays[k]} of ${parts.samples} rays)` : "nothing of the target";
    if (difference && !isShown(picture, k)) return "nothing of the target in one of them";
    if (isMean(picture) && !shows) return what;
    const out = [stderr ? withError(value[k], stderr[k], unitOf(picture)) : `${brief(value[k])} ${unitOf(picture)}`.trimEnd()];
    if (difference && stderr?.[k] > 0) out.push(`${brief(value[k] / stderr[k], 3)} σ`);
    const seen = difference ? null : radianceOf(picture, k);
    if (seen && picture.layer.name === "counts") out.push(`${brief(seen.radiance)} W/(m² sr)`);
    const kelvin = seen && info.plain_band_um.length === 2 && bandTemperature(info.plain_band_um, seen.radiance);
    if (kelvin) out.push(`apparent temperature${seen.of} ${brief(kelvin)} K`);
    return [...out, what].join(", ");
  }

  paint() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.pictures.forEach((_, k) => this.paintNow(k));
    });
  }
  paintNow(which) {
    const canvas = this.canvases[which], context = canvas.getContext("2d"), { width } = this.pictures[which], factor = canvas.width / width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.pixels[which], 0, 0, canvas.width, canvas.height);
    context.scale(factor, factor);
    const mark = new Path2D();
    if (this.place) mark.rect(...this.place, 1, 1);
    for (const [color, wide] of [["rgb(0 0 0 / 75%)", 3], ["#ffffff", 1]]) {
      context.strokeStyle = color;
      context.lineWidth = wide * Math.max(1, canvas.width / (canvas.clientWidth || canvas.width)) / factor;
      if (this.lines[which]) context.stroke(this.lines[which]);
      context.stroke(mark);
    }
  }
}
