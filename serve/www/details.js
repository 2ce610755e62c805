// Details of one row in words and numbers: values, error budget, ledger; and the progress of
// sweeps.
import { html, table } from "./draw.js";
import { aspectText, brief, rangeText, withError } from "./numbers.js";

const SHOWN = [
  ["intensity", "Intensity", "intensity_w_sr", "numerical_error_w_sr", "W/sr"],
  ["apparent_intensity", "Apparent intensity", "apparent_intensity_w_sr", "apparent_numerical_error_w_sr", "W/sr"],
  ["contrast_intensity", "Contrast intensity", "contrast_intensity_w_sr", "contrast_numerical_error_w_sr", "W/sr"],
  ["background_radiance", "Background radiance", "background_radiance_w_m2_sr", "background_radiance_stderr_w_m2_sr", "W/(m² sr)"],
  ["", "Projected area", "projected_area_m2", "projected_area_stderr_m2", "m²"]];

const number = (column, value) => html("span", { "data-column": column, "data-value": value }, brief(value));

function valueCell(signature, column, error, unit) {
  const value = signature[column];
  if (value === null || value === undefined) return "not stored";
  return html("span", { class: "number" }, number(column, value), ` ± ${brief(signature[error], 2)} ${unit}`);
}

// The layer of cloud of a row's condition, in words; "" without a cover.
function cloudText(row) {
  const layer = row.explained.cloud?.[0];
  if (!layer) return "";
  return `${layer.type || "cloud"} covers ${brief(100 * layer.cover)} % of the sky, ${brief(layer.base_m)} to ${brief(layer.top_m)} m, ${brief(layer.water_path_g_m2)} g/m² of ${layer.phase}`;
}

// row, other: answers of /api/row (other: null); difference: {value, error, sigmas, unit} or null.
export function values(row, other, difference) {
  const a = row.signature[0], b = other?.signature[0];
  const heads = ["", b ? "A" : "Value", ...(b ? ["B"] : [])];
  const lines = SHOWN.map(([quantity, name, column, error, unit]) => {
    const head = html("span", { class: quantity === row.quantity ? "asked" : "" }, name);
    return [head, valueCell(a, column, error, unit), ...(b ? [valueCell(b, column, error, unit)] : [])];
  });
  for (const [name, column] of [["Source radiance temperature", "source_radiance_temperature_k"], ["Apparent temperature", "apparent_temperature_k"]])
    lines.push([name, ...[a, b].filter(Boolean).map((s) =>
      s[column] === null ? "–" : html("span", { class: "number" }, number(column, s[column]), " K"))]);
  if (a.path_transmittance !== null)
    lines.push(["Transmittance of the air", ...[a, b].filter(Boolean).map((s) => html("span", { class: "number" }, number("path_transmittance", s.path_transmittance)))]);
  const where = html("p", { class: "where" },
    `Row ${a.row}: ${a.season}, ${a.time_utc}, ${a.band} (${brief(a.lambda_min_um)} to ${brief(a.lambda_max_um)} µm), ${aspectText(a.aspect_azimuth_deg, a.aspect_elevation_deg)}, ${rangeText(a.range_m)}`);
  const out = [where];
  if (cloudText(row)) out.push(html("p", { class: "where" }, `Sky: ${cloudText(row)}`));
  if (b) out.push(html("p", { class: "where" }, `B is row ${b.row}: ${b.sweep}, ${b.season}, ${b.time_utc}, ${b.band}`));
  if (b && cloudText(other)) out.push(html("p", { class: "where" }, `Sky of B: ${cloudText(other)}`));
  if (a.stored_range_m) out.push(html("p", { class: "note" }, `Computed at ${rangeText(a.stored_range_m)} and brought to ${rangeText(a.range_m)} through the air of the sweep; map, cut and image are of the stored range.`));
  out.push(table("Values with one numerical error", heads, lines));
  if (difference)
    out.push(html("p", { class: "difference" }, "B − A: ", html("strong", { "data-column": "difference", "data-value": difference.value }, withError(difference.value, difference.error, difference.unit)),
      ", ", html("strong", { "data-column": "sigmas", "data-value": difference.sigmas }, `${brief(difference.sigmas, 3)} σ`),
      html("span", { class: "hint" }, " of errors taken as independent; conditions of one view share their paths, so the true error is rather smaller.")));
  for (const note of row.notes) out.push(html("p", { class: "note" }, note));
  return out;
}

export function budget(row) {
  const parts = row.budget.part;
  if (parts.length === 0) return null;
  const worth = parts.filter((p) => p.error > 0).sort((a, b) => b.share - a.share);
  const bar = (share) => {
    const fill = html("span", { class: "fill" });
    fill.style.width = `${Math.max(0.5, 100 * share)}%`;
    return html("span", { class: "bar", "aria-hidden": "true" }, fill);
  };
  const rows = worth.map((p) => [
    html("span", { title: p.what }, `${p.name}${p.bound && p.name !== "bounds together" ? " bound" : ""}`, html("small", {}, p.what)),
    html("span", { "data-part": p.name, "data-value": p.error }, brief(p.error, 3)),
    html("span", { class: "share" }, bar(p.share), p.share < 1e-3 ? "< 0.1 %" : `${brief(100 * p.share, 2)} %`)]);
  const none = parts.filter((p) => !(p.error > 0)).map((p) => p.name);
  const relative = row.value === 0 ? "" : ` (${brief(100 * row.numerical_error / Math.abs(row.value), 2)} % of the value)`;
  return [
    html("p", {}, `Numerical error of the ${row.quantity.replaceAll("_", " ")}: `, html("strong", { "data-column": "numerical_error", "data-value": row.numerical_error }, `${brief(row.numerical_error, 3)} ${row.unit}`), relative),
    table("Shares of its square", ["Reason", row.unit, "Share"], rows),
    none.length > 0 ? html("p", { class: "hint" }, `Nothing from: ${none.join(", ")}.`) : null].filter(Boolean);
}

const REASONS = {
  always: 'cannot be left out',
  not_in_scene: 'nothing here causes it',
  within_fraction: 'its bound fits into the error asked for',
  above_fraction: 'it matters',
  other_row: 'another row of the view needs it',
  no_goal: 'a number of samples was asked for',
  unbounded: 'no bound is known',
  forced: 'asked for',
  not_worth: 'leaving it out saves nothing',
  not_asked: 'the sweep asks to leave it out'
};

// A bound of what is simulated is in no error, however large it is.
function bound(effect, value) {
  const idle = effect.state === "on" && effect.bound_w_sr > Math.abs(value);
  return html("span", {}, brief(effect.bound_w_sr, 3), idle ? html("small", {}, "a rough bound above the value itself, which does not matter: the effect is simulated") : null);
}

export function ledger(row) {
  const { effects, energy, parts, temperatures } = row.explained;
  const signature = row.explained.signature[0];
  const out = [];
  const cause =
      ['emitted', 'sun_reflected', 'sky_reflected', 'surface_reflected', 'interreflected'];
  out.push(table("Intensity by cause", ["Cause", "W/sr"], cause.map((c) => [c.replaceAll("_", " "), html("span", { "data-column": `${c}_w_sr`, "data-value": signature[`${c}_w_sr`] }, withError(signature[`${c}_w_sr`], signature[`${c}_stderr_w_sr`], ""))])));
  if (parts.length > 0)
    out.push(table("Intensity by the part that the sensor sees", ["Part", "W/sr"], parts.map((p) => [p.part, withError(p.part_intensity_w_sr, p.part_intensity_stderr_w_sr, "")])));
  if (temperatures.length > 0)
    out.push(table("Computed temperatures of the facets", ["Part", "mean K", "coldest", "hottest", "error"],
      temperatures.map((t) => [t.part, brief(t.mean_k), brief(t.coldest_k), brief(t.hottest_k), brief(t.error_k, 2)])));
  if (effects.length > 0) {
    const words = (e) => e.effect.replaceAll("_", " ");
    const absent = effects.filter((e) => e.state === "absent");
    out.push(html(
        'div', {class: 'effects'},
        table(
            'Effects', ['Effect', 'State', 'If left out, at most W/sr', 'Share in W/sr', 'Why'],
            effects.filter((e) => e.state !== 'absent')
                .map(
                    (e) =>
                        [words(e), html('span', {class: `state ${e.state}`}, e.state),
                         bound(e, signature.intensity_w_sr), brief(e.fraction_w_sr, 4),
                         REASONS[e.reason] ?? e.reason])),
        html(
            'p', {class: 'hint'},
            'What an effect could change at most, had it been left out: what is simulated (on) has no part of this in its error.'),
        absent.length > 0 ? html(
                                'p', {class: 'hint absent'},
                                `Nothing here causes: ${absent.map(words).join(', ')}.`) :
                            null));
  } else out.push(html("p", { class: "note" }, "No ledger of effects: an older irsig stored this row."));
  if (energy.length > 0)
    out.push(table('Where light that the sensor would send out ends', ['', 'Share'], [
      ['absorbed', brief(energy[0].absorbed)], ['to the sky', brief(energy[0].escaped_to_sky)],
      ['to sea or ground', brief(energy[0].escaped_to_surface)],
      ['cut off', brief(energy[0].cut_off)], ['sum', brief(energy[0].balance)]
    ]));
  return [html("details", { open: true }, html("summary", {}, "Causes, parts, effects, energy"), html("div", { class: "tables" }, ...out))];
}

function workers(farm) {
  const count = (state) => farm.worker.filter((w) => w.state === state).length;
  const states = ["computing", "idle", "set aside"].filter((s) => count(s) > 0).map((s) => `${count(s)} ${s}`).join(", ");
  const seconds = (w) => (w.job_s === undefined ? "" : `${brief(w.job_s, 3)} s`);
  return [...farm.warning.map((w) => html("p", { class: "note" }, w)),
    html("details", { id: "workers" }, html("summary", {}, `${farm.workers} worker${farm.workers === 1 ? "" : "s"}${states ? `: ${states}` : ""}`),
      table("Workers, those set aside first", ["Name", "State", "Its job since", "Job", "Memory", "Why"], farm.worker.map((w) => [
        w.name, w.state, seconds(w), w.job_key.slice(0, 12), w.memory_bytes > 0 ? `${brief(w.memory_bytes / 1e9, 3)} GB` : "", w.reason])))];
}

// database, farm, farm_error: of /api/progress.
export function progress({ database, farm, farm_error: trouble }) {
  const out = [];
  for (const d of database) {
    if (d.error) {
      out.push(html("p", { class: "words" }, `${d.name}: ${d.error}`));
      continue;
    }
    if (d.sweep.length === 0) out.push(html("p", {}, `${d.name}: no sweep yet`));
    for (const s of d.sweep) {
      const whole = s.done === s.jobs;
      const state = whole ? "complete" : d.writing ? `running, ${s.leased} on workers` : "not complete, nobody is computing it";
      out.push(html("div", { class: "sweep" },
        html("span", {}, `${d.name}: sweep ${s.name}, ${s.done} of ${s.jobs} jobs, ${state}`,
          s.failed > 0 ? `, ${s.failed} failed` : "", s.worst_relative_error > 0 ? `; greatest error ${brief(100 * s.worst_relative_error, 2)} %` : ""),
        whole ? null : html("progress", { max: s.jobs, value: s.done, "aria-label": `jobs of ${s.name}` }),
        ...s.failures.map((f) => html("p", { class: "note" }, f))));
    }
  }
  if (trouble) out.push(html("p", { class: "words" }, trouble));
  if (farm) out.push(...workers(farm));
  return out;
}
