// Colours for values: what each layer of the viewer maps to which colour, and the bar that says so.
const ramps = {
  // Stops of matplotlib's inferno, viridis and magma, and of ColorBrewer's RdBu: even in lightness, safe for the
  // colour-blind, readable in grey (the signed one by its ends' names).
  inferno: ['#000004', '#1b0c41', '#4a0c6b', '#781c6d', '#a52c60', '#cf4446', '#ed6925', '#fb9b06', '#f7d13d', '#fcffa4'],
  viridis: ['#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'],
  magma: ['#000004', '#180f3d', '#440f76', '#721f81', '#9e2f7f', '#cd4071', '#f1605d', '#fd9668', '#feca8d', '#fcfdbf'],
  signed: ['#2166ac', '#67a9cf', '#d1e5f0', '#f7f7f7', '#fddbc7', '#ef8a62', '#b2182b'],
  hue: ['#e05050', '#a89a20', '#35a35a', '#2b98c4', '#7b6fe0', '#c957b5', '#e05050'],
};
const rampTables = new Map();
const noValue = [110, 110, 110], notFinite = [255, 0, 200];

// Uint8Array of 256 colours.
function rampTable(name) {
  if (rampTables.has(name)) return rampTables.get(name);
  const stops = ramps[name].map((text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16)));
  const table = new Uint8Array(3 * 256);
  for (let i = 0; i < 256; ++i) {
    const at = i / 255 * (stops.length - 1), first = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; ++c) {
      table[3 * i + c] = Math.round(stops[first][c] + (at - first) * (stops[first + 1][c] - stops[first][c]));
    }
  }
  rampTables.set(name, table);
  return table;
}

// {ramp, position: value -> 0..1, ends: texts below the bar, title}
function logScale(ramp, low, high, title) {
  const span = Math.log(high / low);
  return {ramp, title: `${title}, log`, ends: [numberText(low, 2), numberText((low * high) ** 0.5, 2), numberText(high, 2)],
    position: (v) => Math.log(Math.max(v, low) / low) / span};
}
function linearScale(ramp, low, high, title, ends) {
  return {ramp, title, ends: ends ?? [numberText(low, 2), numberText((low + high) / 2, 2), numberText(high, 2)],
    position: (v) => (v - low) / (high - low)};
}

// The layers in the order of their buttons; `picture` is the stored image a layer shows.
const layers = {
  image: {name: 'image', picture: 'estimate'},
  error: {name: 'error', picture: 'squared_error',
    scale: (scene) => logScale('inferno', 1e-5 * scene.mean ** 2, scene.mean ** 2, 'squared error')},
  flip: {name: 'FLIP', picture: 'flip', scale: () => linearScale('magma', 0, 1, 'FLIP')},
  difference: {name: 'difference', picture: 'estimate', minus: 'reference',
    scale: ({mean}) => linearScale('signed', -mean / 2, mean / 2, 'estimate - reference, luminance')},
  density: {name: 'density', picture: 'density',
    scale: (scene, spp) => logScale('viridis', 1, Math.max(2, 8 * spp), 'samples per pixel')},
  size: {name: 'size', picture: 'filter_size',
    scale: () => linearScale('inferno', -0.5, 6, 'filter size, pixels', ['1', '', '64'])},
  direction: {name: 'direction', picture: 'direction', cyclic: true,
    scale: () => linearScale('hue', 0, 180, 'direction; grey: none', ['0°', '90°', '180°'])},
};

// The scale as a bar on the picture itself, lower left; `unit` is the size of a CSS pixel.
function drawBar(context, scale, width, height, unit) {
  const length = Math.min(0.6 * width, 220 * unit), thick = 9 * unit, pad = 6 * unit;
  const left = pad, top = height - thick - 20 * unit;
  context.fillStyle = 'rgba(0, 0, 0, 0.66)';
  context.fillRect(0, top - 20 * unit, length + 2 * pad, height);
  const table = rampTable(scale.ramp);
  for (let x = 0; x < length; ++x) {
    const i = 3 * Math.round(255 * x / (length - 1));
    context.fillStyle = `rgb(${table[i]}, ${table[i + 1]}, ${table[i + 2]})`;
    context.fillRect(left + x, top, 1.5, thick);
  }
  context.fillStyle = '#fff';
  context.font = `${11 * unit}px system-ui, sans-serif`;
  context.textBaseline = 'alphabetic';
  context.textAlign = 'left';
  context.fillText(scale.title, left, top - 6 * unit, length);
  scale.ends.forEach((text, i) => {
    context.textAlign = ['left', 'center', 'right'][i];
    context.fillText(text, left + i * length / 2, top + thick + 13 * unit);
  });
}
