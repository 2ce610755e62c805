// Frames as the server sends them, and how they are painted.

// float16 by its bits.
const HALF = new Float32Array(65536);
for (let i = 0; i < 65536; ++i) {
  const sign = i & 0x8000 ? -1 : 1, exponent = (i >> 10) & 31, fraction = i & 1023;
  HALF[i] = exponent === 0 ? sign * fraction * 2 ** -24
    : exponent === 31 ? (fraction ? NaN : sign * Infinity) : sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

export function decode(buffer) {
  const view = new DataView(buffer), width = view.getUint32(4, true), height = view.getUint32(8, true);
  const pixels = width * height, scale = view.getFloat32(16, true);
  const halves = new Uint16Array(buffer, 64, pixels), radiance = new Float32Array(pixels);
  for (let i = 0; i < pixels; ++i) radiance[i] = scale * HALF[halves[i]];
  return { width, height, radiance, error: new Uint8Array(buffer, 64 + 2 * pixels, pixels),
    state: view.getUint32(12, true), ms: view.getFloat32(20, true), low: view.getFloat32(24, true),
    high: view.getFloat32(28, true), edges: view.getFloat32(32, true),
    gain: view.getFloat32(36, true), offset: view.getFloat32(40, true) };  // counts; gain 0: radiance
}

// A stated error relative to the radiance; null: the pixel lies on an edge.
export const relativeError = (byte) => (byte === 255 ? null : 1e-4 * 10 ** ((byte * 4) / 254));

const INFERNO = ["#000004", "#210c4a", "#570f6d", "#8a226a", "#bc3754", "#e45a31", "#f98e09", "#f9cb35", "#fcffa4"];
function table(nodes) {
  const rgb = nodes.map((c) => [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16)));
  const out = new Uint32Array(256);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (rgb.length - 1), k = Math.min(Math.floor(at), rgb.length - 2);
    const c = [0, 1, 2].map((j) => Math.round(rgb[k][j] + (at - k) * (rgb[k + 1][j] - rgb[k][j])));
    out[i] = (255 << 24) | (c[2] << 16) | (c[1] << 8) | c[0];
  }
  return out;
}
export const PALETTES = { "white hot": table(["#000000", "#ffffff"]), "black hot": table(["#ffffff", "#000000"]), inferno: table(INFERNO) };

// The middle 99.5 % of the radiances.
export function scaleOf(frame) {
  const sorted = Float32Array.from(frame.radiance.filter((v, i) => i % 7 === 0)).sort();
  const at = (f) => sorted[Math.round(f * (sorted.length - 1))];
  const low = at(0.0025), high = at(0.9975);
  return { low, high: high > low ? high : low + 1e-6 + Math.abs(low) * 1e-3 };
}

export function paint(canvas, frame, palette, scale, errors) {
  if (canvas.width !== frame.width || canvas.height !== frame.height) {
    canvas.width = frame.width;
    canvas.height = frame.height;
  }
  const context = canvas.getContext("2d"), image = context.createImageData(frame.width, frame.height);
  const out = new Uint32Array(image.data.buffer), colors = PALETTES[palette], per = 255 / (scale.high - scale.low);
  for (let i = 0; i < out.length; ++i) {
    const v = errors ? frame.error[i] : (frame.radiance[i] - scale.low) * per;
    out[i] = errors && v === 255 ? 0xffff8000 : colors[v < 0 ? 0 : v > 255 ? 255 : v | 0];
  }
  context.putImageData(image, 0, 0);
}
