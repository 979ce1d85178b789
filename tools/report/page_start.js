// Fills the areas that the page holds; whichever fails says so in its place.
for (const [id, start] of [['headline-area', startHeadline], ['chart-area', startCharts], ['table-area', startTable], ['image-area', startImages], ['live-area', startLive]]) {
  const area = document.getElementById(id);
  if (!area) continue;
  try {
    start(area);
  } catch (error) {
    area.append(element('p', {class: 'warning'}, `This part cannot be shown: ${error.message}`));
    throw error;
  }
}
