import { Camera } from "./camera.js";
import { decode, paint, relativeError, scaleOf } from "./picture.js";

const $ = (id) => document.getElementById(id);
const canvas = $("picture");
const STATES = ["moving: 2 rays a pixel", "at rest: the estimator's first rays", "at rest: as stored images are"];
let scene, camera, frame, drawn, scale, asked = "", pointer = null, hourMoved = false, visibilityMoved = false;
window.irsigFly = { frames: 0, state: () => frame && frame.state, camera: () => camera, drawn: () => drawn };  // for tests

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
function trouble(words) {
  $("trouble").hidden = !words;
  $("trouble").textContent = words || "";
}

function parameters() {
  const [width, height] = $("size").value.split("x");
  const out = { viewer: scene.viewer, ...camera.parameters(), width_px: width, height_px: height,
    condition: $("condition").value, band: $("band").value, light: $("light").value,
    imager: +$("imager").checked,
    sun: +$("sun").checked, sky: +$("sky").checked, parts: +$("parts").checked };
  if (hourMoved && !scene.keeps_hours) out.minute_utc = $("hour").value;
  if (visibilityMoved) out.visibility_m = Math.round(10 ** $("visibility").value);
  return new URLSearchParams(out).toString();
}

async function ask(path, parameters) {
  const reply = await fetch(`api/${path}?${parameters}`);
  if (reply.ok) return reply;
  const words = await reply.json().catch(() => ({ error: `the server answered ${reply.status}` }));
  throw Object.assign(new Error(words.error), { said: true });
}

function kelvinOf(radiance) {
  const table = scene.blackbody[$("band").value].radiance, [first, step] = scene.kelvin;
  if (!(radiance > table[0])) return NaN;
  let low = 0, high = table.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (table[middle] <= radiance) low = middle;
    else high = middle;
  }
  const f = Math.log(radiance / table[low]) / Math.log(table[high] / table[low]);
  return first * step ** (low + f);
}
function amount(radiance, relative) {
  const counts = frame.gain > 0 ? `${Math.round(frame.gain * radiance + frame.offset)} counts, ` : "";
  return counts + physical(radiance, relative);
}
function physical(radiance, relative) {
  if ($("unit").value === "w") {
    const error = relative === null ? "an edge, no error stated" : `± ${(radiance * relative).toPrecision(2)}`;
    return `${radiance.toPrecision(4)} W/(m² sr) ${error}`;
  }
  const kelvin = kelvinOf(radiance);
  const error = relative === null ? "an edge, no error stated" : `± ${(kelvinOf(radiance * (1 + relative)) - kelvin).toFixed(2)}`;
  return `${kelvin.toFixed(2)} K ${error}`;
}

function show() {
  if (!$("hold").checked || !scale) scale = scaleOf(frame);
  paint(canvas, frame, $("palette").value, scale, $("errors").checked);
  $("state").textContent = `${STATES[frame.state]}; ${frame.ms > 0 ? `${frame.ms.toFixed(0)} ms a frame, ` : ""}` +
    `${(100 * frame.edges).toFixed(1)} % on edges; ${amount(scale.low, 0).split("±")[0]} to ${amount(scale.high, 0).split("±")[0]}`;
  readOut();
}
function readOut() {
  if (!pointer || !frame) return;
  const x = Math.floor(pointer[0] * frame.width), y = Math.floor(pointer[1] * frame.height);
  if (x < 0 || y < 0 || x >= frame.width || y >= frame.height) return;
  const i = y * frame.width + x;
  $("readout").textContent = `(${x}, ${y}): ${amount(frame.radiance[i], relativeError(frame.error[i]))}`;
}
let pickTimer = 0;
function pick() {
  clearTimeout(pickTimer);
  pickTimer = setTimeout(async () => {
    if (!pointer || !frame) return;
    // Pixels of the view, which an imager's are not.
    const [x, y] = $("size").value.split("x").map((size, k) => Math.min(size - 1, Math.floor(pointer[k] * size)));
    try {
      const found = await (await ask("pick", `${parameters()}&x=${x}&y=${y}`)).json();
      const part = (name) => `${name} ${((100 * found[name]) / found.total).toFixed(0)} %`;
      readOut();
      $("readout").textContent += `; ${found.what}` + (found.range_m ? `, ${found.range_m.toFixed(0)} m away` : "") +
        (found.temperature_k ? `, surface ${found.temperature_k.toFixed(1)} K` : "") + (found.in_sun ? ", in the sun" : "") +
        `: ${["emitted", "sun", "reflected", "air"].map(part).join(", ")}`;
    } catch (error) {
      if (error.said) $("readout").textContent = error.message;
    }
  }, 120);
}

async function loop() {
  for (;;) {
    const now = parameters();
    if (now === asked && frame) {
      // At rest: the estimator's pictures come when they are ready; then a sign of life. A key ends
      // the pause, so that its picture does not wait for it.
      const until = performance.now() + (frame.state === 2 ? 1000 : 100);
      while (performance.now() < until && parameters() === asked) await new Promise(requestAnimationFrame);
      if (parameters() !== asked) continue;
    }
    asked = now;
    const from = { azimuth: camera.azimuth };  // of the camera as it is asked for
    try {
      const next = decode(await (await ask("frame", now)).arrayBuffer());
      frame = next;
      ++window.irsigFly.frames;
      trouble("");
      show();
      drawn = from;
    } catch (error) {
      trouble(error.said ? error.message : "The connection is lost: is irsig fly still running? Trying again.");
      asked = "";
      await pause(500);
    }
    await new Promise(requestAnimationFrame);
  }
}

function keys() {
  const held = new Set();
  const STEP = {
    ArrowLeft: () => camera.orbit(-1, 0), ArrowRight: () => camera.orbit(1, 0), ArrowUp: () => camera.orbit(0, 1),
    ArrowDown: () => camera.orbit(0, -1), "+": () => camera.approach(0.97), "=": () => camera.approach(0.97),
    "-": () => camera.approach(1.03), w: () => camera.fly(0.02, 0, 0), s: () => camera.fly(-0.02, 0, 0),
    a: () => camera.fly(0, -0.02, 0), d: () => camera.fly(0, 0.02, 0), q: () => camera.fly(0, 0, -0.01),
    e: () => camera.fly(0, 0, 0.01), z: () => camera.zoom(0.97), x: () => camera.zoom(1.03) };
  const name = (event) => (event.key.length === 1 ? event.key.toLowerCase() : event.key);
  canvas.addEventListener("keydown", (event) => {
    if (!STEP[name(event)] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (!held.has(name(event))) STEP[name(event)]();
    held.add(name(event));
  });
  for (const end of ["keyup", "blur"]) canvas.addEventListener(end, (event) => (event.key ? held.delete(name(event)) : held.clear()));
  setInterval(() => held.forEach((key) => STEP[key]()), 33);
}

function pointers() {
  const down = new Map();
  const place = (event) => {
    const box = canvas.getBoundingClientRect(), aspect = frame ? frame.width / frame.height : 1.25;
    const width = Math.min(box.width, box.height * aspect), height = width / aspect;
    return [(event.clientX - box.left - (box.width - width) / 2) / width, (event.clientY - box.top - (box.height - height) / 2) / height];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus();
    down.set(event.pointerId, place(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const to = place(event), from = down.get(event.pointerId);
    pointer = to;
    if (!from) {
      readOut();
      pick();
      return;
    }
    const dx = to[0] - from[0], dy = to[1] - from[1];
    if (down.size === 2) {
      const other = [...down.entries()].find(([id]) => id !== event.pointerId)[1];
      const gap = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
      if (gap(to) > 0.01) camera.approach(gap(from) / gap(to));
    } else if (event.shiftKey) camera.aside(-dx, dy);
    else camera.orbit(-120 * dx, 90 * dy);
    down.set(event.pointerId, to);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => down.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.approach(event.deltaY > 0 ? 1.08 : 1 / 1.08);
  }, { passive: false });
}

function controls() {
  const fill = (id, names, chosen) => names.forEach((text, k) => $(id).add(new Option(text, k, false, k === chosen)));
  fill("condition", scene.conditions, scene.condition);
  fill("band", scene.bands, scene.band);
  $("hour-label").hidden = scene.keeps_hours;
  $("visibility-label").hidden = !scene.has_air;
  $("imager-label").hidden = scene.imager === "";
  $("imager-name").textContent = `as recorded by ${scene.imager}`;
  const hour = () => ($("hour-text").textContent = hourMoved
    ? `${String(Math.floor($("hour").value / 60)).padStart(2, "0")}:${String($("hour").value % 60).padStart(2, "0")}` : "as written");
  const visibility = () => ($("visibility-text").textContent = visibilityMoved ? `${(10 ** $("visibility").value / 1000).toFixed(1)} km` : "as written");
  $("hour").addEventListener("change", () => { hourMoved = true; hour(); });
  $("condition").addEventListener("change", () => { hourMoved = false; hour(); });
  $("visibility").addEventListener("change", () => { visibilityMoved = true; visibility(); });
  hour();
  visibility();
  for (const id of ["palette", "unit", "errors", "hold"]) $(id).addEventListener("change", () => frame && show());
  $("sweep").addEventListener("click", () => { location.href = `api/sweep?${parameters()}`; });
  $("keep").addEventListener("click", async () => {
    $("kept").textContent = "Computing the job of this view";
    try {
      $("kept").textContent = (await (await ask("keep", parameters())).json()).kept;
    } catch (error) {
      $("kept").textContent = error.message;
    }
  });
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  addEventListener("pagehide", () => fetch(`api/leave?viewer=${scene.viewer}`, { keepalive: true }));
}

async function begin() {
  for (;;) {
    try {
      scene = await (await ask("scene", "")).json();
      break;
    } catch (error) {
      trouble(error.said ? error.message : "The connection is lost: is irsig fly still running? Trying again.");
      await pause(2000);
    }
  }
  trouble("");
  camera = new Camera(scene.camera, scene.target);
  $("title").textContent = scene.title;
  document.querySelector("main").hidden = false;
  controls();
  keys();
  pointers();
  canvas.focus();
  loop();
}
begin();
