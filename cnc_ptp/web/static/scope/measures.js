// Figures of a piece of a signal, and its spectrum.

/** Smallest, largest, mean, root mean square, peak to peak and slope (least squares, per s) of samples. */
export function measure(values, cycleTime) {
  let [count, low, high, sum, squares, times, products, timesSquared] = [0, Infinity, -Infinity, 0, 0, 0, 0, 0];
  for (let i = 0; i < values.length; i++) {
    const value = values[i];
    if (Number.isNaN(value)) continue;
    const time = i * cycleTime;
    count += 1;
    if (value < low) low = value;
    if (value > high) high = value;
    sum += value;
    squares += value * value;
    times += time;
    products += time * value;
    timesSquared += time * time;
  }
  if (count === 0) return { min: NaN, max: NaN, mean: NaN, rms: NaN, peak: NaN, slope: NaN };
  const spread = count * timesSquared - times * times;
  return { min: low, max: high, mean: sum / count, rms: Math.sqrt(squares / count), peak: high - low, slope: spread > 0 ? (count * products - times * sum) / spread : NaN };
}

/** Amplitudes over frequencies (Hz) of the newest power of two of samples, with a Hann window, without the mean. */
export function spectrum(values, cycleTime) {
  const size = 2 ** Math.floor(Math.log2(Math.max(1, values.length)));
  if (size < 8) return { frequencies: [], amplitudes: [] };
  const used = values.subarray(values.length - size);
  let mean = 0;
  for (const value of used) mean += (Number.isNaN(value) ? 0 : value) / size;
  const [real, imaginary] = [new Float64Array(size), new Float64Array(size)];
  for (let i = 0; i < size; i++) {
    const value = Number.isNaN(used[i]) ? 0 : used[i] - mean;
    real[i] = value * (0.5 - 0.5 * Math.cos((2 * Math.PI * i) / size));
  }
  transform(real, imaginary);
  const half = size / 2;
  const frequencies = Float64Array.from({ length: half }, (_, i) => i / (size * cycleTime));
  const amplitudes = Float64Array.from({ length: half }, (_, i) => (4 * Math.hypot(real[i], imaginary[i])) / size); // 2 of the sides, 2 of the window
  return { frequencies, amplitudes };
}

/** Fast Fourier transform in place, radix 2; the length is a power of two. */
export function transform(real, imaginary) {
  const size = real.length;
  for (let i = 1, j = 0; i < size; i++) {
    let bit = size >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [real[i], real[j]] = [real[j], real[i]];
      [imaginary[i], imaginary[j]] = [imaginary[j], imaginary[i]];
    }
  }
  for (let length = 2; length <= size; length *= 2) {
    const angle = (-2 * Math.PI) / length;
    for (let k = 0; k < length / 2; k++) {
      const [cos, sin] = [Math.cos(angle * k), Math.sin(angle * k)];
      for (let i = k; i < size; i += length) butterfly(real, imaginary, i, i + length / 2, cos, sin);
    }
  }
}

function butterfly(real, imaginary, a, b, cos, sin) {
  const re = real[b] * cos - imaginary[b] * sin;
  const im = real[b] * sin + imaginary[b] * cos;
  real[b] = real[a] - re;
  imaginary[b] = imaginary[a] - im;
  real[a] += re;
  imaginary[a] += im;
}
