// The time series: small charts over fleet time with a common cursor. Only one chart is drawn at a time, in turn, so
// that the map loses no frame.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

import {element, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {clock, fixed, metres, milliseconds, percent} from './format.ts';
import type {FiguresPoint} from './live.js';

interface Series {
  label: string;
  colour: string;  // a variable of the style sheet
  value: (point: FiguresPoint) => number | null;
}

interface ChartSpec {
  title: string;
  hint: string;
  series: Series[];
  text: (value: number) => string;
  axis?: (value: number) => string;
}

const count = (value: number) => fixed(value, 0);

const charts: ChartSpec[] = [
  {title: 'Robots', hint: 'with a path, and arrived', text: count, series: [
    {label: 'planned', colour: 'series-b', value: (p) => p.planned},
    {label: 'arrived', colour: 'series-a', value: (p) => p.arrived},
  ]},
  {title: 'Trees', hint: 'published by brokers, and grafted by robots', text: count, series: [
    {label: 'published', colour: 'series-a', value: (p) => p.trees_published},
    {label: 'grafted', colour: 'series-b', value: (p) => p.trees_grafted},
  ]},
  {title: 'Separation', hint: 'least distance between two robots, edge to edge', text: metres, axis: (v) => String(+v.toPrecision(6)), series: [
    {label: '', colour: 'series-a', value: (p) => (p._separation ? p.separation : null)},
  ]},
  {title: 'State age', hint: 'of the states that robots use: median of all robots, and largest 99th percentile of a robot', text: milliseconds, axis: (v) => String(Math.round(v * 1000)), series: [
    {label: 'p50', colour: 'series-a', value: (p) => p.state_age_p50},
    {label: 'p99', colour: 'series-b', value: (p) => p.state_age_p99},
  ]},
  {title: 'Processors', hint: 'cores that agents and brokers use', text: (v) => fixed(v, 2), series: [
    {label: 'cores', colour: 'series-a', value: (p) => (p.processors >= 0 ? p.processors : null)},
  ]},
  {title: 'Periods missed', hint: 'recent share of all control periods', text: (v) => percent(v, 2), axis: (v) => `${+(v * 100).toPrecision(3)}%`, series: [
    {label: '', colour: 'series-b', value: (p) => p.periods_missed},
  ]},
];

const cursorGroup = 'figures';
const height = 96;  // pixels of a plot

export class Charts {
  private readonly plots: Plot[];
  private next = 0;

  constructor(private readonly frame: HTMLElement, private readonly fleet: Fleet) {
    this.plots = charts.map((spec) => new Plot(spec, frame));
  }

  /// Updates one chart. Called six times as often as each chart is drawn.
  updateNext(): void {
    if (this.frame.clientHeight === 0) return;  // not shown
    this.plots[this.next].update(this.fleet);
    this.next = (this.next + 1) % this.plots.length;
  }

  restyle(): void {
    for (const plot of this.plots) plot.restyle();
  }
}

class Plot {
  private plot: uPlot | undefined;
  private drawn = -1;  // revision
  private readonly holder = element('div', {className: 'plot'});
  private readonly readings: HTMLElement[];
  private values: uPlot.AlignedData = [[]];

  constructor(private readonly spec: ChartSpec, frame: HTMLElement) {
    this.readings = spec.series.map((series) => element('span', {className: `reading ${series.colour}`}));
    const caption = element('figcaption', {title: spec.hint}, element('b', {}, spec.title), ...this.readings);
    const figure = element('figure', {ariaLabel: `${spec.title}: ${spec.hint}`}, caption, this.holder);
    frame.append(figure);
    this.read(null);
    new ResizeObserver(() => this.plot?.setSize(this.size())).observe(this.holder);
  }

  update({figures, revision}: Fleet): void {
    if (this.drawn === revision.figures || (figures.length === 0 && !this.plot)) return;
    this.drawn = revision.figures;
    this.values = [figures.map((p) => p.time), ...this.spec.series.map((s) => figures.map(s.value))];
    if (!this.plot) this.restyle();
    else this.plot.setData(this.values);
    this.read(null);
  }

  /// uPlot reads its colours when it is created.
  restyle(): void {
    if (this.values[0].length === 0) return;
    this.plot?.destroy();
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(`--${name}`).trim();
    const axis = {
      stroke: colour('muted'), font: '10px ui-sans-serif, system-ui, "DejaVu Sans", sans-serif',
      grid: {stroke: colour('grid'), width: 1}, ticks: {show: false},
    };
    const {spec} = this;
    this.plot = new uPlot({
      ...this.size(),
      legend: {show: false},
      padding: [6, 14, 0, 0],
      cursor: {sync: {key: cursorGroup}, y: false, points: {size: 5}, drag: {x: false, y: false}},
      scales: {x: {time: false}, y: {range: (_, low, high) => rangeOf(low, high)}},
      series: [{}, ...spec.series.map(({label, colour: name}) => ({label, stroke: colour(name), width: 1.5, points: {show: false}}))],
      axes: [
        {...axis, size: 22, gap: 6, space: 56, values: (_, marks) => marks.map(clock)},
        {...axis, size: 38, gap: 3, space: 22, values: (_, marks) => marks.map(spec.axis ?? String)},
      ],
      hooks: {setCursor: [(plot) => this.read(plot.cursor.idx ?? null)]},
    }, this.values, this.holder);
  }

  private read(index: number | null): void {
    const at = index ?? this.values[0].length - 1;
    this.spec.series.forEach(({label}, k) => {
      const value = this.values[k + 1]?.[at];
      const text = value === null || value === undefined ? '–' : this.spec.text(value);
      setText(this.readings[k], label ? `${label} ${text}` : text);
    });
  }

  private size(): {width: number; height: number} {
    return {width: Math.max(60, this.holder.clientWidth), height};
  }
}

/// The range begins at 0, unless a value is below 0.
function rangeOf(low: number | null, high: number | null): [number, number] {
  const top = high ?? 1;
  return [Math.min(0, low ?? 0), top > 0 ? top * 1.08 : 1];
}
