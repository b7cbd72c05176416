// What an operator should look at now: the number of alarms in the line at the top, and a list in the side panel. New
// alarms are said aloud to those who do not see the page.
import {byId, element, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {clock} from './format.ts';

const most = 50;  // in the list

export class AlarmPanel {
  private readonly panel = byId('alarms');
  private readonly list = byId('alarm-list');
  private readonly count = byId<HTMLButtonElement>('alarm-count');
  private revision = -1;
  private told = new Set<string>();  // texts of alarms that last
  private ages: {node: HTMLElement; since: number}[] = [];

  constructor(private readonly fleet: Fleet, private readonly announced: HTMLElement, private readonly onPick: (robot: number) => void) {
    this.count.addEventListener('click', () => this.list.focus());
  }

  update(): void {
    if (this.revision !== this.fleet.revision.alarms) this.write();
    for (const {node, since} of this.ages) setText(node, since > 0 ? `for ${clock(this.fleet.beat - since)}` : '');
  }

  private write(): void {
    const {alarms} = this.fleet;
    this.revision = this.fleet.revision.alarms;
    this.panel.hidden = this.count.hidden = alarms.length === 0;
    setText(byId('alarm-number'), String(alarms.length));
    setText(byId('alarm-word'), alarms.length === 1 ? ' alarm' : ' alarms');
    this.count.ariaLabel = `${alarms.length} ${alarms.length === 1 ? 'alarm' : 'alarms'}`;
    this.ages = [];
    const items = alarms.slice(0, most).map(({robot, since, text}) => {
      const age = element('time');
      this.ages.push({node: age, since});
      const label = robot >= 0 ? this.toRobot(robot, text) : element('span', {}, text);
      return element('li', {}, label, age);
    });
    if (alarms.length > most) items.push(element('li', {}, `and ${alarms.length - most} more`));
    const hadFocus = this.list.contains(document.activeElement);
    this.list.replaceChildren(...items);
    if (hadFocus) this.list.focus();  // the button that had it is gone
    this.announce(alarms.map(({text}) => text));
  }

  private toRobot(robot: number, text: string): HTMLButtonElement {
    const button = element('button', {type: 'button', title: 'Show the robot'}, text);
    button.addEventListener('click', () => this.onPick(robot));
    return button;
  }

  private announce(texts: string[]): void {
    const fresh = texts.filter((text) => !this.told.has(text));
    this.told = new Set(texts);
    if (fresh.length > 0) this.announced.textContent = `Alarm: ${fresh.slice(0, 3).join('; ')}${fresh.length > 3 ? `; and ${fresh.length - 3} more` : ''}`;
  }
}
