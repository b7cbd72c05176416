// The table of robots. Only visible rows exist, and only changed cells are written.
import {missedShare, whyMissed, whyOld, whySilent} from './alarms.ts';
import {element, setText, sign} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {compact} from './format.ts';
import {type Shown, asPhase, lost, phaseNames, phaseOrder} from './phases.ts';

const spare = 3;       // rows beyond the visible ones

interface Column {
  title: string;
  hint: string;
  text: (fleet: Fleet, robot: number) => string;
  key: (fleet: Fleet, robot: number) => number;
  alarm?: (fleet: Fleet, robot: number) => string;  // explains what is wrong; empty: nothing
}

const speed = ({frame}: Fleet, k: number) => (frame ? Math.hypot(frame.vx[k], frame.vy[k]) : NaN);
const age = ({statuses}: Fleet, k: number) => statuses[k]?.state_age_p99;
const times = (factor: number, value: number | undefined) => (value === undefined ? undefined : factor * value);
const share = ({statuses}: Fleet, k: number) => {
  const of = statuses[k]?.processor_share;
  return of !== undefined && of >= 0 ? of : undefined;
};

/// What a robot does; what it said last means nothing once it is not heard any more.
export function phaseOf(fleet: Fleet, robot: number): Shown {
  if (fleet.lost.has(robot)) return lost;
  const byte = fleet.frame?.phase?.[robot] ?? fleet.statuses[robot]?.phase ?? 0;
  return asPhase(byte);
}

const columns: Column[] = [
  {title: 'Robot', hint: 'name', text: ({roster}, k) => roster[k].name, key: ({rank}, k) => rank[k]},
  {title: 'Phase', hint: 'what the robot is doing', alarm: whySilent, text: (f, k) => phaseNames[phaseOf(f, k)], key: (f, k) => phaseOrder[phaseOf(f, k)]},
  {title: 'm/s', hint: 'speed, m/s', text: (f, k) => compact(speed(f, k), 1), key: speed},
  {title: 'To go', hint: 'distance left along its path, m', text: (f, k) => compact(f.toGo(k), 1), key: (f, k) => f.toGo(k) ?? NaN},
  {
    title: 'Age ms', hint: 'age of the states of other robots when it uses them, 99th percentile, ms', alarm: whyOld,
    text: (f, k) => compact(times(1000, age(f, k)), 0), key: (f, k) => age(f, k) ?? NaN,
  },
  {
    title: 'Late %', hint: 'recent share of control periods missed for lack of processor time, %', alarm: whyMissed,
    text: (f, k) => compact(times(100, missedShare(f, k)), 1), key: (f, k) => missedShare(f, k) ?? NaN,
  },
  {title: 'CPU %', hint: 'recent share of one core, %', text: (f, k) => compact(times(100, share(f, k)), 0), key: (f, k) => share(f, k) ?? NaN},
];

/// Unknown values come last in both directions.
function compare(a: number, b: number, descending: boolean): number {
  if (Number.isNaN(a) || Number.isNaN(b)) return Number(Number.isNaN(a)) - Number(Number.isNaN(b));
  return descending ? b - a : a - b;
}

interface Row {
  element: HTMLTableRowElement;
  texts: Text[];  // one per column
  sign: SVGSVGElement;
  robot: number;
  phase: number;
}

export class RobotTable {
  private sortedBy = 0;
  private descending = false;
  private order: number[] = [];
  private rows: Row[] = [];
  private filter = '';
  private readonly head = element('tr');
  private readonly body = element('tbody');
  private readonly above = element('tr', {className: 'spacer', ariaHidden: 'true'});
  private readonly below = element('tr', {className: 'spacer', ariaHidden: 'true'});
  private readonly table = element('table');
  private rowHeight = 26;  // pixels: --row of style.css, which is greater for fingers

  constructor(
    private readonly frame: HTMLElement,  // scrolls
    private readonly fleet: Fleet,
    private readonly selected: () => number,
    private readonly onPick: (robot: number) => void,
  ) {
    this.table.ariaLabel = 'Robots';
    this.table.append(element('thead', {}, this.head), this.body);
    this.frame.append(this.table);
    this.body.append(this.above, this.below);
    columns.forEach((column, k) => this.head.append(this.header(column, k)));
    this.showSorting();
    frame.addEventListener('scroll', () => this.update(), {passive: true});
    frame.addEventListener('keydown', (event) => this.onKey(event));
    new ResizeObserver(() => this.update()).observe(frame);
  }

  search(text: string): void {
    this.filter = text.trim().toLowerCase();
    this.frame.scrollTop = 0;
    this.update();
  }

  /// The robots in the order of the table.
  sort(): number[] {
    const {fleet} = this;
    const {key} = columns[this.sortedBy];
    const keys = fleet.roster.map((_, k) => key(fleet, k));
    const robots = [...keys.keys()].filter((k) => !this.filter || fleet.roster[k].name.toLowerCase().includes(this.filter));
    return robots.sort((a, b) => compare(keys[a], keys[b], this.descending) || a - b);
  }

  update(): void {
    const height = this.frame.clientHeight;
    if (height === 0) return;  // not shown
    this.order = this.sort();
    this.rowHeight = parseFloat(getComputedStyle(this.frame).getPropertyValue('--row'));
    const {rowHeight} = this;
    const first = Math.max(0, Math.min(Math.floor(this.frame.scrollTop / rowHeight) - spare, this.order.length - 1));
    const count = Math.min(this.order.length - first, Math.ceil(height / rowHeight) + 2 * spare);
    this.setRowCount(Math.max(0, count));
    setHeight(this.above, first * rowHeight);
    setHeight(this.below, (this.order.length - first - count) * rowHeight);
    this.table.ariaRowCount = String(this.order.length + 1);
    this.rows.forEach((row, k) => this.write(row, first + k));
  }

  /// Scrolls to the selected robot's row.
  reveal(robot: number): void {
    const place = this.order.indexOf(robot);
    if (place < 0) return;
    const {rowHeight} = this;
    const top = place * rowHeight;
    const height = this.frame.clientHeight - 2 * rowHeight;
    if (top < this.frame.scrollTop || top > this.frame.scrollTop + height)
      this.frame.scrollTop = Math.max(0, top - height / 2);
    this.update();
  }

  private header(column: Column, k: number): HTMLTableCellElement {
    const button = element('button', {type: 'button', title: `${column.hint}: sort`}, column.title);
    button.addEventListener('click', () => {
      this.descending = this.sortedBy === k && !this.descending;
      this.sortedBy = k;
      this.showSorting();
      this.update();
    });
    return element('th', {scope: 'col'}, button);
  }

  private showSorting(): void {
    [...this.head.children].forEach((cell, k) => {
      cell.ariaSort = k !== this.sortedBy ? 'none' : this.descending ? 'descending' : 'ascending';
    });
  }

  private setRowCount(count: number): void {
    while (this.rows.length > count) this.rows.pop()!.element.remove();
    while (this.rows.length < count) {
      const row = this.makeRow();
      this.rows.push(row);
      this.below.before(row.element);
    }
  }

  private makeRow(): Row {
    const texts = columns.map(() => new Text());
    const cells = texts.map((text) => element('td', {}, text));
    const row: Row = {element: element('tr', {}, ...cells), texts, sign: sign('phase-0'), robot: -1, phase: -1};
    cells[1].prepend(row.sign);
    row.element.addEventListener('click', () => this.onPick(row.robot));
    return row;
  }

  private write(row: Row, place: number): void {
    const robot = this.order[place];
    const phase = phaseOf(this.fleet, robot);
    row.robot = robot;
    if (row.phase !== phase) {
      row.phase = phase;
      row.sign.setAttribute('class', `sign phase-${phase}`);
      row.sign.firstElementChild!.setAttribute('href', `#phase-${phase}`);
    }
    columns.forEach((column, k) => {
      setText(row.texts[k], column.text(this.fleet, robot));
      if (column.alarm) setAlarm(row.texts[k].parentElement!, column.alarm(this.fleet, robot));
    });
    const selected = robot === this.selected();
    if (row.element.classList.contains('selected') !== selected) row.element.classList.toggle('selected', selected);
    const index = String(place + 2);
    if (row.element.ariaRowIndex !== index) row.element.ariaRowIndex = index;
    const told = selected ? 'true' : 'false';
    if (row.element.ariaSelected !== told) row.element.ariaSelected = told;
  }

  private onKey(event: KeyboardEvent): void {
    const steps: Record<string, number> = {ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10, Home: -Infinity, End: Infinity};
    const step = steps[event.key];
    if (step === undefined || this.order.length === 0 || event.target !== this.frame) return;
    event.preventDefault();
    event.stopPropagation();
    const place = this.order.indexOf(this.selected()) + step;
    const robot = this.order[Math.max(0, Math.min(this.order.length - 1, place))];
    this.onPick(robot);
    this.reveal(robot);
  }
}

function setAlarm(cell: HTMLElement, why: string): void {
  if (cell.title === why) return;
  cell.title = why;
  cell.classList.toggle('alarm', why !== '');
}

function setHeight(spacer: HTMLTableRowElement, pixels: number): void {
  const height = `${pixels}px`;
  if (spacer.style.height !== height) spacer.style.height = height;
}
