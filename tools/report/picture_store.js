// The stored pictures, unpacked when they are needed, and painted at their own size.
class Recent {  // keeps the last `most` entries
  constructor(most) { this.most = most; this.map = new Map(); }
  get(key, make) {
    const value = this.map.has(key) ? this.map.get(key) : make();
    this.map.delete(key);
    this.map.set(key, value);
    if (this.map.size > this.most) this.map.delete(this.map.keys().next().value);
    return value;
  }
}
const unpackedPictures = new Recent(24), paintedPictures = new Recent(12);

// Promise of {width, height, channels, values [y][x][c]}; null where it is not stored.
function loadPicture(set, name) {
  if (set?.live) return livePicture(set, name);
  const index = set?.images[name];
  if (index === undefined) return Promise.resolve(null);
  return unpackedPictures.get(index, async () => {
    const {width, height, channels} = report.pictures.images[index];
    return {width, height, channels, values: await unpackImage(index), key: index};
  });
}

const luminanceAt = (v, p) => 0.2126 * v[3 * p] + 0.7152 * v[3 * p + 1] + 0.0722 * v[3 * p + 2];

// Picture of estimate - reference, in luminance.
function differenceOf(a, b) {
  if (!a || !b) return null;
  const values = Float32Array.from({length: a.width * a.height},
    (_, p) => luminanceAt(a.values, p) - luminanceAt(b.values, p));
  return {...a, channels: 1, values, key: `${a.key}-${b.key}`};
}

function canvasOf(width, height) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

function painted(picture, colour) {
  const canvas = canvasOf(picture.width, picture.height), context = canvas.getContext('2d');
  const image = context.createImageData(picture.width, picture.height);
  for (let p = 0; p < picture.width * picture.height; ++p) {
    colour(p, image.data, 4 * p);
    image.data[4 * p + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

const srgbTable = Uint8Array.from({length: 4097}, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});

function paintImage(picture, exposure) {
  return paintedPictures.get(`${picture.key} ${exposure}`, () => {
    const factor = 2 ** exposure * 4096, {values, channels} = picture;
    const byte = (value) => srgbTable[Math.max(0, Math.min(4096, Math.round(value * factor)))];
    return painted(picture, (p, out, o) => {
      const colour = [0, 1, 2].map((c) => values[channels === 3 ? 3 * p + c : p]);
      const finite = colour.every(Number.isFinite);
      for (let c = 0; c < 3; ++c) out[o + c] = finite ? byte(colour[c]) : notFinite[c];
    });
  });
}

function paintMap(picture, scale, cyclic) {
  return paintedPictures.get(`${picture.key} ${scale.title} ${scale.ends}`, () => {
    const table = rampTable(scale.ramp);
    return painted(picture, (p, out, o) => {
      const at = scale.position(picture.values[p]);
      const index = cyclic ? ((at % 1) + 1) % 1 : Math.max(0, Math.min(1, at));
      for (let c = 0; c < 3; ++c) out[o + c] = Number.isNaN(at) ? noValue[c] : table[3 * Math.round(255 * index) + c];
    });
  });
}

// Result sets with pictures of one recording; `dump` is its index.
const setsOf = (dump) => report.pictures.sets.filter((set) => Object.keys(set.images).length > 0 &&
  report.combinations[set.combination].dump === dump);
const budgetsOf = (sets) => [...new Set(sets.map((set) => report.combinations[set.combination].spp))].sort((a, b) => a - b);

// Per pixel, sum over channels of the squared relative difference from the reference.
function relativeError(picture, reference) {
  const {values} = picture, truth = reference.values, n = picture.width * picture.height;
  const mean = truth.reduce((sum, v) => sum + (Number.isFinite(v) ? v : 0), 0) / truth.length || 1;
  return Float32Array.from({length: n}, (_, p) => {
    let sum = 0;
    for (let c = 0; c < 3; ++c) {
      const t = truth[3 * p + c] / mean, d = values[3 * p + c] / mean - t;
      sum += d * d / (t * t + 0.01);
    }
    return Number.isFinite(sum) ? sum : 0;
  });
}

// The square window with the largest sum of `score`, its outliers capped, half its side and more from those `taken`.
function bestWindow(score, width, height, side, taken = []) {
  const sorted = Float32Array.from(score).sort(), cap = sorted[Math.floor(0.98 * (sorted.length - 1))] || Infinity;
  const sums = new Float64Array((width + 1) * (height + 1)), row = width + 1;
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      sums[(y + 1) * row + x + 1] = Math.min(score[y * width + x], cap) + sums[y * row + x + 1] +
        sums[(y + 1) * row + x] - sums[y * row + x];
    }
  }
  let best = {x: 0, y: 0, side}, most = -1;
  for (let y = 0; y + side <= height; ++y) {
    for (let x = 0; x + side <= width; ++x) {
      const sum = sums[(y + side) * row + x + side] - sums[y * row + x + side] - sums[(y + side) * row + x] + sums[y * row + x];
      const free = taken.every((t) => Math.max(Math.abs(t.x - x), Math.abs(t.y - y)) >= 1.5 * side);
      if (free && sum > most) [best, most] = [{x, y, side}, sum];
    }
  }
  return best;
}
