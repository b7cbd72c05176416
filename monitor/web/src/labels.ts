// Places for the names of robots on the map: beside the robot, where the name covers neither a robot nor another name. A
// robot keeps its place as long as that is free, so that names do not jump.

export interface Body {
  x: number;  // pixels, of the middle
  y: number;
  size: number;  // radius
}

export interface Label {
  robot: number;
  x: number;  // left end of the text's base line
  y: number;
}

interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

const height = 11;     // pixels of the text
const gap = 2;         // between robot and name
const cell = 48;       // pixels: boxes are looked up by squares of this size
const mostNamed = 1_000;  // robots: of more, only those that are marked have names, as drawing takes too long

/// Where a name may stand, the preferred place first.
const sides: readonly ((body: Body, width: number) => {x: number; y: number})[] = [
  ({x, y, size}, width) => ({x: x - width / 2, y: y - size - gap - 1}),
  ({x, y, size}, width) => ({x: x - width / 2, y: y + size + gap + height - 2}),
  ({x, y, size}) => ({x: x + size + gap, y: y + height / 2 - 2}),
  ({x, y, size}, width) => ({x: x - size - gap - width, y: y + height / 2 - 2}),
];

/// Boxes by the squares that they touch.
class Taken {
  private readonly squares = new Map<number, Box[]>();

  isFree(box: Box, own?: Box): boolean {
    return this.near(box).every((boxes) => boxes.every((other) => other === own || !overlap(box, other)));
  }
  add(box: Box): void {
    for (const square of squaresOf(box)) {
      const boxes = this.squares.get(square);
      if (boxes) boxes.push(box);
      else this.squares.set(square, [box]);
    }
  }
  private near(box: Box): Box[][] {
    return squaresOf(box).map((square) => this.squares.get(square) ?? []);
  }
}

export class Labels {
  private sideOf: number[] = [];
  private readonly widths = new Map<string, number>();

  /// `robots`: those that want a name, the most important first. `all`: those that no name may cover.
  place(
    robots: readonly number[], all: readonly number[], nameOf: (robot: number) => string, bodyOf: (robot: number) => Body, measure: (text: string) => number,
    isMarked: (robot: number) => boolean, {width, height: high}: {width: number; height: number},
  ): Label[] {
    const taken = new Taken();
    const own = new Map<number, Box>();
    for (const k of all) {
      const box = boxOf(bodyOf(k));
      own.set(k, box);
      taken.add(box);
    }
    const labels: Label[] = [];
    for (const robot of robots) {
      const always = isMarked(robot);
      if (!always && robots.length > mostNamed) continue;
      const name = nameOf(robot);
      const long = this.widthOf(name, measure);
      const body = bodyOf(robot);
      const before = this.sideOf[robot] ?? 0;
      const fits = (side: number) => {
        const {x, y} = sides[side](body, long);
        const box = {left: x, top: y - height, right: x + long, bottom: y + 2};
        return box.left >= 0 && box.top >= 0 && box.right <= width && box.bottom <= high && taken.isFree(box, own.get(robot));
      };
      const side = [before, 0, 1, 2, 3].find(fits) ?? (always ? 0 : undefined);
      if (side === undefined) continue;
      this.sideOf[robot] = side;
      const at = sides[side](body, long);
      taken.add({left: at.x, top: at.y - height, right: at.x + long, bottom: at.y + 2});
      labels.push({robot, ...at});
    }
    return labels;
  }

  private widthOf(name: string, measure: (text: string) => number): number {
    let width = this.widths.get(name);
    if (width === undefined) this.widths.set(name, (width = measure(name)));
    return width;
  }
}

function boxOf({x, y, size}: Body): Box {
  return {left: x - size, top: y - size, right: x + size, bottom: y + size};
}

function overlap(a: Box, b: Box): boolean {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

function squaresOf({left, top, right, bottom}: Box): number[] {
  const squares: number[] = [];
  for (let i = Math.floor(left / cell); i <= Math.floor(right / cell); ++i)
    for (let j = Math.floor(top / cell); j <= Math.floor(bottom / cell); ++j) squares.push(i * 65_536 + j);
  return squares;
}
