// The number of robots in each phase.
import {element, setText, sign} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {type Shown, phaseNames, shownCount} from './phases.ts';
import {phaseOf} from './table.ts';

export class PhaseCounts {
  private readonly items: {item: HTMLElement; count: HTMLElement}[];

  constructor(list: HTMLElement, private readonly fleet: Fleet) {
    this.items = Array.from({length: shownCount}, (_, phase) => {
      const count = element('b');
      const item = element('li', {hidden: true}, sign(`phase-${phase}`), count, phaseNames[phase as Shown]);
      list.append(item);
      return {item, count};
    });
  }

  update(): void {
    const counts = new Array<number>(shownCount).fill(0);
    for (const robot of this.fleet.roster.keys()) ++counts[phaseOf(this.fleet, robot)];
    this.items.forEach(({item, count}, phase) => {
      const hidden = counts[phase] === 0;
      if (item.hidden !== hidden) item.hidden = hidden;
      setText(count, String(counts[phase]));
    });
  }
}
