// The figures, what is chosen to be shown, and small pieces that every part of the page uses.
const report = JSON.parse(document.getElementById('report-data').textContent);
const quantityIndex = new Map(report.quantities.map((q, i) => [q.name, i]));

// How an area of the page is filled, by its id: a page has some of them.
const starts = {};

// What is shown; parts of the page register for changes.
const shown = {
  dump: 0,
  metric: report.metric,
  samplers: new Set(report.samplers.keys()),
  filters: new Set(report.filters.keys()),
};
const listeners = [];
function changed() {
  for (const listener of listeners) listener();
}

function interval(combination, name) {
  const value = combination.values[quantityIndex.get(name)] ?? [];
  const [mean = NaN, low = NaN, high = NaN] = value.map(Number);
  return {mean, low, high};
}

// An image that was made elsewhere has a name, and no filter.
const methodOf = (c) => [report.samplers[c.sampler], report.filters[c.filter]].filter((name) => name).join(' + ');
// By its mark, as there is one of each number of threads.
const isBaseline = (c) => c.baseline || methodOf(c) === report.baseline;
const conditionOf = (dump, spp) => report.conditions.find((c) => c.dump === dump && c.spp === spp);
const rankedMethods = (dump, spp) => (conditionOf(dump, spp)?.field ?? []).map((i) => methodOf(report.combinations[i]));
const metricText = (name) => report.names?.[name] ?? name;
const isShown = (c) => shown.samplers.has(c.sampler) && shown.filters.has(c.filter);

function numberText(value, digits = 4) {
  if (Number.isNaN(value)) return '';
  if (!Number.isFinite(value)) return value > 0 ? 'inf' : '-inf';
  if (value === 0) return '0';
  const magnitude = Math.abs(value);
  if (magnitude >= 1e5 || magnitude < 1e-3) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

// Like the program's tables: a ratio that is not 1 does not read 1, which would not agree with the verdict beside it.
function ratioText(value, digits = 3) {
  const text = numberText(value, digits);
  return text === '1' && value !== 1 && digits < 6 ? ratioText(value, digits + 1) : text;
}

const boundsText = ({low, high}, digits = 4, text = numberText) => (Number.isFinite(low) ? ` [${text(low, digits)}, ${text(high, digits)}]` : '');

// element('td', {class: 'x', onclick: f}, 'text', child): text never becomes markup.
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value !== null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

function select(label, texts, value, onchange) {
  const list = element('select', {onchange: (event) => onchange(Number(event.target.value))});
  texts.forEach((text, i) => list.append(element('option', {value: i, selected: i === value}, text)));
  return element('label', {}, label + ' ', list);
}

// A picture or a chart, by its name.
function named(node, text) {
  node.setAttribute('role', 'img');
  node.setAttribute('aria-label', text);
  return node;
}

// While it is printed the page is light and its charts are as wide as paper.
const root = document.documentElement, darkQuery = matchMedia('(prefers-color-scheme: dark)');
const isPrinted = () => root.classList.contains('printed');
const isDark = () => darkQuery.matches && !isPrinted();
addEventListener('beforeprint', () => root.classList.add('printed'));
addEventListener('afterprint', () => root.classList.remove('printed'));
function onLook(draw) {
  darkQuery.addEventListener('change', draw);
  for (const name of ['beforeprint', 'afterprint']) addEventListener(name, draw);
}

// For what is below the first screen: it is there before anyone prints.
const afterFirstPaint = (draw) => requestAnimationFrame(() => setTimeout(draw));

// What plotly's charts take from the page.
const pageColour = (name) => getComputedStyle(root).getPropertyValue(name).trim();
const chartLook = (size) => ({paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)', width: isPrinted() ? 680 : undefined,
  font: {color: pageColour('--text-colour'), size}});
const chartAxis = () => ({gridcolor: pageColour('--rule'), linecolor: pageColour('--rule'), zeroline: false, automargin: true});

// Colours of samplers, distinct on the page's light and dark grounds and by colour-blind readers.
const palettes = {
  light: ['#0072b2', '#d55e00', '#009a4e', '#aa3377', '#909090', '#332288', '#5c3d00', '#222222'],
  dark: ['#4da3e0', '#ff8a4c', '#2fc79b', '#f7e3a1', '#9ad4f5', '#eeeeee', '#c0ff42', '#7d6bd6'],
};
const samplerColour = (sampler) => {
  const palette = isDark() ? palettes.dark : palettes.light;
  return palette[sampler % palette.length];
};
