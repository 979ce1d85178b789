// Which pages a book of images has, and how each maps values to colours.
const glslNumber = (value) => value.toExponential(8);

function logScale(low, high) {
  return {
    script: `float v = rgb.x; rgb = anynan(rgb) ? vec3(0.2, 0.2, 0.25) : infernoMap(log(${glslNumber(low)}), ` +
      `log(${glslNumber(high)}), log(max(v, ${glslNumber(low)})));`,
    min: low, max: high, bar: 'inferno', ends: [numberText(low, 2), numberText(high, 2)],
  };
}

function signedScale(high) {
  return {
    script: `float v = clamp(rgb.x / ${glslNumber(high)}, -1.0, 1.0); rgb = anynan(rgb) ? vec3(0.2) : ` +
      'v > 0.0 ? mix(vec3(0.9), vec3(0.45, 0.0, 0.02), v) : mix(vec3(0.9), vec3(0.0, 0.05, 0.4), -v);',
    min: -high, max: high, bar: 'signed', ends: [numberText(-high, 2), '0', numberText(high, 2)],
  };
}

const levelScale = {
  script: 'rgb = anynan(rgb) ? vec3(0.2) : infernoMap(-0.5, 6.0, rgb.x);',
  min: -0.5, max: 6, bar: 'inferno', ends: ['size 1', '64'],
};

const directionScale = {
  script: 'float t = 6.0 * mod(rgb.x, 180.0) / 180.0; rgb = anynan(rgb) ? vec3(0.2) : ' +
    'pow(clamp(abs(mod(t + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0), vec3(2.2));',
  min: 0, max: 180, bar: 'hue', ends: ['0°', '90°', '180°; grey: none'],
};

// At most 12 pages, the number a book can hold and keys can reach. `b` null: compared with the reference.
function bookPages(scene, a, b, spp) {
  const pages = [];
  const add = (name, set, picture, mapping, legend) => {
    const image = set?.images[picture];
    if (image !== undefined) pages.push({name, key: `${set.combination}-${picture}`, image, mapping, legend});
  };
  const error = logScale(1e-5 * scene.mean ** 2, scene.mean ** 2);
  const difference = signedScale(scene.mean / 2);
  const reference = a.images.reference !== undefined ? a : b;
  add('A', a, 'estimate', null, 'estimate A');
  add('B', b, 'estimate', null, 'estimate B');
  add('reference', reference, 'reference', null, 'what errors are measured against');
  const other = b ? b.images.estimate : a.images.reference;
  if (other !== undefined && a.images.estimate !== undefined) {
    pages.push({name: b ? 'A - B' : 'A - reference', minus: [a.images.estimate, other], mapping: difference,
      legend: 'difference of luminance; red: A is brighter'});
  }
  for (const [letter, set] of [['A', a], ['B', b]]) {
    add(`error ${letter}`, set, 'squared_error', error, 'squared error, mean over channels');
  }
  for (const [letter, set] of [['A', a], ['B', b]]) {
    add(`density ${letter}`, set, 'density', logScale(1, Math.max(2, 8 * spp)), 'samples per pixel');
  }
  for (const [letter, set] of [['A', a], ['B', b]]) {
    add(`size ${letter}`, set, 'filter_size', levelScale, 'filter size, pixels (2^value)');
  }
  for (const [letter, set] of [['A', a], ['B', b]]) {
    add(`direction ${letter}`, set, 'direction', directionScale, 'dominant direction');
  }
  return pages;
}

// Float32Array of RGB of a page; one channel is repeated.
async function pagePixels(page, cache) {
  const load = (index) => {
    if (!cache.has(index)) cache.set(index, unpackImage(index));
    return cache.get(index);
  };
  if (page.minus) {
    const [a, b] = await Promise.all(page.minus.map(load));
    const luminance = (v, i) => 0.2126 * v[3 * i] + 0.7152 * v[3 * i + 1] + 0.0722 * v[3 * i + 2];
    return grey(a.length / 3, (i) => luminance(a, i) - luminance(b, i));
  }
  const values = await load(page.image);
  const {channels} = report.pictures.images[page.image];
  return channels === 3 ? values : grey(values.length, (i) => values[i]);
}

function grey(pixels, value) {
  const result = new Float32Array(3 * pixels);
  for (let i = 0; i < pixels; ++i) result[3 * i] = result[3 * i + 1] = result[3 * i + 2] = value(i);
  return result;
}
