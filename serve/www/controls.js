// The form that says what is shown.
import { html } from "./draw.js";
import { rangeText } from "./numbers.js";

export const QUANTITIES = [
  ["intensity", "intensity (source)"], ["apparent_intensity", "apparent intensity"],
  ["contrast_intensity", "contrast intensity"], ["background_radiance", "background radiance"]];

function select(label, name, options, value, change) {
  const list = html("select", { name }, ...options.map(([v, text]) => html("option", { value: v, selected: v === value }, text)));
  list.addEventListener("change", () => change({ [name]: list.value }));
  return html("label", {}, label, list);
}

// A slider over the times of a season; its words follow while it moves.
function hours(name, times, value, change) {
  const at = Math.max(0, times.indexOf(value));
  const words = html("output", {}, times[at]);
  const slider = html("input", { type: "range", name, min: 0, max: times.length - 1, step: 1, value: at, "aria-valuetext": times[at] });
  slider.addEventListener("input", () => {
    const time = times[Number(slider.value)];
    words.textContent = time;
    slider.setAttribute("aria-valuetext", time);
    change({ [name]: time });
  });
  return html("label", {}, "Hour", slider, words);
}

function selection(prefix, state, contents, change) {
  const database = contents.database[Number(state[`${prefix}db`])];
  const sweep = database.sweep.find((s) => s.name === state[`${prefix}sweep`]);
  const field = (name) => prefix + name;
  const seasons = [...new Set(sweep.condition.map((c) => c.season))];
  const times = sweep.condition.filter((c) => c.season === state[field("season")]).map((c) => c.time_utc);
  const out = [];
  if (contents.database.length > 1)
    out.push(select("Database", field("db"), contents.database.flatMap((d, k) => (d.error ? [] : [[String(k), d.name]])), state[field("db")], change));
  if (database.sweep.length > 1) out.push(select("Sweep", field("sweep"), database.sweep.map((s) => [s.name, s.name]), state[field("sweep")], change));
  out.push(select("Season", field("season"), seasons.map((s) => [s, s]), state[field("season")], change));
  if (times.length > 1) out.push(hours(field("time"), times, state[field("time")], change));
  else out.push(html("span", { class: "fixed" }, "Hour", html("output", {}, times[0])));
  out.push(select("Band", field("band"), sweep.band.map((b) => [b.name, `${b.name} (${b.lambda_min_um} to ${b.lambda_max_um} µm)`]), state[field("band")], change));
  if (sweep.range_m.length > 1) out.push(select("Range", field("at_range_m"), sweep.range_m.map((r) => [String(r), rangeText(r)]), state[field("at_range_m")], change));
  return out;
}

// change(fields): some fields of the state have new values.
export function fillControls(form, state, contents, change) {
  const focused = document.activeElement?.name;
  const from = html("input", { type: "number", name: "range_m", min: "1", step: "any", inputmode: "decimal", placeholder: state.at_range_m, value: state.range_m });
  from.addEventListener("change", () => change({ range_m: from.value }));
  const compare = html("input", { type: "checkbox", name: "compare", checked: state.compare === "1" });
  compare.addEventListener("change", () => change({ compare: compare.checked ? "1" : "" }));
  const groups = [
    html("fieldset", {}, html("legend", {}, state.compare ? "A" : "Condition"), ...selection("", state, contents, change)),
    html("fieldset", {}, html("legend", {}, "Shown"),
      select("Quantity", "quantity", QUANTITIES, state.quantity, change),
      html("label", { title: "The chosen viewpoint as seen from there: its values and its spectrum" }, "Seen from [m]", from),
      html("label", { class: "check" }, compare, "Compare"))];
  if (state.compare) {
    groups.push(html("fieldset", {}, html("legend", {}, "B"), ...selection("b_", state, contents, change),
      select("Map", "show", [["difference", "B − A in σ"], ["a", "A"], ["b", "B"]], state.show || "difference", change)));
  }
  form.replaceChildren(...groups);
  if (focused) form.elements[focused]?.focus();
}
