// Map of all aspects: values, the difference of two conditions, or the errors of interpolation at
// each viewpoint from the others.
import { addressOf, ask } from "./api.js";
import { brief, withError } from "./numbers.js";
import { selectionParameters, sweepOf } from "./state.js";

// Shows A, with the reason, if the request about A cannot be answered.
export async function askMap(state, contents) {
  const a = { ...selectionParameters(state), quantity: state.quantity };
  let reason = "";
  const besides = (path, parameters, words) => ask(path, parameters).catch((error) => {
    reason = `${words}: ${error.message}`;
  });
  if (state.compare) {
    const both = { ...a, ...selectionParameters(state, "b_", "b_") };
    const c = sweepOf(state, "b_", contents) && await besides("api/compare", both, "Nothing is compared, shown is A alone");
    if (c) return ofTwo(c, both, state.show);
  }
  const m = await ask("api/map", a);
  const map = { ...m, azimuth: m.azimuth_deg, elevation: m.elevation_deg, around0: false, shown_unit: m.unit, shown_title: m.title,
    files: [["CSV", addressOf("file/rows.csv", a)], ["SVG", addressOf("file/map.svg", a)]],
    words: (k) => withError(m.value[k], m.error[k], m.unit) };
  const l = !state.compare && state.show === "left_out" && await besides("api/left_out", a, "Shown are the values");
  return l ? leftOut(map, l, a) : { ...map, reason };
}

function ofTwo(c, both, asked) {
  const show = ["a", "b"].includes(asked) ? asked : "difference";
  const difference = show === "difference";
  return { ...c, azimuth: c.azimuth_deg, elevation: c.elevation_deg, row: c.a_row, value: difference ? c.sigmas : c[show], around0: difference,
    shown_unit: difference ? "σ" : c.unit, shown_title: difference ? `B − A of the ${c.title.toLowerCase()}` : `${c.title} of ${show.toUpperCase()}`,
    files: [["CSV", addressOf("file/compare.csv", both)]],
    words: (k) => `A ${withError(c.a[k], c.a_error[k], c.unit)}, B ${withError(c.b[k], c.b_error[k], c.unit)}, B − A ${brief(c.sigmas[k], 3)} σ` };
}

// Each viewpoint as the others have it, as far as they surround it.
function leftOut(map, l, a) {
  const at = new Map(l.row.map((row, k) => [row, k])), share = map.signed ? "% of the rms" : "%";
  const sorted = [...l.relative_deviation].sort((x, y) => x - y);
  // The colours are for the many, not for the few that are far off.
  const upto = 100 * sorted[Math.floor(0.95 * (sorted.length - 1))];
  return { ...map, command: l.command, upto, shown_unit: "%", shown_title: `Error of interpolation from the other viewpoints: ${map.title.toLowerCase()}`,
    value: map.row.map((row) => (at.has(row) ? 100 * l.relative_deviation[at.get(row)] : null)),
    files: [["CSV", addressOf("file/left_out.csv", a)]],
    words: (k) => {
      const i = at.get(map.row[k]);
      if (i === undefined) return `${map.words(k)}; the others do not surround it`;
      return `${map.words(k)}, from the others ${withError(l.interpolated[i], l.error[i], map.unit)}: off by ${brief(100 * l.relative_deviation[i], 3)} ${share}`;
    } };
}
