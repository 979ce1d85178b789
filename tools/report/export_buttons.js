// Files made in the page from what it shows, without a connection: CSV and LaTeX of tables, SVG of charts.
function saveText(name, type, text) {
  const link = element('a', {href: URL.createObjectURL(new Blob([text], {type})), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const csvField = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
const csvText = (rows) => rows.map((row) => row.map(csvField).join(',')).join('\n') + '\n';
const latexText = (text) => text.replace(/[\\{}$&#_%~^]/g, (c) => ({'\\': '\\textbackslash{}', '~': '\\textasciitilde{}',
  '^': '\\textasciicircum{}'}[c] ?? `\\${c}`));

// Rows of {texts, bold}: bold is the set of columns that a verdict put there.
function latexTable(head, rows) {
  const line = (texts) => `  ${texts.join(' & ')} \\\\`;
  return ['% needs \\usepackage{booktabs}', `\\begin{tabular}{l${'r'.repeat(head.length - 1)}}`, '\\toprule',
    line(head.map(latexText)), '\\midrule', ...rows.map(({texts, bold}) => line(texts.map(
      (text, i) => (bold.has(i) ? `\\textbf{${latexText(text)}}` : latexText(text))))), '\\bottomrule', '\\end{tabular}', ''].join('\n');
}

// The headline's values and ratios. Bold: the first of its ranking, where the file separates it from every other.
function headlineRows() {
  const conditions = report.conditions.filter((c) => c.spp === hero.spp);
  const head = [`method, ${metricText(report.metric)}`, ...conditions.map((c) => `${report.dumps[c.dump]}, ${hero.spp} spp`)];
  const rows = headlineMethods().map((name) => {
    const bold = new Set();
    const texts = conditions.map((condition, i) => {
      const index = condition.field.find((k) => methodOf(report.combinations[k]) === name);
      if (index === undefined) return '';
      if (condition.alone && condition.field[0] === index) bold.add(i + 1);
      const value = interval(report.combinations[index], report.metric);
      return numberText(value.mean, 3) + (value.low === value.high ? '' : boundsText(value, 3));
    });
    return {texts: [name, ...texts], bold};
  });
  return {head, rows};
}

function exportButtons() {
  const button = (text, name, type, made) => element('button', {type: 'button', onclick: () => {
    const {head, rows} = headlineRows();
    saveText(name, type, made(head, rows));
  }}, text);
  return element('span', {class: 'buttons', role: 'group', 'aria-label': 'Save the table'},
    button('CSV', 'headline.csv', 'text/csv', (head, rows) => csvText([head, ...rows.map((r) => r.texts)])),
    button('LaTeX', 'headline.tex', 'text/plain', latexTable));
}

// Plotly draws its charts as SVG: the same, as a file.
async function saveChart(target, name) {
  const address = await Plotly.toImage(target, {format: 'svg', width: 720, height: 480});
  saveText(`${name}.svg`, 'image/svg+xml', decodeURIComponent(address.slice(address.indexOf(',') + 1)));
}

// Every combination with all its quantities, as the table has them.
function allResultsCsv() {
  const head = ['recording', 'sampler', 'filter', 'spp', 'replicates', ...report.quantities.flatMap(
    (q) => [q.name, `${q.name}_low`, `${q.name}_high`])];
  const number = (value) => (Number.isNaN(value) ? '' : String(value));
  const rows = report.combinations.filter(isShown).map((c) => [report.dumps[c.dump], report.samplers[c.sampler],
    report.filters[c.filter], String(c.spp), String(c.replicates), ...report.quantities.flatMap((q) => {
      const {mean, low, high} = interval(c, q.name);
      return [number(mean), number(low), number(high)];
    })]);
  return csvText([head, ...rows]);
}
