// The camera: where it stands around the target and where it looks, in the body frame (x forward,
// y starboard, z down). What it does to a question to the server is in parameters().

const RAD = Math.PI / 180;
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const add = (a, b, s = 1) => a.map((v, k) => v + s * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a, s) => a.map((v) => v * s);
const length = (a) => Math.sqrt(dot(a, a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export class Camera {
  constructor([azimuth, elevation, range, field], [x, y, z, radius]) {
    Object.assign(this, { azimuth, elevation, range, field, radius, centre: [x, y, z], look: [x, y, z] });
  }
  sensor() {
    const a = this.azimuth * RAD, e = this.elevation * RAD;
    return scaled([Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), -Math.sin(e)], this.range);
  }
  orbit(azimuth, elevation) {
    this.azimuth = (((this.azimuth + azimuth) % 360) + 360) % 360;
    this.elevation = clamp(this.elevation + elevation, -89, 89);
  }
  approach(factor) {
    this.range = clamp(this.range * factor, 1.5 * this.radius, 1e6);
  }
  zoom(factor) {
    this.field = clamp(this.field * factor, 0.05, 90);
  }
  // Axes of the picture: forward, right, up.
  axes() {
    const away = add(this.look, this.sensor(), -1), forward = scaled(away, 1 / length(away));
    const across = cross(forward, [0, 0, -1]);
    const right = length(across) > 1e-6 ? scaled(across, 1 / length(across)) : [0, 1, 0];
    return { forward, right, up: cross(right, forward), distance: length(away) };
  }
  // Looks aside by fractions of the picture's width.
  aside(x, y) {
    const { right, up, distance } = this.axes(), width = 2 * distance * Math.tan((this.field / 2) * RAD);
    this.look = add(add(this.look, right, x * width), up, y * width);
  }
  // Moves the sensor and what it looks at, by fractions of its distance.
  fly(ahead, right, up) {
    const axes = this.axes(), level = [axes.forward[0], axes.forward[1], 0], size = length(level) || 1;
    let by = scaled(level, ahead / size);
    by = add(add(by, axes.right, right), [0, 0, -1], up);
    by = scaled(by, Math.max(this.range, this.radius));
    const at = add(this.sensor(), by);
    this.look = add(this.look, by);
    this.range = Math.max(length(at), 1.5 * this.radius);
    this.azimuth = ((Math.atan2(at[1], at[0]) / RAD) + 360) % 360;
    this.elevation = clamp(Math.asin(clamp(-at[2] / length(at), -1, 1)) / RAD, -89, 89);
  }
  parameters() {
    return { azimuth_deg: this.azimuth, elevation_deg: this.elevation, range_m: this.range,
      field_of_view_deg: this.field, look_x_m: this.look[0], look_y_m: this.look[1], look_z_m: this.look[2] };
  }
}
