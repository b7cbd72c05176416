// All that the page knows of a fleet, and how a message changes it. Counters tell the views what has changed.
import {
  type AlarmsAlarm, type Begin, EdgesKind, type FiguresPoint, type Frame, type Life, LifeState, type Map as GridMap, type Path, type Playback,
  type RosterRobot,
  type StatusesStatus, type ToPage,
} from './live.js';
import {oldAfter} from './silence.ts';

export type Robot = RosterRobot;
export type Status = StatusesStatus;

/// Number of points of the time series to keep. With twice as many, every other point of the older half is dropped.
export const figuresKept = 5_000;

const byNumber = new Intl.Collator(undefined, {numeric: true});

export class Fleet {
  begin: Begin | undefined;
  map: GridMap | undefined;
  roster: Robot[] = [];
  statuses: (Status | undefined)[] = [];
  frame: Frame | undefined;  // the newest
  figures: FiguresPoint[] = [];
  playback: Playback | undefined;
  alarms: AlarmsAlarm[] = [];
  lost: ReadonlySet<number> = new Set();  // robots that are not heard any more
  beat = 0;  // the newest time of the monitor, seconds since the Unix epoch
  revision = {roster: 0, statuses: 0, figures: 0, alarms: 0};
  rank: number[] = [];  // order of the robots by name: r2 comes before r10
  private indices = new Map<string, number>();

  on(message: ToPage): void {
    if (message.begin) this.forget(message.begin);
    if (message.map) this.map = message.map;
    if (message.roster) this.takeRoster(message.roster.robots);
    if (message.statuses) this.takeStatuses(message.statuses.statuses);
    if (message.frame) this.frame = message.frame;
    if (message.figures) this.takeFigures(message.figures.points);
    if (message.playback) this.playback = message.playback;
    if (message.alarms) this.takeAlarms(message.alarms.alarms);
    if (message.beat) this.beat = message.beat.at;
  }

  indexOf(name: string): number | undefined {
    return this.indices.get(name);
  }

  /// Metres left of a robot's path; undefined without a path.
  toGo(robot: number): number | undefined {
    const metres = this.frame?.to_go[robot];
    return Number.isFinite(metres) ? metres : undefined;
  }

  /// Wall seconds since the robot was last heard.
  silenceOf(robot: number): number {
    return this.frame?.silence[robot] ?? 0;
  }
  /// Whether what is shown of the robot is old, though it does not count as lost yet.
  isOld(robot: number): boolean {
    return this.silenceOf(robot) > oldAfter && !this.lost.has(robot) && this.life?.state !== LifeState.ENDED;
  }

  /// Why a robot does not come on, and for how long it has not; none if it does.
  waitOf(robot: number): {seconds: number; cause: string} | undefined {
    const [seconds, cause] = [this.frame?.waiting[robot] ?? 0, this.statuses[robot]?.wait_cause ?? ''];
    return seconds > 0 && cause ? {seconds, cause} : undefined;
  }

  /// A robot's position in the map frame. Frames are relative to the map's origin.
  placeOf(robot: number): {x: number; y: number} | undefined {
    const {frame, map} = this;
    if (!frame || !Number.isFinite(frame.x[robot])) return undefined;
    return {x: (map?.origin_x ?? 0) + frame.x[robot], y: (map?.origin_y ?? 0) + frame.y[robot]};
  }

  /// Whether the map has an obstacle there. Beside the map there is one, too.
  isBlocked({x, y}: {x: number; y: number}): boolean {
    const {map} = this;
    if (!map) return false;
    const [i, j] = [Math.floor((x - map.origin_x) / map.resolution), Math.floor((y - map.origin_y) / map.resolution)];
    if (i < 0 || j < 0 || i >= map.width || j >= map.height) return true;
    const bit = i + j * map.width;
    return ((map.occupancy![bit >> 3] >> (bit & 7)) & 1) === 1;
  }

  get life(): Life | undefined {
    return this.frame?.life;
  }

  private forget(begin: Begin): void {
    this.begin = begin;
    this.map = this.frame = this.playback = undefined;
    this.roster = [];
    this.statuses = [];
    this.figures = [];
    this.indices.clear();
    this.takeAlarms([]);
    this.touch('roster', 'statuses', 'figures');
  }

  private takeRoster(robots: Robot[]): void {
    this.roster = robots;
    this.indices = new Map(robots.map((robot, index) => [robot.name, index]));
    const byName = [...robots.keys()].sort((a, b) => byNumber.compare(robots[a].name, robots[b].name));
    byName.forEach((robot, place) => (this.rank[robot] = place));
    this.touch('roster');
  }

  private takeStatuses(statuses: Status[]): void {
    for (const status of statuses) this.statuses[status.robot] = status;
    this.touch('statuses');
  }

  private takeAlarms(alarms: AlarmsAlarm[]): void {
    this.alarms = alarms;
    this.lost = new Set(alarms.filter(({kind}) => kind === 'robot_silent').map(({robot}) => robot));
    this.touch('alarms');
  }

  private takeFigures(points: FiguresPoint[]): void {
    for (const point of points) {
      const last = this.figures.at(-1);
      if (!last || point.time > last.time) this.figures.push(point);
    }
    if (this.figures.length > 2 * figuresKept)
      this.figures = this.figures.filter((_, k) => k >= figuresKept || k % 2 === 0);
    this.touch('figures');
  }

  private touch(...what: (keyof Fleet['revision'])[]): void {
    for (const each of what) ++this.revision[each];
  }
}

/// The part of a message that is drawn beneath the robots (background_scene.ts).
export type SceneChange =
  | {what: 'forget'}
  | {what: 'map'; map: GridMap}
  | {what: 'roster'; robots: Robot[]}
  | {what: 'edges'; kind: EdgesKind; robot: number; anew: boolean; points: Float32Array}
  | {what: 'path'; robot: number; points: Float32Array};

export function sceneChanges(message: ToPage): SceneChange[] {
  const changes: SceneChange[] = [];
  if (message.begin) changes.push({what: 'forget'});
  if (message.map) changes.push({what: 'map', map: message.map});
  if (message.roster) changes.push({what: 'roster', robots: message.roster.robots});
  if (message.edges) changes.push({what: 'edges', ...message.edges, points: new Float32Array(message.edges.points)});
  if (message.path) changes.push(pathChange(message.path));
  return changes;
}

function pathChange(path: Path): SceneChange {
  return {what: 'path', robot: path.robot, points: new Float32Array(path.points)};
}
