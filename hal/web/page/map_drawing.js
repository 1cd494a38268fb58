// How things look on the map. All take the canvas's context, the viewport and the colours.

const kDegrees = Math.PI / 180;
export const kRobotRadius_mm = 165; // a Create is 330 mm across

export function mapColours(style) {
  const names = ["ground", "grid", "wall", "box", "cliff", "beam", "base", "estimate", "truth",
    "danger", "muted", "text", "panel"];
  return Object.fromEntries(names.map((name) => [name, style(`--${name}`)]));
}

function line(c, view, points) {
  c.beginPath();
  let down = false;
  for (const [x_mm, y_mm] of points) {
    if (down) c.lineTo(view.x(x_mm), view.y(y_mm));
    else c.moveTo(view.x(x_mm), view.y(y_mm));
    down = true;
  }
}

function disc(c, view, x_mm, y_mm, radius_mm) {
  c.beginPath();
  c.arc(view.x(x_mm), view.y(y_mm), Math.max(radius_mm * view.px_mm, 1), 0, 2 * Math.PI);
}

// Lines a metre apart or, seen from afar, ten; the axes a little stronger.
export function drawGrid(c, view, colours) {
  const step = [100, 500, 1000, 5000, 10000, 50000].find((mm) => mm * view.px_mm >= 40) ?? 50000;
  const low = view.floor(0, view.height);
  const high = view.floor(view.width, 0);
  c.lineWidth = 1;
  c.strokeStyle = colours.grid;
  for (let i = Math.ceil(low.x_mm / step); i <= high.x_mm / step; i += 1) {
    line(c, view, [[i * step, low.y_mm], [i * step, high.y_mm]]);
    c.stroke();
  }
  for (let i = Math.ceil(low.y_mm / step); i <= high.y_mm / step; i += 1) {
    line(c, view, [[low.x_mm, i * step], [high.x_mm, i * step]]);
    c.stroke();
  }
  drawScale(c, view, colours, step);
}

function drawScale(c, view, colours, step) {
  const [x, y, long] = [10, view.height - 10, step * view.px_mm];
  c.strokeStyle = colours.muted;
  c.fillStyle = colours.muted;
  c.lineWidth = 2;
  c.beginPath();
  c.moveTo(x, y - 4);
  c.lineTo(x, y);
  c.lineTo(x + long, y);
  c.lineTo(x + long, y - 4);
  c.stroke();
  c.font = "12px system-ui, sans-serif";
  c.fillText(step < 1000 ? `${step / 10} cm` : `${step / 1000} m`, x + 4, y - 5);
}

function drawRectangle(c, view, { x_mm, y_mm, width_mm, height_mm }) {
  c.beginPath();
  c.rect(view.x(x_mm), view.y(y_mm + height_mm), width_mm * view.px_mm, height_mm * view.px_mm);
}

// A beam ends somewhere in the room; how far it is drawn says nothing.
function drawBeam(c, view, { x_mm, y_mm, heading_deg }, colour, length_mm, half_deg) {
  const edge = (angle) => [
    x_mm + length_mm * Math.cos((heading_deg + angle) * kDegrees),
    y_mm + length_mm * Math.sin((heading_deg + angle) * kDegrees),
  ];
  line(c, view, [[x_mm, y_mm], edge(-half_deg), edge(half_deg)]);
  c.closePath();
  c.fillStyle = colour;
  c.globalAlpha = 0.18;
  c.fill();
  c.globalAlpha = 1;
}

export function drawWorld(c, view, colours, world) {
  for (const cliff of world.cliffs ?? []) {
    drawRectangle(c, view, cliff);
    c.fillStyle = colours.cliff;
    c.fill();
    c.setLineDash([6, 4]);
    c.strokeStyle = colours.danger;
    c.lineWidth = 1.5;
    c.stroke();
    c.setLineDash([]);
  }
  for (const beam of world.virtual_walls ?? []) {
    drawBeam(c, view, beam, colours.beam, 2500, 4);
    disc(c, view, beam.x_mm, beam.y_mm, 40);
    c.fillStyle = colours.beam;
    c.fill();
  }
  if (world.home_base) drawBase(c, view, colours, world.home_base);
  c.fillStyle = colours.box;
  c.strokeStyle = colours.wall;
  c.lineWidth = 1.5;
  for (const box of world.boxes ?? []) {
    drawRectangle(c, view, box);
    c.fill();
    c.stroke();
  }
  for (const { x_mm, y_mm, radius_mm } of world.posts ?? []) {
    disc(c, view, x_mm, y_mm, radius_mm);
    c.fill();
    c.stroke();
  }
  c.lineWidth = 3;
  c.lineCap = "round";
  for (const wall of world.walls ?? []) {
    line(c, view, [[wall.x1_mm, wall.y1_mm], [wall.x2_mm, wall.y2_mm]]);
    c.stroke();
  }
  c.lineCap = "butt";
}

function drawBase(c, view, colours, base) {
  drawBeam(c, view, base, colours.base, 600, 40);
  c.save();
  c.translate(view.x(base.x_mm), view.y(base.y_mm));
  c.rotate(-base.heading_deg * kDegrees);
  c.scale(view.px_mm, view.px_mm);
  c.fillStyle = colours.base;
  c.fillRect(-60, -150, 90, 300);
  c.restore();
}

export function drawTrack(c, view, colour, track, dashes) {
  c.beginPath();
  let down = false;
  track.forEach((x_mm, y_mm) => {
    const gap = Number.isNaN(x_mm);
    if (!gap && down) c.lineTo(view.x(x_mm), view.y(y_mm));
    if (!gap && !down) c.moveTo(view.x(x_mm), view.y(y_mm));
    down = !gap;
  });
  c.strokeStyle = colour;
  c.lineWidth = 2;
  c.setLineDash(dashes);
  c.stroke();
  c.setLineDash([]);
}

export function drawEllipse(c, view, colour, pose, { a_mm, b_mm, angle_rad }) {
  c.beginPath();
  c.ellipse(view.x(pose.x_mm), view.y(pose.y_mm), a_mm * view.px_mm, b_mm * view.px_mm,
    -angle_rad, 0, 2 * Math.PI);
  c.strokeStyle = colour;
  c.lineWidth = 1.5;
  c.stroke();
  c.globalAlpha = 0.15;
  c.fillStyle = colour;
  c.fill();
  c.globalAlpha = 1;
}

// The hull, with its bumper in front and a line that says where front is.
export function drawRobot(c, view, colours, colour, pose, radius_mm, { filled, pressed }) {
  const radius = Math.max(radius_mm * view.px_mm, 7);
  c.save();
  c.translate(view.x(pose.x_mm), view.y(pose.y_mm));
  c.rotate(-pose.heading_rad);
  c.beginPath();
  c.arc(0, 0, radius, 0, 2 * Math.PI);
  if (filled) {
    c.fillStyle = colours.panel;
    c.globalAlpha = 0.75;
    c.fill();
    c.globalAlpha = 1;
  }
  c.strokeStyle = colour;
  c.lineWidth = 2.5;
  c.stroke();
  c.beginPath();
  c.moveTo(0, 0);
  c.lineTo(radius, 0);
  c.stroke();
  // On a canvas y grows downwards: the robot's left is at negative angles.
  for (const [side, from, to] of [["left", -1.3, -0.08], ["right", 0.08, 1.3]]) {
    if (!pressed?.[side]) continue;
    c.beginPath();
    c.arc(0, 0, radius + 2, from, to);
    c.strokeStyle = colours.danger;
    c.lineWidth = 5;
    c.stroke();
  }
  c.restore();
}

// A cross where it bumped, a triangle where a hazard ended its mode.
export function drawMark(c, view, colours, { x_mm, y_mm, kind }) {
  const [x, y] = [view.x(x_mm), view.y(y_mm)];
  c.beginPath();
  if (kind === "bump") {
    c.moveTo(x - 5, y - 5);
    c.lineTo(x + 5, y + 5);
    c.moveTo(x + 5, y - 5);
    c.lineTo(x - 5, y + 5);
  } else {
    c.moveTo(x, y - 7);
    c.lineTo(x + 7, y + 5);
    c.lineTo(x - 7, y + 5);
    c.closePath();
  }
  c.strokeStyle = colours.danger;
  c.lineWidth = 2.5;
  c.stroke();
}
