// The stored image of a row: its pixels, their standard errors, and which part each pixel shows.
import { ask, askBytes } from "./api.js";
import { decodeExr } from "./exr.js";

const TARGET = { name: "", unit: "W/(m2 sr)", what: "radiance at the target, without the air" };
// Layers whose every pixel counts: the others are of the target alone.
const WHOLE_FRAME = ["counts", "at_sensor", "background", "path", "land_emitted", "land_sky",
  "land_sun", "without_air", "land_temperature", "gas_emitted", "gas_absorbed"];
const MEANS = ["temperature", "range", "normal_x", "normal_y", "normal_z", "sunlit"];
export const isWholeFrame = ({ layer }) => WHOLE_FRAME.includes(layer.name);

// Counts of rays as /api/silhouette.json packs them: per pixel the fraction that the target fills,
// and the part that most rays meet, counted from 1, with the number of its rays.
function partsOf(answer, count) {
  const filled = new Uint32Array(count), part = new Uint16Array(count), rays = new Uint16Array(count);
  answer.part.forEach(({ run }, p) => {
    for (let k = 0, at = 0; k < run.length; k += 3) {
      at += run[k];
      for (const end = at + run[k + 1]; at < end; ++at) {
        filled[at] += run[k + 2];
        if (run[k + 2] <= rays[at]) continue;
        part[at] = p + 1;
        rays[at] = run[k + 2];
      }
    }
  });
  const fraction = new Float32Array(filled);
  for (let k = 0; k < count; ++k) fraction[k] /= answer.pixel_samples;
  return { fraction, part, rays, names: answer.part.map((p) => p.name), samples: answer.pixel_samples };
}

// Counts of [imager] of the sweep, on the camera's pixels.
const countsLayer = ({ name, ...more }) => ({ ...more, name: "counts", unit: "counts", stderr: false, what: `counts of ${name}, ${more.bits} bits` });

// row: {db, sweep, row}; layer: its name; "radiance" for the target's, which also stands in for a
// layer that the row has not; "" for counts where the sweep has an imager, else for that radiance.
// An Error says in words why there is no image.
export async function askImage(row, layer) {
  const info = await ask("api/image.json", row);
  const counts = info.counts.map(countsLayer), wanted = layer === "" && counts.length > 0 ? "counts" : layer;
  const layers = [{ ...TARGET, stderr: info.stderr, command: info.command }, ...counts, ...info.layer];
  const chosen = layers.find((l) => l.name === wanted) ?? layers[0];
  const frame = chosen.width_px ? chosen : info;
  const size = { width: frame.width_px, height: frame.height_px, pixelRad: frame.pixel_rad };
  const pixels = async (more) => {
    try {
      return await decodeExr(await askBytes("api/image.exr", { ...row, layer: chosen.name, ...more }), size);
    } catch (error) {
      throw error.fromServer ? error : new Error(`The stored image of row ${row.row} cannot be shown: ${error.message}.`);
    }
  };
  const [value, stderr, silhouette] = await Promise.all([pixels({}), chosen.stderr ? pixels({ stderr: "1" }) : null, ask("api/silhouette.json", chosen.name === "counts" ? { ...row, layer: "counts" } : row)]);
  return { ...size, info, layers, layer: chosen, value, stderr, parts: partsOf(silhouette, value.length) };
}

// Returns true if a pixel is painted: it shows a part of the target, or light of the target's gas.
export const isShown = (picture, k) => picture.shown ? picture.shown[k] === 1 : isWholeFrame(picture) || picture.parts.fraction[k] > 0 || picture.value[k] !== 0;

// Values that the colours are for: where the target fills at least half of a pixel, unless it is
// smaller than that everywhere; its gas beside it; of the whole frame all.
export function valuesOf(picture) {
  const { value, parts } = picture, { fraction } = parts;
  if (picture.shown) return Array.from(value.filter((_, k) => picture.shown[k]));
  const least = fraction.some((f) => f >= 0.5) ? 0.5 : Number.MIN_VALUE;
  const all = isWholeFrame(picture), step = Math.ceil(value.length / 1e6);
  const out = [];
  for (let k = 0; k < value.length; k += step)
    if (all || fraction[k] >= least || (fraction[k] === 0 && value[k] !== 0)) out.push(value[k]);
  return out;
}

// The radiance of which an apparent temperature is known, and of what it is: the value itself, or,
// of a target without gas, what it sends from the fraction that it fills. null: of a single cause.
export function radianceOf({ layer, info, value, parts }, k) {
  if (layer.name === "counts") return { of: "", radiance: (value[k] - layer.offset_counts) / layer.counts_per_w_m2_sr };
  if (layer.name === "at_sensor" || (layer.name === "" && info.gas)) return { of: "", radiance: value[k] };
  return layer.name === "" && parts.fraction[k] > 0 ? { of: " of the target", radiance: value[k] / parts.fraction[k] } : null;
}

// Returns true for layers in which a pixel without target has no value.
export const isMean = ({ layer }) => MEANS.includes(layer.name);

export const canSubtract = (a, b) => a.width === b.width && a.height === b.height && a.pixelRad === b.pixelRad;

// The picture of B − A; the parts are those of A. The errors of both are taken as independent.
export function differenceOf(a, b) {
  const shown = Uint8Array.from(a.value, (_, k) => (isMean(a) ? isShown(a, k) && isShown(b, k) : isShown(a, k) || isShown(b, k)));
  const stderr = a.stderr && b.stderr ? a.stderr.map((e, k) => Math.hypot(e, b.stderr[k])) : null;
  return { ...a, value: b.value.map((v, k) => (shown[k] ? v - a.value[k] : 0)), stderr, shown };
}
