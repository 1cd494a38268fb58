// Poses, and where odometry's own coordinates lie in those of the virtual world.

const kDegrees = Math.PI / 180;

export const fromDegrees = ({ x_mm, y_mm, heading_deg }) => ({
  x_mm,
  y_mm,
  heading_rad: heading_deg * kDegrees,
});

export const toDegrees = (radians) => radians / kDegrees;

// `pose` is in a frame whose origin is at `frame`: where that is outside.
export function outOf(frame, pose) {
  const c = Math.cos(frame.heading_rad);
  const s = Math.sin(frame.heading_rad);
  return {
    x_mm: frame.x_mm + c * pose.x_mm - s * pose.y_mm,
    y_mm: frame.y_mm + s * pose.x_mm + c * pose.y_mm,
    heading_rad: frame.heading_rad + pose.heading_rad,
  };
}

// The frame in which `inside` is where `outside` is outside.
export function frameOf(inside, outside) {
  const heading_rad = outside.heading_rad - inside.heading_rad;
  const turned = outOf({ x_mm: 0, y_mm: 0, heading_rad }, inside);
  return { x_mm: outside.x_mm - turned.x_mm, y_mm: outside.y_mm - turned.y_mm, heading_rad };
}

// The half axes, and the direction of the longer one, of an ellipse of `sigmas` deviations.
export function ellipse({ xx_mm2, xy_mm2, yy_mm2 }, sigmas) {
  const middle = (xx_mm2 + yy_mm2) / 2;
  const apart = Math.hypot((xx_mm2 - yy_mm2) / 2, xy_mm2);
  return {
    a_mm: sigmas * Math.sqrt(Math.max(middle + apart, 0)),
    b_mm: sigmas * Math.sqrt(Math.max(middle - apart, 0)),
    angle_rad: Math.atan2(2 * xy_mm2, xx_mm2 - yy_mm2) / 2,
  };
}

// Whether a robot cannot have driven from one pose to the other in that time: it was carried, or
// its odometry was set.
export function jumped(before, after, seconds) {
  const kFastest_mm_s = 500;
  const kSlack_mm = 60;
  const way = Math.hypot(after.x_mm - before.x_mm, after.y_mm - before.y_mm);
  return way > 2 * kFastest_mm_s * Math.max(seconds, 0) + kSlack_mm;
}
