// The first screen: methods x recordings at one budget, coloured by the ratio to a baseline; letters and verdicts are
// those of statistics.json. Ratios to another baseline are the file's pairs, read in the other direction where needed.
const verdictWords = ['better', 'worse', 'undecided', 'identical', 'not compared'];
const opposite = {better: 'worse', worse: 'better'};

function againstText(verdict, other) {
  const words = {undecided: 'not separated from', identical: 'identical to', 'not compared': 'not compared with'};
  return `${words[verdict] ?? `${verdict} than`} ${other}`;
}

// {mean, low, high, verdict} of a combination against the method `baseline` in the same condition; null where unknown.
function ratioTo(condition, index, baseline) {
  const c = report.combinations[index];
  if (baseline === report.baseline ? isBaseline(c) : methodOf(c) === baseline) return {mean: 1, low: NaN, high: NaN, verdict: 'baseline'};
  if (baseline === report.baseline) {
    const verdict = (c.ranks[report.metric] ?? [])[1];
    return verdict ? {...interval(c, `${report.metric}_ratio`), verdict} : null;
  }
  const place = condition.field.indexOf(index);
  const other = condition.field.findIndex((i) => methodOf(report.combinations[i]) === baseline);
  if (other < 0) return null;
  const inverse = (value) => (value === null ? NaN : 1 / value);  // null: not resolved
  for (const [a, b, mean, low, high, word] of condition.pairs) {
    const verdict = verdictWords[word];
    if (a === place && b === other) return {mean, low, high, verdict};
    if (a === other && b === place) return {mean: inverse(mean), low: inverse(high), high: inverse(low), verdict: opposite[verdict] ?? verdict};
  }
  return null;
}

// Blue is better, orange worse; full colour at a factor of 8 and beyond.
function ratioColour(ratio) {
  if (!isPositive(ratio)) return 'transparent';
  const t = Math.max(-1, Math.min(1, Math.log2(ratio) / 3));
  return t <= 0 ? `rgba(38, 128, 214, ${(-0.55 * t).toFixed(3)})` : `rgba(240, 120, 20, ${(0.55 * t).toFixed(3)})`;
}

const hero = {spp: null, baseline: report.baseline, dump: 0, all: false, most: 12};

function startHeadline(area) {
  const budgets = [...new Set(report.conditions.map((c) => c.spp))].sort((a, b) => a - b);
  if (budgets.length === 0) return;
  hero.spp = report.budget;
  const methods = [...new Set(report.conditions.flatMap((c) => c.field.map((i) => methodOf(report.combinations[i]))))];
  const others = report.conditions.some((c) => c.pairs.length > 0) ? methods.filter((m) => m !== report.baseline) : [];
  const baselines = [report.baseline, ...others].filter((name) => name);
  hero.baseline = baselines[0] ?? '';
  const holder = element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Methods and recordings'});
  const chart = element('div', {class: 'chart', id: 'hero-chart'}), title = element('h3');
  const strip = element('div', {class: 'crops', id: 'crops'});
  const note = element('p', {class: 'note'}), told = element('p', {class: 'note hint told'}, 'Point at a cell for its interval and verdict.');
  const tell = ({target}) => { told.textContent = target.closest('[title]')?.title || told.textContent; };
  for (const name of ['focusin', 'pointerover']) holder.addEventListener(name, tell);
  area.append(
    element('div', {class: 'controls'},
      select('Samples per pixel', budgets.map(String), budgets.indexOf(hero.spp), (i) => { hero.spp = budgets[i]; draw(); }),
      baselines.length > 1 ? select('Relative to', baselines, 0, (i) => { hero.baseline = baselines[i]; draw(); }) : null,
      exportButtons()),
    element('div', {class: 'hero'}, element('div', {}, holder, told, note), element('figure', {}, title, chart)), strip);
  function draw() {
    holder.replaceChildren(headlineTable(draw));
    const beside = report.better[report.metric] === 'lower' ? `relative to ${hero.baseline}: below 1 is better` : `beside ${hero.baseline}, without ratios`;
    note.textContent = `${metricText(report.metric)} at ${hero.spp} spp ${hero.baseline ? `${beside}. Bold: separated from it.` :
      'has no baseline: no ratios.'} Methods that ` +
      `share a letter are not separated. ${report.lettersNote} ‡: no verdict. ▼: loses energy.${report.pictures.sets.length > 0 ? ' A click shows the pictures.' : ''}`;
    title.textContent = `${report.dumps[hero.dump]}: ${metricText(report.metric)} against samples per pixel`;
    drawHeroChart(chart);
    drawCrops(strip);
  }
  onLook(() => drawHeroChart(chart));
  draw();
}
starts['headline-area'] = startHeadline;

// The rows: what the user added first; in the order of the overall ratio where there is one, else that of the first recording.
function headlineMethods() {
  const overall = report.overall.filter((c) => c.spp === hero.spp);
  const conditions = report.conditions.filter((c) => c.spp === hero.spp);
  const names = [...new Set(conditions.flatMap((c) => c.field.map((i) => methodOf(report.combinations[i]))))];
  if (overall.length === 0) return ownFirst(names);
  const means = new Map(overall.map((c) => [methodOf(c), costOf(report.metric, interval(c, report.metric).mean)]));
  const value = (name) => means.get(name) ?? Infinity;
  return ownFirst(names.sort((a, b) => (value(a) > value(b)) - (value(a) < value(b))));
}

const ownFirst = (names) => [...names.filter((name) => report.own.includes(name)), ...names.filter((name) => !report.own.includes(name))];

function headlineTable(redraw) {
  const conditions = report.conditions.filter((c) => c.spp === hero.spp);
  const withOverall = conditions.length > 1 && hero.baseline === report.baseline && report.overall.length > 0;
  const head = element('tr', {}, element('th', {scope: 'col'}, 'method'));
  for (const c of conditions) {
    head.append(element('th', {scope: 'col'}, element('button', {type: 'button', class: 'plain',
      'aria-pressed': String(c.dump === hero.dump), title: 'show in the chart',
      onclick: () => { hero.dump = c.dump; redraw(); }}, report.dumps[c.dump])));
  }
  if (withOverall) head.append(element('th', {scope: 'col', title: 'geometric mean over the recordings'}, 'all'));
  const names = headlineMethods(), body = element('tbody');
  const few = hero.all ? names : names.filter((name, i) => i < hero.most || (hero.baseline && name.startsWith(hero.baseline)));
  for (const name of few) {
    const row = element('tr', {}, element('th', {scope: 'row'}, name));
    for (const condition of conditions) row.append(headlineCell(condition, name));
    if (withOverall) row.append(overallCell(name));
    body.append(row);
  }
  const table = element('table', {class: 'headline', id: 'headline'}, element('thead', {}, head), body);
  if (few.length === names.length) return table;
  return element('div', {}, table, element('button', {type: 'button', onclick: () => { hero.all = true; redraw(); }},
    `all ${names.length} methods`));
}

function headlineCell(condition, name) {
  const index = condition.field.find((i) => methodOf(report.combinations[i]) === name);
  if (index === undefined) return element('td', {class: 'number'}, '');
  const c = report.combinations[index], ratio = ratioTo(condition, index, hero.baseline);
  const value = interval(c, report.metric), letters = (c.ranks[report.metric] ?? [''])[0] || (report.lettersNote ? '' : '‡');
  const mean = ratio?.verdict === 'baseline' ? '1' : ratioText(ratio?.mean ?? NaN) || '-';
  const told = ratio && (ratio.verdict === 'better' || ratio.verdict === 'worse');
  const words = [`${metricText(report.metric)} ${numberText(value.mean)}${boundsText(value, 3)}`];
  if (ratio && ratio.verdict !== 'baseline') words.push(`ratio ${mean}${boundsText(ratio, 3, ratioText)}: ${againstText(ratio.verdict, hero.baseline)}`);
  if (c.loses) words.push(`loses ${numberText(100 * c.loses, 2)} % of the energy`);
  const title = `${name}, ${report.dumps[condition.dump]}: ${words.join('; ')}`;
  return element('td', {class: `number ${ratio?.verdict ?? ''}`, 'data-ratio': ratio ? ratio.mean : '',
    'data-verdict': ratio?.verdict ?? '', style: `background: ${ratioColour(ratio?.verdict === 'not compared' ? NaN : ratio?.mean)}`},
  element('button', {type: 'button', class: 'cell', title, 'aria-label': title, onclick: () => openInViewer(c)},
    told ? element('b', {}, mean) : mean, ' ', element('span', {class: 'letters'}, letters), c.loses ? ' ▼' : ''));
}

function overallCell(name) {
  const c = report.overall.find((o) => o.spp === hero.spp && methodOf(o) === name);
  const ratio = c ? interval(c, `${report.metric}_ratio`).mean : NaN;
  return element('td', {class: 'number', style: `background: ${ratioColour(c?.against.includes('not compared') ? NaN : ratio)}`,
    tabindex: 0, title: c?.against ? `${name}, all recordings: ${c.against}` : false},
  name === report.baseline ? '1' : ratioText(ratio));
}

// The first methods of the table and the baseline over the budgets of one recording.
function drawHeroChart(target) {
  const names = new Set([...ownFirst(rankedMethods(hero.dump, hero.spp)).slice(0, 5), hero.baseline]);
  const points = report.combinations.filter((c) => c.dump === hero.dump && names.has(methodOf(c)) &&
    isPositive(interval(c, report.metric).mean));
  drawChart(target, points, {x: budgetOf, title: 'samples per pixel', ticks: budgetTicks(points), dodge: true, metric: report.metric, height: 300});
}
