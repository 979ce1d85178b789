// What was recorded at a pixel that was touched: its samples in the order of replicate 0, which of them A and B took, their
// running mean with its interval against the reference, and a histogram. Every number is the program's (spool pixel).
const pixelsOf = (dump) => report.pixels.find((entry) => entry.dump === dump)?.answers ?? [];

function buildPixelPanel(view) {
  view.pixelPanel = element('div', {class: 'pixel-panel', id: 'pixel-panel', 'aria-live': 'polite'});
  view.area.append(view.pixelPanel);
  view.listeners.push(() => drawPixelPanel(view));
  onLook(() => view.drawPixelCharts?.());
}

// The stored pixel that was touched, or the nearest within a few, of those in the picture.
function storedPixel(view) {
  const {pixel} = view.state, crop = view.scene().crop ?? [0, 0];
  if (!pixel) return null;
  const distance = (p) => Math.hypot(p.x - crop[0] - pixel.x, p.y - crop[1] - pixel.y);
  const isShown = (p) => p.x >= crop[0] && p.y >= crop[1] && p.x < crop[0] + view.size.width && p.y < crop[1] + view.size.height;
  const nearest = pixelsOf(view.scene().dump).filter(isShown).reduce((best, p) => (!best || distance(p) < distance(best) ? p : best), null);
  return nearest && distance(nearest) <= Math.max(2, view.size.width / 40) ? nearest : null;
}

async function drawPixelPanel(view) {
  const panel = view.pixelPanel, all = pixelsOf(view.scene().dump);
  if (all.length === 0 && !report.live) return;
  const asked = view.pixelAsked = `${JSON.stringify(view.state.pixel)} ${view.state.scene} ${view.pair().map((set) => set.combination)}`;
  const found = report.live ? await livePixelOf(view, asked) : storedPixel(view);
  if (asked !== view.pixelAsked) return;
  if (!found) {
    if (panel.dataset.at) Plotly.purge(panel.querySelector('.running'));
    panel.dataset.at = '';
    view.drawPixelCharts = null;
    panel.replaceChildren(element('p', {class: 'note'}, report.live ?
      view.pixelFailure ?? 'Touch a pixel: what was recorded there, and which samples A and B took.' : view.state.pixel ?
      'The samples of this pixel are not in the page; "spool pixel FILE --at X,Y" tells them. Round marks have theirs.' :
      'Touch a pixel with a round mark: what was recorded there, and which samples A and B took.'));
    return;
  }
  const [a, b] = view.pair(), crop = view.scene().crop ?? [0, 0];
  const key = `${found.x},${found.y},${a.combination},${b.combination},${view.state.exposure}`;
  if (panel.dataset.at === key) return;
  panel.dataset.at = key;
  const valueAt = async (set, name) => {
    const picture = await loadPicture(set, name);
    return picture ? picture.values[(found.y - crop[1]) * picture.width + found.x - crop[0]] : NaN;
  };
  const taken = await Promise.all([a, b].map((set) => valueAt(set, 'density')));
  const notes = await Promise.all([a, b].map(async (set, i) => {
    const [size, angle] = await Promise.all([valueAt(set, 'filter_size'), valueAt(set, 'direction')]);
    return `${'AB'[i]}, ${view.faces[i].name}: the first ${taken[i]} of ${found.capacity}` +
      (Number.isNaN(size) ? '' : `; filter size ${2 ** Math.max(0, size)}, direction ${Number.isNaN(angle) ? 'none' : `${numberText(angle, 3)}°`}`);
  }));
  if (panel.dataset.at !== key) return;
  const running = named(element('div', {class: 'chart running'}), 'Mean of the first samples with its interval, against samples');
  const histogram = named(element('div', {class: 'chart histogram'}), 'Number of samples against their luminance');
  panel.replaceChildren(
    element('h3', {}, `Pixel ${found.x}, ${found.y}: its samples in the order in which they are taken`),
    sampleStrip(found, taken, view.scene().exposure + view.state.exposure),
    element('p', {class: 'note'}, notes.join('. '), '.'),
    footprintFigures(view, found),
    element('div', {class: 'charts'}, element('figure', {}, element('h3', {}, 'Mean of the first samples, 95 % interval'), running),
      element('figure', {}, element('h3', {}, 'Luminance of the samples'), histogram)));
  const {reference} = view.images;
  const truth = reference ? luminanceAt(reference.values, (found.y - crop[1]) * reference.width + found.x - crop[0]) : NaN;
  view.drawPixelCharts = () => {
    drawRunning(running, found, taken, truth);
    drawHistogram(histogram, found);
  };
  view.drawPixelCharts();
}

// Asked once for a pixel and a pair.
async function livePixelOf(view, asked) {
  if (view.pixelTold?.asked !== asked) view.pixelTold = {asked, answer: livePixel(view)};
  try {
    view.pixelFailure = null;
    return await view.pixelTold.answer;
  } catch (error) {
    view.pixelFailure = error.message;
    return null;
  }
}

// A square for each sample in its colour; below, what A and B took.
function sampleStrip({samples}, taken, exposure) {
  const across = Math.min(64, samples.length), side = 14, rows = Math.ceil(samples.length / across);
  const canvas = canvasOf(across * side, rows * (side + 10)), context = canvas.getContext('2d');
  samples.forEach((sample, i) => {
    const x = i % across * side, y = Math.floor(i / across) * (side + 10);
    const byte = (v) => srgbTable[Math.max(0, Math.min(4096, Math.round((v ?? 0) * 2 ** exposure * 4096)))];
    context.fillStyle = `rgb(${sample.map(byte).join(', ')})`;
    context.fillRect(x, y, side - 1, side - 1);
    taken.forEach((n, k) => {
      context.fillStyle = insetColours[k];
      if (i < n) context.fillRect(x, y + side + 4 * k, side - 1, 3);
    });
  });
  canvas.className = 'samples';
  return named(canvas, `${samples.length} samples; A took ${taken[0]}, B took ${taken[1]}`);
}

function pixelLayout(xTitle, yTitle, more = {}) {
  return {...chartLook(12), height: 260, margin: {l: 10, r: 10, t: 8, b: 10}, showlegend: false, bargap: 0.05,
    xaxis: {...chartAxis(), type: 'log', title: {text: xTitle}}, yaxis: {...chartAxis(), title: {text: yTitle}, ...more}};
}
const pixelConfig = {responsive: true, displayModeBar: false, showSendToCloud: false, plotlyServerURL: ''};

function drawRunning(target, {mean, low, high}, taken, truth) {
  const x = mean.map((_, i) => i + 1), colour = samplerColour(0), last = x.length;
  const line = (y, more) => ({type: 'scatter', mode: 'lines', x, y, line: {color: colour, width: 1}, ...more});
  const lines = [line(low, {line: {width: 0}, hoverinfo: 'skip'}),
    line(high, {line: {width: 0}, fill: 'tonexty', fillcolor: 'rgba(80, 150, 220, 0.25)', hoverinfo: 'skip'}),
    line(mean, {name: 'mean', line: {color: colour, width: 2}})];
  if (Number.isFinite(truth)) {
    lines.push({type: 'scatter', mode: 'lines', x: [1, last], y: [truth, truth], name: 'reference', line: {color: '#888', dash: 'dash'}});
  }
  taken.forEach((n, i) => {
    if (n >= 1 && n <= last) {
      lines.push({type: 'scatter', mode: 'markers+text', x: [n], y: [mean[n - 1]], text: ['AB'[i]], textposition: taken[0] === taken[1] ? ['top left', 'top right'][i] : 'top center',
        name: `${'AB'[i]} stopped`, marker: {color: insetColours[i], size: 10, line: {color: '#000', width: 1}}});
    }
  });
  const ends = mean.filter((_, i) => i >= 1).concat(Number.isFinite(truth) ? [truth] : []);
  const top = 1.6 * Math.max(...ends, high[Math.min(7, last - 1)] ?? 0);
  Plotly.newPlot(target, lines, pixelLayout('samples', 'luminance', {range: [0, top]}), pixelConfig);
}

function drawHistogram(target, {histogram: {edges, counts, not_positive: zero}}) {
  const middle = counts.map((_, i) => (edges[i] * edges[i + 1]) ** 0.5), width = counts.map((_, i) => edges[i + 1] - edges[i]);
  Plotly.newPlot(target, [{type: 'bar', x: middle, y: counts, width, marker: {color: samplerColour(0)}}],
    pixelLayout(`luminance${zero > 0 ? `; ${zero} at or below 0 are not drawn` : ''}`, 'samples'), pixelConfig);
}
