// The map: the world, the way driven, where odometry and the truth put the robot, and where it
// bumped. Of a virtual Create it is drawn in the world's coordinates, else in odometry's.

import { byId, fitCanvas, fixed, isNumber, onColours, oncePerFrame, setAttribute, setText, style }
  from "./dom.js";
import { ellipse, frameOf, fromDegrees, jumped, outOf, toDegrees } from "./frames.js";
import { Ring, Track } from "./history.js";
import * as drawing from "./map_drawing.js";
import { Bounds, Viewport } from "./viewport.js";

const kPoints = 6000;
const kApart_mm = 20;
const kMarks = 200;
const kLate_s = 0.5; // after that, the robot is not where the event was
// Within them are 95 % of a place, which has two dimensions, and of a heading, which has one.
const kSigmasOfPlace = 2.448;
const kSigmasOfHeading = 1.96;
const kSame = { x_mm: 0, y_mm: 0, heading_rad: 0 };

export class RobotMap {
  constructor(link, canvas = byId("map")) {
    this.link = link;
    this.canvas = canvas;
    this.view = new Viewport();
    this.draw = oncePerFrame(() => this.#draw());
    this.following = true;
    this.#forget();
    link.addEventListener("hello", ({ detail }) => this.#meet(detail));
    link.addEventListener("world", ({ detail }) => this.#takeWorld(detail));
    link.addEventListener("state", ({ detail }) => this.#takeState(detail));
    link.addEventListener("truth", ({ detail }) => this.#takeTruth(detail));
    link.addEventListener("event", ({ detail }) => this.#takeEvent(detail));
    new ResizeObserver(() => this.draw()).observe(canvas);
    onColours(() => {
      this.colours = drawing.mapColours(style);
      this.draw();
    });
  }

  // Both of them as drawn, in the map's coordinates; undefined if not known.
  get odometry() {
    return this.state && outOf(this.frame ?? kSame, this.state.pose);
  }
  get radius_mm() {
    return this.world?.robot_radius_mm ?? drawing.kRobotRadius_mm;
  }

  fit() {
    const all = new Bounds();
    this.#addWorld(all);
    for (const track of [this.track, this.trueTrack]) track.forEach((x, y) => all.add(x, y, 100));
    for (const pose of [this.odometry, this.truth]) if (pose) all.add(pose.x_mm, pose.y_mm, 300);
    if (all.empty) all.add(0, 0, 1000);
    if (all.right - all.left < 1500) all.add((all.left + all.right) / 2, all.bottom, 750);
    this.view.fit(all);
    this.draw();
  }

  #forget() {
    this.hello = null;
    this.world = null;
    this.state = undefined;
    this.truth = undefined;
    this.truthTime_s = 0;
    this.frame = null; // of odometry, in the world; null until both are known
    this.track = new Track(kPoints, kApart_mm);
    this.trueTrack = new Track(kPoints, kApart_mm);
    this.marks = new Ring(kMarks);
    this.fitted = false;
  }

  // Another process, or the same one on another robot, begins another map.
  #meet(hello) {
    const same = this.hello && this.hello.pid === hello.pid && this.hello.port === hello.port;
    if (!same) this.#forget();
    this.hello = hello;
    this.track.gap();
    this.trueTrack.gap();
    byId("truth-row").hidden = hello.robot !== "virtual Create";
    this.draw();
  }

  #takeWorld(world) {
    this.world = world;
    this.fitted = false;
    this.draw();
  }

  #takeState(state) {
    const before = this.state;
    if (before && (state.robot_time_s < before.robot_time_s ||
        jumped(before.pose, state.pose, state.robot_time_s - before.robot_time_s))) {
      this.frame = null;
      this.track.gap();
    }
    this.state = state;
    this.#align();
    const at = this.odometry;
    if (!this.truth || this.frame) this.track.add(at.x_mm, at.y_mm);
    this.draw();
  }

  #takeTruth({ pose, time_s }) {
    const truth = fromDegrees(pose);
    if (this.truth && (time_s < this.truthTime_s ||
        jumped(this.truth, truth, time_s - this.truthTime_s))) {
      this.frame = null;
      this.trueTrack.gap();
      this.track.gap();
    }
    this.truth = truth;
    this.truthTime_s = time_s;
    this.trueTrack.add(truth.x_mm, truth.y_mm);
    this.#align();
    this.draw();
  }

  // Odometry does not know where it began. From the first moment that both are known, it is drawn
  // from the truth on: what they are apart later is its error since then.
  #align() {
    if (this.frame || !this.truth || !this.state) return;
    this.frame = frameOf(this.state.pose, this.truth);
    this.track.gap();
  }

  #takeEvent(event) {
    const kind = { bump_began: "bump", mode_lost: "hazard" }[event.what];
    const pose = this.truth ?? this.odometry;
    // A new connection begins with what happened before, elsewhere.
    const late_s = this.state ? this.state.robot_time_s - event.robot_time_s : Infinity;
    if (!kind || !pose || Math.abs(late_s) > kLate_s) return;
    const sides = String(event.bumps ?? "");
    const turn = sides.includes("left") - sides.includes("right");
    const angle = pose.heading_rad + 0.7 * turn;
    const out_mm = kind === "bump" ? this.radius_mm : 0;
    this.marks.push({
      kind,
      x_mm: pose.x_mm + out_mm * Math.cos(angle),
      y_mm: pose.y_mm + out_mm * Math.sin(angle),
    });
    this.draw();
  }

  #addWorld(all) {
    const { walls = [], boxes = [], posts = [], cliffs = [], virtual_walls = [], home_base } =
      this.world ?? {};
    for (const wall of walls) {
      all.add(wall.x1_mm, wall.y1_mm);
      all.add(wall.x2_mm, wall.y2_mm);
    }
    for (const box of [...boxes, ...cliffs]) {
      all.add(box.x_mm, box.y_mm);
      all.add(box.x_mm + box.width_mm, box.y_mm + box.height_mm);
    }
    for (const post of posts) all.add(post.x_mm, post.y_mm, post.radius_mm);
    for (const beam of virtual_walls) all.add(beam.x_mm, beam.y_mm, 100);
    if (home_base) all.add(home_base.x_mm, home_base.y_mm, 150);
  }

  #draw() {
    const c = this.canvas.getContext("2d");
    const view = Object.assign(this.view, fitCanvas(this.canvas));
    const { colours, odometry, truth } = this;
    const shown = truth ?? odometry;
    if (!this.fitted && shown && view.width > 1) {
      this.fitted = true;
      this.fit();
    }
    if (this.following && shown) view.follow(shown.x_mm, shown.y_mm);
    c.fillStyle = colours.ground;
    c.fillRect(0, 0, view.width, view.height);
    drawing.drawGrid(c, view, colours);
    if (this.world) drawing.drawWorld(c, view, colours, this.world);
    drawing.drawTrack(c, view, colours.truth, this.trueTrack, [5, 4]);
    drawing.drawTrack(c, view, colours.estimate, this.track, []);
    for (let i = 0; i < this.marks.length; i += 1) {
      drawing.drawMark(c, view, colours, this.marks.at(i));
    }
    this.#drawRobots(c, view, colours, odometry, truth);
    this.#describe(odometry, truth);
  }

  #drawRobots(c, view, colours, odometry, truth) {
    const bumps = String(this.state?.bumps ?? "");
    const pressed = { left: bumps.includes("left"), right: bumps.includes("right") };
    if (truth) {
      drawing.drawRobot(c, view, colours, colours.truth, truth, this.radius_mm,
        { filled: true, pressed });
    }
    if (!odometry) return;
    const around = this.#uncertainty();
    if (around) drawing.drawEllipse(c, view, colours.estimate, odometry, around);
    drawing.drawRobot(c, view, colours, colours.estimate, odometry, this.radius_mm,
      truth ? {} : { filled: true, pressed });
  }

  #uncertainty() {
    const { covariance } = this.state;
    if (!covariance || !isNumber(covariance.xx_mm2)) return null;
    const found = ellipse(covariance, kSigmasOfPlace);
    return { ...found, angle_rad: found.angle_rad + (this.frame ?? kSame).heading_rad };
  }

  // The same in words, for who cannot see the picture.
  #describe(odometry, truth) {
    if (odometry) {
      setText(byId("pose"), place(odometry));
      const around = this.#uncertainty();
      const variance = Math.max(this.state.covariance?.hh_rad2 ?? 0, 0);
      const heading = toDegrees(kSigmasOfHeading * Math.sqrt(variance));
      setText(byId("uncertainty"),
        around ? `${around.a_mm.toFixed(0)} mm, ${heading.toFixed(1)}° (95 %)` : "–");
    }
    if (truth) setText(byId("truth"), place(truth));
    if (truth ?? odometry) {
      const marks = `${this.marks.length} marks of bumps and hazards`;
      setAttribute(this.canvas, "aria-label",
        `Map. The robot is at ${place(truth ?? odometry)}. ${marks}.`);
    }
  }
}

function place({ x_mm, y_mm, heading_rad }) {
  const degrees = toDegrees(Math.atan2(Math.sin(heading_rad), Math.cos(heading_rad)));
  return `x ${fixed(x_mm)} mm, y ${fixed(y_mm)} mm, ${fixed(degrees)}°`;
}
