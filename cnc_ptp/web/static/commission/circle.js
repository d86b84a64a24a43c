// A circle through measured points, and how far they are from it.

/** Centre and radius by least squares (Kåsa): x² + y² = 2ax + 2by + c. Null for fewer than 3 points or for a line. */
export function fitCircle(xs, ys) {
  const count = xs.length;
  const [mx, my] = [mean(xs), mean(ys)];
  let [uu, vv, uv, uuu, vvv, uvv, vuu] = [0, 0, 0, 0, 0, 0, 0];
  for (let i = 0; i < count; i++) {
    const [u, v] = [xs[i] - mx, ys[i] - my];
    uu += u * u;
    vv += v * v;
    uv += u * v;
    uuu += u * u * u;
    vvv += v * v * v;
    uvv += u * v * v;
    vuu += v * u * u;
  }
  const determinant = uu * vv - uv * uv;
  if (count < 3 || determinant <= 1e-12 * uu * vv) return null;
  const [p, q] = [(uuu + uvv) / 2, (vvv + vuu) / 2];
  const [a, b] = [(p * vv - q * uv) / determinant, (q * uu - p * uv) / determinant];
  return { x: mx + a, y: my + b, radius: Math.sqrt(a * a + b * b + (uu + vv) / count) };
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Deviations of the radius, and points whose deviations are drawn larger by a factor. */
export function polar(xs, ys, circle, factor) {
  const [px, py] = [new Array(xs.length), new Array(xs.length)];
  let [least, most] = [Infinity, -Infinity];
  for (let i = 0; i < xs.length; i++) {
    const [dx, dy] = [xs[i] - circle.x, ys[i] - circle.y];
    const radius = Math.hypot(dx, dy);
    const deviation = radius - circle.radius;
    least = Math.min(least, deviation);
    most = Math.max(most, deviation);
    const scale = radius > 0 ? (circle.radius + factor * deviation) / radius : 0;
    px[i] = dx * scale;
    py[i] = dy * scale;
  }
  return { points: [px, py], least, most };
}
