// Numbers and units as people read them.

// Five digits: as many as differ between neighbours, and fewer than anybody copies.
export function brief(value, digits = 5) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return value.toExponential(digits - 1).replace("e+", "e").replace("-", "−");
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

export const withError = (value, error, unit) => `${brief(value)} ± ${brief(error, 2)} ${unit}`.trim();

// "kW/sr" and 1e-3 for values up to `largest` W/sr.
export function displayUnit(largest, unit) {
  const size = Math.abs(largest);
  for (const [prefix, factor] of [["G", 1e9], ["M", 1e6], ["k", 1e3]])
    if (size >= 2 * factor) return { unit: prefix + unit, factor: 1 / factor };
  if (size > 0 && size < 0.2) return { unit: (size < 2e-4 ? "µ" : "m") + unit, factor: size < 2e-4 ? 1e6 : 1e3 };
  return { unit, factor: 1 };
}

// About `count` round numbers from low to high.
export function ticks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((s) => s * power).find((s) => s >= rough * 0.999) || 10 * power;
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) out.push(k * step);
  return out;
}

// All with the same number of decimals.
export function tickLabels(values, factor = 1) {
  const shown = values.map((v) => v * factor);
  const step = shown.length > 1 ? Math.abs(shown[1] - shown[0]) : Math.abs(shown[0]) || 1;
  let decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) ++decimals;
  return shown.map((v) => v.toFixed(Math.min(decimals, 6)).replace("-", "−"));
}

export const degrees = (value) => `${Number(value.toFixed(2))}°`.replace("-", "−");
export const aspectText = (azimuth, elevation) => `azimuth ${degrees(azimuth)}, elevation ${degrees(elevation)}`;
export const rangeText = (metres) => (metres >= 1000 ? `${metres / 1000} km` : `${metres} m`);
