// The temperature of the blackbody that has an in-band radiance: Planck's law, integrated over the
// limits of a band without response by Simpson's rule.

import { tickLabels, ticks } from "./numbers.js";

const C1L = 1.191042972397188e8;  // 2 h c^2 [W um^4/(m2 sr)]
const C2 = 14387.768775039337;    // h c / k [um K]
const INTERVALS = 64;

function bandRadiance([low, high], kelvin) {
  const step = (high - low) / INTERVALS;
  let sum = 0;
  for (let k = 0; k <= INTERVALS; ++k) {
    const um = low + k * step, weight = k === 0 || k === INTERVALS ? 1 : k % 2 ? 4 : 2;
    sum += weight * C1L / (um ** 5 * Math.expm1(C2 / (um * kelvin)));
  }
  return sum * step / 3;
}

// [K]; null: there is none. limits: [from, to] in um; radiance in W/(m2 sr).
export function bandTemperature(limits, radiance) {
  let low = 1, high = 1e5;
  if (!(radiance > bandRadiance(limits, low) && radiance < bandRadiance(limits, high))) return null;
  for (let k = 0; k < 60; ++k) {
    const middle = Math.sqrt(low * high);
    if (bandRadiance(limits, middle) < radiance) low = middle;
    else high = middle;
  }
  return low;
}

// Round temperatures between two in-band radiances, at the values that the radiances have on a
// scale: value(radiance). null: the radiances are of no temperatures.
export function kelvinTicks(limits, low, high, value) {
  const warmest = bandTemperature(limits, high);
  const coldest = bandTemperature(limits, low) ?? bandTemperature(limits, 0.02 * high);
  if (!warmest || !coldest || !(coldest < warmest)) return null;
  const kelvin = ticks(coldest, warmest, 5);
  return { unit: "K", at: kelvin.map((k) => value(bandRadiance(limits, k))), labels: tickLabels(kelvin, 1) };
}
