// Which window of a band a detector sees the target best in: its form, the map of all windows, the best of them.
import { scaleOf } from "./colors.js";
import { html, svg, table } from "./draw.js";
import { brief, rangeText, tickLabels, ticks } from "./numbers.js";
import { readOut } from "./readout.js";

export const BAND_FIELDS = ["bands", "detector", "nei_w_m2", "merit", "percentile", "threshold", "over", "clutter"];
const MERITS = [["mean", "mean SNR"], ["percentile", "SNR that all but a few % exceed"], ["worst", "worst SNR"], ["above", "share above a threshold"]];
const SIZE = 420, LEFT = 52, TOP = 10, SIDE = 340;

// The detector that was named on the command line is the one that is asked for; "none": constant noise.
const detectorOf = (state, detectors) => (state.detector !== "" ? state.detector : detectors.length > 0 ? "0" : "none");

// Returns the parameters of the state for the server. sweep: the selected one; clutter is requested
// if its rows have some.
export function bandParameters(state, detectors, sweep) {
  const merit = state.merit || "mean", detector = detectorOf(state, detectors);
  return { range_m: state.range_m, detector: detector === "none" ? "" : detector, nei_w_m2: detector === "none" ? state.nei_w_m2 : "", merit, over: state.over,
    clutter: sweep?.clutter ? state.clutter : "",
    percentile: merit === "percentile" ? state.percentile : "", threshold: merit === "above" ? state.threshold : "" };
}

export function fillBandForm(form, state, detectors, sweep, change) {
  const focused = document.activeElement?.name;
  const select = (label, name, options, value) => {
    const list = html("select", { name }, ...options.map(([v, text]) => html("option", { value: v, selected: v === value }, text)));
    list.addEventListener("change", () => change({ [name]: list.value }));
    return html("label", {}, label, list);
  };
  const number = (label, name, otherwise) => {
    const input = html("input", { type: "number", name, min: "0", step: "any", inputmode: "decimal", placeholder: otherwise, value: state[name] });
    input.addEventListener("change", () => change({ [name]: input.value }));
    return html("label", {}, label, input);
  };
  const merit = state.merit || "mean";
  const detector = detectorOf(state, detectors);
  const known = [...detectors.map((name, k) => [String(k), name]), ["none", "constant noise"]];
  form.replaceChildren(...[
    select("Detector", "detector", known, detector),
    detector === "none" ? number("NEI [W/m²]", "nei_w_m2", "1e-9") : null,
    sweep?.clutter ? select("Against", "clutter", [["", "noise"], ["1", "clutter and noise"]], state.clutter) : null,
    select("Best is", "merit", MERITS, merit),
    merit === "percentile" ? number("all but [%]", "percentile", "10") : null,
    merit === "above" ? number("SNR above", "threshold", "5") : null,
    select("Over", "over", [["aspects", "all aspects, this hour"], ["conditions", "all aspects, seasons and hours"]], state.over || "aspects"),
  ].filter(Boolean));
  if (focused) form.elements[focused]?.focus();
}

// answer: of /api/bands. A window is the cell of its two limits.
export function drawBands(answer, readout) {
  const { edge_um: edge, first, last, merit } = answer.window;
  const low = edge[0], high = edge.at(-1), scale = scaleOf(merit);
  const X = (um) => LEFT + SIDE * (um - low) / (high - low), Y = (um) => TOP + SIDE * (high - um) / (high - low);
  const words = (k) => `${brief(edge[first[k]])} to ${brief(edge[last[k]])} µm: ${answer.title} ${brief(merit[k])}`;
  const parts = first.map((f, k) => svg("rect", { x: X(edge[f]), y: Y(edge[last[k]]), width: X(edge[f + 1]) - X(edge[f]) + 0.3,
    height: Y(edge[last[k] - 1]) - Y(edge[last[k]]) + 0.3, fill: scale.css(scale.place(merit[k])) }));
  const marks = ticks(low, high, 5), labels = tickLabels(marks);
  marks.forEach((um, k) => parts.push(svg("text", { class: "middle", x: X(um), y: TOP + SIDE + 18 }, labels[k]), svg("text", { class: "end", x: LEFT - 6, y: Y(um) + 4 }, labels[k])));
  const best = merit.indexOf(Math.max(...merit));
  const at = [(X(edge[first[best]]) + X(edge[first[best] + 1])) / 2, (Y(edge[last[best]]) + Y(edge[last[best] - 1])) / 2];
  parts.push(svg("circle", { class: "best", cx: at[0], cy: at[1], r: 6 }),
    svg("text", { class: "middle", x: LEFT + SIDE / 2, y: TOP + SIDE + 38 }, "from [µm]"),
    svg("text", { class: "middle", x: 14, y: TOP + SIDE / 2, transform: `rotate(-90 14 ${TOP + SIDE / 2})` }, "to [µm]"));
  const picture = svg("svg", { viewBox: `0 0 ${SIZE} ${SIZE - 20}`, class: "plot", role: "img", "aria-label": `${answer.title} of every window; the best is ${words(best)}` }, ...parts);
  const index = new Map(first.map((f, k) => [`${f},${last[k]}`, k]));
  const here = svg("rect", { class: "here", width: 0, height: 0 });
  picture.append(here);
  readout.textContent = words(best);
  return readOut(picture, {
    first: best,
    at: (x, y) => {
      const from = low + (high - low) * (x - LEFT) / SIDE, to = high - (high - low) * (y - TOP) / SIDE;
      return index.get(`${edge.findLastIndex((e) => e <= from)},${edge.findIndex((e) => e >= to)}`);
    },
    step: (k, dx, dy) => index.get(`${first[k] + dx},${last[k] + dy}`),
    say: (k) => {
      const [x, y] = [X(edge[first[k]]), Y(edge[last[k]])];
      for (const [name, value] of Object.entries({ x, y, width: X(edge[first[k] + 1]) - x, height: Y(edge[last[k] - 1]) - y })) here.setAttribute(name, value);
      readout.textContent = words(k);
    },
  });
}

export function bestWindows(answer) {
  const { best } = answer;
  return [table(`The best of ${answer.window.merit.length} windows over ${answer.rows} rows${answer.range_m ? ` seen from ${rangeText(answer.range_m)}` : ""}, ${answer.detector}`, ["Window [µm]", answer.title, "error", "is the best", "as good as the first"],
    best.merit.map((m, k) => [`${brief(best.lambda_min_um[k])} to ${brief(best.lambda_max_um[k])}`, html("span", { "data-merit": m }, brief(m)), brief(best.total_error[k], 2),
      `${brief(100 * best.best[k], 3)} %`, `${brief(100 * best.as_good[k], 3)} %`])),
    ...answer.notes.map((note) => html("p", { class: "note" }, note))];
}
