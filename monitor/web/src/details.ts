// All that is known of one robot, as a list of terms and values that are written only when they change.
import {byId, element, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {fixed, metres, milliseconds, percent} from './format.ts';
import {phaseNames, stageNames, type Stage} from './phases.ts';
import {phaseOf} from './table.ts';

interface Line {
  term: string;
  value: (fleet: Fleet, robot: number) => string;
}

const place = (x: number | undefined, y: number | undefined) => `${fixed(x, 2)}, ${fixed(y, 2)}`;
const positive = (value: number | undefined) => (value !== undefined && value > 0 ? value : undefined);

const groups: {title: string; lines: Line[]}[] = [
  {title: 'Motion', lines: [
    {term: 'Position', value: ({frame}, k) => place(frame?.x[k], frame?.y[k])},
    {term: 'Velocity', value: ({frame}, k) => place(frame?.vx[k], frame?.vy[k])},
    {term: 'Speed', value: ({frame, roster}, k) => `${fixed(frame && Math.hypot(frame.vx[k], frame.vy[k]), 1)} of ${fixed(roster[k].max_speed, 1, 'm/s')}`},
    {term: 'Stage', value: ({frame}, k) => stageNames[(frame?.stage?.[k] ?? 0) as Stage] ?? '–'},
    {term: 'Waits for', value: ({frame, roster}, k) => roster[frame?.waits_for[k] ?? -1]?.name ?? 'nobody'},
    {term: 'Heard', value: ({frame}, k) => `${milliseconds(frame?.age[k])} ago`},
  ]},
  {title: 'Planning', lines: [
    {term: 'Plan time', value: ({statuses}, k) => fixed(positive(statuses[k]?.plan_seconds), 3, 's')},
    {term: 'Nodes valid', value: ({statuses}, k) => fixed(statuses[k]?.nodes_valid, 0)},
    {term: 'Nodes invalid', value: ({statuses}, k) => fixed(statuses[k]?.nodes_invalid, 0)},
    {term: 'Trees received', value: ({statuses}, k) => fixed(statuses[k]?.trees_received, 0)},
    {term: 'Trees grafted', value: ({statuses}, k) => fixed(statuses[k]?.trees_grafted, 0)},
  ]},
  {title: 'Body', lines: [
    {term: 'Radius', value: ({roster}, k) => metres(roster[k].radius)},
    {term: 'Acceleration', value: ({roster}, k) => `up to ${fixed(roster[k].max_acceleration, 1, 'm/s²')}`},
  ]},
  {title: 'Mission', lines: [
    {term: 'Number', value: ({roster}, k) => (roster[k].mission > 0 ? String(roster[k].mission) : 'none yet')},
    {term: 'Start', value: ({roster}, k) => place(roster[k].start_x, roster[k].start_y)},
    {term: 'Goal', value: ({roster}, k) => place(roster[k].goal_x, roster[k].goal_y)},
    {term: 'Tolerance', value: ({roster}, k) => metres(roster[k].goal_tolerance)},
    {term: 'Path', value: ({statuses}, k) => metres(positive(statuses[k]?.path_length))},
    {term: 'Driven', value: ({statuses}, k) => metres(statuses[k]?.driven_length)},
    {term: 'To go', value: (fleet, k) => metres(fleet.toGo(k))},
    {term: 'Arrived at', value: ({statuses}, k) => fixed(positive(statuses[k]?.arrival_time), 2, 's')},
    {term: 'Fulfilled', value: ({statuses}, k) => fixed(statuses[k]?.missions_fulfilled, 0)},
  ]},
  {title: 'Process', lines: [
    {term: 'Of one core', value: ({statuses}, k) => {
      const share = statuses[k]?.processor_share;
      return share !== undefined && share >= 0 ? percent(share, 1) : 'not known';
    }},
    {term: 'Periods missed', value: ({statuses}, k) => `${fixed(statuses[k]?.periods_missed, 0)} of ${fixed(statuses[k]?.periods, 0)}`},
    {term: 'Age median', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_p50)},
    {term: 'Age p99', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_p99)},
    {term: 'Age most', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_max)},
    {term: 'Rejected', value: ({statuses}, k) => `${fixed(statuses[k]?.rejected, 0)} messages`},
  ]},
];

export class Details {
  private readonly panel = byId('details');
  private readonly name = byId('details-name');
  private readonly phase = byId('details-phase');
  private readonly reason = byId('details-reason');
  private readonly values: {node: HTMLElement; line: Line}[] = [];

  constructor(private readonly fleet: Fleet) {
    const columns = element('div', {className: 'columns'});
    byId('details-body').append(columns);
    for (const {title, lines} of groups) {
      const list = element('dl');
      for (const line of lines) {
        const node = element('dd');
        this.values.push({node, line});
        list.append(element('dt', {}, line.term), node);
      }
      columns.append(element('section', {}, element('h3', {}, title), list));
    }
  }

  update(robot: number): void {
    const known = robot in this.fleet.roster;
    if (this.panel.hidden === known) this.panel.hidden = !known;
    document.body.classList.toggle('has-selection', known);
    if (!known || this.panel.clientHeight === 0) return;
    const phase = phaseOf(this.fleet, robot);
    setText(this.name, this.fleet.roster[robot].name);
    setText(this.phase, phaseNames[phase]);
    const tag = `phase-tag phase-${phase}`;
    if (this.phase.className !== tag) this.phase.className = tag;
    setText(this.reason, this.fleet.statuses[robot]?.reason ?? '');
    for (const {node, line} of this.values) setText(node, line.value(this.fleet, robot));
  }
}
