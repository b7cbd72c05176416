// Decodes and checks a message of the monitor (idl/live.proto). A decoded message has lists of equal lengths, robot
// indices within the limits, and sizes that a page can hold.
import {PbfReader, PbfWriter} from 'pbf';
import {type FromPage, type ToPage, readToPage, writeFromPage} from './live.js';

export const limits = {
  messageBytes: 64 << 20,
  robots: 10_000,
  mapCells: 1 << 28,
};

/// The monitor sent something that this page does not understand.
export class ProtocolError extends Error {}

function require(holds: boolean, message: string): void {
  if (!holds) throw new ProtocolError(message);
}

function checkMap({map}: ToPage): void {
  if (!map) return;
  const cells = map.width * map.height;
  require(cells > 0 && cells <= limits.mapCells, `a map of ${map.width} x ${map.height} cells`);
  require(map.resolution > 0 && Number.isFinite(map.resolution), `a map whose cells are ${map.resolution} m`);
  require(Number.isFinite(map.origin_x) && Number.isFinite(map.origin_y), 'a map without a finite origin');
  require((map.occupancy?.length ?? 0) >= Math.ceil(cells / 8), 'a map with too few cells');
}

function checkFrame({frame}: ToPage): void {
  if (!frame) return;
  const robots = frame.x.length;
  require(robots <= limits.robots, `a frame of ${robots} robots`);
  require(Number.isFinite(frame.time), `a frame of time ${frame.time}`);
  const lists = [frame.y, frame.vx, frame.vy, frame.waits_for, frame.decision_time, frame.next_vx, frame.next_vy, frame.expiry, frame.age];
  for (const list of [...lists, frame.phase ?? [], frame.stage ?? []])
    require(list.length === robots, `a frame with lists of ${robots} and ${list.length} robots`);
  for (const list of [frame.to_go, frame.waiting, frame.idle, frame.silence])  // only for the table, and for marks
    require(list.length === robots || list.length === 0, `a frame with lists of ${robots} and ${list.length} robots`);
}

function checkRobots({roster, statuses, edges, path, alarms}: ToPage): void {
  require((roster?.robots.length ?? 0) <= limits.robots, 'a roster of too many robots');
  for (const status of statuses?.statuses ?? []) require(status.robot < limits.robots, `a status of robot ${status.robot}`);
  for (const alarm of alarms?.alarms ?? []) require(alarm.robot >= -1 && alarm.robot < limits.robots, `an alarm of robot ${alarm.robot}`);
  if (edges) require(edges.robot < limits.robots && edges.points.length % 4 === 0, 'edges of no robot, or not in fours');
  if (path) require(path.robot < limits.robots && path.points.length % 2 === 0, 'a path of no robot, or not in twos');
}

export function decode(bytes: ArrayBuffer): ToPage {
  require(bytes.byteLength <= limits.messageBytes, `a message of ${bytes.byteLength} bytes`);
  let message: ToPage;
  try {
    message = readToPage(new PbfReader(bytes));
  } catch (error) {
    throw new ProtocolError(`bytes that are not a message (${error instanceof Error ? error.message : error})`);
  }
  checkMap(message);
  checkFrame(message);
  checkRobots(message);
  return message;
}

export function encode(message: Partial<FromPage>): Uint8Array {
  const writer = new PbfWriter();
  writeFromPage(message, writer);
  return writer.finish();
}
