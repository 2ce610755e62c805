// SVG and HTML, element by element: names and messages come from databases and are text, never markup.

const SVG = "http://www.w3.org/2000/svg";

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {}))
    if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, value);
  for (const child of children) if (child !== null && child !== undefined) element.append(child);
  return element;
}
export const svg = (name, attributes, ...children) => filled(document.createElementNS(SVG, name), attributes, children);
export const html = (name, attributes, ...children) => filled(document.createElement(name), attributes, children);

export const path = (points) => points.map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");

// A panel shows its content or, in its place, why there is none.
export class Panel {
  constructor(id) {
    this.section = document.getElementById(id);
    this.body = this.section.querySelector(".body");
    this.words = this.section.querySelector(".words");
    this.tools = this.section.querySelector(":scope > .tools");
    this.readout = this.section.querySelector(":scope > .readout");
  }
  // A plot that is drawn anew keeps the focus.
  show(...content) {
    this.words.hidden = true;
    this.body.hidden = false;
    const held = this.body.contains(document.activeElement) && document.activeElement.matches(".plot");
    if (content.length > 0) this.body.replaceChildren(...content);
    if (held) this.body.querySelector(".plot")?.focus();
  }
  // Beside the content.
  say(words) {
    this.words.textContent = words;
    this.words.hidden = words === "";
  }
  fail(message) {
    this.say(message);
    this.body.hidden = true;
    if (this.readout) this.readout.textContent = "";
    this.tools.replaceChildren();
  }
  title(text) {
    const heading = this.section.querySelector("h2");
    if (heading.textContent !== text) heading.textContent = text;
  }
  offer(command, files) {
    offer(this.tools, command, files);
  }
}

// command: what prints the same; files: [name, address].
export function offer(tools, command, files) {
  const links = files.map(([name, address]) => html("a", { href: address, download: true }, name));
  tools.replaceChildren(
    html("button", { type: "button", "data-command": command, title: command }, "Copy as CLI command"), ...links);
}

export function table(caption, heads, rows) {
  return html("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    html("table", {}, html("caption", {}, caption),
      html("thead", {}, html("tr", {}, ...heads.map((h) => html("th", { scope: "col" }, h)))),
      html("tbody", {}, ...rows.map((row) => html("tr", {},
        ...row.map((cell, k) => (k === 0 ? html("th", { scope: "row" }, cell) : html("td", {}, cell))))))));
}
