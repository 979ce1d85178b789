// Error against time and error against budget of one recording, both axes logarithmic.
// Colour and filling = sampler, symbol and dash = filter, so that lines differ in grey print, too: 32 samplers, 60 filters.
const symbols = {circle: '●', square: '■', diamond: '◆', cross: '✚', x: '✖', 'triangle-up': '▲', 'triangle-down': '▼', star: '★',
  'triangle-left': '◀', 'triangle-right': '▶'};
const fillings = ['', '-open', '-dot', '-open-dot'];
const dashes = ['none', '8 4', '2 3', '8 3 2 3', '16 4', '16 3 2 3'];

// Place in two lists that both change from one number to the next and do not repeat together.
const inBoth = (i, first, second) => [i % first.length, (i % first.length + Math.floor(i / first.length)) % second.length];
const fillingOf = (sampler) => fillings[inBoth(sampler, palettes.light, fillings)[1]];
function symbolOf(filter) {
  const [symbol, dash] = inBoth(filter, Object.keys(symbols), dashes);
  return {symbol: Object.keys(symbols)[symbol], dash: dashes[dash]};
}

// Plotly reads a subset of HTML in its labels.
const plotText = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');

// A long name in several lines.
const wrappedText = (text) => (text.match(text.length < 50 ? /.+/g : /.{1,40}(?:[ ,]|$)|.{40}/g) ?? []).map(plotText).join('<br>');

const isPositive = (value) => value > 0 && Number.isFinite(value);

// A bar that reaches zero or below has no end on a logarithmic axis: it ends off the axis instead.
function errorBar(points, colour) {
  const known = (p) => Number.isFinite(p.low) && Number.isFinite(p.high);
  return {
    type: 'data', symmetric: false, visible: true, color: colour, thickness: 1.5, width: 4,
    array: points.map((p) => (known(p) ? p.high - p.mean : NaN)),
    arrayminus: points.map((p) => (known(p) ? p.mean - Math.max(p.low, p.mean * 1e-6) : NaN)),
  };
}

// Labels at 1, 2 and 5 of each decade, at 1 alone over many, of some decades over very many, written out with their unit: 0.1 s, 0.2 s.
function logTicks([low, high], unit = '') {
  if (high - low < 0.35) return {};  // plotly's choice on a short axis
  const tickvals = [], step = Math.ceil((high - low) / 12);
  for (let decade = step * Math.floor(low / step); decade <= high; decade += step) {
    for (const digit of high - low > 4 ? [1] : [1, 2, 5]) {
      const value = Number(`${digit}e${decade}`), at = Math.log10(value);
      if (at >= low && at <= high) tickvals.push(value);
    }
  }
  return {tickvals, ticktext: tickvals.map((value) => numberText(value, 1) + unit)};
}

const budgetOf = (c) => ({mean: c.spp, low: NaN, high: NaN});

function budgetTicks(points) {
  const budgets = [...new Set(points.map((c) => c.spp))].sort((a, b) => a - b);
  return budgets.length > 0 && budgets.length < 12 ? {tickvals: budgets, ticktext: budgets.map(String)} : {};
}

// Range that holds all means and those interval ends that are within a factor 100 of their mean.
function logRange(points) {
  const ends = points.flatMap((p) => [p.mean, p.low, p.high].filter(
    (end) => isPositive(end) && end > p.mean / 100));
  const low = Math.log10(Math.min(...ends)), high = Math.log10(Math.max(...ends));
  const margin = Math.max(0.06 * (high - low), 0.05);
  return [low - margin, high + margin];
}

function hoverText(c) {
  const lines = [`${c.spp} spp${c.replicates ? `, ${c.replicates} replicates` : ''}`];
  for (const name of [shown.metric, 'energy_ratio', 'seconds_total']) {
    if (!quantityIndex.has(name)) continue;
    const value = interval(c, name);
    lines.push(`${name} ${numberText(value.mean)}${boundsText(value)}`);
  }
  const [letters, against] = c.ranks[shown.metric] ?? ['', ''];
  if (letters) lines.push(`group ${letters}`);
  if (against) lines.push(againstText(against, report.baseline));
  return [wrappedText(methodOf(c)), ...lines.map(plotText)].join('<br>');
}

// x: what a combination's place on the horizontal axis is, as {mean, low, high}. With `dodge`, lines stand beside each
// other where they would hide each other's bars: at most 4 % apart from their place.
function traces(combinations, {x, dodge, metric}) {
  const groups = new Map();
  for (const c of combinations) {
    const key = c.sampler * report.filters.length + c.filter;
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(c);
  }
  return [...groups.values()].map((group, i) => {
    const aside = dodge && groups.size > 1 ? 1 + 0.08 * (i / (groups.size - 1) - 0.5) : 1;
    const {sampler, filter} = group[0];
    const colour = samplerColour(sampler), {symbol, dash} = symbolOf(filter), filling = fillingOf(sampler);
    const ys = group.map((c) => interval(c, metric)), xs = group.map(x);
    return {
      type: 'scatter', mode: 'lines+markers', name: wrappedText(methodOf(group[0])),
      x: xs.map((p) => p.mean * aside), customdata: xs.map((p) => p.mean), y: ys.map((p) => p.mean),
      error_y: errorBar(ys, colour), error_x: errorBar(xs, colour),
      text: group.map(hoverText), hovertemplate: '%{text}<extra></extra>',
      marker: {color: colour, symbol: symbol + filling, size: 10,
        line: filling === '-dot' ? {color: pageColour('--page'), width: 1.5} : {}},
      line: {color: colour, width: 1.2, dash},
    };
  });
}

// Less is better of it.
function costOf(metric, value) {
  const better = report.better[metric];
  return better === 'higher' ? -value : better === 'near 1' ? Math.abs(Math.log(value)) : value;
}

function frontTrace(combinations, {x, metric}) {
  const points = combinations.map((c) => [x(c).mean, interval(c, metric).mean])
    .sort((a, b) => a[0] - b[0] || costOf(metric, a[1]) - costOf(metric, b[1]));
  const front = [];
  for (const point of points) {
    if (front.length === 0 || costOf(metric, point[1]) < costOf(metric, front[front.length - 1][1])) front.push(point);
  }
  return {
    type: 'scatter', mode: 'lines', name: 'Pareto front of the means', hoverinfo: 'skip',
    x: front.map((p) => p[0]), y: front.map((p) => p[1]),
    line: {color: isDark() ? '#888' : '#999', width: 6, shape: 'hv'}, opacity: 0.35,
  };
}

// axes: {x, title, unit, ticks, dodge, front, metric, height}
function drawChart(target, combinations, axes) {
  target.hidden = combinations.length === 0;
  if (target.hidden) return;
  const narrow = target.clientWidth < 560;
  const axis = {...chartAxis(), type: 'log', ticks: 'outside', tickcolor: pageColour('--rule')};
  const ys = combinations.map((c) => interval(c, axes.metric)), xs = combinations.map(axes.x);
  const lines = traces(combinations, axes);
  if (axes.front) lines.unshift(frontTrace(combinations, axes));
  const longest = Math.max(...lines.map(({name}) => name.split('<br>').length));
  const legendRows = longest * (narrow ? lines.length : Math.ceil(lines.length / (longest > 1 ? 2 : 3)));
  const layout = {
    ...chartLook(13), height: (axes.height ?? 420) + Math.min(legendRows, 20) * 22, margin: {l: 10, r: 12, t: 12, b: 10},
    xaxis: {...axis, title: {text: axes.title}, range: logRange(xs), ...logTicks(logRange(xs), axes.unit), ...axes.ticks},
    yaxis: {...axis, title: {text: plotText(metricText(axes.metric))}, range: logRange(ys), ...logTicks(logRange(ys))},
    legend: {orientation: 'h', yref: 'container', y: 0, yanchor: 'bottom', x: 0, font: {size: 12}},
    hovermode: 'closest', showlegend: true,
    hoverlabel: {bgcolor: pageColour('--panel'), font: {color: pageColour('--text-colour')}},
  };
  target.style.minHeight = `${layout.height}px`;
  named(target, `${metricText(axes.metric)} against ${axes.title}, ${new Set(combinations.map(methodOf)).size} methods`);
  Plotly.react(target, lines, layout, {responsive: true, displaylogo: false,
    showSendToCloud: false, plotlyServerURL: '',  // the page makes no connection
    modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d', 'toImage', 'sendDataToCloud', 'sendChartToCloud']});
}

// More lines than these are no chart, and take seconds: the first methods of the table and the baseline, until all are asked for.
const mostLines = 12;
function firstMethods(names) {
  const ordered = headlineMethods().filter((name) => names.has(name));
  return new Set([...(ordered.length > 0 ? ordered : [...names]).slice(0, mostLines), report.baseline]);
}

function startCharts(area) {
  const heading = (text, target, name) => element('h3', {}, text + ' ',
    element('button', {type: 'button', class: 'small', onclick: () => saveChart(target, name)}, 'SVG'));
  const pareto = element('div', {class: 'chart', id: 'pareto-chart'});
  const budget = element('div', {class: 'chart', id: 'budget-chart'});
  const note = element('p', {class: 'note', 'aria-live': 'polite'});
  let all = false;
  const allButton = element('button', {type: 'button', onclick: () => { all = true; draw(); }});
  area.append(filterControls(), note, allButton,
    element('div', {class: 'charts'},
      element('figure', {}, heading('Error against time', pareto, 'error_time'), pareto),
      element('figure', {}, heading('Error against samples per pixel', budget, 'error_budget'), budget)));

  const draw = () => {
    let known = [...report.combinations, ...report.overall].filter(
      (c) => c.dump === shown.dump && isShown(c));
    const names = new Set(known.map(methodOf)), first = all ? names : firstMethods(names);
    known = known.filter((c) => first.has(methodOf(c)));
    allButton.hidden = first.size >= names.size;
    allButton.textContent = `all ${names.size} methods`;
    const drawable = known.filter((c) => isPositive(interval(c, shown.metric).mean));
    const timed = drawable.filter((c) => isPositive(interval(c, 'seconds_total').mean));
    const hidden = known.length - drawable.length;
    note.textContent = `${report.dumps[shown.dump] ?? 'All recordings'}. ` + 'Bars are 95 % intervals; colour and filling are the sampler, symbol and dash the filter. ' +
      'Points of a line are budgets; lines stand a little aside where their bars would meet.' + (allButton.hidden ? '' :
        ` Drawn are the first ${mostLines} methods of the table above and the baseline, of ${names.size}.`) + (shown.dump < report.dumps.length ? '' :
        ' Geometric means over the recordings, which are taken as given.') + (hidden === 0 ? '' :
        ` Not drawn, for they have no value above zero: ${hidden} of ${known.length}.`);
    drawChart(pareto, timed, {x: (c) => interval(c, 'seconds_total'), title: 'time', unit: ' s', front: true, metric: shown.metric});
    drawChart(budget, drawable, {x: budgetOf, title: 'samples per pixel', ticks: budgetTicks(drawable), dodge: true, metric: shown.metric});
  };
  listeners.push(draw);
  onLook(draw);
  afterFirstPaint(draw);
}
starts['chart-area'] = startCharts;

// Recording, metric, samplers and filters, for charts and table alike.
function filterControls() {
  const chips = (title, names, chosen, mark) => {
    const group = element('fieldset', {class: 'chips'}, element('legend', {}, title));
    names.forEach((name, i) => {
      const box = element('input', {type: 'checkbox', checked: chosen.has(i)});
      box.addEventListener('change', () => {
        if (box.checked) chosen.add(i); else chosen.delete(i);
        changed();
      });
      listeners.push(() => { box.checked = chosen.has(i); });
      group.append(element('label', {}, box, mark(i), ' ' + name));
    });
    return group;
  };
  const mark = (width, svg) => {
    const node = element('span', {class: 'mark', 'aria-hidden': 'true'});
    const paint = () => { node.innerHTML = `<svg width="${width}" height="14">${svg()}</svg>`; };
    onLook(paint);
    paint();
    return node;
  };
  const samplerMark = (i) => mark(14, () => {
    const colour = samplerColour(i), filling = fillingOf(i), open = filling.startsWith('-open');
    return `<circle cx="7" cy="7" r="5" stroke-width="2" stroke="${colour}" fill="${open ? 'none' : colour}"/>` +
      (filling.endsWith('-dot') ? `<circle cx="7" cy="7" r="1.8" fill="${open ? colour : pageColour('--page')}"/>` : '');
  });
  const filterMark = (i) => mark(44, () => `<path d="M0 7h44" stroke="currentColor" stroke-dasharray="${symbolOf(i).dash}"/>` +
    `<text x="22" y="12" text-anchor="middle" fill="currentColor">${symbols[symbolOf(i).symbol]}</text>`);
  return element('div', {class: 'controls'},
    select('Recording', report.overall.length > 0 ? [...report.dumps, 'all: geometric mean'] : report.dumps, shown.dump,
      (i) => { shown.dump = i; changed(); }),
    select('Error', report.metrics.map(metricText), report.metrics.indexOf(shown.metric),
      (i) => { shown.metric = report.metrics[i]; changed(); }),
    chips('Samplers', report.samplers, shown.samplers, samplerMark),
    chips('Filters', report.filters, shown.filters, filterMark));
}
