// A plot that says what it holds: of the place under the pointer or the finger, and, step by step,
// of the one that the arrow keys have come to.

// picture: an SVG, or a canvas, whose points count in its pixels. first: the place where the keys begin; at(x, y): that at a point of the viewBox, or undefined;
// step(place, dx, dy): that beside it, up and to the right being positive; say(place).
export function readOut(picture, { first, at, step, say }) {
  let place = first;
  const go = (to) => {
    if (to === undefined) return;
    place = to;
    say(place);
  };
  const point = (event) => {
    const box = picture.getBoundingClientRect(), { width, height } = picture.viewBox?.baseVal ?? picture;
    go(at(((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * height));
  };
  picture.setAttribute("tabindex", "0");
  picture.setAttribute("role", "application");
  picture.setAttribute("aria-label", `${picture.getAttribute("aria-label")}; arrows go from value to value, with shift ten at a time`);
  picture.addEventListener("pointermove", point);
  picture.addEventListener("pointerdown", point);
  picture.addEventListener("focus", () => say(place));
  picture.addEventListener("keydown", (event) => {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!arrow || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const far = event.shiftKey ? 10 : 1;
    go(step(place, arrow[0] * far, arrow[1] * far));
  });
  return picture;
}

// The index of the least of `count` distances.
export function nearest(count, distance) {
  let best = 0;
  for (let k = 1; k < count; ++k) if (distance(k) < distance(best)) best = k;
  return best;
}
