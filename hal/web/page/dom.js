// What all parts of the page do with its elements.

export const byId = (id) => document.getElementById(id);

// Screen readers and layout notice each write, so that only changes are written.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
export function setAttribute(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

// An element with properties of its own (`className`, `onclick`), attributes (those with a hyphen,
// `role`, `for`, `list`) and children, which are elements or text.
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children);
  return element;
}

export const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

// As toFixed(), but what rounds to 0 has no sign.
export function fixed(value, decimals = 0) {
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

// A number with its unit, or a dash where it is not known.
export function quantity(value, unit, decimals = 0) {
  return isNumber(value) ? `${fixed(value, decimals)} ${unit}` : "–";
}

// Names as people write them: `cliff_front_left` is "cliff front left".
export const words = (name) => String(name).replaceAll("_", " ");

export function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// Called at once and whenever the colours change between light and dark.
export function onColours(changed) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  changed();
}

// Calls `draw` once before the next frame on the screen, however often it is asked to.
export function oncePerFrame(draw) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame((now) => {
      asked = false;
      draw(now);
    });
  };
}

// Makes the canvas as fine as the screen. Returns its size in CSS pixels.
export function fitCanvas(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const wanted = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) {
    [canvas.width, canvas.height] = wanted;
  }
  canvas.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
  return { width, height };
}
