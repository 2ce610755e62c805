// The form that says what is shown.
import { html } from "./draw.js";
import { brief, rangeText } from "./numbers.js";
import { fits, sweepOf } from "./state.js";

export const QUANTITIES = [
  ["intensity", "intensity (source)"], ["apparent_intensity", "apparent intensity"],
  ["contrast_intensity", "contrast intensity"], ["background_radiance", "background radiance"]];
const MAPS = [["", "values"], ["left_out", "error of interpolation"]];
const MAPS_OF_TWO = [["difference", "B − A in σ"], ["a", "A"], ["b", "B"]];

function select(label, name, options, value, change) {
  const list = html("select", { name }, ...options.map(([v, text]) => html("option", { value: v, selected: v === value }, text)));
  list.addEventListener("change", () => change({ [name]: list.value }));
  return html("label", {}, label, list);
}

// A choice with a slider over it, whose words follow while it moves. live: what is shown follows, too.
function choice(label, name, options, value, change, { live = false } = {}) {
  if (options.length === 1) return html("span", { class: "fixed" }, label, html("output", {}, options[0][1]));
  const box = select(label, name, options, value, (fields) => {
    follow(list.selectedIndex);
    change(fields);
  });
  const list = box.querySelector("select");
  const slider = html("input", { type: "range", name: `${name}_slider`, min: 0, max: options.length - 1, step: 1, "aria-label": `${label}, as a slider` });
  const follow = (k) => {
    list.selectedIndex = k;
    slider.value = k;
    slider.setAttribute("aria-valuetext", options[k][1]);
  };
  follow(Math.max(0, options.findIndex(([v]) => v === value)));
  slider.addEventListener("input", () => follow(Number(slider.value)));
  slider.addEventListener(live ? "input" : "change", () => change({ [name]: list.value }));
  return html("div", { class: "choice" }, box, slider);
}

// From a tenth of the stored range to ten times it; the number beside it says any other.
function seenFrom(state, change) {
  const stored = Number(state.at_range_m);
  const number = html("input", { type: "number", name: "range_m", min: "1", max: "1e9", step: "any", inputmode: "decimal", placeholder: state.at_range_m, value: state.range_m });
  const slider = html("input", { type: "range", name: "range_m_slider", min: -1, max: 1, step: 0.05, "aria-label": "Seen from, as a slider" });
  const follow = () => {
    const range = Number(number.value) || stored;
    slider.value = Math.log10(range / stored);
    slider.setAttribute("aria-valuetext", `${rangeText(range)}${number.value === "" ? ", as stored" : ""}`);
  };
  follow();
  slider.addEventListener("input", () => {
    const range = Number((stored * 10 ** Number(slider.value)).toPrecision(2));
    number.value = Number(slider.value) === 0 ? "" : range;
    slider.setAttribute("aria-valuetext", rangeText(Number(number.value) || stored));
  });
  slider.addEventListener("change", () => change({ range_m: number.value }));
  number.addEventListener("change", () => {
    follow();
    change({ range_m: number.value });
  });
  return html("div", { class: "choice" },
    html("label", { title: "The chosen viewpoint as seen from there: its values and its spectrum" }, "Seen from [m]", number), slider);
}

function selection(prefix, state, contents, change) {
  const field = (name) => prefix + name, value = (name) => state[field(name)];
  const database = Number(value("db")), sweep = sweepOf(state, prefix, contents);
  const out = [];
  // The current choice is always listed, so that the user can see and change it.
  const useful = (d, k) => !d.error && (k === database || (prefix === "" ? true : d.sweep.some((s) => fits(state, prefix, contents, k, s.name))));
  const databases = contents.database.flatMap((d, k) => (useful(d, k) ? [[String(k), d.name]] : []));
  if (contents.database.length > 1) out.push(select("Database", field("db"), databases, value("db"), change));
  if (!sweep) return out;
  const sweeps = contents.database[database].sweep.filter((s) => s === sweep || fits(state, prefix, contents, database, s.name));
  if (sweeps.length > 1) out.push(select("Sweep", field("sweep"), sweeps.map((s) => [s.name, s.name]), value("sweep"), change));
  const same = (list) => list.map((v) => [v, v]);
  const times = sweep.condition.filter((c) => c.season === value("season")).map((c) => c.time_utc);
  out.push(choice("Season", field("season"), same([...new Set(sweep.condition.map((c) => c.season))]), value("season"), change),
    choice("Hour", field("time"), same(times), value("time"), change, { live: true }),
    choice("Band", field("band"), sweep.band.map((b) => [b.name, `${b.name} (${brief(b.lambda_min_um)} to ${brief(b.lambda_max_um)} µm)`]), value("band"), change));
  if (sweep.range_m.length > 1) out.push(choice("Range", field("at_range_m"), sweep.range_m.map((r) => [String(r), rangeText(r)]), value("at_range_m"), change));
  return out;
}

// change(fields): some fields of the state have new values.
export function fillControls(form, state, contents, change) {
  const focused = document.activeElement?.name;
  const groups = [];
  const group = (name, fields) => {
    if (fields.length > 0) groups.push(html("fieldset", {}, html("legend", {}, name), ...fields));
  };
  group(state.compare ? "A" : "Condition", selection("", state, contents, change));
  if (sweepOf(state, "", contents)) {
    const compare = html("input", { type: "checkbox", name: "compare", checked: state.compare === "1" });
    compare.addEventListener("change", () => change({ compare: compare.checked ? "1" : "" }));
    group("Shown", [select("Quantity", "quantity", QUANTITIES, state.quantity, change),
      state.compare ? null : select("Map", "show", MAPS, state.show, change), seenFrom(state, change),
      html("label", { class: "check" }, compare, "Compare")].filter(Boolean));
    if (state.compare) group("B", [...selection("b_", state, contents, change), select("Map", "show", MAPS_OF_TWO, state.show || "difference", change)]);
  }
  form.replaceChildren(...groups);
  if (focused) form.elements[focused]?.focus();
}
