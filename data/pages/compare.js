'use strict';
// Charts, viewer and table of a comparison. The page is whole without this: pictures and table are in it.
const rows = JSON.parse(document.getElementById('data').textContent);
const styles = {
  'none': ['#8a939b', 'rectRot'], 'static': ['#b07d2b', 'rect'], 'blend': ['#7a5ba8', 'triangle'], 'box': ['#3f7fc1', 'rectRounded'],
  'mem paper': ['#d98a9b', 'star'], 'mem': ['#0b6e5f', 'circle'], 'rerender': ['#c8452d', 'crossRot'], 'raytrace': ['#111820', 'rectRot'],
};
const colourOf = title => (styles[title] || ['#555'])[0];
const shapeOf = title => (styles[title] || [0, 'circle'])[1];
// Less than a twentieth of a millisecond is the clock's noise: drawn at the edge.
const leastTime = 0.05;
const timeOf = row => row.reflection_ms ? Math.max(row.reflection_ms.median, leastTime) : NaN;
const digits = (x, n) => x === null || !isFinite(x) ? '–' : x.toFixed(n);
const byNumber = (a, b) => a - b;
const carCounts = [...new Set(rows.map(r => r.cars))].sort(byNumber);
const titles = Object.keys(styles).filter(t => rows.some(r => r.title === t));
const hidden = new Set();

document.querySelectorAll('.key[data-method]').forEach(key => { key.style.background = colourOf(key.dataset.method); });

const measures = {
  'mean_flip': ['mean FLIP', r => r.mean_flip],
  'against_rerender.mean_flip': ['mean FLIP to re-rendering', r => r.against_rerender.mean_flip],
  'angle': ['angle of features, degrees', r => r.feature_angle_deg],
  'flicker': ['flicker, ‰', r => r.flicker === null ? null : 1000 * r.flicker],
  'mse': ['mean squared error', r => r.psnr_db === null ? null : Math.pow(10, -r.psnr_db / 10)],
};

/// The points that no other beats, by rising time.
function front(points) {
  const best = [];
  for (const p of [...points].sort((a, b) => a.x - b.x || a.y - b.y))
    if (!best.length || p.y < best[best.length - 1].y) best.push(p);
  return best;
}

Chart.defaults.font.family = getComputedStyle(document.documentElement).fontFamily;
Chart.defaults.font.size = 12;
Chart.defaults.color = '#5b6670';
Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;
Chart.defaults.devicePixelRatio = Math.max(2, window.devicePixelRatio || 1);
const charts = [], fronts = [];

const logTick = value => {
  const lead = value / Math.pow(10, Math.floor(Math.log10(value) + 1e-9));
  return [1, 2, 5].some(k => Math.abs(lead - k) < 1e-6) ? String(+value.toPrecision(3)) : '';
};
/// A little below the least, so that no mark stands on the edge.
const floorOf = values => { const known = values.filter(v => v > 0 && isFinite(v)); return known.length ? 0.8 * Math.min(...known) : undefined; };
const logAxis = (text, extra) => Object.assign({
  type: 'logarithmic', title: { display: true, text }, grid: { color: '#eceff1' }, ticks: { callback: logTick, maxRotation: 0, autoSkip: false },
}, extra);

function datasetsFor(cars, measure) {
  const value = measures[measure][1];
  const points = rows.filter(r => r.cars === cars && r.views === 'one' && r.title !== 'none' && !hidden.has(r.title))
    .map(row => ({ x: timeOf(row), y: value(row), row }))
    // What has no error at all has no place on a logarithmic axis.
    .filter(p => p.y !== null && isFinite(p.x) && p.y > 0);
  const sets = [{ label: 'front', type: 'line', data: front(points), stepped: 'after', borderColor: '#1c232b', borderWidth: 1.5,
    borderDash: [5, 4], pointRadius: 0, pointHitRadius: 0, order: 20 }];
  for (const title of titles.filter(t => t !== 'none' && !hidden.has(t))) {
    const own = points.filter(p => p.row.title === title), colour = colourOf(title);
    sets.push({ label: title + ' front', type: 'line', data: front(own), borderColor: colour, borderWidth: 2, pointRadius: 0, pointHitRadius: 0, order: 10 });
    sets.push({ label: title, data: own, backgroundColor: colour, borderColor: colour, borderWidth: shapeOf(title) === 'crossRot' || shapeOf(title) === 'star' ? 2 : 0,
      pointStyle: shapeOf(title), radius: own.map(p => p.row.default ? 8 : 4.5), hoverRadius: 9, order: 1 });
  }
  return sets;
}

for (const cars of carCounts) {
  const box = document.createElement('div');
  box.className = 'chart';
  box.innerHTML = '<h3>' + cars + (cars === 1 ? ' car' : ' cars') + ' on screen</h3><div class="canvas"><canvas></canvas></div>';
  document.getElementById('charts').append(box);
  const chart = new Chart(box.querySelector('canvas'), {
    type: 'scatter', data: { datasets: datasetsFor(cars, 'mean_flip') },
    options: {
      interaction: { mode: 'nearest', intersect: true },
      scales: { x: logAxis('reflections, ms a frame'), y: logAxis('mean FLIP') },
      plugins: { legend: { display: false }, tooltip: {
        filter: item => item.raw.row !== undefined && item.dataset.type !== 'line', displayColors: false, padding: 10,
        callbacks: {
          title: items => items.length ? items[0].raw.row.title + (items[0].raw.row.on_front ? '  (on the front)' : '') : '',
          label: item => {
            const r = item.raw.row;
            return [r.setting, digits(r.reflection_ms.median, 2) + ' ms, ' + digits(r.ratio_to_none, 2) + ' of the frame without',
              'FLIP ' + digits(r.mean_flip, 4) + ', PSNR ' + digits(r.psnr_db, 1) + ' dB, flicker ' + digits(1000 * r.flicker, 2) + '‰',
              digits(r.maps_updated_per_frame, 1) + ' maps a frame'];
          },
        } } },
    },
  });
  fit(chart);
  chart.update();
  charts.push(chart);
  fronts.push([cars, chart]);
}
function fit(chart) {
  const points = chart.data.datasets.flatMap(set => set.data);
  chart.options.scales.x.min = floorOf(points.map(p => p.x));
  chart.options.scales.y.min = floorOf(points.map(p => p.y));
}
function redraw() {
  const measure = document.getElementById('measure').value;
  for (const [cars, chart] of fronts) {
    chart.data.datasets = datasetsFor(cars, measure);
    chart.options.scales.y.title.text = measures[measure][0];
    fit(chart);
    chart.update();
  }
}
document.getElementById('measure').addEventListener('change', redraw);
const legend = document.getElementById('legend');
for (const title of titles.filter(t => t !== 'none')) {
  const item = document.createElement('li');
  item.innerHTML = '<i class="key" style="background:' + colourOf(title) + '"></i>' + title;
  item.addEventListener('click', () => {
    if (!hidden.delete(title)) hidden.add(title);
    item.classList.toggle('off', hidden.has(title));
    redraw();
  });
  legend.append(item);
}
legend.insertAdjacentHTML('beforeend', '<li style="cursor:default"><i class="key dashed"></i>Pareto front of all</li>');

const usual = (title, cars, views) => rows.find(r => r.title === title && r.default && r.cars === cars && r.views === views);
const lineOptions = (x, y) => ({ scales: { x, y }, plugins: { legend: { position: 'bottom', labels: { usePointStyle: true, boxWidth: 9, padding: 14 } },
  tooltip: { callbacks: { label: item => item.dataset.label + ': ' + digits(item.parsed.y, 2) + ' ms' } } } });
charts.push(new Chart(document.getElementById('by-cars'), {
  type: 'line', data: { labels: carCounts, datasets: titles.filter(t => t !== 'none').map(title => ({
    label: title, data: carCounts.map(cars => { const r = usual(title, cars, 'one'); return r ? timeOf(r) : null; }),
    borderColor: colourOf(title), backgroundColor: colourOf(title), pointStyle: shapeOf(title), pointRadius: 5, borderWidth: title === 'mem' ? 3 : 1.8 })) },
  options: lineOptions({ title: { display: true, text: 'cars on screen' }, grid: { color: '#eceff1' } }, logAxis('ms a frame')),
}));
const kinds = [['one', 'one view'], ['eyes', 'two eyes'], ['four', 'four displays']], most = carCounts[carCounts.length - 1];
charts.push(new Chart(document.getElementById('by-views'), {
  type: 'bar', data: { labels: kinds.map(k => k[1]), datasets: titles.filter(t => t !== 'none' && usual(t, most, 'four')).map(title => ({
    label: title, data: kinds.map(([kind]) => { const r = usual(title, most, kind); return r ? timeOf(r) : null; }), backgroundColor: colourOf(title), pointStyle: 'rect' })) },
  options: lineOptions({ grid: { display: false } }, logAxis('ms a frame')),
}));

// Windows: a line for each number of mirrors in a row.
const windowRows = JSON.parse(document.getElementById('window-data').textContent);
if (windowRows.length) {
  const usual = windowRows.filter(r => r.place === 'street' && !r.wet);
  const depths = [...new Set(usual.map(r => r.depth))].sort(byNumber), shades = ['#8a939b', '#0b6e5f', '#3f7fc1', '#7a5ba8', '#c8452d'];
  const lines = (x, y) => depths.map((depth, i) => ({ label: depth === 0 ? 'no mirror' : depth === 1 ? 'one mirror' : depth + ' mirrors in a row',
    data: usual.filter(r => r.depth === depth && r[y] !== null).map(row => ({ x: row[x], y: row[y], row })).sort((a, b) => a.x - b.x),
    borderColor: shades[i % shades.length], backgroundColor: shades[i % shades.length], showLine: depth > 0, pointRadius: 5, borderWidth: 2 }));
  const line = (label, keep, x, y, colour) => ({ label, data: windowRows.filter(r => keep(r) && r[y] !== null).map(row => ({ x: row[x], y: row[y], row })).sort((a, b) => a.x - b.x),
    borderColor: colour, backgroundColor: colour, showLine: true, pointRadius: 5, borderWidth: 2 });
  const about = { callbacks: { label: item => { const r = item.raw.row; return r.method + ': ' + r.passes + ' passes, ' + digits(r.ratio_to_painted, 2) +
    ' of painted, ' + digits(r.psnr_db, 1) + ' dB, FLIP ' + digits(r.mean_flip, 4); } } };
  const wetLine = (x, y) => line('wet street', r => r.wet, x, y, '#2b4a6f');
  for (const [id, x, y, across, up] of [['windows-cost', 'passes', 'ratio_to_painted', 'reflections drawn a frame', 'time, of painted windows'],
    ['windows-error', 'ratio_to_painted', 'mean_flip', 'time, of painted windows', 'mean FLIP on glass'],
    ['windows-count', 'fronts', 'ratio_to_painted', 'fronts that mirror', 'time, of painted windows']])
    charts.push(new Chart(document.getElementById(id), { type: 'scatter', data: { datasets: id === 'windows-count' ? [line('where most fronts are in view', r => r.place === 'fronts', x, y, '#0b6e5f')] : [...lines(x, y), wetLine(x, y)] }, options: {
      scales: { x: { title: { display: true, text: across }, grid: { color: '#eceff1' } }, y: { title: { display: true, text: up }, grid: { color: '#eceff1' } } },
      plugins: { legend: { position: 'bottom', labels: { usePointStyle: true, boxWidth: 9, padding: 14 } }, tooltip: about } } }));
}

// Paper shows a picture of each chart, drawn at paper's proportions: a canvas does not follow another layout.
for (const chart of charts) {
  const paper = document.createElement('img');
  paper.className = 'paper';
  paper.alt = '';
  chart.canvas.parentNode.after(paper);
  chart.paper = paper;
}
function drawForPaper() {
  for (const chart of charts) {
    chart.resize(520, 350);
    chart.paper.src = chart.toBase64Image();
    chart.resize();
  }
}
window.addEventListener('beforeprint', drawForPaper);

// The viewer: one method at a time beside the truth.
document.querySelectorAll('.strip').forEach(strip => {
  const truth = strip.querySelector('.truth').src, figures = [...strip.querySelectorAll('figure[data-method]')];
  if (!figures.length) return;
  const viewer = document.createElement('div');
  viewer.className = 'viewer';
  viewer.innerHTML = '<div class="slider"><img class="under" alt="the method"><img class="over" alt="the truth">' +
    '<input type="range" min="0" max="100" step="0.1" value="50" aria-label="where the truth ends and the method begins"><div class="bar"></div>' +
    '<span class="left">truth</span><span class="right"></span></div><img class="apart" alt="difference"><div class="caption"></div>';
  const [under, over, slider, bar, right] = ['.under', '.over', 'input', '.bar', '.right'].map(s => viewer.querySelector(s));
  over.src = truth;
  const place = () => { over.style.clipPath = 'inset(0 ' + (100 - slider.value) + '% 0 0)'; bar.style.left = slider.value + '%'; };
  slider.addEventListener('input', place);
  const tabs = strip.querySelector('.tabs');
  figures.forEach(figure => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = figure.dataset.method;
    button.addEventListener('click', () => {
      tabs.querySelectorAll('button').forEach(b => b.setAttribute('aria-pressed', b === button));
      under.src = figure.querySelector('.method').src;
      viewer.querySelector('.apart').src = figure.querySelector('.difference').src;
      viewer.querySelector('.caption').innerHTML = figure.querySelector('figcaption').innerHTML;
      right.textContent = figure.dataset.method;
    });
    tabs.append(button);
    if (figure.dataset.method === 'mem' || figure === figures[0]) button.click();
  });
  place();
  strip.append(viewer);
  strip.classList.add('live');
});

// Sorting by a heading; a second click turns it round.
const table = document.getElementById('rows'), body = table.tBodies[0];
[...table.tHead.rows[0].cells].forEach((heading, column) => heading.addEventListener('click', () => {
  const down = heading.getAttribute('aria-sort') === 'ascending';
  [...table.tHead.rows[0].cells].forEach(h => h.removeAttribute('aria-sort'));
  heading.setAttribute('aria-sort', down ? 'descending' : 'ascending');
  const key = row => { const c = row.cells[column], v = c.dataset.v ?? c.textContent; return v === '' || isNaN(v) ? v : +v; };
  const order = (a, b) => {
    const x = key(a), y = key(b);
    if (x === '' || y === '') return (x === '') - (y === '');
    return (down ? -1 : 1) * (typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y)));
  };
  body.append(...[...body.rows].sort(order));
}));
