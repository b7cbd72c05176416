// All that is known of one robot, as a list of terms and values. Values are written only when they change.
import {alarmsOf} from './alarms.ts';
import {byId, element, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {fixed, metres, milliseconds, percent} from './format.ts';
import {phaseNames, stageNames, type Stage} from './phases.ts';
import {phaseOf} from './table.ts';

interface Line {
  term: string;
  hint: string;
  value: (fleet: Fleet, robot: number) => string;
}

const place = (x: number | undefined, y: number | undefined) => `${fixed(x, 2)}, ${fixed(y, 2)}`;
const exactPlace = (at: {x: number; y: number} | undefined) => `${fixed(at?.x, 3)}, ${fixed(at?.y, 3)}`;
const waitOf = (fleet: Fleet, k: number) => {
  const wait = fleet.waitOf(k);
  return wait ? `${fixed(wait.seconds, 1, 's')}: ${wait.cause}` : 'no';
};
const positive = (value: number | undefined) => (value !== undefined && value > 0 ? value : undefined);

const finite = (value: number | undefined) => (value !== undefined && Number.isFinite(value) ? value : undefined);

const groups: {title: string; lines: Line[]}[] = [
  {title: 'Motion', lines: [
    {term: 'Position', hint: 'metres in the map frame', value: (fleet, k) => exactPlace(fleet.placeOf(k))},
    {term: 'No nearer', hint: 'time since it last came nearer to the end of its path', value: ({frame}, k) => `for ${fixed(frame?.idle[k], 1, 's')}`},
    {term: 'Velocity', hint: 'x and y, m/s', value: ({frame}, k) => place(frame?.vx[k], frame?.vy[k])},
    {term: 'Speed', hint: 'now, and greatest', value: ({frame, roster}, k) => `${fixed(frame && Math.hypot(frame.vx[k], frame.vy[k]), 1)} of ${fixed(roster[k].max_speed, 1, 'm/s')}`},
    {term: 'Yaw', hint: 'of a robot that turns: from the x axis towards the y axis', value: ({frame}, k) => fixed(finite(frame?.yaw?.[k]), 2, 'rad')},
    {term: 'Stage', hint: 'whether it drives by itself, or takes part in a joint plan of several robots', value: ({frame}, k) => stageNames[(frame?.stage?.[k] ?? 0) as Stage] ?? '–'},
    {term: 'Waits', hint: 'how long it has not come on, and why, in the words of its agent', value: waitOf},
    {term: 'Heard', hint: 'age of the newest state that the monitor has received from it', value: ({frame}, k) => `${milliseconds(frame?.age[k])} ago`},
  ]},
  {title: 'Planning', lines: [
    {term: 'Plan time', hint: 'from its mission to its first path, by the wall clock', value: ({statuses}, k) => fixed(positive(statuses[k]?.plan_seconds), 3, 's')},
    {term: 'Nodes valid', hint: 'samples that joined one of its trees', value: ({statuses}, k) => fixed(statuses[k]?.nodes_valid, 0)},
    {term: 'Nodes invalid', hint: 'samples that hit an obstacle', value: ({statuses}, k) => fixed(statuses[k]?.nodes_invalid, 0)},
    {term: 'Trees received', hint: 'shared trees that it has received', value: ({statuses}, k) => fixed(statuses[k]?.trees_received, 0)},
    {term: 'Trees grafted', hint: 'shared trees that it has grafted', value: ({statuses}, k) => fixed(statuses[k]?.trees_grafted, 0)},
  ]},
  {title: 'Body', lines: [
    {term: 'Radius', hint: 'of its disc, or of that which holds its footprint', value: ({roster}, k) => metres(roster[k].radius)},
    {term: 'Acceleration', hint: 'greatest acceleration and braking', value: ({roster}, k) => `up to ${fixed(roster[k].max_acceleration, 1, 'm/s²')}`},
  ]},
  {title: 'Mission', lines: [
    {term: 'Number', hint: 'of its mission in this run', value: ({roster}, k) => (roster[k].mission > 0 ? String(roster[k].mission) : 'none yet')},
    {term: 'Start', hint: 'of its mission, metres in the map frame', value: ({roster}, k) => place(roster[k].start_x, roster[k].start_y)},
    {term: 'Goal', hint: 'of its mission, metres in the map frame', value: ({roster}, k) => place(roster[k].goal_x, roster[k].goal_y)},
    {term: 'Tolerance', hint: 'greatest distance from its goal at which it has arrived', value: ({roster}, k) => metres(roster[k].goal_tolerance)},
    {term: 'Path', hint: 'length of the path that it follows', value: ({statuses}, k) => metres(positive(statuses[k]?.path_length))},
    {term: 'Driven', hint: 'in this mission', value: ({statuses}, k) => metres(statuses[k]?.driven_length)},
    {term: 'Waited', hint: 'in this mission, in all', value: ({statuses}, k) => fixed(positive(statuses[k]?.waited), 1, 's')},
    {term: 'To go', hint: 'from its position to its path, and along it to its end', value: (fleet, k) => metres(fleet.toGo(k))},
    {term: 'Arrived at', hint: 'fleet time', value: ({statuses}, k) => fixed(positive(statuses[k]?.arrival_time), 2, 's')},
    {term: 'Fulfilled', hint: 'missions in this run', value: ({statuses}, k) => fixed(statuses[k]?.missions_fulfilled, 0)},
  ]},
  {title: 'Process', lines: [
    {term: 'Of one core', hint: 'recent processor time of its agent', value: ({statuses}, k) => {
      const share = statuses[k]?.processor_share;
      return share !== undefined && share >= 0 ? percent(share, 1) : 'not known';
    }},
    {term: 'Periods missed', hint: 'control periods (20 per second) that were over before its agent decided, for lack of processor time', value: ({statuses}, k) => `${fixed(statuses[k]?.periods_missed, 0)} of ${fixed(statuses[k]?.periods, 0)}`},
    {term: 'Age median', hint: 'age of the states that it uses, of robots that it might touch soon: half are newer', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_p50)},
    {term: 'Age p99', hint: 'the same: 99 of 100 are newer', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_p99)},
    {term: 'Age most', hint: 'the same: the oldest', value: ({statuses}, k) => milliseconds(statuses[k]?.state_age_max)},
    {term: 'Rejected', hint: 'messages that its agent dropped as invalid', value: ({statuses}, k) => `${fixed(statuses[k]?.rejected, 0)} messages`},
  ]},
];

export class Details {
  private readonly panel = byId('details');
  private readonly name = byId('details-name');
  private readonly phase = byId('details-phase');
  private readonly alarms = byId('details-alarms');
  private alarmsShown = '';
  private readonly values: {node: HTMLElement; line: Line}[] = [];

  constructor(private readonly fleet: Fleet) {
    const columns = element('div', {className: 'columns'});
    byId('details-body').append(columns);
    for (const {title, lines} of groups) {
      const list = element('dl');
      for (const line of lines) {
        const node = element('dd');
        this.values.push({node, line});
        node.title = line.hint;
        list.append(element('dt', {title: line.hint}, line.term), node);
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
    this.showAlarms(alarmsOf(this.fleet, robot));
    for (const {node, line} of this.values) setText(node, line.value(this.fleet, robot));
  }
  private showAlarms(alarms: string[]): void {
    const text = alarms.join('\n');
    if (text === this.alarmsShown) return;
    this.alarmsShown = text;
    this.alarms.replaceChildren(...alarms.map((alarm) => element('li', {}, alarm)));
  }
}

/// The meaning of each figure of a robot, for the help.
export const figuresExplained: readonly {term: string; hint: string}[] = groups.flatMap(({lines}) => lines);
