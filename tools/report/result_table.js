// All combinations as a table: sorted by a click or Enter on a header, filtered by words and by the
// choices above. Tablesort moves the rows; empty values are always at the bottom when ascending.
Tablesort.extend('quantity', () => false, (a, b) => {
  const [x, y] = [a, b].map((text) => (text === '' ? Infinity : Number(text)));
  return x === y ? 0 : y > x ? 1 : -1;
});

const chosenColumns = new Set([report.metric, `${report.metric}_ratio`, 'mse', 'relmse_trimmed',
  'energy_ratio', 'seconds_total', 'saturated_share'].filter((name) => quantityIndex.has(name)));

function startTable(area) {
  const search = element('input', {type: 'search', placeholder: 'words, for example: chess gaussian 8spp',
    'aria-label': 'Show rows that hold these words'});
  const count = element('p', {class: 'note', id: 'row-count', 'aria-live': 'polite'});
  const holder = element('div', {class: 'scroll tall', tabindex: '0', role: 'region',
    'aria-label': 'All results'});
  const columns = element('details', {class: 'columns'}, element('summary', {}, 'Columns'));
  for (const q of report.quantities) {
    const box = element('input', {type: 'checkbox', checked: chosenColumns.has(q.name)});
    box.addEventListener('change', () => {
      if (box.checked) chosenColumns.add(q.name); else chosenColumns.delete(q.name);
      build();
    });
    columns.append(element('label', {title: q.meaning}, box, ' ' + q.name));
  }
  area.append(element('div', {class: 'controls'}, element('label', {class: 'grow'}, 'Find ', search),
    element('button', {type: 'button', onclick: () => saveText('results.csv', 'text/csv', allResultsCsv())}, 'CSV'), columns),
    count, holder);
  let rows = [];

  function build() {
    const sorted = holder.querySelector('th[aria-sort]');
    const [column, order] = [sorted?.dataset.name, sorted?.getAttribute('aria-sort')];
    const built = buildTable();
    rows = built.rows;
    holder.replaceChildren(built.table);
    const sorter = new Tablesort(built.table);
    const again = [...built.table.tHead.rows[0].cells].find((cell) => cell.dataset.name === column);
    if (again) {
      sorter.sortTable(again);
      if (order === 'descending') sorter.sortTable(again);
    }
    filter();
  }
  function filter() {
    const words = search.value.toLowerCase().split(/\s+/).filter((word) => word !== '');
    let visible = 0;
    for (const row of rows) {
      row.node.hidden = !(isShown(row.combination) && words.every((word) => row.words.includes(word)));
      if (!row.node.hidden) ++visible;
    }
    count.textContent = `${visible} of ${rows.length} combinations; means over replicates, 95 % ` +
      'intervals below. Click a heading to sort.';
  }
  search.addEventListener('input', filter);
  listeners.push(filter);
  build();
}
starts['table-area'] = startTable;

function buildTable() {
  const texts = ['recording', 'sampler', 'filter'];
  const quantities = report.quantities.filter((q) => chosenColumns.has(q.name));
  const head = element('tr');
  for (const name of texts) head.append(element('th', {scope: 'col', 'data-name': name}, name));
  for (const [name, title] of [['spp', 'samples per pixel'], ['n', 'replicates']]) {
    head.append(element('th', {scope: 'col', 'data-sort-method': 'quantity', 'data-name': name, title}, name));
  }
  for (const q of quantities) {
    head.append(element('th', {scope: 'col', 'data-sort-method': 'quantity', 'data-name': q.name,
      title: q.meaning}, q.name));
  }
  const body = element('tbody');
  const rows = report.combinations.map((combination) => {
    const fields = [report.dumps[combination.dump], report.samplers[combination.sampler],
      report.filters[combination.filter]];
    const node = element('tr', {},
      ...fields.map((text) => element('td', {class: 'name'}, text)),
      element('td', {'data-sort': combination.spp, class: 'number'}, String(combination.spp)),
      element('td', {'data-sort': combination.replicates, class: 'number'},
        combination.replicates + (combination.failed ? ` (${combination.failed} failed)` : '')),
      ...quantities.map((q) => quantityCell(interval(combination, q.name), isRatio(q.name) ? ratioText : numberText)));
    body.append(node);
    return {node, combination, words: `${fields.join(' ')} ${combination.spp}spp`.toLowerCase()};
  });
  return {table: element('table', {class: 'results', id: 'results'}, element('thead', {}, head), body), rows};
}

const isRatio = (name) => name.endsWith('_ratio') && quantityIndex.has(name.slice(0, -'_ratio'.length));  // of two methods

function quantityCell({mean, low, high}, text) {
  const cell = element('td', {class: 'number', 'data-sort': Number.isNaN(mean) ? '' : mean}, text(mean, 4));
  if (Number.isFinite(low) && low !== high) {
    cell.append(element('small', {}, `[${text(low, 4)}, ${text(high, 4)}]`));
  }
  return cell;
}
